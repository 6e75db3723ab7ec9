#include "daemon/exchange/clock.hpp"

#include <ctime>

#include "app/utime.hpp"

namespace rc10 {

MonotonicTime monotonicNow() noexcept {
  // libstdc++'s steady_clock is CLOCK_MONOTONIC.
  return std::chrono::steady_clock::now();
}

std::int64_t wallClockUs() noexcept { return utimeOf(std::chrono::system_clock::now()); }

Duration threadCpuTime() noexcept {
  timespec time{};
  (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec};
}

Duration realtimeOffset(MonotonicTime now) noexcept {
  const auto realtime = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<Duration>(realtime) - now.time_since_epoch();
}

ClockOffset measureRealtimeOffset() noexcept {
  constexpr int kMeasurements = 8;
  ClockOffset best{Duration{}, Duration::max()};
  for (int i = 0; i < kMeasurements; ++i) {
    const MonotonicTime before = monotonicNow();
    const Duration ahead = realtimeOffset(before);
    const Duration window = monotonicNow() - before;
    if (window < best.uncertainty) best = {ahead - window / 2, window};
  }
  return best;
}

}  // namespace rc10
