#include "app/tracking_differentiator.hpp"

#include <cmath>

#include "app/limits.hpp"

namespace rc10 {

float TrackingDifferentiator::step(float target, float dt_s) noexcept {
  if (!active()) {
    state_ = State{.value = target};
    return target;
  }
  const float r = bandwidth_rad_s_;
  // distance'' = -2 r distance' - r^2 distance  =>  distance(t) = (d0 + (v0 + r d0) t) exp(-r t)
  const float decay = std::exp(-r * dt_s);
  const float distance = saturate(state_.value - target);
  const float slope = saturate(state_.rate_per_s + r * distance);
  state_.value = saturate(target + (distance + slope * dt_s) * decay);
  state_.rate_per_s = saturate((state_.rate_per_s - r * slope * dt_s) * decay);
  return state_.value;
}

}  // namespace rc10
