#include "daemon/clients/trace_desk.hpp"

#include <algorithm>

namespace rc10 {

bool TraceDesk::exists(const link::TraceSignal& signal) const noexcept {
  switch (signal.source) {
    case link::TraceSource::kMotor:
      return signal.index < robot_.motors.size() && signal.value < link::kTraceReadings.size();
    case link::TraceSource::kModule:
      return signal.index < robot_.modules.size() &&
             signal.value < robot_.modules[signal.index].signals.outputs.size();
  }
  return false;
}

void TraceDesk::choose(std::uint64_t connection, const link::TraceChoice& choice) {
  std::erase_if(watchers_, [connection](const Watcher& w) { return w.connection == connection; });
  Watcher watcher{.connection = connection, .signals = {}};
  for (const auto& signal : std::span{choice.signals}.first(choice.signal_count)) {
    if (exists(signal)) watcher.signals.push_back(signal);
  }
  if (!watcher.signals.empty()) watchers_.push_back(std::move(watcher));
  publish();
}

void TraceDesk::forget(std::uint64_t connection) {
  if (std::erase_if(watchers_, [connection](const Watcher& w) { return w.connection == connection; }) > 0)
    publish();
}

bool TraceDesk::isWatching(std::uint64_t connection) const noexcept {
  return std::any_of(watchers_.begin(), watchers_.end(),
                     [connection](const Watcher& w) { return w.connection == connection; });
}

void TraceDesk::publish() {
  choice_.count = 0;
  ++choice_.generation;
  for (const auto& watcher : watchers_) {
    for (const auto& signal : watcher.signals) {
      const auto end = choice_.signals.begin() + choice_.count;
      if (std::find(choice_.signals.begin(), end, signal) != end) continue;
      if (choice_.count == choice_.signals.size()) break;
      choice_.signals[choice_.count++] = signal;
    }
  }
  trace_.choice.slot() = choice_;
  trace_.choice.publish();
}

void TraceDesk::fillChoice(link::Trace& out) const noexcept {
  out.signal_count = choice_.count;
  out.signals = choice_.signals;
  out.row_count = 0;
  out.dropped = static_cast<std::int64_t>(trace_.dropped.load(std::memory_order_relaxed));
}

bool TraceDesk::fill(link::Trace& out) noexcept {
  fillChoice(out);
  TracedTick tick;
  while (out.row_count < link::kMaxTraceRows && trace_.ticks.pop(tick)) {
    if (tick.generation == choice_.generation) out.rows[out.row_count++] = tick.row;
  }
  return out.row_count > 0;
}

}  // namespace rc10
