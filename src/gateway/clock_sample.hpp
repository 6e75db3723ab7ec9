#pragma once

#include "app/receive_clock.hpp"
#include "app/time.hpp"

namespace rc10::gateway {

/// Both clocks at one moment.
struct ClockSample {
  MonotonicTime now;
  Duration realtime_offset{};  ///< CLOCK_REALTIME - CLOCK_MONOTONIC
};

[[nodiscard]] ClockSample sampleClocks() noexcept;

/// References for a receive stamp. `empty`: taken before the last time at which the socket was found
/// empty, so that whatever is read now came later. It is not simply the last wake-up: datagrams that were
/// left waiting then must not get younger.
[[nodiscard]] inline WakeUp wakeUp(const ClockSample& now, const ClockSample& empty) noexcept {
  return {now.now, empty.now, now.realtime_offset, empty.realtime_offset};
}

}  // namespace rc10::gateway
