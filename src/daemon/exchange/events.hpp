#pragma once

#include <cstdint>
#include <string>

#include "app/event_code.hpp"
#include "app/time.hpp"
#include "bus/can_frame.hpp"
#include "daemon/exchange/safety_contact.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

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

/// The mode input has changed.
[[nodiscard]] inline Event modeInputEvent(ContactState state, MonotonicTime now) noexcept {
  const auto severity = state == ContactState::kUnreadable ? Severity::kError : Severity::kInfo;
  return {EventCode::kModeInput, severity, -1, static_cast<std::int32_t>(state), 0, now};
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
