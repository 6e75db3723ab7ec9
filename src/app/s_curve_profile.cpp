#include "app/s_curve_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/step_time.hpp"
#include "app/velocity_change.hpp"

namespace rc10 {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// From a state, with positions counted from the one at the beginning of the step: near a target far
/// from 0 no digits are lost.
class Motions {
 public:
  Motions(const ProfileState& state, const SCurveProfile::Limits& limits) noexcept
      : limits_(limits), here_{0.0, state.velocity, state.acceleration} {}

  [[nodiscard]] VelocityChange stop() const noexcept { return stopFrom(here_); }
  [[nodiscard]] VelocityChange go(double direction) const noexcept {
    return change(here_, direction * limits_.velocity);
  }
  [[nodiscard]] VelocityChange stopFrom(const ProfileState& state) const noexcept {
    return change(state, 0.0);
  }

 private:
  [[nodiscard]] VelocityChange change(const ProfileState& from, double velocity) const noexcept {
    return {from, velocity, limits_.acceleration, limits_.jerk};
  }

  const SCurveProfile::Limits& limits_;
  ProfileState here_;
};

/// When to stop going: the last instant in [0, dt] after which stopping does not end beyond the
/// distance. The room that is left falls all the time. Regula falsi with the Illinois rule, which never
/// leaves the bracket.
double switchTime(const Motions& motions, const VelocityChange& go, double direction, double distance,
                  double dt, double room_now, double room_after, double tolerance) noexcept {
  constexpr int kMostSteps = 60;
  double low = 0.0;
  double high = dt;
  double room_low = room_now;
  double room_high = room_after;
  int side = 0;
  for (int i = 0; i < kMostSteps && high - low > kEpsilon * dt; ++i) {
    // The secant; the middle at times, for a root where the room hardly changes.
    double t = i % 8 == 7 ? 0.5 * (low + high) : low + (high - low) * room_low / (room_low - room_high);
    t = std::clamp(t, low, high);
    const double room = direction * (distance - motions.stopFrom(go.at(t)).end().position);
    if (std::abs(room) <= tolerance) return t;
    if (room > 0.0) {
      low = t;
      room_low = room;
      if (side == 1) room_high *= 0.5;
      side = 1;
    } else {
      high = t;
      room_high = room;
      if (side == -1) room_low *= 0.5;
      side = -1;
    }
  }
  return low;
}

}  // namespace

void SCurveProfile::setLimits(const Limits& limits) noexcept {
  limits_ = {usableLimit(limits.velocity), usableLimit(limits.acceleration), usableLimit(limits.jerk)};
}

void SCurveProfile::start(const ProfileState& state) noexcept {
  if (!isFinite(state)) return;
  state_ = {withinMotion(state.position), withinMotion(state.velocity), withinMotion(state.acceleration)};
  target_ = state_.position;
  ahead_ = 0.0;
}

void SCurveProfile::aim(double target) noexcept {
  ahead_ += target_ - target;
  target_ = target;
}

double SCurveProfile::stopPosition() const noexcept {
  if (stuck()) return state_.position;
  return state_.position + Motions(state_, limits_).stop().end().position;
}

void SCurveProfile::moveBy(const ProfileState& step) noexcept {
  ahead_ += step.position;
  state_ = {withinMotion(target_ + ahead_), withinMotion(step.velocity), withinMotion(step.acceleration)};
  if (std::abs(state_.position) >= kHugeMotion) ahead_ = state_.position - target_;
}

const ProfileState& SCurveProfile::brake(float dt_s) noexcept {
  const double dt = stepSeconds(dt_s);
  if (dt == 0.0) return state_;
  if (stuck()) {
    moveBy({});
  } else {
    moveBy(Motions(state_, limits_).stop().at(dt));
  }
  return state_;
}

const ProfileState& SCurveProfile::step(double target, float dt_s) noexcept {
  if (!std::isfinite(target) || limits_.velocity == 0.0 || stuck()) return brake(dt_s);
  const double dt = stepSeconds(dt_s);
  if (dt == 0.0) return state_;
  target = withinMotion(target);

  const Motions motions(state_, limits_);
  aim(target);
  const double distance = -ahead_;
  const VelocityChange stop = motions.stop();
  const double room = distance - stop.end().position;
  // Tolerance around 0: the resolution of positions, and that of velocities over the longest stopping time.
  const double stop_s = limits_.velocity / limits_.acceleration + limits_.acceleration / limits_.jerk;
  const double tolerance = 16.0 * kEpsilon * (std::abs(distance) + std::abs(stop.end().position)) +
                           std::min(16.0 * kEpsilon * limits_.velocity * stop_s, 1e-9);
  const auto finish = [&](const VelocityChange& last, double t) noexcept -> const ProfileState& {
    if (t >= last.durationSeconds() && std::abs(distance - last.end().position) <= 4.0 * tolerance) {
      reset(target);
    } else {
      moveBy(last.at(t));
    }
    return state_;
  };
  if (std::abs(room) <= tolerance) return finish(stop, dt);

  const double direction = room > 0.0 ? 1.0 : -1.0;
  const VelocityChange go = motions.go(direction);
  const ProfileState ahead = go.at(dt);
  const double room_ahead = direction * (distance - motions.stopFrom(ahead).end().position);
  if (room_ahead >= 0.0) {
    moveBy(ahead);
    return state_;
  }
  const double t =
      switchTime(motions, go, direction, distance, dt, std::abs(room), room_ahead, 0.25 * tolerance);
  return finish(motions.stopFrom(go.at(t)), dt - t);
}

}  // namespace rc10
