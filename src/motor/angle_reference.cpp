#include "motor/angle_reference.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include "app/angle.hpp"

namespace rc10 {

void AngleReference::update(double position_deg, bool may_restart, bool may_return) noexcept {
  if (!begun_ || (turn_unclear_ && may_restart) || (lost_ && (may_return || !config_.travel.bothEnds()))) {
    const bool power_on = config_.zero_at_power_on;
    const bool absolute = config_.absolute && !power_on;
    // The number of turns of the drive says nothing.
    const double within_turn_deg = absolute ? shortestAngle(config_.zero_deg, position_deg) : 0.0;
    const double near_deg = begun_ ? totalAngleDeg() : 0.0;
    const auto first_deg =
        absolute ? firstAngle(within_turn_deg, config_.travel, near_deg) : std::optional{0.0};
    offset_deg_ = first_deg.value_or(within_turn_deg) - position_deg;
    known_ = !forgotten_ && ((absolute && first_deg) || power_on);
    turn_unclear_ = !forgotten_ && !first_deg;
    begun_ = true;
    lost_ = false;
  } else if (drifts_) {
    offset_deg_ += position_deg_ - position_deg;  // the turns that are known now are no way
  }
  drifts_ = false;
  position_deg_ = position_deg;
}

void AngleReference::drift(double position_deg) noexcept {
  if (!drifts_) offset_deg_ += position_deg_ - position_deg;
  drifts_ = true;
  position_deg_ = position_deg;
}

bool AngleReference::setZero(double angle_deg) noexcept {
  if (!begun_ || !std::isfinite(angle_deg)) return false;
  offset_deg_ = angle_deg - position_deg_;
  config_.zero_deg = shortestAngle(angle_deg, position_deg_);
  known_ = true;
  turn_unclear_ = false;
  lost_ = false;
  forgotten_ = false;
  return true;
}

double AngleReference::zeroForFile() const noexcept {
  if (!begun_ || !config_.absolute || config_.zero_at_power_on)
    return std::numeric_limits<double>::quiet_NaN();
  return shortestAngle(0.0, config_.zero_deg);
}

void AngleReference::forget() noexcept {
  known_ = false;
  turn_unclear_ = false;
  lost_ = false;
  forgotten_ = true;
}

void AngleReference::lose() noexcept {
  drifts_ = false;
  known_ = false;
  turn_unclear_ = false;
  lost_ = config_.absolute && !config_.zero_at_power_on && !forgotten_;
}

void AngleReference::doubtTurn() noexcept {
  if (begun_ && (config_.travel.bothEnds() || !config_.absolute)) lose();
}

}  // namespace rc10
