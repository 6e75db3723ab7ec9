#include "motor/motor_base.hpp"

#include <cmath>

#include "app/limits.hpp"

namespace rc10 {
namespace {
bool finite(const Target& target) noexcept {
  return std::isfinite(target.value) && std::isfinite(target.velocity_ff_rpm) &&
         std::isfinite(target.torque_ff_nm) && std::isfinite(target.stiffness_nm_per_rad) &&
         std::isfinite(target.damping_nms_per_rad);
}

}  // namespace

std::string describe(const Motor_Base& motor, int drive_id) {
  return "motor '" + std::string{motor.name()} + "' (" + std::string{motor.modelName()} + " id " +
         std::to_string(drive_id) + ")";
}

bool Motor_Base::acceptsTarget(const Target& target) const noexcept {
  return static_cast<int>(target.mode) < kControlModeCount && modes().contains(target.mode) &&
         finite(normalised(target));
}

bool Motor_Base::setTarget(const Target& target) noexcept {
  if (static_cast<int>(target.mode) >= kControlModeCount || !modes().contains(target.mode)) return false;
  const Target accepted = normalised(target);
  if (!finite(accepted)) return false;
  target_ = accepted;
  return true;
}

void Motor_Base::order(FrameKind kind, const Target& in_force) noexcept {
  ordered_ = kind;
  Target& target = in_force_.emplace(in_force);
  // Finite only if each of them is, as nearly always.
  if (std::isfinite(target.velocity_ff_rpm + target.torque_ff_nm + target.stiffness_nm_per_rad +
                    target.damping_nms_per_rad))
    return;
  target.velocity_ff_rpm = finiteOr0(target.velocity_ff_rpm);
  target.torque_ff_nm = finiteOr0(target.torque_ff_nm);
  target.stiffness_nm_per_rad = finiteOr0(target.stiffness_nm_per_rad);
  target.damping_nms_per_rad = finiteOr0(target.damping_nms_per_rad);
}

bool Motor_Base::setTargetCurrent(Amperes current) noexcept {
  return setTarget(Target{.mode = ControlMode::kCurrent, .value = current.value});
}

bool Motor_Base::setTargetRPM(Rpm velocity) noexcept {
  return setTarget(Target{.mode = ControlMode::kVelocity, .value = velocity.value});
}

bool Motor_Base::setTargetAngle(Degrees angle) noexcept {
  return setTarget(Target{.mode = ControlMode::kAngle, .value = angle.value});
}

bool Motor_Base::setTargetTotalAngle(Degrees angle) noexcept {
  return setTarget(Target{.mode = ControlMode::kTotalAngle, .value = angle.value});
}

}  // namespace rc10
