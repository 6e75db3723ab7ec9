#include "link/link_message.hpp"

#include <algorithm>

namespace rc10::link {
namespace {

// Size of a struct whose array member starts at `offset` and uses `used` of its `room` elements. The
// array is the last member of every message of variable size but Request and Response,
// whose arrays are short and travel whole.
template <typename Element>
std::size_t upTo(std::size_t offset, std::size_t used, std::size_t room) noexcept {
  return offset + std::min(used, room) * sizeof(Element);
}

}  // namespace

std::size_t wireSize(const Hello&) noexcept { return sizeof(Hello); }
std::size_t wireSize(const Welcome& message) noexcept {
  return upTo<MotorInfo>(offsetof(Welcome, motors), message.motor_count, kMaxMotors);
}
std::size_t wireSize(const Command& message) noexcept {
  return upTo<Setpoint>(offsetof(Command, setpoints), message.setpoint_count, kMaxMotors);
}
std::size_t wireSize(const Request&) noexcept { return sizeof(Request); }
std::size_t wireSize(const Response&) noexcept { return sizeof(Response); }
std::size_t wireSize(const State& message) noexcept {
  return upTo<MotorState>(offsetof(State, motors), message.motor_count, kMaxMotors);
}
std::size_t wireSize(const Diagnostics& message) noexcept {
  return upTo<Durations>(offsetof(Diagnostics, durations), message.duration_count, kMaxDurations);
}
std::size_t wireSize(const Event&) noexcept { return sizeof(Event); }
std::size_t wireSize(const Signals& message) noexcept {
  return upTo<NamedValue>(offsetof(Signals, values), message.value_count, kMaxSignals);
}
std::size_t wireSize(const ModuleInfo&) noexcept { return sizeof(ModuleInfo); }
std::size_t wireSize(const ModuleState& message) noexcept {
  return upTo<double>(offsetof(ModuleState, values), message.value_count, kMaxSignals);
}
std::size_t wireSize(const TraceChoice&) noexcept { return sizeof(TraceChoice); }
std::size_t wireSize(const Trace& message) noexcept {
  return upTo<TraceRow>(offsetof(Trace, rows), message.row_count, kMaxTraceRows);
}
std::size_t wireSize(const Sighting& message) noexcept {
  return upTo<ScanGuess>(offsetof(Sighting, guesses), message.guess_count, kMaxScanGuesses);
}

bool countsFit(const Hello&) noexcept { return true; }
bool countsFit(const Welcome& message) noexcept {
  return message.motor_count <= kMaxMotors && message.module_count <= kMaxModules;
}
bool countsFit(const Command& message) noexcept { return message.setpoint_count <= kMaxMotors; }
bool countsFit(const Request& message) noexcept { return message.value_count <= kMaxValues; }
bool countsFit(const Response& message) noexcept { return message.value_count <= kMaxValues; }
bool countsFit(const State& message) noexcept { return message.motor_count <= kMaxMotors; }
bool countsFit(const Diagnostics& message) noexcept {
  return message.refusal_count <= kMaxRefusalReasons && message.notice_count <= kMaxNotices &&
         message.bus_count <= kMaxBuses && message.counter_count <= kMaxCounters &&
         message.duration_count <= kMaxDurations;
}
bool countsFit(const Event&) noexcept { return true; }
bool countsFit(const Signals& message) noexcept { return message.value_count <= kMaxSignals; }
bool countsFit(const ModuleInfo& message) noexcept {
  return message.module < kMaxModules && message.input_count <= kMaxSignals &&
         message.output_count <= kMaxSignals;
}
bool countsFit(const ModuleState& message) noexcept {
  return message.module < kMaxModules && message.value_count <= kMaxSignals;
}
bool countsFit(const TraceChoice& message) noexcept { return message.signal_count <= kMaxTraceSignals; }
bool countsFit(const Trace& message) noexcept {
  return message.signal_count <= kMaxTraceSignals && message.row_count <= kMaxTraceRows;
}
bool countsFit(const Sighting& message) noexcept { return message.guess_count <= kMaxScanGuesses; }

bool openEstop(std::span<const std::byte> datagram, Request& request) noexcept {
  constexpr std::size_t kNeeded = offsetof(Request, operation) + sizeof(Request::operation);
  if (datagram.size() < kNeeded) return false;
  std::memcpy(static_cast<void*>(&request), datagram.data(), kNeeded);
  request.target = "";
  request.value_count = 0;
  return request.header.type == MessageType::kRequest &&
         operationNamed(request.operation.view()) == Operation::kEstop;
}

bool readHeader(std::span<const std::byte> datagram, Header& header) noexcept {
  if (datagram.size() < sizeof(Header)) return false;
  std::memcpy(&header, datagram.data(), sizeof(Header));
  return header.size == datagram.size();
}

}  // namespace rc10::link
