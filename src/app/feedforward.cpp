#include "app/feedforward.hpp"

#include <cmath>

#include "app/angle.hpp"

namespace rc10 {
namespace {

// -1 to 1 without a step at rest, which would chatter.
float smoothSign(float velocity_rpm, float width_rpm) noexcept {
  if (width_rpm > 0.0F) return std::tanh(velocity_rpm / width_rpm);
  return velocity_rpm == 0.0F ? 0.0F : std::copysign(1.0F, velocity_rpm);
}

}  // namespace

float Feedforward::output(const Setpoint& setpoint) const noexcept {
  const double from_level_deg = setpoint.angle_deg - static_cast<double>(config_.gravity_deg);
  const float sum = config_.per_rpm * setpoint.velocity_rpm +
                    config_.per_rpm_s * setpoint.acceleration_rpm_s +
                    config_.friction * smoothSign(setpoint.velocity_rpm, config_.friction_rpm) +
                    config_.gravity * static_cast<float>(std::cos(toRadians(from_level_deg)));
  return std::isfinite(sum) && std::isfinite(setpoint.angle_deg) ? sum : 0.0F;
}

}  // namespace rc10
