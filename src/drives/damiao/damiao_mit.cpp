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

double gain(double value, double most) noexcept { return value > 0.0 ? std::min(value, most) : 0.0; }

}  // namespace

double mitTorqueNm(const damiao::MitCommand& command, const DamiaoMitBounds& bounds) noexcept {
  return command.kp_nm_per_rad * (command.position_rad - bounds.position_rad) +
         command.kd_nms_per_rad * (command.velocity_rad_s - bounds.measured_rad_s) + command.torque_nm;
}

damiao::MitCommand boundedMit(damiao::MitCommand wanted, const DamiaoMitBounds& bounds,
                              std::uint32_t& limits) noexcept {
  const double most_nm = std::max(bounds.torque_nm, 0.0);
  const double fastest_rad_s = bounds.velocity_rad_s > 0.0
                                   ? std::min(bounds.velocity_rad_s, bounds.scale.v_max_rad_s)
                                   : bounds.scale.v_max_rad_s;
  damiao::MitCommand command;
  command.torque_nm = within(wanted.torque_nm, most_nm, kLimitCurrent, limits);

  // Only +-p_max can be told. A drive that stands beyond would run back, so it gets no stiffness at all.
  const bool reachable = bounds.position_known && std::fabs(bounds.position_rad) <= bounds.scale.p_max_rad;
  const double stiffness = gain(wanted.kp_nm_per_rad, damiao::kKpMax);
  const double damping = gain(wanted.kd_nms_per_rad, damiao::kKdMax);
  if (stiffness > 0.0 && !reachable) limits |= kLimitAngle;
  if (stiffness > 0.0 && reachable && std::isfinite(wanted.position_rad)) {
    command.kp_nm_per_rad = stiffness;
    const double target_rad = within(wanted.position_rad, bounds.scale.p_max_rad, kLimitAngle, limits);
    double error_rad = target_rad - bounds.position_rad;
    // Where stiffness and damping balance, it turns at just this speed.
    if (bounds.velocity_rad_s > 0.0 && damping > 0.0) {
      error_rad = within(error_rad, damping * fastest_rad_s / stiffness, kLimitVelocity, limits);
    }
    error_rad = within(error_rad, most_nm / stiffness, kLimitCurrent, limits);
    command.position_rad = bounds.position_rad + error_rad;
  }
  if (damping > 0.0) {
    command.kd_nms_per_rad = damping;
    const double target_rad_s = within(wanted.velocity_rad_s, fastest_rad_s, kLimitVelocity, limits);
    const double error_rad_s =
        within(target_rad_s - bounds.measured_rad_s, most_nm / damping, kLimitCurrent, limits);
    command.velocity_rad_s = bounds.measured_rad_s + error_rad_s;
  }

  const double torque_nm = mitTorqueNm(command, bounds);
  if (std::fabs(torque_nm) > most_nm) {
    limits |= kLimitCurrent;
    const double share = most_nm / std::fabs(torque_nm);
    command.torque_nm *= share;
    command.position_rad = bounds.position_rad + share * (command.position_rad - bounds.position_rad);
    command.velocity_rad_s = bounds.measured_rad_s + share * (command.velocity_rad_s - bounds.measured_rad_s);
  }
  // Without a gain its target means nothing; 0 is the plainest.
  if (command.kp_nm_per_rad == 0.0) command.position_rad = 0.0;
  if (command.kd_nms_per_rad == 0.0) command.velocity_rad_s = 0.0;
  return command;
}

}  // namespace rc10
