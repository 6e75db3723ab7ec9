#include "app/velocity_change.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {

VelocityChange::VelocityChange(const ProfileState& from, double to_velocity, double acceleration_limit,
                               double jerk_limit) noexcept
    : start_(from) {
  const double j = jerk_limit;
  double v = from.velocity;
  double a = from.acceleration;
  const double beyond = std::abs(a) - acceleration_limit;
  if (beyond > 0.0) {
    pieces_[0] = {.duration_s = beyond / j, .jerk = -std::copysign(j, a)};
    const ProfileState back = after(from, pieces_[0].jerk, pieces_[0].duration_s);
    v = back.velocity;
    a = std::copysign(acceleration_limit, a);
  }

  // The velocity that is reached if the acceleration is taken back to 0 at once says which way to go.
  const double settled = v + a * std::abs(a) / (2.0 * j);
  const double direction = to_velocity >= settled ? 1.0 : -1.0;
  const double rise = direction * (to_velocity - v);
  const double a0 = direction * a;
  // rise = (peak^2 - a0^2) / 2j + peak^2 / 2j, and what is missing at the limit is driven with it.
  const double free_peak = std::sqrt(std::max(0.0, j * rise + 0.5 * a0 * a0));
  const double peak = std::max(a0, std::min(free_peak, acceleration_limit));
  double hold_s = 0.0;
  if (free_peak > peak) {
    hold_s = std::max(0.0, (rise - (2.0 * peak * peak - a0 * a0) / (2.0 * j)) / peak);
  }
  pieces_[1] = {.duration_s = (peak - a0) / j, .jerk = direction * j};
  pieces_[2] = {.duration_s = hold_s, .jerk = 0.0};
  pieces_[3] = {.duration_s = std::max(0.0, peak) / j, .jerk = -direction * j};

  end_ = from;
  for (const Piece& piece : pieces_) {
    end_ = after(end_, piece.jerk, piece.duration_s);
    duration_s_ += piece.duration_s;
  }
  // Free of what rounding has left.
  end_.velocity = to_velocity;
  end_.acceleration = 0.0;
}

ProfileState VelocityChange::after(const ProfileState& from, double jerk, double t_s) noexcept {
  const double a = from.acceleration;
  return {.position = from.position + (from.velocity + (a / 2.0 + jerk * t_s / 6.0) * t_s) * t_s,
          .velocity = from.velocity + (a + jerk * t_s / 2.0) * t_s,
          .acceleration = a + jerk * t_s};
}

ProfileState VelocityChange::at(double t_s) const noexcept {
  if (t_s >= duration_s_) return after(end_, 0.0, t_s - duration_s_);
  ProfileState state = start_;
  for (const Piece& piece : pieces_) {
    const double t = std::min(t_s, piece.duration_s);
    state = after(state, piece.jerk, t);
    t_s -= t;
    if (t_s <= 0.0) break;
  }
  return state;
}

}  // namespace rc10
