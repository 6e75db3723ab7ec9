#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>

namespace rc10 {

/// Bounds of a controller's output at this step. `low <= high`.
struct OutputRange {
  float low = -std::numeric_limits<float>::infinity();
  float high = std::numeric_limits<float>::infinity();

  /// +-limit. A negative limit or a NaN allows nothing.
  [[nodiscard]] static constexpr OutputRange symmetric(float limit) noexcept {
    const float bound = limit > 0.0F ? limit : 0.0F;
    return {-bound, bound};
  }
  /// The part of both ranges; `other` is symmetric and 0 there means "no limit of its own".
  [[nodiscard]] constexpr OutputRange within(float own_limit) const noexcept {
    if (!(own_limit > 0.0F)) return *this;
    return {std::clamp(low, -own_limit, own_limit), std::clamp(high, -own_limit, own_limit)};
  }
  [[nodiscard]] constexpr OutputRange shifted(float offset) const noexcept {
    return {low + offset, high + offset};
  }
  [[nodiscard]] constexpr float clamp(float value) const noexcept { return std::clamp(value, low, high); }
};

/// Terms of a controller are kept below this, so that no sum of a few of them overflows.
inline constexpr float kHugeTerm = 1e30F;

/// A number that can be added to others: overflow becomes +-kHugeTerm, NaN (0 * infinity) becomes 0.
[[nodiscard]] inline float saturate(float value) noexcept {
  if (std::fabs(value) <= kHugeTerm) return value;  // one comparison, for nearly every number
  if (std::isnan(value)) return 0.0F;
  return value > 0.0F ? kHugeTerm : -kHugeTerm;
}

/// A float near a double of any size.
[[nodiscard]] constexpr float nearFloat(double value) noexcept {
  constexpr auto kBound = static_cast<double>(kHugeTerm);
  return static_cast<float>(std::clamp(value, -kBound, kBound));
}

/// `value`, or 0 for NaN and infinity.
template <std::floating_point T>
[[nodiscard]] inline T finiteOr0(T value) noexcept {
  return std::isfinite(value) ? value : T{0};
}

}  // namespace rc10
