#include "drives/moteus/moteus_model.hpp"

#include <algorithm>
#include <array>

#include "motor/drive_faults.hpp"

namespace rc10 {
namespace {

// Source: docs/protocol/registers.md, register 0x00F; fw/error.h.
constexpr std::array kMoteusFaults{
    DriveFault{32, FaultCode::kDriveCalibration},   // no magnet sensed, or current offset
    DriveFault{33, FaultCode::kDriveHardware},      // gate driver, mostly for lack of voltage
    DriveFault{34, FaultCode::kDriveOverVoltage},   // servo.max_voltage
    DriveFault{35, FaultCode::kDriveEncoder},       //
    DriveFault{36, FaultCode::kDriveCalibration},   // motor not configured
    DriveFault{37, FaultCode::kDriveHardware},      // PWM cycle overrun
    DriveFault{38, FaultCode::kDriveTooHot},        // board, or motor if it has a thermistor
    DriveFault{39, FaultCode::kDriveLimit},         // started outside servopos bounds
    DriveFault{40, FaultCode::kDriveUnderVoltage},  //
    DriveFault{41, FaultCode::kDriveSetting},       // configured while it ran
    DriveFault{42, FaultCode::kDriveEncoder},       // no commutation encoder
    DriveFault{43, FaultCode::kDriveEncoder},       // no output encoder
    DriveFault{44, FaultCode::kDriveHardware},      // gate driver does not enable
    DriveFault{45, FaultCode::kDriveSetting},       // stop position with limits
    DriveFault{46, FaultCode::kDriveHardware},      // timing
    DriveFault{47, FaultCode::kDriveSetting},       // bemf_feedforward without acceleration limit
    DriveFault{48, FaultCode::kDriveSetting},       // servopos bounds outside the range
    DriveFault{49, FaultCode::kDriveOverload},      // servo.fault_position_error
    DriveFault{50, FaultCode::kDriveOverload},      // servo.fault_velocity_error
};

struct NativeLimit {
  std::uint32_t native;
  std::uint32_t limits;
};
// 100 and 101 stand for 99 while heat derates the limit (fw/bldc_servo.cc, where the current is cut off). 104
// and 105, flux braking and field weakening, bound nothing.
constexpr std::uint32_t kDerated = kLimitTemperature | kLimitCurrent;
constexpr std::array kLimits{
    NativeLimit{96, kLimitVelocity}, NativeLimit{97, kLimitCurrent}, NativeLimit{98, kLimitCurrent},
    NativeLimit{99, kLimitCurrent},  NativeLimit{100, kDerated},     NativeLimit{101, kDerated},
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

FaultCode moteusFault(std::uint32_t native) noexcept { return faultOfCode(kMoteusFaults, native); }

std::uint32_t moteusLimit(std::uint32_t native) noexcept {
  for (const auto& row : kLimits) {
    if (row.native == native) return row.limits;
  }
  return 0;
}

}  // namespace rc10
