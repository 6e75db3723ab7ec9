#pragma once

#include <cmath>
#include <limits>

namespace rc10::sim {

/// Load on a simulated motor's output shaft, and defects of the motor.
struct MotorLoad {
  float inertia_kg_m2 = std::numeric_limits<float>::quiet_NaN();  ///< Load only; NaN: the model's default.
  float viscous_nms_per_rad = std::numeric_limits<float>::quiet_NaN();  ///< NaN: the model's default.
  float coulomb_nm = std::numeric_limits<float>::quiet_NaN();           ///< NaN: the model's default.
  float load_torque_nm = 0.0F;  ///< Constant torque against which the motor works (a hanging weight).
  float gravity_nm = 0.0F;      ///< An arm's: what holds it level. Against the motor beyond hangs_at_deg.
  float hangs_at_deg = 0.0F;    ///< Where gravity leaves the arm at rest.
  float payload_kg = 0.0F;      ///< Weight that the arm carries, beside gravity_nm and inertia_kg_m2.
  float payload_at_m = 0.0F;    ///< Its distance from the shaft.
  /// End stops: the shaft does not turn beyond them. NaN: none.
  float stop_min_deg = std::numeric_limits<float>::quiet_NaN();
  float stop_max_deg = std::numeric_limits<float>::quiet_NaN();
  float initial_angle_deg = 0.0F;
  bool stalled = false;      ///< The shaft does not turn.
  bool silent = false;       ///< The drive sends nothing.
  float lost_frames = 0.0F;  ///< Fraction of feedback frames that are lost, 0 to 1.
};

/// `value`, or the model's default where it is NaN.
[[nodiscard]] inline double orDefault(float value, double model_default) noexcept {
  return std::isnan(value) ? model_default : static_cast<double>(value);
}

}  // namespace rc10::sim
