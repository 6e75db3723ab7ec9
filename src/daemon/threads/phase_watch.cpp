#include "daemon/threads/phase_watch.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace rc10 {

PhaseWatch::PhaseWatch(const TimeGrid& ticks, Duration ahead, LinkExchange& exchange) noexcept
    : ticks_(ticks), phase_(ticks.phaseOn(ahead)), notes_(exchange.notes, EventCode::kPhaseLost) {}

void PhaseWatch::check(const ClockOffset& realtime, MonotonicTime now) {
  constexpr int kOff = 10;
  constexpr int kUncertain = 20;
  if (lost_ || realtime.uncertainty > ticks_.period / kUncertain) return;
  const Duration phase = ticks_.phaseOn(realtime.ahead);
  const Duration apart = std::max(phase, phase_) - std::min(phase, phase_);
  if (std::min(apart, ticks_.period - apart) <= ticks_.period / kOff) return;
  lost_ = true;
  const auto part = [this](Duration of) {
    return static_cast<double>(of.count()) / static_cast<double>(ticks_.period.count());
  };
  notes_.tell("scheduler", Severity::kWarning,
              fmt::format("the wall clock was stepped: ticks lie at {:.2f} of its periods, not at {:.2f}, "
                          "beside those of other computers; restart rc10d to lay them anew",
                          part(phase), part(phase_)),
              now);
}

}  // namespace rc10
