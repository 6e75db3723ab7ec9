#include "module/remote_channels.hpp"

#include <array>

#include "module/dbus_protocol.hpp"
#include "module/sbus_protocol.hpp"

namespace rc10 {
namespace {

// The default deadband: one wrong frame does not make a stick of one that is released.
constexpr double kStickTolerance = 0.05;
// Counts of a frame: a hand that aims moves by fewer.
constexpr double kMouseTolerance = 20.0;

template <typename Protocol>
class ChannelsOf : public RemoteChannels {
 public:
  [[nodiscard]] const std::vector<std::string>& names() const noexcept override { return names_; }
  [[nodiscard]] std::unique_ptr<I_Protocol> takeProtocol() override { return std::move(owned_); }
  [[nodiscard]] Duration age(MonotonicTime now) const noexcept override {
    return protocol_->input().age(now);
  }

 protected:
  explicit ChannelsOf(std::vector<std::string> names)
      : names_(std::move(names)), owned_(std::make_unique<Protocol>()), protocol_(owned_.get()) {}
  [[nodiscard]] const auto& input() const noexcept { return protocol_->input().value; }

 private:
  std::vector<std::string> names_;
  std::unique_ptr<Protocol> owned_;
  const Protocol* protocol_;
};

[[nodiscard]] double switchValue(Dr16Input::Switch position) noexcept {
  switch (position) {
    case Dr16Input::Switch::kUp: return 1.0;
    case Dr16Input::Switch::kDown: return -1.0;
    case Dr16Input::Switch::kMiddle: break;
  }
  return 0.0;
}

// The keys in the order of their bits.
constexpr std::array<const char*, 16> kKeyboardChannels{
    "key_w", "key_s", "key_a", "key_d", "key_shift", "key_ctrl", "key_q", "key_e",
    "key_r", "key_f", "key_g", "key_z", "key_x",     "key_c",    "key_v", "key_b"};

class DbusChannels final : public ChannelsOf<DbusProtocol> {
 public:
  DbusChannels() : ChannelsOf(channelNames()) {}
  [[nodiscard]] SerialFormat format() const noexcept override {
    return {.baud = 100'000, .data_bits = 8, .parity = Parity::kEven, .stop_bits = 1};
  }
  // The protocol has no flag for it: the receiver falls silent, or repeats its last frame.
  [[nodiscard]] bool saysLost() const noexcept override { return false; }

  [[nodiscard]] double tolerance(std::size_t channel) const noexcept override {
    constexpr std::size_t kSticks = 5;  // with the wheel
    constexpr std::size_t kMouse = 7;
    constexpr std::size_t kMouseEnd = 10;
    if (channel < kSticks) return kStickTolerance;
    return channel >= kMouse && channel < kMouseEnd ? kMouseTolerance : 0.0;
  }

  void read(std::span<double> values) const noexcept override {
    const auto& in = input();
    const auto stick = [](std::int16_t raw) { return static_cast<double>(raw) / Dr16Input::kFullDeflection; };
    const std::array<double, 12> fixed{stick(in.right_horizontal),
                                       stick(in.right_vertical),
                                       stick(in.left_horizontal),
                                       stick(in.left_vertical),
                                       stick(in.wheel),
                                       switchValue(in.right_switch),
                                       switchValue(in.left_switch),
                                       static_cast<double>(in.mouse_x),
                                       static_cast<double>(in.mouse_y),
                                       static_cast<double>(in.mouse_z),
                                       in.mouse_left ? 1.0 : 0.0,
                                       in.mouse_right ? 1.0 : 0.0};
    std::copy(fixed.begin(), fixed.end(), values.begin());
    for (std::size_t key = 0; key < kKeyboardChannels.size(); ++key)
      values[fixed.size() + key] = (in.keys >> key & 1U) != 0U ? 1.0 : 0.0;
  }

 private:
  [[nodiscard]] static std::vector<std::string> channelNames() {
    std::vector<std::string> names{"right_x", "right_y",      "left_x",      "left_y",
                                   "wheel",   "right_switch", "left_switch", "mouse_x",
                                   "mouse_y", "mouse_z",      "mouse_left",  "mouse_right"};
    names.insert(names.end(), kKeyboardChannels.begin(), kKeyboardChannels.end());
    return names;
  }
};

class SbusChannels final : public ChannelsOf<SbusProtocol> {
 public:
  SbusChannels() : ChannelsOf(channelNames()) {}
  [[nodiscard]] SerialFormat format() const noexcept override {
    return {.baud = 100'000, .data_bits = 8, .parity = Parity::kEven, .stop_bits = 2};
  }
  [[nodiscard]] bool saysLost() const noexcept override { return input().failsafe || input().frame_lost; }

  [[nodiscard]] double tolerance(std::size_t channel) const noexcept override {
    return channel < SbusInput::kChannels ? kStickTolerance : 0.0;
  }

  void read(std::span<double> values) const noexcept override {
    const auto& in = input();
    for (std::size_t i = 0; i < SbusInput::kChannels; ++i) values[i] = static_cast<double>(in.deflection(i));
    for (std::size_t i = 0; i < in.digital.size(); ++i)
      values[SbusInput::kChannels + i] = in.digital[i] ? 1.0 : 0.0;
  }

 private:
  [[nodiscard]] static std::vector<std::string> channelNames() {
    std::vector<std::string> names;
    for (int i = 1; i <= 18; ++i) names.push_back("ch" + std::to_string(i));
    return names;
  }
};

}  // namespace

std::unique_ptr<RemoteChannels> RemoteChannels::make(std::string_view protocol) {
  if (protocol == "dbus") return std::make_unique<DbusChannels>();
  if (protocol == "sbus") return std::make_unique<SbusChannels>();
  return nullptr;
}

}  // namespace rc10
