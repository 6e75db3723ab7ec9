#include "rc10/setpoint.hpp"

#include <cmath>

#include "app/target.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

// All but the value travel as 32 bit floats.
[[nodiscard]] bool fitsFloat(double number) {
  return std::abs(number) <= static_cast<double>(std::numeric_limits<float>::max());
}

}  // namespace

Result<void> Setpoint::check() const {
  const std::string what = std::string(toString(mode)) + " setpoint: ";
  if (static_cast<int>(mode) >= kControlModeCount) return fail("the mode is none of Mode");
  if (!std::isfinite(value)) return fail(what + "the value is not a finite number");
  if (mode == Mode::kDuty && std::abs(value) > 1.0) return fail(what + "a duty is within -1 to 1");
  if (!fitsFloat(forward.velocity.value) || !fitsFloat(forward.torque_nm)) {
    return fail(what + "a feed-forward is not a finite number");
  }
  const TargetFields used = fieldsOf(static_cast<ControlMode>(mode));
  if (!used.velocity_ff && forward.velocity.value != 0.0)
    return fail(what + "a velocity feed-forward is for ANGLE, TOTAL_ANGLE and IMPEDANCE only");
  if (!used.torque_ff && forward.torque_nm != 0.0)
    return fail(what +
                "a torque feed-forward is for CURRENT, VELOCITY, ANGLE, TOTAL_ANGLE and IMPEDANCE only");
  if (mode == Mode::kImpedance) {
    // Written so that NaN is refused as well.
    if (!(stiffness_nm_per_rad >= 0.0 && fitsFloat(stiffness_nm_per_rad))) {
      return fail(what + "the stiffness is not a finite number from 0 on");
    }
    if (!(damping_nms_per_rad >= 0.0 && fitsFloat(damping_nms_per_rad))) {
      return fail(what + "the damping is not a finite number from 0 on");
    }
  }
  return {};
}

}  // namespace robot_client
}  // namespace rc10
