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

/// The values of the family's own keys.
struct VescOptions {
  explicit VescOptions(const OwnValues& own);

  int pole_pairs;
  VescAngle angle;
  double position_divider;
  double speed_ramp_erpm_per_s;
  VescStop velocity_zero;
  float motor_current_max_a;
  bool relative_current;
  float brake_current_a;
  float handbrake_current_a;  ///< 0: no handbrake.
  double kv_rpm_per_v;        ///< 0: unknown.
  double supply_v;
  bool motor_temperature;  ///< Else the drive's.
  bool ask_status;
  int host_id;
};

/// Fault of a native code; kDriveOther for an unknown one.
[[nodiscard]] FaultCode vescFault(std::uint8_t native_code) noexcept;

/// The slowest feedback on which the host closes the angle loop.
inline constexpr int kVescLoopMinHz = 50;
/// The rate of what a drive sends seldom: "CAN Status Rate 2".
inline constexpr int kVescSlowHz = 5;

}  // namespace rc10
