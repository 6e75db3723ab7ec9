#pragma once

#include <cmath>
#include <limits>

#include "app/motion_match.hpp"
#include "app/units.hpp"

namespace rc10 {

/// Rate of the base of an axis: what a gyro on the axis says, less the motor's speed at the same
/// instant. A late gyro against the speed of now would be positive feedback: a limit cycle from about 8 ms.
/// Until the lag is known a low-pass keeps it stable; a first motion of some degrees shows the lag.
class CarriedRate {
 public:
  void step(double motor_rpm, double rate_deg_s, float dt_s) noexcept {
    match_.step(motor_rpm * kDegPerSPerRpm, rate_deg_s, dt_s);
    const double now_deg_s = rate_deg_s - match_.motorThen();
    if (!std::isfinite(rate_deg_s) || !std::isfinite(motor_rpm) || opposed()) {
      carried_deg_s_ = std::numeric_limits<double>::quiet_NaN();
    } else if (match_.lagSeconds() || !std::isfinite(carried_deg_s_)) {
      if (match_.fresh()) carried_deg_s_ = now_deg_s;
    } else {
      const auto dt = static_cast<double>(dt_s);
      carried_deg_s_ += (now_deg_s - carried_deg_s_) * dt / (kSettlingSeconds + dt);
    }
  }
  /// NaN while it is not known.
  [[nodiscard]] double degPerSecond() const noexcept { return carried_deg_s_; }
  [[nodiscard]] bool opposed() const noexcept { return match_.sign() == MotionMatch::Sign::kOpposed; }
  [[nodiscard]] const MotionMatch& match() const noexcept { return match_; }
  void forget() noexcept { match_.reset(); }

 private:
  // With it the loop is stable up to 30 ms of lag.
  static constexpr double kSettlingSeconds = 0.040;

  MotionMatch match_{{.enough = 1.0}};  // 10 deg/s, for 10 ms
  double carried_deg_s_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace rc10
