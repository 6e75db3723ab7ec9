#include "app/trapezoid_profile.hpp"

#include <algorithm>
#include <cmath>

#include "app/step_time.hpp"

namespace rc10 {

double TrapezoidProfile::stopDistance() const noexcept {
  if (!(limits_.acceleration > 0.0)) return 0.0;
  return state_.velocity * std::abs(state_.velocity) / (2.0 * limits_.acceleration);
}

void TrapezoidProfile::setLimits(const Limits& limits) noexcept {
  limits_ = {usableLimit(limits.velocity), usableLimit(limits.acceleration)};
}

void TrapezoidProfile::start(const ProfileState& state) noexcept {
  if (!isFinite(state)) return;
  state_ = {.position = withinMotion(state.position), .velocity = withinMotion(state.velocity)};
  target_ = state_.position;
  ahead_ = 0.0;
}

void TrapezoidProfile::moveBy(double way, double velocity, double acceleration) noexcept {
  ahead_ += way;
  state_ = {.position = withinMotion(target_ + ahead_), .velocity = velocity, .acceleration = acceleration};
  if (std::abs(state_.position) >= kHugeMotion) ahead_ = state_.position - target_;
}

const ProfileState& TrapezoidProfile::brake(float dt_s) noexcept {
  const double dt = stepSeconds(dt_s);
  const double a = limits_.acceleration;
  if (dt == 0.0) return state_;
  const double v = state_.velocity;
  if (std::abs(v) <= a * dt || a == 0.0) {
    moveBy(stopDistance(), 0.0, 0.0);
    return state_;
  }
  const double braking = -std::copysign(a, v);
  moveBy((v + 0.5 * braking * dt) * dt, v + braking * dt, braking);
  return state_;
}

const ProfileState& TrapezoidProfile::step(double target, float dt_s) noexcept {
  if (!std::isfinite(target) || limits_.velocity == 0.0 || limits_.acceleration == 0.0) return brake(dt_s);
  double left = stepSeconds(dt_s);
  if (left == 0.0) return state_;
  target = withinMotion(target);
  ahead_ += target_ - target;
  target_ = target;

  // As if the target lay in the positive direction of where braking would end.
  const double direction = ahead_ + stopDistance() <= 0.0 ? 1.0 : -1.0;
  const double a = limits_.acceleration;
  const double distance = -direction * ahead_;
  const double v0 = direction * state_.velocity;
  // Accelerate to a peak and brake from it: distance = (peak^2 - v0^2) / 2a + peak^2 / 2a.
  const double square = std::max(0.0, a * distance + 0.5 * v0 * v0);
  const double peak = std::min(std::sqrt(square), limits_.velocity);
  // v0 is above the peak only where the velocity limit was lowered.
  const double to_peak = v0 <= peak ? a : -a;
  const double to_peak_s = (peak - v0) / to_peak;
  const double cruise = distance - (peak * peak - v0 * v0) / (2.0 * to_peak) - peak * peak / (2.0 * a);
  const double cruise_s = peak > 0.0 ? std::max(0.0, cruise) / peak : 0.0;
  const double brake_s = peak / a;

  if (to_peak_s + cruise_s + brake_s <= left) {
    reset(target);
    return state_;
  }

  double moved = 0.0;
  double v = v0;
  double now = 0.0;
  const auto drive = [&](double acceleration, double duration_s) noexcept {
    const double t = std::min(left, duration_s);
    if (t <= 0.0) return;
    moved += (v + 0.5 * acceleration * t) * t;
    v += acceleration * t;
    now = acceleration;
    left -= t;
  };
  drive(to_peak, to_peak_s);
  drive(0.0, cruise_s);
  drive(-a, brake_s);
  moveBy(direction * moved, direction * v, direction * now);
  return state_;
}

}  // namespace rc10
