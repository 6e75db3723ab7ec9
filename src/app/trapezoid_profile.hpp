#pragma once

#include "app/profile_state.hpp"

namespace rc10 {

/// Leads a reference to a target with limited velocity and acceleration, as fast as these allow: at
/// each step it plans anew from where it is, so the target may change at any time, and each step is the
/// exact solution over its dt, so the steps may have any length.
///
/// Reckoned from the target, so that no digits are lost far from 0: a move always ends.
///
/// The target is hit exactly. It is not overshot, unless stopping at once would already pass it: then the
/// reference brakes, having gone past it, and comes back. So from rest it never leaves the range between its
/// start and its targets, as long as limits are not lowered in mid-motion.
///
/// dt of 0, below, or NaN: nothing moves; above kMaxStepSeconds: as that. A target that is not finite:
/// as brake(). A velocity limit that is not above 0: as brake(). An acceleration limit that is not
/// above 0: the reference stands still at once.
class TrapezoidProfile {
 public:
  struct Limits {
    double velocity = 0.0;      ///< P / s
    double acceleration = 0.0;  ///< P / s^2
  };

  TrapezoidProfile() = default;
  explicit TrapezoidProfile(const Limits& limits) noexcept { setLimits(limits); }

  /// One step towards rest at the target.
  const ProfileState& step(double target, float dt_s) noexcept;
  /// One step towards rest, wherever that is.
  const ProfileState& brake(float dt_s) noexcept;

  /// From now on. A velocity that is above a lowered limit returns to it within the acceleration.
  void setLimits(const Limits& limits) noexcept;
  /// Goes on from this state (its acceleration means nothing here). One that is not finite is refused.
  void start(const ProfileState& state) noexcept;
  /// Rest at this position.
  void reset(double position) noexcept { start({.position = position}); }

  [[nodiscard]] const ProfileState& state() const noexcept { return state_; }
  /// Where brake() would come to rest.
  [[nodiscard]] double stopPosition() const noexcept { return state_.position + stopDistance(); }
  [[nodiscard]] bool restsAt(double target) const noexcept {
    return state_ == ProfileState{.position = target};
  }

 private:
  [[nodiscard]] double stopDistance() const noexcept;
  void moveBy(double way, double velocity, double acceleration) noexcept;

  Limits limits_;
  ProfileState state_;
  double target_ = 0.0;  ///< Target of the last step().
  double ahead_ = 0.0;   ///< From it to the position: what the position of state_ has no digits for.
};

}  // namespace rc10
