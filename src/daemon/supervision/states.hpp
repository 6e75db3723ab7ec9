#pragma once

#include <array>
#include <cstdint>

#include "app/vocabulary.hpp"

namespace rc10 {

/// Event in the life of a motor.
enum class MotorEvent : std::uint8_t {
  kFeedbackFresh,  ///< Feedback is there and young enough.
  kFeedbackLost,
  kEnable,      ///< Somebody asked for it.
  kEnableDone,  ///< The drive has answered the enable sequence.
  kEnableFailed,
  kDisable,
  kDisableUnasked,  ///< As a program ends: what is held or braked already stays so.
  kEstop,           ///< Robot-wide stop, or the process is about to end.
  kFault,
  kClear,
  kGroupStop,  ///< Its group stops: a member is lost, or its drive has refused.
};
inline constexpr int kMotorEventCount = 11;

namespace detail {
inline constexpr auto kMotorTransitions = [] {
  using enum MotorStatus;
  // Rows: status. Columns: fresh, lost, enable, done, failed, disable, disable unasked, estop, fault,
  // clear, group stop.
  return std::array<std::array<MotorStatus, kMotorEventCount>, kMotorStatusCount>{{
      /* offline  */ {kReady, kOffline, kOffline, kOffline, kOffline, kOffline, kOffline, kOffline, kFault,
                      kOffline, kOffline},
      /* ready    */
      {kReady, kOffline, kEnabling, kReady, kReady, kReady, kReady, kReady, kFault, kReady, kReady},
      /* enabling */
      {kEnabling, kOffline, kEnabling, kActive, kReady, kReady, kReady, kReady, kFault, kEnabling, kReady},
      /* active   */
      {kActive, kOffline, kActive, kActive, kReady, kReady, kReady, kReady, kFault, kActive, kReady},
      /* fault    */
      {kFault, kFault, kFault, kFault, kFault, kFault, kFault, kFault, kFault, kOffline, kFault},
  }};
}();
}  // namespace detail

/// The motor state machine: the whole of it. Only an enable request that the drive has answered leads
/// to kActive, and only `clear` leaves kFault, by way of kOffline so that fresh feedback is seen first.
[[nodiscard]] constexpr MotorStatus next(MotorStatus status, MotorEvent event) noexcept {
  const auto row = static_cast<std::size_t>(status);
  const auto column = static_cast<std::size_t>(event);
  // Rest is the answer to everything unknown.
  if (row >= kMotorStatusCount || column >= kMotorEventCount) return MotorStatus::kFault;
  return detail::kMotorTransitions[row][column];
}

/// Reason why such an event stops a motor that was on.
[[nodiscard]] constexpr StopCause causeOf(MotorEvent event, RobotStatus robot) noexcept {
  switch (event) {
    case MotorEvent::kFeedbackLost: return StopCause::kSilence;
    case MotorEvent::kEnableFailed: return StopCause::kRefused;
    case MotorEvent::kDisable:
    case MotorEvent::kDisableUnasked: return StopCause::kRequest;
    case MotorEvent::kEstop:
      return robot == RobotStatus::kStopping ? StopCause::kShutdown : StopCause::kEstop;
    case MotorEvent::kFault: return StopCause::kFault;
    case MotorEvent::kGroupStop: return StopCause::kGroup;
    case MotorEvent::kFeedbackFresh:
    case MotorEvent::kEnable:
    case MotorEvent::kEnableDone:
    case MotorEvent::kClear: break;
  }
  return StopCause::kNone;
}

[[nodiscard]] constexpr bool isDisable(MotorEvent event) noexcept {
  return event == MotorEvent::kDisable || event == MotorEvent::kDisableUnasked;
}

/// Whether such a motor moves, or is about to.
[[nodiscard]] constexpr bool isOn(MotorStatus status) noexcept {
  return status == MotorStatus::kEnabling || status == MotorStatus::kActive;
}

}  // namespace rc10
