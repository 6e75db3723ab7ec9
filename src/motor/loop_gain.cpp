#include "motor/loop_gain.hpp"

#include <variant>

namespace rc10 {
namespace {

/// Gains that both types of velocity loop have.
template <typename Config>
float* commonGain(Config& pid, LoopGain gain) noexcept {
  switch (gain) {
    case LoopGain::kVelocityKp: return &pid.kp;
    case LoopGain::kVelocityKi: return &pid.ki;
    case LoopGain::kVelocityKd: return &pid.kd;
    case LoopGain::kVelocityDeadband: return &pid.deadband;
    case LoopGain::kVelocityDerivativeFilter: return &pid.derivative_filter_hz;
    default: return nullptr;
  }
}

float* velocityGain(PID_Position::Config& pid, LoopGain gain) noexcept {
  if (gain == LoopGain::kVelocityIntegralLimit) return &pid.integral_limit;
  if (gain == LoopGain::kVelocityIntegralSeparation) return &pid.integral_separation;
  return commonGain(pid, gain);
}

float* velocityGain(PID_Incremental::Config& pid, LoopGain gain) noexcept {
  if (gain == LoopGain::kVelocityTargetBandwidth) return &pid.tracking_rad_s;
  return commonGain(pid, gain);
}

}  // namespace

float* gainIn(CascadeConfig& loops, LoopGain gain) noexcept {
  switch (gain) {
    case LoopGain::kAngleKp: return &loops.angle.kp;
    case LoopGain::kAngleKi: return &loops.angle.ki;
    case LoopGain::kAngleKd: return &loops.angle.kd;
    case LoopGain::kAngleDeadband: return &loops.angle.deadband;
    case LoopGain::kAngleVelocityLimit: return &loops.angle.output_limit;
    case LoopGain::kAngleIntegralLimit: return &loops.angle.integral_limit;
    case LoopGain::kAngleIntegralSeparation: return &loops.angle.integral_separation;
    case LoopGain::kAngleDerivativeFilter: return &loops.angle.derivative_filter_hz;
    default: break;
  }
  if (auto* incremental = std::get_if<PID_Incremental::Config>(&loops.velocity))
    return velocityGain(*incremental, gain);
  return velocityGain(*std::get_if<PID_Position::Config>(&loops.velocity), gain);
}

float gainOf(const CascadeConfig& loops, LoopGain gain) noexcept {
  CascadeConfig copy = loops;
  const float* value = gainIn(copy, gain);
  return value != nullptr ? *value : 0.0F;
}

}  // namespace rc10
