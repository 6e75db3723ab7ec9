#include "app/tracking_differentiator.hpp"

#include <cmath>

#include "app/limits.hpp"

namespace rc10 {

void TrackingDifferentiator::reset(float value) noexcept {
  state_ = State{.value = value};
  target_ = static_cast<double>(saturate(value));
  distance_ = 0.0;
  rate_per_s_ = 0.0;
}

float TrackingDifferentiator::step(float target, float dt_s) noexcept {
  if (!active()) {
    reset(target);
    return target;
  }
  const auto goal = static_cast<double>(saturate(target));
  const auto r = static_cast<double>(bandwidth_rad_s_);
  const auto dt = static_cast<double>(dt_s);
  // distance'' = -2 r distance' - r^2 distance  =>  distance(t) = (d0 + (v0 + r d0) t) exp(-r t)
  const double decay = std::exp(-r * dt);
  const double distance = distance_ + (target_ - goal);
  const double slope = rate_per_s_ + r * distance;
  target_ = goal;
  distance_ = (distance + slope * dt) * decay;
  rate_per_s_ = (rate_per_s_ - r * slope * dt) * decay;
  // The rest becomes 0 itself: subnormal numbers are slow.
  constexpr double kNothing = 1e-60;
  if (std::fabs(distance_) < kNothing && std::fabs(rate_per_s_) < kNothing) distance_ = rate_per_s_ = 0.0;
  state_ = {.value = nearFloat(goal + distance_), .rate_per_s = nearFloat(rate_per_s_)};
  return state_.value;
}

}  // namespace rc10
