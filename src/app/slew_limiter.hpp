#pragma once

#include "app/planar_motion.hpp"

namespace rc10 {

/// A value that follows its target no faster than its rates: one for growing away from 0, one for
/// going back towards 0 (a drive usually may brake harder than it accelerates).
///
/// A rate that is not above 0 allows no change, infinity any. dt of 0, below, or NaN, and a target that
/// is not finite: the value stays. dt above kMaxStepSeconds: as that.
class SlewLimiter {
 public:
  struct Rates {
    double away_per_s = 0.0;     ///< While the value grows away from 0.
    double towards_per_s = 0.0;  ///< While it comes back towards 0.
  };

  SlewLimiter() = default;
  explicit SlewLimiter(const Rates& rates) noexcept { setRates(rates); }
  explicit SlewLimiter(double rate_per_s) noexcept : SlewLimiter(Rates{rate_per_s, rate_per_s}) {}

  double step(double target, float dt_s) noexcept;

  void setRates(const Rates& rates) noexcept;
  /// A value that is not finite is refused.
  void reset(double value) noexcept;
  [[nodiscard]] double value() const noexcept { return value_; }

 private:
  Rates rates_;
  double value_ = 0.0;
};

/// A twist that follows its target with limited acceleration. The velocity is limited as a vector: it
/// changes straight towards the target, so that the path of a robot is not bent by one axis that is
/// quicker than the other.
///
/// Edges as in SlewLimiter.
class TwistSlewLimiter {
 public:
  struct Rates {
    double linear_m_s2 = 0.0;
    double angular_deg_s2 = 0.0;
  };

  TwistSlewLimiter() = default;
  explicit TwistSlewLimiter(const Rates& rates) noexcept { setRates(rates); }

  const Twist2D& step(const Twist2D& target, float dt_s) noexcept;

  void setRates(const Rates& rates) noexcept;
  /// A twist that is not finite is refused.
  void reset(const Twist2D& value) noexcept;
  [[nodiscard]] const Twist2D& value() const noexcept { return value_; }

 private:
  Rates rates_;
  Twist2D value_;
};

}  // namespace rc10
