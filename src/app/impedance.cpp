#include "app/impedance.hpp"

#include <algorithm>
#include <cmath>

#include "app/angle.hpp"
#include "app/units.hpp"

namespace rc10 {

float Impedance::torque(const Target& target, const Measured& measured, OutputRange range) const noexcept {
  const auto gain = [](float value) noexcept { return value > 0.0F ? static_cast<double>(value) : 0.0; };
  const double error_deg = config_.circular ? shortestAngle(measured.angle_deg, target.angle_deg)
                                            : target.angle_deg - measured.angle_deg;
  const double error_rpm =
      static_cast<double>(target.velocity_rpm) - static_cast<double>(measured.velocity_rpm);
  const double sum = gain(config_.stiffness_nm_per_rad) * toRadians(error_deg) +
                     gain(config_.damping_nms_per_rad) * error_rpm * kRadPerSPerRpm +
                     static_cast<double>(target.torque_nm);
  if (!std::isfinite(sum)) return 0.0F;
  return range.within(config_.torque_limit_nm).clamp(nearFloat(sum));
}

}  // namespace rc10
