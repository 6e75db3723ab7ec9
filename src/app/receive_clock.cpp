#include "app/receive_clock.hpp"

#include <algorithm>
#include <chrono>

namespace rc10 {
namespace {

// Slewing moves CLOCK_REALTIME and CLOCK_MONOTONIC alike: the offset changes by steps only (settimeofday,
// a leap second, suspend). A smaller change is the noise of reading two clocks one after the other.
constexpr Duration kOffsetNoise = std::chrono::milliseconds{1};

}  // namespace

MonotonicTime toMonotonic(Duration realtime_stamp, const WakeUp& wake) noexcept {
  const Duration step = wake.realtime_offset - wake.previous_offset;
  if (step > kOffsetNoise || step < -kOffsetNoise) return wake.previous;
  const MonotonicTime received{realtime_stamp - wake.realtime_offset};
  // Not std::clamp: it is undefined should `previous` ever lie after `now`.
  return std::min(std::max(received, wake.previous), wake.now);
}

}  // namespace rc10
