#pragma once

#include <cstdint>

#include "motor/fault_code.hpp"
#include "motor/motor_family.hpp"

namespace rc10 {

/// Source of the angle; determines where the angle loop is closed.
enum class VescAngle : std::uint8_t {
  kTachometer,  ///< STATUS_5; loop on the host, speeds to the drive.
  kEncoder,     ///< STATUS_4; the drive's own position loop.
  kNone,
};

/// Meaning of a velocity of 0.
enum class VescStop : std::uint8_t { kRegulate, kCoast, kBrake };

/// Settings of one VESC, from its own keys.
struct VescSettings {
  int pole_pairs = 0;
  VescAngle angle = VescAngle::kTachometer;
  double position_divider = 0.0;
  double speed_ramp_erpm_per_s = 0.0;
  VescStop velocity_zero = VescStop::kRegulate;
  float motor_current_max_a = 0.0F;
  bool relative_current = false;
  float brake_current_a = 0.0F;
  float handbrake_current_a = 0.0F;  ///< 0: no handbrake.
  double kv_rpm_per_v = 0.0;         ///< 0: unknown.
  double supply_v = 0.0;
  bool motor_temperature = false;  ///< false: the drive's.
  bool ask_status = false;
  int host_id = 0;
};
[[nodiscard]] VescSettings vescSettings(const OwnValues& own);

/// Fault of a native code; kDriveOther for an unknown one.
[[nodiscard]] FaultCode vescFault(std::uint8_t native_code) noexcept;

/// The slowest feedback on which the host closes the angle loop.
inline constexpr int kVescLoopMinHz = 50;
/// The rate of what a drive sends seldom: "CAN Status Rate 2".
inline constexpr int kVescSlowHz = 5;

}  // namespace rc10
