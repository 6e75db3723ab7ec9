#pragma once

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
    const auto in_interval = now.time_since_epoch() % interval_;
    const auto place =
        static_cast<std::size_t>(in_interval.count()) * things / static_cast<std::size_t>(interval_.count());
    const bool all = last_ == MonotonicTime{} || now - last_ >= interval_;
    due_ = all ? things : (place + things - place_) % things;
    first_ = (place_ + 1) % things;
    things_ = things;
    place_ = place;
    last_ = now;
  }
  [[nodiscard]] constexpr bool due(std::size_t thing) const noexcept {
    return (thing + things_ - first_) % things_ < due_;
  }

 private:
  Duration interval_;
  MonotonicTime last_{};
  std::size_t place_ = 0;  // thing of the last turn
  std::size_t first_ = 0;  // first thing of this turn
  std::size_t due_ = 0;    // number of things in this turn
  std::size_t things_ = 1;
};

}  // namespace rc10
