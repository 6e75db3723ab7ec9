#include "drives/vesc/vesc_family.hpp"

#include <algorithm>
#include <memory>
#include <string>

#include "drives/vesc/vesc_motor.hpp"

namespace rc10 {
namespace {

constexpr std::array<std::string_view, 1> kVescModels{"VESC"};
constexpr int kAsksPerSecond = 10;
// Packets 0 to 63 with its own id or 255: firmware compares the low byte, and all that it knows is below 64.
constexpr std::uint32_t kObeyedMask = 0x1FFF'C0FF;

class VescFamily final : public MotorFamily {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "VESC"; }
  [[nodiscard]] std::span<const std::string_view> models() const noexcept override { return kVescModels; }
  [[nodiscard]] std::span<const FamilyKey> keys() const noexcept override { return vescKeys(); }

  [[nodiscard]] MotorTraits traits(std::string_view /*model*/, const OwnValues& own) const override {
    return vescTraits(VescOptions{own});
  }

  [[nodiscard]] Result<void> check(const MotorSettings& settings) const override {
    const VescOptions options{settings.own};
    if (options.host_id == settings.id) {
      return fail("host_id: " + std::to_string(options.host_id) + " is this drive's own id; give a free one");
    }
    if (options.angle != VescAngle::kTachometer) return {};
    if (options.handbrake_current_a > 0.0F) {
      return fail(
          "handbrake_current_a: not with angle: tachometer, which does not count while the handbrake "
          "holds; write angle: encoder or angle: none");
    }
    if (settings.feedback_hz > 0 && settings.feedback_hz < kVescLoopMinHz) {
      return fail("feedback_hz: angles from the tachometer need at least " + std::to_string(kVescLoopMinHz) +
                  " Hz; set the drive higher, or write angle: none");
    }
    return {};
  }

  [[nodiscard]] BusUse busUse(const MotorSettings& settings) const override {
    const VescOptions options{settings.own};
    const auto exactly = [&settings](VescPacket packet) {
      return FrameFilter{.id = vescId(packet, settings.id)};
    };
    const FrameFilter answers{
        .id = vescId(VescPacket::kProcessShortBuffer, options.host_id),
        .discriminator = PayloadDiscriminator{.value = static_cast<std::uint8_t>(settings.id)}};
    BusUse use;
    use.sends = {exactly(VescPacket::kStatus1),    exactly(VescPacket::kStatus2),
                 exactly(VescPacket::kStatus3),    exactly(VescPacket::kStatus4),
                 exactly(VescPacket::kStatus5),    exactly(VescPacket::kStatus6),
                 exactly(VescPacket::kNotifyBoot), answers};
    use.obeys = {FrameFilter{.id = {static_cast<std::uint32_t>(settings.id), true}, .mask = kObeyedMask},
                 FrameFilter{.id = {static_cast<std::uint32_t>(kVescBroadcast), true}, .mask = kObeyedMask}};

    const double rate_hz = settings.feedback_hz > 0 ? settings.feedback_hz : 50.0;
    const auto status = [&](VescPacket packet, bool fast) {
      use.feedback.push_back({.id = vescId(packet, settings.id),
                              .shape = {.extended = true, .length = kVescStatusLength},
                              .per_second = fast ? rate_hz : static_cast<double>(kVescSlowHz)});
    };
    status(VescPacket::kStatus1, true);
    status(VescPacket::kStatus4, options.angle == VescAngle::kEncoder);
    status(VescPacket::kStatus5, options.angle == VescAngle::kTachometer);
    use.commands.push_back(
        {.id = vescId(VescPacket::kSetCurrent, settings.id),
         .shape = {.extended = true, .length = 4},
         .per_second = static_cast<double>(settings.tick_hz) / std::max(settings.command_divider, 1)});
    if (options.ask_status) {
      use.feedback.push_back(
          {.id = answers.id, .shape = {.extended = true, .length = 8}, .per_second = kAsksPerSecond});
      use.commands.push_back({.id = vescId(VescPacket::kProcessShortBuffer, settings.id),
                              .shape = {.extended = true, .length = 7},
                              .per_second = kAsksPerSecond});
    }
    return use;
  }

  [[nodiscard]] Result<std::unique_ptr<Motor_Base>> build(const MotorSettings& settings,
                                                          BusParts& parts) const override {
    if (auto checked = check(settings); !checked) return tl::unexpected(checked.error());
    return registerSolo(std::make_unique<VESC_Motor>(settings), parts);
  }
};

}  // namespace

const MotorFamily& vescFamily() noexcept {
  static const VescFamily kFamily;
  return kFamily;
}

}  // namespace rc10
