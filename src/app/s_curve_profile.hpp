#pragma once

#include "app/profile_state.hpp"

namespace rc10 {

/// Leads a reference to a target with limited velocity, acceleration and jerk, as fast as these allow.
///
/// At each step it knows two motions from where it is: the one that stops, and the one to full speed
/// towards the target. It goes, unless it would then no longer stop at the target: then it goes until
/// the instant inside the step from which stopping ends exactly there, and stops. Both are the fastest
/// of their kind (VelocityChange), so that going and then stopping is the fastest way to rest at the
/// target from any state; it need not be planned, and the target may change at any time.
///
/// Reckoned from the target, so that no digits are lost far from 0: a move always ends.
///
/// The target is hit exactly. It is not overshot, unless stopping at once would already pass it: then the
/// reference stops, having gone past it, and comes back. So from rest it never leaves the range between its
/// start and its targets, as long as limits are not lowered in mid-motion.
///
/// dt of 0, below, or NaN: nothing moves; above kMaxStepSeconds: as that. A target that is not finite:
/// as brake(). A velocity limit that is not above 0: as brake(). An acceleration or jerk limit that is
/// not above 0: the reference stands still at once.
class SCurveProfile {
 public:
  struct Limits {
    double velocity = 0.0;      ///< P / s
    double acceleration = 0.0;  ///< P / s^2
    double jerk = 0.0;          ///< P / s^3
  };

  SCurveProfile() = default;
  explicit SCurveProfile(const Limits& limits) noexcept { setLimits(limits); }

  /// One step towards rest at the target.
  const ProfileState& step(double target, float dt_s) noexcept;
  /// One step towards rest, wherever that is.
  const ProfileState& brake(float dt_s) noexcept;

  /// From now on. Velocity and acceleration above lowered limits return to them as fast as the others
  /// allow.
  void setLimits(const Limits& limits) noexcept;
  /// Goes on from this state. One that is not finite is refused.
  void start(const ProfileState& state) noexcept;
  /// Rest at this position.
  void reset(double position) noexcept { start({.position = position}); }

  [[nodiscard]] const ProfileState& state() const noexcept { return state_; }
  /// Where brake() would come to rest.
  [[nodiscard]] double stopPosition() const noexcept;
  [[nodiscard]] bool restsAt(double target) const noexcept {
    return state_ == ProfileState{.position = target};
  }

 private:
  [[nodiscard]] bool stuck() const noexcept { return limits_.acceleration == 0.0 || limits_.jerk == 0.0; }
  void moveBy(const ProfileState& step) noexcept;
  void aim(double target) noexcept;

  Limits limits_;
  ProfileState state_;
  double target_ = 0.0;  ///< Target of the last step().
  double ahead_ = 0.0;   ///< From it to the position: what the position of state_ has no digits for.
};

}  // namespace rc10
