#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace rc10 {

// Numbers and words of the protocol: those of lcm_types/, of rc10ctl, of the black box and of the log.

/// Meaning of a target: setpoint_t.lcm.
enum class ControlMode : std::uint8_t {
  kCoast = 0,
  kCurrent = 1,     ///< A
  kVelocity = 2,    ///< rpm
  kAngle = 3,       ///< deg, the shortest way round
  kTotalAngle = 4,  ///< deg, multi-turn
  kImpedance = 5,   ///< deg, with stiffness and damping
  kVoltage = 6,     ///< V
  kDuty = 7,        ///< -1 to 1
  kBrake = 8,
};
inline constexpr int kControlModeCount = 9;

/// motor_state_t.lcm.
enum class MotorStatus : std::uint8_t {
  kOffline = 0,   ///< No fresh feedback.
  kReady = 1,     ///< Feedback, no torque; waits to be enabled.
  kEnabling = 2,  ///< The enable sequence is under way.
  kActive = 3,    ///< Obeys setpoints.
  kFault = 4,     ///< Latched until cleared.
};
inline constexpr int kMotorStatusCount = 5;

/// robot_state_t.lcm.
enum class RobotStatus : std::uint8_t {
  kRun = 0,
  kEstop = 1,     ///< Latched: every motor at rest until `clear`.
  kStopping = 2,  ///< The process is about to end: what the fallbacks do, then rest frames only.
};

/// Source of what the shaft feels: motor_state_t.lcm.
enum class Acting : std::uint8_t {
  kNothing = 0,  ///< No torque.
  kTarget = 1,
  kHold = 2,
  kDamp = 3,
  kBrake = 4,
  kRamp = 5,  ///< A velocity that falls to 0.
};

/// Reason why a motor does not obey, or the robot does not run: motor_state_t.lcm.
enum class StopCause : std::uint8_t {
  kNone = 0,
  kRequest = 1,
  kEstop = 2,
  kFault = 3,
  kSilence = 4,  ///< Its drive was not heard.
  kGroup = 5,
  kTimeout = 6,    ///< The command in force was not renewed.
  kRefused = 7,    ///< Its drive did not confirm that it was enabled.
  kReference = 8,  ///< Its angle has lost the reference.
  kShutdown = 9,
  kInput = 10,     ///< The e-stop input.
  kGuard = 11,     ///< rc10-guard told the drives to rest, has ended, or stands still.
  kOverload = 12,  ///< The ticks used nearly all of their periods.
};

/// Bits of robot_state_t.lcm.
enum Condition : std::uint32_t {
  kConditionSimulated = 1U << 0U,
  kConditionInputOpen = 1U << 1U,
  kConditionReduced = 1U << 2U,
  kConditionTuningLocked = 1U << 3U,
};

/// bus_state_t.lcm.
enum class BusState : std::uint8_t {
  kActive = 0,
  kWarning = 1,
  kPassive = 2,
  kBusOff = 3,
  kDown = 4,     ///< The interface is down.
  kGone = 5,     ///< The interface does not exist.
  kSilent = 6,   ///< No frame received for a while although motors are expected to talk.
  kStalled = 7,  ///< No echo of our own frames: they do not reach the wire.
};

/// Unit of what is sent to the drive: motor_state_t.lcm.
enum class CommandUnit : std::uint8_t { kNone = 0, kAmpere = 1, kVolt = 2, kNative = 3 };

/// Limits that act right now: not faults. Bits of motor_state_t.lcm.
enum LimitFlag : std::uint32_t {
  kLimitCurrent = 1U << 0U,
  kLimitVelocity = 1U << 1U,
  kLimitAngle = 1U << 2U,
  kLimitTemperature = 1U << 3U,
  kLimitSlew = 1U << 4U,
  kLimitStall = 1U << 5U,
};

/// Operation of a request: request_t.lcm, and the black box, which holds the number.
enum class Operation : std::uint8_t {
  kEnable = 0,
  kDisable = 1,
  kEstop = 2,
  kClear = 3,
  kZero = 4,
  kConfigure = 5,
  kSetGains = 6,
  kEnableAlone = 7,    ///< One motor, and no other until it is not ACTIVE any more.
  kGetConfig = 8,      ///< The gains in force.
  kDriveSettings = 9,  ///< Settings that kConfigure can write.
  kHand = 10,          ///< Turns a simulated shaft as a hand would.
  kLoad = 11,          ///< Another load on a simulated shaft.
  kScan = 12,          ///< Drives of one bus: listens, then asks.
};
inline constexpr int kOperationCount = 13;

/// event_t.lcm.
enum class Severity : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2 };

/// By number. A number from another program may have no word.
inline constexpr std::array kControlModeWords{"coast",     "current", "velocity", "angle", "total_angle",
                                              "impedance", "voltage", "duty",     "brake"};
inline constexpr std::array kControlModeUnits{"", "A", "rpm", "deg", "deg", "deg", "V", "", ""};
inline constexpr std::array kMotorStatusWords{"OFFLINE", "READY", "ENABLING", "ACTIVE", "FAULT"};
inline constexpr std::array kRobotStatusWords{"RUN", "ESTOP", "STOPPING"};
inline constexpr std::array kActingWords{"nothing", "target", "hold", "damp", "brake", "ramp"};
inline constexpr std::array kStopCauseWords{"",      "request", "estop",   "fault",     "silence",
                                            "group", "timeout", "refused", "reference", "shutdown",
                                            "input", "guard",   "overload"};
inline constexpr std::array kConditionWords{"simulated", "input-open", "reduced", "tuning-locked"};
inline constexpr std::array kBusStateWords{"active", "warning", "passive", "bus-off",
                                           "down",   "gone",    "silent",  "stalled"};
inline constexpr std::array kCommandUnitWords{"", "A", "V", "native"};
inline constexpr std::array kLimitWords{"current", "velocity", "angle", "temperature", "slew", "stall"};
inline constexpr std::array kOperationWords{
    "enable",     "disable",        "estop", "clear", "zero", "configure-drive", "set_gains", "enable_alone",
    "get_config", "drive-settings", "hand",  "load",  "scan"};
inline constexpr std::array kSeverityWords{"info", "warning", "error"};
static_assert(kControlModeWords.size() == kControlModeCount && kControlModeUnits.size() == kControlModeCount);
static_assert(kMotorStatusWords.size() == kMotorStatusCount);
static_assert(kOperationWords.size() == kOperationCount);

namespace detail {
template <std::size_t N, typename Number>
[[nodiscard]] constexpr const char* word(const std::array<const char*, N>& words, Number number,
                                         const char* otherwise) noexcept {
  const auto index = static_cast<std::size_t>(number);
  return index < N ? words[index] : otherwise;
}
}  // namespace detail

[[nodiscard]] constexpr const char* toString(ControlMode mode) noexcept {
  return detail::word(kControlModeWords, mode, "unknown");
}
[[nodiscard]] constexpr const char* toString(MotorStatus status) noexcept {
  return detail::word(kMotorStatusWords, status, "UNKNOWN");
}
[[nodiscard]] constexpr const char* toString(RobotStatus status) noexcept {
  return detail::word(kRobotStatusWords, status, "UNKNOWN");
}
[[nodiscard]] constexpr const char* toString(Acting acting) noexcept {
  return detail::word(kActingWords, acting, "unknown");
}
/// "" for kNone.
[[nodiscard]] constexpr const char* toString(StopCause cause) noexcept {
  return detail::word(kStopCauseWords, cause, "unknown");
}
[[nodiscard]] constexpr const char* toString(BusState state) noexcept {
  return detail::word(kBusStateWords, state, "unknown");
}
[[nodiscard]] constexpr const char* toString(CommandUnit unit) noexcept {
  return detail::word(kCommandUnitWords, unit, "unknown");
}
[[nodiscard]] constexpr const char* toString(Operation operation) noexcept {
  return detail::word(kOperationWords, operation, "unknown");
}
[[nodiscard]] constexpr std::optional<Operation> operationNamed(std::string_view word) noexcept {
  for (std::size_t i = 0; i < kOperationWords.size(); ++i) {
    if (word == kOperationWords[i]) return static_cast<Operation>(i);
  }
  return std::nullopt;
}
/// Takes the torque away: carried out however late it comes and however often.
[[nodiscard]] constexpr bool stops(Operation operation) noexcept {
  return operation == Operation::kEstop || operation == Operation::kDisable;
}
[[nodiscard]] constexpr const char* toString(Severity severity) noexcept {
  return detail::word(kSeverityWords, severity, "unknown");
}
/// Unit of a target of this mode; "" where there is none.
[[nodiscard]] constexpr const char* unitOf(ControlMode mode) noexcept {
  return detail::word(kControlModeUnits, mode, "");
}

}  // namespace rc10
