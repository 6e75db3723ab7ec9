#pragma once

namespace rc10 {

/// Scales a motion down while it takes more power than it may. Pure: the power comes in.
class PowerLimiter {
 public:
  /// 0: no limit.
  explicit PowerLimiter(double limit_w) noexcept : limit_w_(limit_w) {}

  /// One step with the power that is taken now. Returns the factor for the motion, kLeast to 1.
  double step(double power_w, float dt_s) noexcept;
  [[nodiscard]] double factor() const noexcept { return factor_; }

  static constexpr double kLeast = 0.1;  ///< The robot must still get out of the way.

 private:
  double limit_w_;
  double factor_ = 1.0;
};

}  // namespace rc10
