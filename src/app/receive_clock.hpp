#pragma once

#include "app/time.hpp"

namespace rc10 {

/// One wake-up of a thread that receives: what turns the kernel's wall-clock receive stamps into
/// monotonic time. The first wake-up is its own predecessor.
struct WakeUp {
  MonotonicTime now;
  MonotonicTime previous;      ///< The wake-up before this one.
  Duration realtime_offset{};  ///< CLOCK_REALTIME - CLOCK_MONOTONIC, sampled at this wake-up.
  Duration previous_offset{};  ///< The same at the wake-up before.
};

/// Converts a CLOCK_REALTIME receive stamp (ns since 1970) into monotonic time, clamped to
/// [previous, now]: nothing that is received now came before the last time we looked. If the wall
/// clock was stepped in between, the stamp means nothing and the answer is `previous`: the oldest
/// possible time, so that no old command looks fresh.
[[nodiscard]] MonotonicTime toMonotonic(Duration realtime_stamp, const WakeUp& wake) noexcept;

}  // namespace rc10
