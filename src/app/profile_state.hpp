#pragma once

#include <algorithm>
#include <cmath>

namespace rc10 {

/// Where the reference of a motion is. P: unit of the position.
struct ProfileState {
  double position = 0.0;      ///< P
  double velocity = 0.0;      ///< P / s
  double acceleration = 0.0;  ///< P / s^2

  friend constexpr bool operator==(const ProfileState&, const ProfileState&) = default;
};

/// Positions, and what they change by, are kept within this, so that no step overflows.
inline constexpr double kHugeMotion = 1e12;
/// A limit below this is no motion.
inline constexpr double kTinyLimit = 1e-9;

/// A limit of a motion as it is used: 0 for what is not above kTinyLimit (NaN as well), and at most
/// kHugeMotion.
[[nodiscard]] constexpr double usableLimit(double limit) noexcept {
  return limit > kTinyLimit ? std::min(limit, kHugeMotion) : 0.0;
}

[[nodiscard]] inline bool isFinite(const ProfileState& state) noexcept {
  return std::isfinite(state.position) && std::isfinite(state.velocity) && std::isfinite(state.acceleration);
}

[[nodiscard]] constexpr double withinMotion(double value) noexcept {
  return std::clamp(value, -kHugeMotion, kHugeMotion);
}

}  // namespace rc10
