#pragma once

#include <cstdint>

namespace rc10 {

/// The numbers are those of robot_state_t.lcm.
enum class RobotState : std::uint8_t {
  kRun = 0,
  kEstop = 1,     ///< Latched: every motor at rest until `clear`.
  kStopping = 2,  ///< The process is about to end: rest frames only.
};

/// The numbers are those of motor_state_t.lcm.
enum class MotorStatus : std::uint8_t {
  kOffline = 0,   ///< No fresh feedback.
  kReady = 1,     ///< Feedback, no torque; waits to be enabled.
  kEnabling = 2,  ///< The enable sequence is under way.
  kActive = 3,    ///< Obeys setpoints.
  kFault = 4,     ///< Latched until cleared.
};
inline constexpr int kMotorStatusCount = 5;

/// Requests of a module to the robot, beside targets. Writing to drives is not among them: that takes a
/// person.
enum class RobotRequest : std::uint8_t { kEnable, kDisable, kEstop, kClear, kZero };

}  // namespace rc10
