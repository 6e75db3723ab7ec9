#pragma once

#include <chrono>
#include <cstdint>

namespace rc10 {

using Duration = std::chrono::nanoseconds;

/// A point on CLOCK_MONOTONIC, the only clock of the process. Nothing below the daemon asks a clock:
/// time is an argument.
using MonotonicTime = std::chrono::time_point<std::chrono::steady_clock, Duration>;

/// Present tick, as every motor, packer and module gets it.
struct Tick {
  std::uint64_t index = 0;  ///< Ticks executed since start.
  MonotonicTime now;        ///< When this tick started.
  float dt_s = 0.001F;      ///< Distance on the grid since the last executed tick, at most 5 periods.
};

[[nodiscard]] constexpr float seconds(Duration duration) noexcept {
  return static_cast<float>(std::chrono::duration<double>(duration).count());
}

/// Period of a rate; below 1 Hz that of 1 Hz.
[[nodiscard]] constexpr Duration periodOf(int hz) noexcept {
  return Duration{std::chrono::seconds{1}} / (hz > 1 ? hz : 1);
}

}  // namespace rc10
