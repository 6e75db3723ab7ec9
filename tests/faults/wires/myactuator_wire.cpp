// MyActuator's CAN protocol V4.2: 0x140 + id, answers 0x240 + id, little endian; motion 0x400 + id, packed.
#include <cmath>
#include <numbers>

#include "bus/can_frame.hpp"
#include "faults/wire.hpp"

namespace rc10::test {
namespace {

constexpr double kAngleRad = 12.5;
constexpr double kVelocityRadS = 45.0;
constexpr double kTorqueNm = 24.0;
constexpr double kMyActuatorStiffnessMax = 500.0;
constexpr double kMyActuatorDampingMax = 5.0;
constexpr double kRadPerRaw = 0.01 * std::numbers::pi / 180.0;

class MyactuatorWire final : public Wire {
 public:
  explicit MyactuatorWire(const MotorConfig& config)
      : Wire(config), number_(static_cast<std::uint32_t>(config.settings.id)) {
    speed_field_end_rad_s_ = kVelocityRadS;
  }

  std::uint64_t said(const CanFrame& frame) override {
    const bool request = frame.id == CanId{0x140U + number_, false};
    const bool motion = frame.id == CanId{0x400U + number_, false};
    if (!request && !motion) return 0;
    if (!plainFrame(frame, 8)) refuse(frame, "a command frame of another form");
    if (motion) {
      saidMotion(frame);
    } else {
      saidRequest(frame);
    }
    return kAllBytes;
  }

  [[nodiscard]] bool steeredBy(const CanFrame& frame) const override {
    if (!plainFrame(frame, 8)) return false;
    const bool moves = frame.data[0] == 0xA1 || frame.data[0] == 0xA2 || frame.data[0] == 0xA4;
    return frame.id == CanId{0x400U + number_, false} ||
           (frame.id == CanId{0x140U + number_, false} && moves);
  }

  bool heard(const CanFrame& frame) override {
    if (!plainFrame(frame, 8)) return false;
    if (frame.id == CanId{0x500U + number_, false} && frame.data[0] == number_) {
      velocity_rad_s_ = onScale(bitsAt(frame, 24, 12), -kVelocityRadS, kVelocityRadS, 12);
      measured_.velocity_rpm = rpmOfRadPerS(velocity_rad_s_);
      return false;
    }
    if (frame.id != CanId{0x240U + number_, false}) return false;
    switch (frame.data[0]) {
      case 0x92: place_raw_ = int32Of(littleEndian(frame, 4, 4)); return true;
      case 0x9A: measured_.temperature_c = static_cast<std::int8_t>(frame.data[1]); return false;
      case 0x9C:
      case 0xA1:
      case 0xA2:
      case 0xA4: {
        measured_.temperature_c = static_cast<std::int8_t>(frame.data[1]);
        const double deg_s = int16Of(littleEndian(frame, 4, 2));
        measured_.velocity_rpm = deg_s / 6.0 / perOutput();
        velocity_rad_s_ = deg_s * 100.0 * kRadPerRaw;
        return false;
      }
      default: return false;
    }
  }

  [[nodiscard]] Told told() const override { return told_; }

 private:
  void saidRequest(const CanFrame& frame) {
    const auto number = static_cast<double>(int32Of(littleEndian(frame, 4, 4)));
    const Told plain{.effort_step = 0.005, .velocity_step_rpm = 0.01 / 6.0 / std::fabs(perOutput())};
    switch (frame.data[0]) {
      case 0x76:  // restarts
      case 0x80: told_ = {}; return;
      case 0x77:  // the brake is released
      case 0x92:  // questions
      case 0x9A:
      case 0x9C:
      case 0xB1: return;
      case 0xA1:
        told_ = plain;
        told_.law = Told::Law::kEffort;
        told_.effort = direction() * int16Of(littleEndian(frame, 4, 2)) * 0.01;
        return;
      case 0xA2:
        told_ = plain;
        told_.law = Told::Law::kVelocity;
        told_.velocity_rpm = number * 0.01 / 6.0 / perOutput();
        return;
      case 0xA4:
        told_ = plain;
        told_.law = Told::Law::kAngle;
        told_.most_rpm = static_cast<double>(littleEndian(frame, 2, 2)) / 6.0 / std::fabs(perOutput());
        told_.ahead_deg = (number - place_raw_) * 0.01 / perOutput();
        told_.ahead_step_deg = 0.01 / std::fabs(perOutput());
        return;
      default: refuse(frame, "a setting that is stored, or nothing known");
    }
  }

  void saidMotion(const CanFrame& frame) {
    told_ = springOf({.position_rad = onScale(bitsAt(frame, 0, 16), -kAngleRad, kAngleRad, 16),
                      .velocity_rad_s = onScale(bitsAt(frame, 16, 12), -kVelocityRadS, kVelocityRadS, 12),
                      .stiffness = onScale(bitsAt(frame, 28, 12), 0.0, kMyActuatorStiffnessMax, 12),
                      .damping = onScale(bitsAt(frame, 40, 12), 0.0, kMyActuatorDampingMax, 12),
                      .torque_nm = onScale(bitsAt(frame, 52, 12), -kTorqueNm, kTorqueNm, 12)},
                     {.position_rad = 2.0 * kAngleRad / 65535.0,
                      .velocity_rad_s = 2.0 * kVelocityRadS / 4095.0,
                      .stiffness = kMyActuatorStiffnessMax / 4095.0,
                      .damping = kMyActuatorDampingMax / 4095.0,
                      .torque_nm = 2.0 * kTorqueNm / 4095.0},
                     place_raw_ * kRadPerRaw, velocity_rad_s_);
  }

  std::uint32_t number_;
  double place_raw_ = 0.0;
  double velocity_rad_s_ = 0.0;
  Told told_;
};

}  // namespace

std::unique_ptr<Wire> makeMyactuatorWire(const MotorConfig& config) {
  return std::make_unique<MyactuatorWire>(config);
}

}  // namespace rc10::test
