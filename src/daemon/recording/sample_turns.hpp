#pragma once

#include <cstddef>

#include "app/time.hpp"

namespace rc10 {

/// Spreads the samples of many things over an interval: each has its turn once an interval, and no tick has
/// them all. What a late tick has missed, the next one takes.
class SampleTurns {
 public:
  explicit constexpr SampleTurns(Duration interval) noexcept : interval_(interval) {}

  /// `things`: how many there are, the same in every tick. The first tick takes all.
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
  std::size_t place_ = 0;  // of the thing that had its turn last
  std::size_t first_ = 0;  // whose turn it is
  std::size_t due_ = 0;    // how many have it
  std::size_t things_ = 1;
};

}  // namespace rc10
