#pragma once

namespace rc10 {

/// Follows a target as a critically damped second-order system: no overshoot, no step. One step is
/// the exact solution over dt, so that it is stable for any bandwidth and any dt (the users' library
/// integrates by Euler and diverges for bandwidth * dt > 2). Reckoned in double, from the target: it arrives
/// at any target, however far from 0.
class TrackingDifferentiator {
 public:
  struct State {
    float value = 0.0F;
    float rate_per_s = 0.0F;
  };

  /// `bandwidth_rad_s`: 98 % of a step after 5.8 / bandwidth seconds. 0: the target itself.
  explicit constexpr TrackingDifferentiator(float bandwidth_rad_s = 0.0F) noexcept
      : bandwidth_rad_s_(bandwidth_rad_s) {}

  /// One step of dt_s > 0 towards the target.
  float step(float target, float dt_s) noexcept;
  void reset(float value) noexcept;
  /// From the next step on; it goes on from where it is.
  void setBandwidth(float bandwidth_rad_s) noexcept { bandwidth_rad_s_ = bandwidth_rad_s; }

  [[nodiscard]] bool active() const noexcept { return bandwidth_rad_s_ > 0.0F; }
  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  float bandwidth_rad_s_;
  State state_;
  double target_ = 0.0;      ///< Target of the last step.
  double distance_ = 0.0;    ///< From it to the value.
  double rate_per_s_ = 0.0;  ///< The state's, with all its digits.
};

}  // namespace rc10
