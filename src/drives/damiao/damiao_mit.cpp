#include "drives/damiao/damiao_mit.hpp"

#include <algorithm>
#include <cmath>

#include "motor/motor_base.hpp"

namespace rc10 {
namespace {

/// `value` within [-bound, bound]; NaN: 0. Sets the flag if that is another value.
double within(double value, double bound, LimitFlag flag, std::uint32_t& limits) noexcept {
  if (std::isnan(value)) return 0.0;
  const double bounded = std::clamp(value, -bound, bound);
  if (bounded != value) limits |= flag;
  return bounded;
}

}  // namespace

SpringLaw boundedMit(SpringLaw law, const DamiaoMitBounds& bounds, std::uint32_t& limits) noexcept {
  const double most_nm = std::max(bounds.torque_nm, 0.0);
  const double fastest_rad_s = bounds.velocity_rad_s > 0.0
                                   ? std::min(bounds.velocity_rad_s, bounds.scale.v_max_rad_s)
                                   : bounds.scale.v_max_rad_s;
  boundGains(law, damiao::kKpMax, damiao::kKdMax);
  law.torque_nm = within(law.torque_nm, most_nm, kLimitCurrent, limits);

  // Only +-p_max can be told. A drive that stands beyond would run back, so it gets no stiffness at all.
  const bool reachable =
      bounds.position_known && std::fabs(bounds.measured.position_rad) <= bounds.scale.p_max_rad;
  if (law.stiffness_nm_per_rad > 0.0 && !reachable) {
    limits |= kLimitAngle;
    law = dampOnly(law, bounds.damping_nms_per_rad);
  }
  if (!reachable || !std::isfinite(law.position_rad)) law.stiffness_nm_per_rad = 0.0;
  if (law.stiffness_nm_per_rad > 0.0) {
    const double reach_rad = std::min(bounds.reach_rad, bounds.scale.p_max_rad);
    law.position_rad = within(law.position_rad, reach_rad, kLimitAngle, limits);
  }
  if (law.damping_nms_per_rad > 0.0) {
    law.velocity_rad_s = within(law.velocity_rad_s, fastest_rad_s, kLimitVelocity, limits);
  }
  // The speed that the spring leads to and that of the trajectory are one.
  if (bounds.lead != nullptr && bounds.velocity_rad_s > 0.0 &&
      bounds.lead->apply(law, bounds.measured, fastest_rad_s, most_nm, bounds.now)) {
    limits |= kLimitVelocity;
  }
  if (boundParts(law, bounds.measured, most_nm)) limits |= kLimitCurrent;
  if (boundTorque(law, bounds.measured, most_nm, SpringYield::kErrors)) limits |= kLimitCurrent;
  // A shaft that is faster than its field can say has a greater error than that: the gains yield.
  law.velocity_rad_s = std::clamp(law.velocity_rad_s, -bounds.scale.v_max_rad_s, bounds.scale.v_max_rad_s);
  if (boundTorque(law, bounds.measured, most_nm, SpringYield::kGains)) limits |= kLimitCurrent;
  keepResisting(law, damiao::kKdStep);
  // Without a gain its target means nothing; 0 is the plainest.
  if (law.stiffness_nm_per_rad == 0.0) law.position_rad = 0.0;
  if (law.damping_nms_per_rad == 0.0) law.velocity_rad_s = 0.0;
  return law;
}

}  // namespace rc10
