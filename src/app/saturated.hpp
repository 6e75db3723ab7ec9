#pragma once

#include <cmath>
#include <concepts>
#include <limits>

namespace rc10 {

/// The nearest integer that T can hold: never wraps. NaN becomes 0.
template <std::integral T>
[[nodiscard]] inline T saturatedRound(double value) noexcept {
  static_assert(sizeof(T) <= 4, "a double holds its limits exactly");
  constexpr auto kLowest = static_cast<double>(std::numeric_limits<T>::min());
  constexpr auto kHighest = static_cast<double>(std::numeric_limits<T>::max());
  if (std::isnan(value)) return T{0};
  if (value <= kLowest) return std::numeric_limits<T>::min();
  if (value >= kHighest) return std::numeric_limits<T>::max();
  return static_cast<T>(std::lround(value));
}

}  // namespace rc10
