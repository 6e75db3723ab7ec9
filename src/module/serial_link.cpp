#include "module/serial_link.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "module/held_back.hpp"
#include "module/modbus_rtu.hpp"
#include "module/serial_link_codec.hpp"
#include "module/serial_link_keys.hpp"
#include "module/silence.hpp"

namespace rc10 {
namespace {

// Gap of the ticks after which the outputs are safe again, as in a GPIO module.
constexpr Duration kLongestGapOfTicks = std::chrono::milliseconds{200};

/// A field that is sent, as an output that keeps to its safe value.
struct LinkOutput {
  double low = 0.0;
  double high = 0.0;
  double safe = 0.0;
  bool keeps_at_estop = false;
  HeldBack held_back{};
};

[[nodiscard]] ModuleSignals linkSignals(const OwnValues& own) {
  ModuleSignals signals;
  for (const auto& row : own.rows("send")) signals.inputs.push_back(row.text("name"));
  for (const auto& row : own.rows("receive")) signals.outputs.push_back(row.text("name"));
  for (const auto& row : own.rows("send")) signals.outputs.push_back(row.text("name"));
  for (const auto name : kLinkSignals) signals.outputs.emplace_back(name);
  signals.events = {
      {.text = "the board is silent: its values mean nothing; see its power, wires (TX to RX), baud rate and "
               "protocol"},
      {.text = "the board is back", .expected = true},
      {.text =
           "after a start, an e-stop or a loss of its line a field is sent with its safe value until it is "
           "commanded so once, or not at all for 1 s",
       .expected = true}};
  return signals;
}

[[nodiscard]] std::unique_ptr<SerialLinkCodec> codecOf(const OwnValues& own, const SerialFormat& format) {
  auto received = linkFields(own, "receive");
  auto sent = linkFields(own, "send");
  const auto protocol = own.text("protocol");
  if (protocol == "text") return makeTextCodec(std::move(received), std::move(sent));
  if (protocol == "cobs") return makeCobsCodec(std::move(received), std::move(sent));
  return makeModbusCodec({.address = static_cast<std::uint8_t>(own.integer("address")),
                          .byte_time = format.byteTime(),
                          .frame_gap = ModbusRtu::frameGap(format),
                          .timeout = std::chrono::milliseconds{own.integer("timeout_ms")},
                          .low_word_first = own.text("word_order") == "low_first"},
                         std::move(received), std::move(sent));
}

class SerialLink : public Module_Base {
 public:
  SerialLink(const OwnValues& own, const SerialFormat& format)
      : Module_Base(linkSignals(own)),
        path_(own.text("port")),
        format_(format),
        period_(std::chrono::nanoseconds{std::chrono::seconds{1}} / own.integer("rate_hz")),
        max_age_(std::chrono::milliseconds{own.integer("max_age_ms")}),
        codec_(codecOf(own, format)) {
    for (const auto& row : own.rows("send")) {
      const auto range = linkRange(row, own.text("protocol"));
      sent_.push_back({.low = std::max(row.number("min"), range.low),
                       .high = std::min(row.number("max"), range.high),
                       .safe = row.number("safe_value"),
                       .keeps_at_estop = row.text("on_estop") == "keep"});
    }
    values_.resize(sent_.size());
    before_.resize(sent_.size());
  }

  [[nodiscard]] std::optional<SerialNeed> takeSerialNeed() override {
    return SerialNeed{.path = path_, .format = format_, .protocol = codec_->takeProtocol()};
  }
  void useSerial(SerialDevice& device) noexcept override { device_ = &device; }

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    const bool open = device_ != nullptr && device_->state() == SerialState::kOpen;
    decideValues(tick, robot, open);
    send(tick, open);
    tellReceived(tick, robot);
    const std::size_t link = codec_->received().fields.size() + sent_.size();
    setOutput(link, open ? 1.0 : 0.0);
    setOutput(link + 2, static_cast<double>(codec_->errors() + skipped_));
  }

  // As outputs of a GPIO module: safe at the end, whatever on_estop says.
  void rest(const Tick& tick) noexcept override {
    for (std::size_t i = 0; i < sent_.size(); ++i) values_[i] = sent_[i].safe;
    send(tick, device_ != nullptr && device_->state() == SerialState::kOpen);
  }

 private:
  enum LinkEvent : std::size_t { kSilent, kBack, kHeldBack };

  void send(const Tick& tick, bool open) noexcept {
    bool urgent = false;
    for (std::size_t i = 0; i < sent_.size(); ++i)
      urgent |= values_[i] == sent_[i].safe && before_[i] != values_[i];
    auto round = tick.now >= next_ ? SerialLinkCodec::Round::kBegins : SerialLinkCodec::Round::kGoesOn;
    if (urgent) round = SerialLinkCodec::Round::kUrgent;
    // At most one round waits: old values are not sent before new ones.
    if (open && round != SerialLinkCodec::Round::kGoesOn && device_->pendingBytes() > 0) {
      if (!urgent) ++skipped_;
      if (!urgent) next_ = tick.now + period_;
      round = SerialLinkCodec::Round::kGoesOn;
    }
    if (round != SerialLinkCodec::Round::kGoesOn) {
      next_ = next_ + period_ > tick.now ? next_ + period_ : tick.now + period_;
      if (open) before_ = values_;
    }
    if (open) codec_->step(*device_, values_, round, tick.now);
  }

  void decideValues(const Tick& tick, ModuleRobot& robot, bool open) noexcept {
    const bool running = robot.state() == RobotStatus::kRun;
    const bool lost = (was_open_ && !open) || (last_tick_ && tick.now - *last_tick_ > kLongestGapOfTicks);
    was_open_ = open;
    last_tick_ = tick.now;
    bool held_back = false;
    bool in_vain = false;
    const std::size_t first = codec_->received().fields.size();
    for (std::size_t i = 0; i < sent_.size(); ++i) {
      auto& output = sent_[i];
      const bool given = std::isfinite(input(i));
      const double wanted = given ? std::clamp(input(i), output.low, output.high) : output.safe;
      const bool safe = wanted == output.safe;
      const bool held = output.held_back.step(
          {.given = given, .safe = safe},
          {.usable = running && open, .dropped = lost || (!running && !output.keeps_at_estop)}, tick);
      held_back |= held;
      in_vain |= running && held && !safe;
      values_[i] = held ? output.safe : wanted;
      setOutput(first + i, open ? values_[i] : kNoSignal);
    }
    if (in_vain && !std::exchange(told_, true)) robot.report(kHeldBack);
    if (!held_back) told_ = false;
  }

  void tellReceived(const Tick& tick, ModuleRobot& robot) noexcept {
    const auto& readings = codec_->received().readings;
    Duration oldest{};
    bool fresh = !readings.empty();
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const auto& reading = readings[i];
      const Duration age = reading.received ? tick.now - *reading.received : Duration::max();
      setOutput(i, age <= max_age_ ? reading.value : kNoSignal);
      oldest = std::max(oldest, age);
      fresh = fresh && age <= max_age_;
    }
    setAge(readings.size() + sent_.size() + 1, readings.empty() ? Duration::max() : oldest);
    silence_.watch(fresh, robot);
  }

  std::string path_;
  SerialFormat format_;
  Duration period_;
  Duration max_age_;
  std::unique_ptr<SerialLinkCodec> codec_;
  std::vector<LinkOutput> sent_;
  std::vector<double> values_;  ///< Values in this tick.
  std::vector<double> before_;  ///< Values as they were sent last.
  std::uint64_t skipped_ = 0;   ///< Rounds that the line had no room for.
  SerialDevice* device_ = nullptr;
  MonotonicTime next_{};
  Silence silence_{kSilent, kBack};
  bool told_ = false;
  bool was_open_ = false;
  std::optional<MonotonicTime> last_tick_;
};

class SerialLinkType : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "serial_link"; }
  [[nodiscard]] std::string_view about() const noexcept override {
    return "A board of one's own on a serial port: its fields are inputs and outputs.";
  }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return serialLinkKeys(); }

  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& settings,
                                                           const RobotOutline& robot) const override {
    const auto format = checkSerialLink(settings.own, robot.tick_hz);
    if (!format) return tl::unexpected(format.error());
    return std::make_unique<SerialLink>(settings.own, *format);
  }
};

}  // namespace

const ModuleType& serialLinkType() noexcept {
  static const SerialLinkType kType;
  return kType;
}

}  // namespace rc10
