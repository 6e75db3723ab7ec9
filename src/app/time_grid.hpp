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

  /// Points `phase` after each multiple of `period` on a clock that is `ahead` of CLOCK_MONOTONIC. Both are
  /// slewed alike, so the points stay there until the clock is stepped.
  [[nodiscard]] static constexpr TimeGrid onClock(Duration period, Duration phase, Duration ahead) noexcept {
    return {period, ((phase - ahead) % period + period) % period};
  }
  /// Place of the points in the periods of a clock that is `ahead`. Range: 0 to below the period.
  [[nodiscard]] constexpr Duration phaseOn(Duration ahead) const noexcept {
    return ((offset + ahead) % period + period) % period;
  }
};

}  // namespace rc10
