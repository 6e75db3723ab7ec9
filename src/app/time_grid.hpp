#pragma once

#include "app/time.hpp"

namespace rc10 {

/// Points in time that several threads keep without telling each other: `offset` after each multiple of
/// `period` on CLOCK_MONOTONIC. The offset may be negative.
struct TimeGrid {
  Duration period;
  Duration offset{};

  /// The first point that lies at least half a period ahead.
  [[nodiscard]] constexpr MonotonicTime next(MonotonicTime now) const noexcept {
    const auto ahead = now.time_since_epoch() - offset + period / 2;
    return MonotonicTime{(ahead / period + 1) * period + offset};
  }

  [[nodiscard]] constexpr TimeGrid shifted(Duration by) const noexcept { return {period, offset + by}; }
};

}  // namespace rc10
