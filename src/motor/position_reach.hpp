#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "motor/first_angle.hpp"

namespace rc10 {

/// Bound of the targets of a drive with a spring, which can be told positions up to `range_rad` to either
/// side of its own 0. A loaded spring stands beside its target, and a drive beyond its range has to be let
/// go: so the sag at full torque is left over. A soft spring keeps half of the range.
[[nodiscard]] inline double springReachRad(double range_rad, double torque_nm,
                                           double stiffness_nm_per_rad) noexcept {
  constexpr double kMostSag = 0.5;
  if (!(stiffness_nm_per_rad > 0.0)) return range_rad;
  return range_rad - std::clamp(torque_nm / stiffness_nm_per_rad, 0.0, kMostSag * range_rad);
}

/// The same over time: a shaft that is farther out when it begins to follow angles is not drawn in, and is
/// led no farther out.
class SpringReach {
 public:
  /// The bound of this tick, in which it follows an angle. `reach_rad`: springReachRad().
  [[nodiscard]] double step(double reach_rad, double position_rad) noexcept {
    bound_rad_ = std::clamp(std::fabs(position_rad), reach_rad, std::max(reach_rad, bound_rad_));
    return bound_rad_;
  }
  /// It follows no angle.
  void release() noexcept { bound_rad_ = std::numeric_limits<double>::infinity(); }

 private:
  double bound_rad_ = std::numeric_limits<double>::infinity();
};

/// Whether a drive that stands at `position_deg` of its own could be told both limits of the travel, were the
/// output shaft at `angle_deg`. Without a limit nothing says where it has to go.
[[nodiscard]] inline bool reachesTravel(const Travel& travel, double angle_deg, double position_deg,
                                        double drive_per_output, double reach_deg) noexcept {
  const auto reaches = [&](double limit_deg) {
    return !std::isfinite(limit_deg) ||
           std::fabs(position_deg + drive_per_output * (limit_deg - angle_deg)) <= reach_deg;
  };
  return reaches(travel.min_deg) && reaches(travel.max_deg);
}

}  // namespace rc10
