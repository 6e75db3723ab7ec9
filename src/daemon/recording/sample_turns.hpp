#pragma once

#include <algorithm>
#include <cstddef>

#include "app/time.hpp"

namespace rc10 {

/// Spreads the samples of many things over an interval: each has its turn once an interval, and no tick has
/// them all. A late tick makes up for the turns that it has missed.
class SampleTurns {
 public:
  explicit constexpr SampleTurns(Duration interval) noexcept : interval_(interval) {}

  /// `things`: their number, the same in every tick. All are due in the first tick.
  constexpr void advance(MonotonicTime now, std::size_t things) noexcept {
    const auto intervals = static_cast<std::size_t>(now.time_since_epoch() / interval_);
    const auto within = static_cast<std::size_t>((now.time_since_epoch() % interval_).count());
    const std::size_t turn =
        intervals * things + within * things / static_cast<std::size_t>(interval_.count());
    due_ = turn_ == 0 ? things : std::min(turn - turn_, things);
    first_ = (turn - due_ + 1) % things;
    things_ = things;
    turn_ = turn;
  }
  [[nodiscard]] constexpr bool due(std::size_t thing) const noexcept {
    return (thing + things_ - first_) % things_ < due_;
  }

 private:
  Duration interval_;
  std::size_t turn_ = 0;   // the last one, counted from the clock's begin
  std::size_t first_ = 0;  // first thing of this turn
  std::size_t due_ = 0;    // number of things in this turn
  std::size_t things_ = 1;
};

}  // namespace rc10
