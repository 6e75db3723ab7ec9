#pragma once

#include <cstdint>

namespace rc10 {

/// Two small numbers in an event's `extra`: of a change, the one before and the StopCause; of a skipped
/// setpoint, its mode and the MotorStatus.
template <typename First, typename Second>
struct ExtraPair {
  First first{};
  Second second{};

  [[nodiscard]] static constexpr ExtraPair from(std::int32_t extra) noexcept {
    return {static_cast<First>(extra % kShift), static_cast<Second>(extra / kShift)};
  }
  [[nodiscard]] constexpr std::int32_t extra() const noexcept {
    return static_cast<std::int32_t>(first) + kShift * static_cast<std::int32_t>(second);
  }

 private:
  static constexpr std::int32_t kShift = 256;  // part of the LCM contract: docs/lcm.md
};
template <typename First, typename Second>
ExtraPair(First, Second) -> ExtraPair<First, Second>;

/// Kind of event. The numbers are part of the LCM contract (event_t.code, docs/lcm.md) and never change.
enum class EventCode : std::int32_t {
  kMotorStatus =
      100,  ///< value: new MotorStatus, extra: ExtraPair of the old one and the StopCause; `client`: by whom
  kCommandTimeout = 101,   ///< no valid command any more; value: the FallbackAction
  kReferenceLost = 102,    ///< the angle has no reference any more
  kSetpointSkipped = 103,  ///< value: the SkipReason, extra: ExtraPair of the mode and the MotorStatus
  kNotOwner = 104,         ///< a command refused: a motor is held by another client (`client`: who asked)
  kMotorFault = 105,       ///< value: the FaultCode; extra: the drive's own code
  kGroupStopped = 106,     ///< with `source`; value: index of the group; extra: the GroupStop
  kGroupRearmed = 107,     ///< enabled again at rest; value: index of the group
  kModule = 108,           ///< of a module: value: its place in ModuleSignals::events
  kModuleRefused =
      109,             ///< targets of a module (`source`) refused: another client commands one of its motors
  kGainChanged = 110,  ///< of a loop; value: the LoopGain, plus kGainInVolts; extra: the bits of the float;
                       ///< `client`: who asked
  kMovesAtRest = 111,  ///< it gains speed though its drive is told to rest; value: its speed in rpm
  kNeverHeard = 112,   ///< no frame of its drive since the start; value: its id
  kFallbackReplaced =
      113,  ///< a load drags it faster than reduced mode allows; value: the FallbackAction that resists now
  kRobotState =
      200,  ///< value: new RobotStatus, extra: ExtraPair of the old one and the StopCause; `client`: by whom
  kTicksMissed = 201,     ///< value: how many
  kCommandRefused = 202,  ///< admission refused a command message
  kEstopInput = 203,      ///< value: the ContactState of the e-stop input
  kModeInput = 204,       ///< value: the ContactState of the mode input
  kPhaseLost = 205,  ///< the wall clock, on which the ticks lie, was stepped; from the io thread, in words
  kBusState = 300,   ///< value: new BusState, extra: old one
  kBusAdvice = 301,  ///< repair of a bus, by rc10d or left to a person; from the io thread, in words
  kForeignSender = 302,  ///< somebody else sends a command id of ours; value: frames since the last report,
                         ///< extra: foreignFrame()
  kSerialPort = 310,     ///< a serial port came, went or cannot be opened; from the io thread, in words
  kDevice = 311,  ///< an SPI device or the lines of a GPIO chip came, went or cannot be opened; in words
  kOtherDefinitions = 400,  ///< rc10-lcm: a client was built from other .lcm files
  kMalformed = 401,         ///< rc10-lcm: a message that is not understood
  kLinkBusy = 402,          ///< rc10-lcm: rc10d does not take the commands: dropped
};

/// Reason why a setpoint of an accepted message did not act.
enum class SkipReason : std::int32_t {
  kNotActive,
  kNoReference,
  kFirstStep,  ///< Farther from the measured angle than max_first_step_deg.
  kRefused,    ///< By the motor itself.
  kTooFar,     ///< An angle beyond kFarthestAngleDeg.
  kGroup,      ///< Not every motor of its group is ACTIVE, and they act together only.
};

/// Reason why a group has stopped.
enum class GroupStop : std::int32_t {
  kLost,      ///< `source` is offline or in fault.
  kDisabled,  ///< `source` was disabled.
  kRefused,   ///< `source` was not enabled: its drive refused.
};

}  // namespace rc10
