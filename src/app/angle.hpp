#pragma once

#include <cmath>
#include <concepts>

#include "app/units.hpp"

namespace rc10 {

template <std::floating_point T>
[[nodiscard]] constexpr T toRadians(T angle_deg) noexcept {
  return angle_deg * static_cast<T>(kRadPerDeg);
}

template <std::floating_point T>
[[nodiscard]] constexpr T toDegrees(T angle_rad) noexcept {
  return angle_rad * static_cast<T>(kDegPerRad);
}

/// `angle` in [0, period). A NaN stays NaN, an infinity becomes one.
template <std::floating_point T>
[[nodiscard]] inline T wrapPeriod(T angle, T period) noexcept {
  if (angle > T{0} && angle < period) return angle;
  const T wrapped = angle - period * std::floor(angle / period);
  // Rounding may leave a tiny negative angle, or turn one into the period itself.
  if (wrapped >= period || wrapped < T{0}) return T{0};
  return wrapped;
}

/// The angle in [0, 360).
template <std::floating_point T>
[[nodiscard]] inline T wrapDegrees(T angle_deg) noexcept {
  return wrapPeriod(angle_deg, T{360});
}

/// The same as a float: the nearest may be the full turn itself, which is 0.
[[nodiscard]] inline float wrapDegreesToFloat(double angle_deg) noexcept {
  const auto wrapped_deg = static_cast<float>(wrapDegrees(angle_deg));
  return wrapped_deg < 360.0F ? wrapped_deg : 0.0F;
}

/// The angle in [-180, 180]: half a turn keeps its sign. Without rounding; NaN for a NaN or an infinity.
[[nodiscard]] inline double wrapHalfTurn(double angle_deg) noexcept {
  return std::remainder(angle_deg, kDegPerTurn);
}

/// The shortest way from `from` to `to` on a circle, in [-period/2, period/2), whatever turn the two
/// are given in.
template <std::floating_point T>
[[nodiscard]] inline T shortestWay(T from, T to, T period) noexcept {
  return wrapPeriod(to - from + period / T{2}, period) - period / T{2};
}

/// The shortest way from one angle to another in degrees, in [-180, 180).
template <std::floating_point T>
[[nodiscard]] inline T shortestAngle(T from_deg, T to_deg) noexcept {
  return shortestWay(from_deg, to_deg, T{360});
}

}  // namespace rc10
