#include "drives/moteus/moteus_model.hpp"

#include <algorithm>
#include <array>

namespace rc10 {
namespace {

struct NativeFault {
  std::uint32_t native;
  FaultCode fault;
};
// Source: docs/protocol/registers.md, register 0x00F; fw/error.h.
constexpr std::array kMoteusFaults{
    NativeFault{32, FaultCode::kDriveCalibration},   // no magnet sensed, or current offset
    NativeFault{33, FaultCode::kDriveHardware},      // gate driver, mostly for lack of voltage
    NativeFault{34, FaultCode::kDriveOverVoltage},   // servo.max_voltage
    NativeFault{35, FaultCode::kDriveEncoder},       //
    NativeFault{36, FaultCode::kDriveCalibration},   // motor not configured
    NativeFault{37, FaultCode::kDriveHardware},      // PWM cycle overrun
    NativeFault{38, FaultCode::kDriveTooHot},        // board, or motor if it has a thermistor
    NativeFault{39, FaultCode::kDriveLimit},         // started outside servopos bounds
    NativeFault{40, FaultCode::kDriveUnderVoltage},  //
    NativeFault{41, FaultCode::kDriveSetting},       // configured while it ran
    NativeFault{42, FaultCode::kDriveEncoder},       // no commutation encoder
    NativeFault{43, FaultCode::kDriveEncoder},       // no output encoder
    NativeFault{44, FaultCode::kDriveHardware},      // gate driver does not enable
    NativeFault{45, FaultCode::kDriveSetting},       // stop position with limits
    NativeFault{46, FaultCode::kDriveHardware},      // timing
    NativeFault{47, FaultCode::kDriveSetting},       // bemf_feedforward without acceleration limit
    NativeFault{48, FaultCode::kDriveSetting},       // servopos bounds outside the range
    NativeFault{49, FaultCode::kDriveOverload},      // servo.fault_position_error
    NativeFault{50, FaultCode::kDriveOverload},      // servo.fault_velocity_error
};

struct NativeLimit {
  std::uint32_t native;
  LimitFlag limit;
};
// 104 and 105, flux braking and field weakening, bound nothing.
constexpr std::array kLimits{
    NativeLimit{96, kLimitVelocity}, NativeLimit{97, kLimitCurrent},      NativeLimit{98, kLimitCurrent},
    NativeLimit{99, kLimitCurrent},  NativeLimit{100, kLimitTemperature}, NativeLimit{101, kLimitTemperature},
    NativeLimit{102, kLimitCurrent}, NativeLimit{103, kLimitAngle},
};

}  // namespace

MoteusSettings moteusSettings(const OwnValues& own) {
  MoteusSettings settings;
  if (const double ratio = own.number("rotor_to_output_ratio"); ratio > 0.0) {
    settings.rotor_to_output_ratio = ratio;
  }
  if (const int ms = own.integer("watchdog_ms"); ms > 0) settings.watchdog_ms = ms;
  settings.can_prefix = static_cast<std::uint32_t>(std::clamp(own.integer("can_prefix"), 0, 0x1FFF));
  settings.bit_rate_switch = own.flag("bit_rate_switch");
  return settings;
}

FaultCode moteusFault(std::uint32_t native) noexcept {
  for (const auto& row : kMoteusFaults) {
    if (row.native == native) return row.fault;
  }
  return FaultCode::kDriveOther;
}

std::uint32_t moteusLimit(std::uint32_t native) noexcept {
  for (const auto& row : kLimits) {
    if (row.native == native) return row.limit;
  }
  return 0;
}

}  // namespace rc10
