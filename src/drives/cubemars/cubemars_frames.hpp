#pragma once

#include <cstdint>
#include <optional>

#include "bus/can_frame.hpp"
#include "drives/cubemars/cubemars_model.hpp"
#include "motor/spring_law.hpp"

namespace rc10::cubemars {

// Frames of the AK drives: bytes to numbers and back, in the drive's own units. CubeMars AK series module
// driver manual V1.0.8, sections 5.1 to 5.3; V3: cubemars_driver_node.

/// The command in bits 8 and up of an extended id.
enum class ServoCommand : std::uint32_t {
  kDuty = 0,
  kCurrent = 1,
  kBrakeCurrent = 2,
  kVelocity = 3,
  kPosition = 4,
  kOrigin = 5,
  kPositionVelocity = 6,
  kMit = 8,
};
inline constexpr std::uint32_t kServoFeedback = 0x29;
inline constexpr double kLargestReportedErpm = 327'670.0;  ///< 16 bits of 10 ERPM.
inline constexpr double kLargestErpm = 100'000.0;          ///< Range of the velocity command by the manual.

[[nodiscard]] constexpr CanId servoId(ServoCommand command, int motor_id) noexcept {
  return {static_cast<std::uint32_t>(command) << 8U | static_cast<std::uint32_t>(motor_id), true};
}
[[nodiscard]] constexpr CanId servoFeedbackId(int motor_id) noexcept {
  return {kServoFeedback << 8U | static_cast<std::uint32_t>(motor_id), true};
}
[[nodiscard]] constexpr CanId mitId(int motor_id) noexcept {
  return {static_cast<std::uint32_t>(motor_id), false};
}

// Values that are out of a field's range are cut off, NaN is 0.

[[nodiscard]] CanFrame dutyFrame(int motor_id, double duty) noexcept;
[[nodiscard]] CanFrame currentFrame(int motor_id, double amperes) noexcept;
[[nodiscard]] CanFrame brakeFrame(int motor_id, double amperes) noexcept;
[[nodiscard]] CanFrame velocityFrame(int motor_id, double erpm) noexcept;
[[nodiscard]] CanFrame positionFrame(int motor_id, double degrees) noexcept;
/// `erpm` and `erpm_per_s` of the way there.
[[nodiscard]] CanFrame positionVelocityFrame(int motor_id, double degrees, double erpm,
                                             double erpm_per_s) noexcept;

/// Feedback in servo mode, and of V3 drives always.
struct ServoReport {
  double degrees = 0.0;
  bool position_cut_off = false;  ///< The position is beyond what the field can say.
  double erpm = 0.0;
  double amperes = 0.0;
  int temperature_c = 0;
  std::uint8_t error = 0;
};
/// Nothing if the frame cannot be one: its id is not looked at.
[[nodiscard]] std::optional<ServoReport> readServoReport(const CanFrame& frame) noexcept;

/// A MIT command: its law at the drive's own output.
[[nodiscard]] CanFrame mitFrame(int motor_id, const CubemarsRanges& ranges,
                                const SpringLaw& command) noexcept;
[[nodiscard]] CanFrame mitV3Frame(int motor_id, const CubemarsRanges& ranges,
                                  const SpringLaw& command) noexcept;

/// FF FF FF FF FF FF FF and one of these.
enum class MitOrder : std::uint8_t { kEnter = 0xFC, kExit = 0xFD, kZero = 0xFE };
[[nodiscard]] CanFrame mitOrderFrame(int motor_id, MitOrder order) noexcept;

struct MitReport {
  int motor_id = 0;
  double position_rad = 0.0;
  bool at_end = false;        ///< The position is the first or last that the field can say.
  bool speed_at_end = false;  ///< The same of the speed.
  double velocity_rad_s = 0.0;
  double torque_nm = 0.0;
  std::optional<int> temperature_c;  ///< The oldest firmware sends neither this nor an error.
  std::uint8_t error = 0;
};
/// rad after which the field of the position begins anew: 65536 codes, of which 65535 steps are the range.
[[nodiscard]] constexpr double positionWrapRad(const CubemarsRanges& ranges) noexcept {
  return 2.0 * ranges.position_rad * 65536.0 / 65535.0;
}
/// Nothing if the frame cannot be one: its id is not looked at.
[[nodiscard]] std::optional<MitReport> readMitReport(const CanFrame& frame,
                                                     const CubemarsRanges& ranges) noexcept;

}  // namespace rc10::cubemars
