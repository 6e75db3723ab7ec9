#pragma once

#include <algorithm>
#include <chrono>

#include "app/time.hpp"

namespace rc10 {

/// The longest that two samples can have been apart. Stamps of frames that waited for others come bunched:
/// for a bound on how far a shaft may have turned.
[[nodiscard]] constexpr Duration longestApart(Duration gap, Duration period) noexcept {
  constexpr Duration kWaited = std::chrono::milliseconds{5};
  return std::max(gap, Duration::zero()) + period + kWaited;
}

/// The spacing of the samples a loop advances on. Samples beat against the tick and arrive with
/// jitter: a loop that used the tick's dt, or the raw stamps, would see velocities between zero and
/// double. So the spacing is a whole number of sample periods, and the period is low-passed.
class SampleSpacing {
 public:
  /// `nominal`: the drive's own period.
  explicit SampleSpacing(Duration nominal) noexcept;

  /// A sample arrived `spacing` after the one before. The first has none: pass zero.
  void add(Duration spacing) noexcept;

  /// The time since the last take() that found a sample; 0 if none has arrived since then. Otherwise
  /// at least 0.1 and at most 5 nominal periods.
  [[nodiscard]] float take() noexcept;

  /// The drive's period as it is measured.
  [[nodiscard]] float periodSeconds() const noexcept { return period_s_; }

 private:
  /// Takes what is pending as so many periods.
  void takePeriods(float periods) noexcept;
  /// A late sample, or several. Not inlined: take() is short without it.
  [[nodiscard, gnu::noinline]] float takeSeveral() noexcept;

  float shortest_s_;
  float longest_s_;
  float period_s_;
  float pending_s_ = 0.0F;
  int pending_samples_ = 0;
};

}  // namespace rc10
