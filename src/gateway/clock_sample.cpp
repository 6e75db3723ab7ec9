#include "gateway/clock_sample.hpp"

#include <chrono>
#include <ctime>

namespace rc10::gateway {
namespace {

Duration readClock(clockid_t clock) noexcept {
  timespec time{};
  ::clock_gettime(clock, &time);
  return std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec};
}

}  // namespace

ClockSample sampleClocks() noexcept {
  // A pause between the two readings would look like a step of the wall clock: the closest of a few counts.
  constexpr Duration kClose = std::chrono::microseconds{20};
  ClockSample best;
  Duration best_gap = Duration::max();
  for (int attempt = 0; attempt < 5 && best_gap > kClose; ++attempt) {
    const Duration before = readClock(CLOCK_MONOTONIC);
    const Duration realtime = readClock(CLOCK_REALTIME);
    const Duration after = readClock(CLOCK_MONOTONIC);
    if (after - before >= best_gap) continue;
    best_gap = after - before;
    best = {MonotonicTime{before}, realtime - before};
  }
  return best;
}

}  // namespace rc10::gateway
