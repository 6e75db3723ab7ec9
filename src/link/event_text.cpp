#include "link/event_text.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cstdio>

#include "app/event_code.hpp"
#include "app/fault_code.hpp"
#include "link/words.hpp"

namespace rc10::link {
namespace {

[[nodiscard]] std::string busStateText(std::int32_t state) {
  switch (state) {
    case 0: return "active";
    case 1: return "error-warning";
    case 2: return "error-passive";
    case 3: return "bus-off";
    case 4: return "interface down";
    case 5: return "interface gone";
    case 6: return "silent: no frame received; check power, wiring, termination and bit rate";
    case 7: return "stalled: our frames do not reach the wire";
    default: return "unknown";
  }
}

// `reason`: SkipReason.
[[nodiscard]] std::string skipped(std::int32_t reason, std::int32_t extra) {
  const auto [mode, status] = ExtraPair<ControlMode, MotorStatus>::from(extra);
  const auto text = "setpoint " + std::string(toString(mode)) + " skipped: ";
  switch (SkipReason{reason}) {
    case SkipReason::kNotActive:
      if (status == MotorStatus::kActive) return text + "it was sent before the motor was enabled";
      return text + "the motor is " + toString(status) + ", not ACTIVE";
    case SkipReason::kNoReference:
      return text + "the angle has no reference; set it with `zero` or `zero: power_on`";
    case SkipReason::kFirstStep:
      return text + "farther from where the motor is than max_first_step_deg; begin near the measured angle";
    case SkipReason::kRefused: return text + "not a target for this motor";
    case SkipReason::kTooFar:
      return text + "no angle so far from 0 can be told exactly; ask for one within 1e12 degrees";
    case SkipReason::kGroup:
      return text + "its group acts together, and not all of its motors are ACTIVE; enable them all";
    default: return text + "unknown reason";
  }
}

// `reason`: GroupStop.
[[nodiscard]] const char* groupStopped(std::int32_t reason) noexcept {
  switch (GroupStop{reason}) {
    case GroupStop::kDisabled: return "its group is disabled with it";
    case GroupStop::kRefused: return "its group stops: it was not enabled";
    case GroupStop::kLost: break;
  }
  return "its group stops with it";
}

[[nodiscard]] const char* fallbackWord(std::int32_t action) noexcept {
  switch (action) {
    case 0: return "coasting";
    case 1: return "damping";
    case 2: return "braking";
    case 3: return "holding";
    case 4: return "coming to rest along a ramp";
    default: return "at rest";
  }
}

[[nodiscard]] const char* estopInputText(std::int32_t state) noexcept {
  switch (state) {
    case 1: return "the e-stop input is closed again: `clear` ends the e-stop";
    case 2: return "e-stop: the input is open: pressed, or a wire is off";
    case 3: return "e-stop: the input cannot be read: the chip is gone or does not answer";
    case 4: return "e-stop: the enabling switch is released or squeezed: hold it in the middle, then `clear`";
    default: return "e-stop input unknown";
  }
}

[[nodiscard]] const char* modeInputText(std::int32_t state) noexcept {
  switch (state) {
    case 1: return "the mode input is closed: full speed and current again, within two seconds";
    case 2: return "reduced speed and current: the mode input is open";
    case 3:
      return "reduced speed and current: the mode input cannot be read: the chip is gone or does not answer";
    default: return "mode input unknown";
  }
}

// `0x200) from another node on the bus`. `extra`: the id, plus 2^29 if it is extended, plus 2^30 if it was
// sent on this computer.
[[nodiscard]] std::string foreignId(std::int32_t extra) {
  const auto bits = static_cast<std::uint32_t>(extra);
  const bool extended = (bits & (1U << 29U)) != 0;
  std::array<char, 16> id{};
  (void)std::snprintf(id.data(), id.size(), extended ? "0x%08X" : "0x%03X", bits & 0x1FFFFFFFU);
  const bool sent_here = (bits & (1U << 30U)) != 0;
  return std::string(id.data()) + ") from " +
         (sent_here ? "another program on this computer" : "another node on the bus");
}

[[nodiscard]] std::string foreignSender(std::int32_t frames, std::int32_t extra) {
  return std::to_string(frames) + " frames with our command id (" + foreignId(extra) +
         ": two controllers command these motors; stop one";
}

// The drive's own code, for its manual.
[[nodiscard]] std::string nativeCode(std::int32_t code) {
  if (code == 0) return {};
  std::array<char, 32> text{};
  (void)std::snprintf(text.data(), text.size(), " (its code 0x%X)", static_cast<unsigned>(code));
  return text.data();
}

// In the order of CommandRefusal in daemon/clients/admission.hpp.
[[nodiscard]] std::string refused(std::int32_t reason, std::string_view client) {
  constexpr std::array kReasons{"accepted",          "malformed",         "unknown motor",  "unknown mode",
                                "unsupported mode",  "not finite",        "expired",        "old sequence",
                                "too many commands", "unknown module",    "unknown signal", "unused field",
                                "not permitted",     "gains beyond drive"};
  const auto index = static_cast<std::size_t>(reason);
  const bool known = reason > 0 && index < kReasons.size();
  return "command of '" + std::string(client) + "' refused: " + (known ? kReasons[index] : "unknown reason");
}

// `bits`: of the float.
[[nodiscard]] std::string gainChanged(std::int32_t gain, std::int32_t bits, std::string_view client) {
  std::array<char, 32> number{};
  const auto end =
      std::to_chars(number.data(), number.data() + number.size(), std::bit_cast<float>(bits)).ptr;
  return std::string(gainWord(gain)) + " is " + std::string(number.data(), end) + " now, set by '" +
         std::string(client) + "'";
}

[[nodiscard]] std::string neverHeard(std::int32_t id) {
  return "nothing heard from its drive since the start: check its power, CANH and CANL, both terminations, "
         "the "
         "bit rate, and that its id is " +
         std::to_string(id) + " (`rc10ctl scan` names the drives of a bus)";
}

template <typename Status>
[[nodiscard]] std::string change(std::int32_t value, std::int32_t extra, std::string_view by) {
  const auto [before, cause] = ExtraPair<Status, StopCause>::from(extra);
  const auto why = stopText(cause, by);
  return std::string(toString(before)) + " -> " + toString(static_cast<Status>(value)) +
         (why.empty() ? "" : " (" + why + ")");
}

}  // namespace

std::string eventText(std::int32_t code, std::int32_t value, std::int32_t extra, std::string_view client) {
  using enum EventCode;
  switch (EventCode{code}) {
    case kMotorStatus: return change<MotorStatus>(value, extra, client);
    case kCommandTimeout: return std::string("no valid command any more: ") + fallbackWord(value);
    case kReferenceLost:
      return "reference of the angle lost: angle targets are refused until it is known again";
    case kSetpointSkipped: return skipped(value, extra);
    case kNotOwner:
      return "command of '" + std::string(client) +
             "' refused: a client of the same or a higher priority holds the motor";
    case kMotorFault:
      return FaultCode{value} == FaultCode::kForeignCommands ? faultText(value) + " (" + foreignId(extra)
                                                             : faultText(value) + nativeCode(extra);
    case kGroupStopped: return groupStopped(extra);
    case kGroupRearmed: return "its group is enabled again";
    case kModule: return "reported event " + std::to_string(value);
    case kModuleRefused: return "its targets are refused: another client commands one of its motors";
    case kGainChanged: return gainChanged(value, extra, client);
    case kMovesAtRest:
      return "it gains speed, " + std::to_string(value) +
             " rpm now, though its drive is told to rest: gravity, a slope, a hand, or the drive";
    case kNeverHeard: return neverHeard(value);
    case kFallbackReplaced:
      return std::string("a load drags it faster than reduced mode allows: ") + fallbackWord(value) +
             " in place of a fallback that could push";
    case kRobotState: return change<RobotStatus>(value, extra, client);
    case kTicksMissed: return std::to_string(value) + (value == 1 ? " tick missed" : " ticks missed");
    case kCommandRefused: return refused(value, client);
    case kEstopInput: return estopInputText(value);
    case kModeInput: return modeInputText(value);
    case kPhaseLost: return "the wall clock was stepped: the phase of the ticks is lost";
    case kBusState: return "bus " + busStateText(value) + " (was " + busStateText(extra) + ")";
    case kBusAdvice: return "bus restarted, or in need of help";
    case kForeignSender: return foreignSender(value, extra);
    case kSerialPort: return "a serial port came, went or cannot be opened";
    case kDevice: return "an SPI device or GPIO lines came, went or cannot be opened";
    default: return "event " + std::to_string(code);
  }
}

}  // namespace rc10::link
