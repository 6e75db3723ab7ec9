#include "motor/angle_reference.hpp"

#include <cmath>

#include "app/angle.hpp"

namespace rc10 {

void AngleReference::update(double position_deg) noexcept {
  if (!begun_) {
    const bool power_on = config_.zero_at_power_on;
    const bool absolute = config_.absolute && !power_on;
    // In [-180, 180): the number of turns at power-up says nothing.
    const double first_deg = absolute ? shortestAngle(config_.zero_deg, position_deg) : 0.0;
    offset_deg_ = first_deg - position_deg;
    known_ = absolute || power_on;
    begun_ = true;
  }
  position_deg_ = position_deg;
}

bool AngleReference::setZero(double angle_deg) noexcept {
  if (!begun_ || !std::isfinite(angle_deg)) return false;
  offset_deg_ = angle_deg - position_deg_;
  known_ = true;
  return true;
}

void AngleReference::lose() noexcept {
  known_ = false;
  if (config_.absolute && !config_.zero_at_power_on) begun_ = false;
}

}  // namespace rc10
