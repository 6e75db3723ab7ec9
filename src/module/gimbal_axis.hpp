#pragma once

#include <cmath>

#include "app/angle.hpp"
#include "app/units.hpp"

namespace rc10 {

/// One axis that is to look at an angle of the world: computes the velocity of its motor, less the turning of
/// its base.
class GimbalAxis {
 public:
  struct Config {
    double gain_per_s = 10.0;  ///< deg/s for each degree that is missing.
    double velocity_limit_rpm = 0.0;
    bool circular = true;  ///< The shortest way round.
  };
  struct Measured {
    double angle_deg = 0.0;      ///< Angle of the world, or of the chassis.
    double carried_deg_s = 0.0;  ///< NaN: not known, nothing is taken off.
  };

  explicit GimbalAxis(const Config& config) noexcept : config_(config) {}

  /// Looks where it looks now.
  void hold(double angle_deg) noexcept { target_deg_ = angle_deg; }
  void aim(double angle_deg) noexcept { target_deg_ = angle_deg; }
  /// No faster than the axis can follow: a count that runs away never comes back.
  void turn(double rate_deg_s, float dt_s) noexcept {
    const double most_deg_s = config_.velocity_limit_rpm * kDegPerSPerRpm;
    target_deg_ += std::fmax(-most_deg_s, std::fmin(most_deg_s, rate_deg_s)) * static_cast<double>(dt_s);
    if (config_.circular) target_deg_ = wrapHalfTurn(target_deg_);
  }
  [[nodiscard]] double target() const noexcept { return target_deg_; }

  /// `rate_deg_s`: how fast the target itself moves.
  [[nodiscard]] double velocityRpm(const Measured& measured, double rate_deg_s) const noexcept {
    double missing_deg = target_deg_ - measured.angle_deg;
    if (config_.circular) missing_deg = wrapHalfTurn(missing_deg);
    const double wanted_deg_s = rate_deg_s + config_.gain_per_s * missing_deg;
    const double carried_deg_s = std::isfinite(measured.carried_deg_s) ? measured.carried_deg_s : 0.0;
    const double rpm = (wanted_deg_s - carried_deg_s) / kDegPerSPerRpm;
    if (!std::isfinite(rpm)) return 0.0;
    return std::fmax(-config_.velocity_limit_rpm, std::fmin(config_.velocity_limit_rpm, rpm));
  }

 private:
  Config config_;
  double target_deg_ = 0.0;
};

}  // namespace rc10
