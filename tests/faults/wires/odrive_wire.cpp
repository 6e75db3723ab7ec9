// CANSimple of ODrive 0.5 and 0.6: id = node << 5 | message, little endian, turns and N·m of the motor.
#include <cmath>

#include "bus/can_frame.hpp"
#include "faults/wire.hpp"

namespace rc10::test {
namespace {

constexpr std::uint32_t kClosedLoop = 8;

class OdriveWire final : public Wire {
 public:
  explicit OdriveWire(const MotorConfig& config)
      : Wire(config), gear_(config.settings.gear_ratio > 0.0 ? config.settings.gear_ratio : 1.0) {}

  std::uint64_t said(const CanFrame& frame) override {
    if (frame.id.extended || frame.id.value >> 5U != static_cast<std::uint32_t>(id())) return 0;
    if (frame.type != FrameType::kData || frame.fd) refuse(frame, "a command frame of another form");
    const auto number = [&frame](std::size_t at) {
      return static_cast<double>(floatOf(littleEndian(frame, at, 4)));
    };
    switch (frame.id.value & 0x1FU) {
      case 0x07: on_ = littleEndian(frame, 0, 4) == kClosedLoop; break;
      case 0x0B: mode_ = littleEndian(frame, 0, 4); break;
      case 0x0C:
        place_turns_ = number(0);
        place_rpm_ = rpm(int16Of(littleEndian(frame, 4, 2)) * 1e-3);
        place_nm_ = int16Of(littleEndian(frame, 6, 2)) * 1e-3;
        break;
      case 0x0D:
        velocity_rpm_ = rpm(number(0));
        velocity_nm_ = number(4);
        break;
      case 0x0E: torque_nm_ = number(0); break;
      case 0x0F:
        most_rpm_ = std::fabs(rpm(number(0)));
        most_a_ = number(4);
        break;
      case 0x18: break;  // clears errors
      default: refuse(frame, "a message that rc10d has no business with");
    }
    return kAllBytes;
  }

  [[nodiscard]] bool steeredBy(const CanFrame& frame) const override {
    if (frame.id.extended || frame.id.value >> 5U != static_cast<std::uint32_t>(id())) return false;
    const std::uint32_t message = frame.id.value & 0x1FU;
    if (frame.type != FrameType::kData) return false;
    return message == 0x0C || message == 0x0D || (message == 0x0E && saysSomething(frame));
  }

  bool heard(const CanFrame& frame) override {
    if (frame.id.extended || frame.id.value >> 5U != static_cast<std::uint32_t>(id()) ||
        !plainFrame(frame, 8))
      return false;
    const auto number = [&frame](std::size_t at) {
      return static_cast<double>(floatOf(littleEndian(frame, at, 4)));
    };
    switch (frame.id.value & 0x1FU) {
      case 0x01:
        if (frame.data[4] != kClosedLoop) on_ = false;
        return false;
      case 0x09:
        if (!std::isfinite(number(0)) || !std::isfinite(number(4))) return false;
        turns_ = number(0);
        measured_.velocity_rpm = rpm(number(4));
        return true;
      case 0x15: measured_.temperature_c = std::fmax(number(0), number(4)); return false;
      default: return false;
    }
  }

  [[nodiscard]] Told told() const override {
    Told told{.effort_step = 1e-6, .velocity_step_rpm = 1e-6};
    told.most_effort = most_a_;
    told.most_rpm = most_rpm_;
    if (!on_) return told;
    switch (mode_) {
      case 1:
        told.law = Told::Law::kEffort;
        told.effort = effortOfNm(torque_nm_);
        return told;
      case 2:
        told.law = Told::Law::kVelocity;
        told.velocity_rpm = velocity_rpm_;
        told.effort = effortOfNm(velocity_nm_);
        return told;
      default:
        told.law = Told::Law::kAngle;
        told.velocity_rpm = place_rpm_;
        told.effort = effortOfNm(place_nm_);
        told.ahead_deg = (place_turns_ - turns_) * 360.0 / (direction() * gear_);
        told.ahead_step_deg = std::fabs(place_turns_) * 1e-4 / gear_;
        told.effort_step = std::fabs(effortOfNm(1e-3));
        told.velocity_step_rpm = std::fabs(rpm(1e-3));
        return told;
    }
  }

 private:
  [[nodiscard]] double rpm(double turns_per_s) const { return turns_per_s * 60.0 / (direction() * gear_); }

  double gear_;
  bool on_ = false;
  std::uint32_t mode_ = 0;
  double torque_nm_ = 0.0;
  double velocity_rpm_ = 0.0;
  double velocity_nm_ = 0.0;
  double place_turns_ = 0.0;
  double place_rpm_ = 0.0;
  double place_nm_ = 0.0;
  double most_rpm_ = kUnsaid;
  double most_a_ = kUnsaid;
  double turns_ = 0.0;
};

}  // namespace

std::unique_ptr<Wire> makeOdriveWire(const MotorConfig& config) {
  return std::make_unique<OdriveWire>(config);
}

}  // namespace rc10::test
