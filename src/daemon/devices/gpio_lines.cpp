#include "daemon/devices/gpio_lines.hpp"

#include <gpiod.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/errno_text.hpp"

namespace rc10 {
namespace {

struct ChipCloser {
  void operator()(gpiod_chip* chip) const noexcept { gpiod_chip_close(chip); }  // releases its lines too
};
using Chip = std::unique_ptr<gpiod_chip, ChipCloser>;

struct Line {
  Chip chip;
  gpiod_line* line = nullptr;
};

// A path, a name or a label. Not gpiod_chip_open_lookup(): that asks every chip for its label first, and
// fails if one of them may not be opened.
[[nodiscard]] Chip openChip(const std::string& name) noexcept {
  if (name.starts_with("/")) return Chip{gpiod_chip_open(name.c_str())};
  Chip chip{gpiod_chip_open_by_name(name.c_str())};
  if (chip || errno != ENOENT) return chip;
  return Chip{gpiod_chip_open_by_label(name.c_str())};
}

[[nodiscard]] std::string remedy(int error, const std::string& chip) {
  switch (error) {
    case ENOENT: return fmt::format("there is no chip '{}'; `gpiodetect` lists the chips", chip);
    case EACCES:
    case EPERM:
      return "this user may not use it: join the group that owns /dev/gpiochip* (`gpio` on Raspberry Pi OS), "
             "and let the unit have it: the drop-in gpio.conf, docs/installing.md";
    case EBUSY: return "another program or the kernel uses the line; `gpioinfo` says who";
    case EINVAL: return "the kernel cannot do this: it needs CONFIG_GPIO_CDEV_V1, which libgpiod 1 uses";
    case ENXIO:
    case ENOTSUP: return "the chip is gone, or cannot do this; use a line of another chip";
    default: return "see `gpiodetect` and `gpioinfo`";
  }
}

[[nodiscard]] tl::unexpected<Error> refusal(std::string_view key, const GpioPin& pin, int error) {
  return fail(fmt::format("{}: {}: {}: {}", key, pin.name(), errnoText(error), remedy(error, pin.chip)));
}

[[nodiscard]] Result<Line> findLine(std::string_view key, const GpioPin& pin) {
  Line line{.chip = openChip(pin.chip)};
  if (!line.chip) return refusal(key, pin, errno);
  const auto lines = gpiod_chip_num_lines(line.chip.get());
  if (static_cast<unsigned>(pin.line) >= lines) {
    return fail(
        fmt::format("{}: {}: the chip has lines 0 to {}; `gpioinfo` lists them", key, pin.name(), lines - 1));
  }
  line.line = gpiod_chip_get_line(line.chip.get(), static_cast<unsigned>(pin.line));
  if (line.line == nullptr) return refusal(key, pin, errno);
  return line;
}

/// 0, or the errno of the refusal. `high`: of an output.
[[nodiscard]] int request(gpiod_line* line, const char* consumer, int type, int flags,
                          bool high = false) noexcept {
  const gpiod_line_request_config config{.consumer = consumer, .request_type = type, .flags = flags};
  return gpiod_line_request(line, &config, high ? 1 : 0) == 0 ? 0 : errno;
}

class GpioContact final : public ContactInput {
 public:
  /// `edges`: whether the line was taken with edges. A chip without interrupts is only read, each time.
  GpioContact(Line line, bool closed_is_low, bool edges)
      : line_(std::move(line)),
        closed_level_(closed_is_low ? 0 : 1),
        opening_(closed_is_low ? GPIOD_LINE_EVENT_RISING_EDGE : GPIOD_LINE_EVENT_FALLING_EDGE),
        fd_(edges ? gpiod_line_event_get_fd(line_.line) : -1) {}

  [[nodiscard]] ContactState wait(Duration timeout) noexcept override {
    bool opened = false;
    if (fd_ >= 0 && !awaitEdges(timeout, opened)) return ContactState::kUnreadable;
    const int level = gpiod_line_get_value(line_.line);
    if (level < 0) return ContactState::kUnreadable;
    return opened || level != closed_level_ ? ContactState::kOpen : ContactState::kClosed;
  }

 private:
  [[nodiscard]] bool awaitEdges(Duration timeout, bool& opened) const noexcept {
    pollfd edges{.fd = fd_, .events = POLLIN, .revents = 0};
    const timespec limit{.tv_sec = 0, .tv_nsec = std::clamp<std::int64_t>(timeout.count(), 0, 999'999'999)};
    const int ready = ::ppoll(&edges, 1, &limit, nullptr);
    if (ready <= 0) return ready == 0 || errno == EINTR;
    return (edges.revents & POLLIN) != 0 && takeEdges(opened);
  }
  // The kernel keeps 16 edges and drops further ones: the level is read after them.
  [[nodiscard]] bool takeEdges(bool& opened) const noexcept {
    std::array<gpiod_line_event, 16> events{};
    const int count =
        gpiod_line_event_read_fd_multiple(fd_, events.data(), static_cast<unsigned>(events.size()));
    if (count < 0) return false;
    const auto seen = std::span(events).first(static_cast<std::size_t>(count));
    opened = std::any_of(seen.begin(), seen.end(),
                         [this](const auto& event) { return event.event_type == opening_; });
    return true;
  }

  Line line_;
  int closed_level_;
  int opening_;
  int fd_;
};

class GpioInput final : public DigitalInput {
 public:
  explicit GpioInput(Line line) : line_(std::move(line)) {}
  [[nodiscard]] std::optional<bool> high() noexcept override {
    const int level = gpiod_line_get_value(line_.line);
    return level < 0 ? std::nullopt : std::optional{level == 1};
  }

 private:
  Line line_;
};

class GpioOutput final : public DigitalOutput {
 public:
  explicit GpioOutput(Line line) : line_(std::move(line)) {}
  [[nodiscard]] bool set(bool high) noexcept override {
    return gpiod_line_set_value(line_.line, high ? 1 : 0) == 0;
  }

 private:
  Line line_;
};

[[nodiscard]] int biasOf(const ContactGpioConfig& config) noexcept {
  if (!config.internal_bias) return GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
  // An open wire must read as open.
  return config.closed_is_low ? GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP : GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
}

[[nodiscard]] int flagOf(GpioBias bias) noexcept {
  switch (bias) {
    case GpioBias::kAsIs: break;
    case GpioBias::kNone: return GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
    case GpioBias::kPullUp: return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case GpioBias::kPullDown: return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
  }
  return 0;
}

class KernelGpio final : public GpioSystem {
 public:
  [[nodiscard]] Result<std::unique_ptr<DigitalInput>> openInput(const std::string& user, const GpioPin& pin,
                                                                GpioBias bias) override {
    auto line = take(user, pin, GPIOD_LINE_REQUEST_DIRECTION_INPUT, flagOf(bias), false);
    if (!line) return tl::unexpected(line.error());
    return std::make_unique<GpioInput>(std::move(*line));
  }
  [[nodiscard]] Result<std::unique_ptr<DigitalOutput>> openOutput(const std::string& user, const GpioPin& pin,
                                                                  bool high) override {
    auto line = take(user, pin, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, 0, high);
    if (!line) return tl::unexpected(line.error());
    return std::make_unique<GpioOutput>(std::move(*line));
  }

 private:
  [[nodiscard]] static Result<Line> take(const std::string& user, const GpioPin& pin, int type, int flags,
                                         bool high) {
    auto line = findLine(user, pin);
    if (!line) return line;
    const std::string consumer = "rc10d " + user;
    const int error = request(line->line, consumer.c_str(), type, flags, high);
    if (error != 0) return refusal(user, pin, error);
    return line;
  }
};

}  // namespace

std::unique_ptr<GpioSystem> kernelGpio() { return std::make_unique<KernelGpio>(); }

Result<std::unique_ptr<ContactInput>> openContact(const ContactGpioConfig& config, const char* key) {
  const std::string consumer = std::string("rc10d ") + key;
  auto line = findLine(key, config.pin);
  if (!line) return tl::unexpected(line.error());
  const int bias = biasOf(config);
  int error = request(line->line, consumer.c_str(), GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES, bias);
  // Errors of a line without an interrupt, as on many I2C expanders.
  const bool edges = error != ENODEV && error != ENXIO && error != ENOTSUP;
  if (!edges) error = request(line->line, consumer.c_str(), GPIOD_LINE_REQUEST_DIRECTION_INPUT, bias);
  if (error != 0) return refusal(key, config.pin, error);
  return std::make_unique<GpioContact>(std::move(*line), config.closed_is_low, edges);
}

Result<std::unique_ptr<DigitalOutput>> openPulse(const HeartbeatGpioConfig& config) {
  constexpr const char* kKey = "heartbeat_gpio";
  auto line = findLine(kKey, config.pin);
  if (!line) return tl::unexpected(line.error());
  const int error = request(line->line, "rc10d heartbeat", GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, 0);
  if (error != 0) return refusal(kKey, config.pin, error);
  return std::make_unique<GpioOutput>(std::move(*line));
}

}  // namespace rc10
