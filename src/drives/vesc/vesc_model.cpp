#include "drives/vesc/vesc_model.hpp"

#include <array>
#include <string>

// Source, unless another is named: vedderb/bldc@b9d287b, its defaults in motor/mcconf_default.h and
// applications/appconf_default.h.
namespace rc10 {
namespace {

// By native code: mc_fault_code.
constexpr auto kVescFaults = [] {
  using enum FaultCode;
  return std::array<FaultCode, 34>{
      kNone,
      kDriveOverVoltage,
      kDriveUnderVoltage,
      kDriveHardware,     // DRV: the gate driver
      kDriveOverCurrent,  // absolute maximum
      kDriveTooHot,
      kDriveMotorTooHot,
      kDriveHardware,  // gate driver over-voltage
      kDriveHardware,  // gate driver under-voltage
      kDriveHardware,  // MCU under-voltage
      kDriveHardware,  // booting from a reset by the processor's watchdog
      kDriveEncoder,   // SPI
      kDriveEncoder,   // sin/cos too weak
      kDriveEncoder,   // sin/cos too strong
      kDriveHardware,  // flash
      kDriveHardware,  // offset of current sensor 1
      kDriveHardware,
      kDriveHardware,
      kDrivePhase,     // unbalanced currents
      kDriveHardware,  // BRK
      kDriveEncoder,   // resolver LOT
      kDriveEncoder,   // resolver DOS
      kDriveEncoder,   // resolver LOS
      kDriveSetting,   // flash, application settings
      kDriveSetting,   // flash, motor settings
      kDriveEncoder,   // no magnet
      kDriveEncoder,   // magnet too strong
      kDrivePhase,     // phase filter
      kDriveEncoder,   // encoder
      kDriveHardware,  // low-voltage output
      kDriveEncoder,   // encoder slipped
      kDriveLimit,     // too fast
      kDriveLimit,     // too slow
      kDriveLimit,     // too fast, absolute
  };
}();

VescAngle angleOf(const std::string& text) {
  if (text == "encoder") return VescAngle::kEncoder;
  return text == "none" ? VescAngle::kNone : VescAngle::kTachometer;
}

VescStop stopOf(const std::string& text) {
  if (text == "coast") return VescStop::kCoast;
  return text == "brake" ? VescStop::kBrake : VescStop::kRegulate;
}

}  // namespace

VescSettings vescSettings(const OwnValues& own) {
  return {.pole_pairs = own.integer("pole_pairs"),
          .angle = angleOf(own.text("angle")),
          .position_divider = own.number("position_divider"),
          .speed_ramp_erpm_per_s = own.number("speed_ramp_erpm_per_s"),
          .velocity_zero = stopOf(own.text("velocity_zero")),
          .motor_current_max_a = static_cast<float>(own.number("motor_current_max_a")),
          .relative_current = own.flag("relative_current"),
          .brake_current_a = static_cast<float>(own.number("brake_current_a")),
          .handbrake_current_a = static_cast<float>(own.number("handbrake_current_a")),
          .kv_rpm_per_v = own.number("kv_rpm_per_v"),
          .supply_v = own.number("supply_v"),
          .motor_temperature = own.text("temperature") == "motor",
          .ask_status = own.flag("ask_status"),
          .host_id = own.integer("host_id")};
}

FaultCode vescFault(std::uint8_t native_code) noexcept {
  return native_code < kVescFaults.size() ? kVescFaults[native_code] : FaultCode::kDriveOther;
}

}  // namespace rc10
