#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "app/motor_readings.hpp"
#include "app/time.hpp"
#include "app/vocabulary.hpp"
#include "rc10/setpoint.hpp"

namespace rc10 {
inline namespace robot_client {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Bits of MotorState::limits.
using Limit = LimitFlag;

/// One motor, at the output shaft, counter-clockwise positive. NaN: the drive does not report it, or no state
/// has arrived yet.
struct MotorState {
  std::string name{};
  MotorStatus status = MotorStatus::kOffline;
  std::int32_t fault = 0;  ///< 0, or the code of the latched fault.
  std::string fault_text{};
  std::uint32_t limits = 0;  ///< Bits of Limit.

  Mode mode = Mode::kCoast;                 ///< In force; coast when there is no valid target.
  double target = 0.0;                      ///< As it was asked for, in the unit of the mode.
  std::string owner{};                      ///< The client whose target is in force, empty without one.
  Acting acting = Acting::kNothing;         ///< Source of what the shaft feels.
  StopCause stop_cause = StopCause::kNone;  ///< Reason why it stopped obeying; kNone while it obeys.
  std::string stopped_by{};                 ///< The client, module or motor that stopped it, if any.
  bool zeroed = false;                      ///< The angle has a known reference.

  // target_shaped, command_value, and of the drive angle_deg, total_angle_deg, velocity_rpm, current_a,
  // torque_nm, voltage_v, temperature_c: app/motor_readings.hpp.
#define RC10_FIELD(type, name, initial) double name = kUnknown;
  RC10_TICK_READINGS(RC10_FIELD)
  RC10_FEEDBACK_READINGS(RC10_FIELD)
#undef RC10_FIELD

  std::chrono::microseconds feedback_age{-1};         ///< When the state was taken; -1: no feedback yet.
  std::chrono::microseconds feedback_age_at_use{-1};  ///< When the frames computed from it left.
  std::chrono::microseconds command_age{-1};  ///< Since rc10d's host received the command in force; -1: none.
  double feedback_hz = 0.0;
  CommandUnit command_unit = CommandUnit::kNone;  ///< Unit of command_value.
};

/// All motors at one tick of rc10d.
struct RobotState {
  std::int64_t utime = 0;    ///< Wall clock of the host, us since 1970; may step.
  std::int64_t mono_us = 0;  ///< CLOCK_MONOTONIC of the host at this tick.
  std::int64_t tick = 0;     ///< Ticks since start.
  RobotStatus status = RobotStatus::kRun;
  bool realtime = false;  ///< The real-time set-up is complete; `rc10ctl stats` says what is not.
  StopCause stop_cause = StopCause::kNone;  ///< Reason why it is not in RUN.
  std::string stopped_by;                   ///< The client or module that asked for that, if any.
  std::int64_t stopped_mono_us = 0;         ///< When it left RUN, as mono_us; 0 in RUN.
  std::int32_t estop_count = 0;             ///< Since start.
  std::uint32_t conditions = 0;             ///< Bits of Condition.
  std::string version;                      ///< Version of rc10d.
  std::string config_hash;                  ///< SHA-256 of its configuration file, as sha256sum prints it.
  std::vector<MotorState> motors;
  MonotonicTime taken;  ///< When rc10d took it, on this computer's clock.

  /// Some bus has simulated drives.
  [[nodiscard]] bool simulated() const noexcept { return (conditions & kConditionSimulated) != 0; }
  [[nodiscard]] Duration age() const noexcept { return std::chrono::steady_clock::now() - taken; }
  /// nullptr: the robot has no such motor.
  [[nodiscard]] const MotorState* find(std::string_view motor) const noexcept;
  /// "wheel, lift": for messages.
  [[nodiscard]] std::string motorNames() const;
};

/// A fault or a change of state as it happens; the codes are listed in docs/lcm.md.
struct Event {
  std::int64_t utime = 0;    ///< Wall clock of the host, us since 1970.
  std::int64_t mono_us = 0;  ///< CLOCK_MONOTONIC of the host.
  Severity severity = Severity::kInfo;
  std::int32_t code = 0;
  std::string source;    ///< Name of a motor or bus, or "robot", "link", "lcm".
  std::string client{};  ///< Whose request or command it was, empty without one.
  std::string text;
};

}  // namespace robot_client
}  // namespace rc10
