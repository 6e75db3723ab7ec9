#pragma once

#include <cstdint>
#include <string>

#include "app/time.hpp"
#include "bus/can_frame.hpp"
#include "daemon/exchange/estop_contact.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

enum class Severity : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2 };

/// Kind of event. The numbers are part of the LCM contract (event_t.code, docs/lcm.md) and never change.
enum class EventCode : std::int32_t {
  kMotorStatus = 100,      ///< value: new MotorStatus, extra: old one
  kCommandTimeout = 101,   ///< no valid command any more; value: the FallbackAction
  kReferenceLost = 102,    ///< the multi-turn angle is unknown
  kSetpointSkipped = 103,  ///< value: the SkipReason, extra: the mode, plus 256 times the MotorStatus
  kNotOwner = 104,         ///< a command refused: a motor is held by another client (`client`: who asked)
  kMotorFault = 105,       ///< value: the FaultCode; extra: the drive's own code
  kGroupStopped = 106,     ///< with `source`, which is offline or in fault; value: index of the group
  kGroupRearmed = 107,     ///< enabled again at rest; value: index of the group
  kModule = 108,           ///< of a module: value: its place in ModuleSignals::events
  kModuleRefused =
      109,             ///< targets of a module (`source`) refused: another client commands one of its motors
  kGainChanged = 110,  ///< of a loop; value: the LoopGain, plus kGainInVolts; extra: the bits of the float;
                       ///< `client`: who asked
  kRobotState = 200,   ///< value: new RobotState, extra: old one
  kTicksMissed = 201,  ///< value: how many
  kCommandRefused = 202,  ///< admission refused a command message
  kEstopInput = 203,      ///< value: the ContactState of the e-stop input
  kBusState = 300,        ///< value: new BusState, extra: old one
  kBusAdvice = 301,  ///< what rc10d did about a bus, or what a person has to do; from the io thread, in words
  kForeignSender = 302,  ///< somebody else sends a command id of ours; value: frames since the last report,
                         ///< extra: foreignFrame()
  kSerialPort = 310,     ///< a serial port came, went or cannot be opened; from the io thread, in words
  kDevice = 311,  ///< an SPI device or the lines of a GPIO chip came, went or cannot be opened; in words
};

/// Why a setpoint of an accepted message did not act.
enum class SkipReason : std::int32_t {
  kNotActive,
  kNoReference,
  kFirstStep,  ///< Farther from the measured angle than max_first_step_deg.
  kRefused,    ///< By the motor itself.
};

/// Added to the LoopGain of kGainChanged where the loop commands volts: its keys have other names.
inline constexpr std::int32_t kGainInVolts = 256;

/// An event as the scheduler reports it: no text. The link thread puts it into words.
struct Event {
  EventCode code{};
  Severity severity{};
  std::int16_t source = -1;  ///< Index of the motor, bus or module; -1: the robot.
  std::int32_t value = 0;
  std::int32_t extra = 0;
  MonotonicTime time;
  link::Name client{};  ///< Whose command or request it was.
};

/// Repeated reports of one cause come at most this often.
inline constexpr Duration kReportInterval = std::chrono::seconds{1};

/// The e-stop input has changed.
[[nodiscard]] inline Event estopInputEvent(ContactState state, MonotonicTime now) noexcept {
  const auto severity = state == ContactState::kClosed ? Severity::kInfo : Severity::kError;
  return {EventCode::kEstopInput, severity, -1, static_cast<std::int32_t>(state), 0, now};
}

/// The last foreign frame, for kForeignSender: its id, and whether it came from this computer.
[[nodiscard]] constexpr std::int32_t foreignFrame(CanId id, bool sent_here) noexcept {
  return static_cast<std::int32_t>(id.value | (id.extended ? 1U << 29U : 0U) | (sent_here ? 1U << 30U : 0U));
}

/// Whether the source of such an event is a bus.
[[nodiscard]] constexpr bool isOfBus(EventCode code) noexcept {
  return code == EventCode::kBusState || code == EventCode::kBusAdvice || code == EventCode::kForeignSender;
}

/// Whether the source of such an event is a module.
[[nodiscard]] constexpr bool isOfModule(EventCode code) noexcept {
  return code == EventCode::kModule || code == EventCode::kModuleRefused;
}

/// The event in words. Not for real-time threads.
[[nodiscard]] std::string describe(const Event& event);

}  // namespace rc10
