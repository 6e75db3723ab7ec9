#include "daemon/tick/tick_tracer.hpp"

#include <array>
#include <chrono>
#include <limits>
#include <string_view>

namespace rc10 {
namespace {

struct Readable {
  std::string_view name;
  double (*read)(const MotorSnapshot& motor, const Snapshot& snapshot) noexcept;
};

constexpr std::array kReadables{
    Readable{"target", [](const MotorSnapshot& m, const Snapshot&) noexcept { return m.target.value; }},
    Readable{"target_shaped",
             [](const MotorSnapshot& m, const Snapshot&) noexcept { return m.target_shaped; }},
    Readable{"command_value", [](const MotorSnapshot& m,
                                 const Snapshot&) noexcept { return static_cast<double>(m.command_value); }},
    Readable{"feedback_age_us",
             [](const MotorSnapshot& m, const Snapshot& s) noexcept {
               return static_cast<double>(feedbackAgeUs(m.feedback, s.time));
             }},
    Readable{"feedback_age_at_use_us",
             [](const MotorSnapshot& m, const Snapshot& s) noexcept {
               return static_cast<double>(feedbackAgeUs(m.feedback, s.sent));
             }},
    Readable{"command_age_us",
             [](const MotorSnapshot& m, const Snapshot& s) noexcept {
               return static_cast<double>(commandAgeUs(m, s.time));
             }},
#define RC10_READABLE(type, name, initial)                               \
  Readable{#name, [](const MotorSnapshot& m, const Snapshot&) noexcept { \
             return static_cast<double>(m.feedback.name);                \
           }},
    RC10_FEEDBACK_READINGS(RC10_READABLE)
#undef RC10_READABLE
        Readable{"limits", [](const MotorSnapshot& m,
                              const Snapshot&) noexcept { return static_cast<double>(m.limits); }},
    Readable{"status",
             [](const MotorSnapshot& m, const Snapshot&) noexcept { return static_cast<double>(m.status); }},
    Readable{"acting",
             [](const MotorSnapshot& m, const Snapshot&) noexcept { return static_cast<double>(m.acting); }},
};

constexpr bool sameOrder() {
  if (kReadables.size() != link::kTraceReadings.size()) return false;
  for (std::size_t i = 0; i < kReadables.size(); ++i) {
    if (kReadables[i].name != link::kTraceReadings[i]) return false;
  }
  return true;
}
static_assert(sameOrder());

// The link thread has checked the choice against the robot.
double valueOf(const link::TraceSignal& signal, const Snapshot& snapshot) noexcept {
  if (signal.source == link::TraceSource::kModule)
    return snapshot.modules[signal.index].outputs[signal.value];
  return kReadables[signal.value].read(snapshot.motors[signal.index], snapshot);
}

}  // namespace

void trace(const Snapshot& snapshot, TickTrace& out) noexcept {
  const TraceChoice& choice = out.choice.read();
  if (choice.count == 0) return;
  TracedTick tick;
  tick.generation = choice.generation;
  tick.row.mono_us =
      std::chrono::duration_cast<std::chrono::microseconds>(snapshot.time.time_since_epoch()).count();
  tick.row.tick = static_cast<std::int64_t>(snapshot.tick);
  for (std::size_t i = 0; i < choice.count; ++i) tick.row.values[i] = valueOf(choice.signals[i], snapshot);
  if (!out.ticks.push(tick))
    out.dropped.store(out.dropped.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

}  // namespace rc10
