#pragma once

namespace rc10 {

/// Scales a motion down while it takes more power than it may. Pure: the power comes in.
class PowerLimiter {
 public:
  /// Shares of the wanted motion, along it: 1 is all of it.
  struct Shares {
    double told = 0.0;  ///< As the motors are told now; how far it is ahead is what they push for.
    double measured = 0.0;
  };

  /// 0: no limit.
  explicit PowerLimiter(double limit_w) noexcept : limit_w_(limit_w) {}

  /// One step with the power that is taken now. Returns the factor for the motion, kLeast to 1.
  double step(double power_w, const Shares& shares, float dt_s) noexcept;
  [[nodiscard]] double factor() const noexcept { return factor_; }

  static constexpr double kLeast = 0.1;  ///< The robot must still get out of the way.

 private:
  double limit_w_;
  double factor_ = 1.0;
  double power_w_ = 0.0;         ///< Power of the last step.
  double growth_w_per_s_ = 0.0;  ///< Smoothed.
};

}  // namespace rc10
