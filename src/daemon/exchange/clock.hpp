#pragma once

#include "app/receive_clock.hpp"

namespace rc10 {

/// CLOCK_MONOTONIC, now.
[[nodiscard]] MonotonicTime monotonicNow() noexcept;
/// CLOCK_REALTIME in microseconds since 1970, for `utime` fields only.
[[nodiscard]] std::int64_t wallClockUs() noexcept;
/// CPU time of the calling thread. A system call.
[[nodiscard]] Duration threadCpuTime() noexcept;
/// CLOCK_REALTIME - CLOCK_MONOTONIC; `now`: the latter, read just before.
[[nodiscard]] Duration realtimeOffset(MonotonicTime now) noexcept;

/// CLOCK_REALTIME - CLOCK_MONOTONIC.
struct ClockOffset {
  Duration ahead;
  Duration uncertainty;  ///< The clocks are read one after the other, and the thread may be preempted.
};
/// The least uncertain of some measurements.
[[nodiscard]] ClockOffset measureRealtimeOffset() noexcept;

}  // namespace rc10
