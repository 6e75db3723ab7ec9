#include "app/slew_limiter.hpp"

#include <algorithm>
#include <cmath>

#include "app/step_time.hpp"

namespace rc10 {
namespace {

double usableRate(double rate) noexcept { return rate > 0.0 ? rate : 0.0; }

double towards(double value, double target, double most) noexcept {
  const double change = target - value;
  // Not value + change at the end: rounding would miss the target.
  return std::abs(change) <= most ? target : value + std::copysign(most, change);
}

}  // namespace

void SlewLimiter::setRates(const Rates& rates) noexcept {
  rates_ = {usableRate(rates.away_per_s), usableRate(rates.towards_per_s)};
}

void SlewLimiter::reset(double value) noexcept {
  if (std::isfinite(value)) value_ = value;
}

double SlewLimiter::step(double target, float dt_s) noexcept {
  double dt = stepSeconds(dt_s);
  if (dt == 0.0 || !std::isfinite(target)) return value_;
  // Back to 0, or to a target on this side of it that is nearer to 0 ...
  const double back = std::signbit(target) == std::signbit(value_)
                          ? std::copysign(std::min(std::abs(value_), std::abs(target)), value_)
                          : std::copysign(0.0, target);
  if (back != value_) {
    const double way = std::abs(back - value_);
    value_ = towards(value_, back, rates_.towards_per_s * dt);
    if (value_ != back) return value_;
    dt = std::max(0.0, dt - way / rates_.towards_per_s);
  }
  // ... and on with the time that is left.
  value_ = dt > 0.0 ? towards(value_, target, rates_.away_per_s * dt) : value_;
  return value_;
}

void TwistSlewLimiter::setRates(const Rates& rates) noexcept {
  rates_ = {usableRate(rates.linear_m_s2), usableRate(rates.angular_deg_s2)};
}

void TwistSlewLimiter::reset(const Twist2D& value) noexcept {
  if (isFinite(value)) value_ = value;
}

const Twist2D& TwistSlewLimiter::step(const Twist2D& target, float dt_s) noexcept {
  const double dt = stepSeconds(dt_s);
  if (dt == 0.0 || !isFinite(target)) return value_;
  const double dx = target.vx_m_s - value_.vx_m_s;
  const double dy = target.vy_m_s - value_.vy_m_s;
  const double change = std::hypot(dx, dy);
  const double most = rates_.linear_m_s2 * dt;
  if (change <= most) {
    value_.vx_m_s = target.vx_m_s;
    value_.vy_m_s = target.vy_m_s;
  } else if (std::isfinite(change)) {
    value_.vx_m_s += dx * (most / change);
    value_.vy_m_s += dy * (most / change);
  }
  value_.wz_deg_s = towards(value_.wz_deg_s, target.wz_deg_s, rates_.angular_deg_s2 * dt);
  return value_;
}

}  // namespace rc10
