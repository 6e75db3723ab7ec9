#pragma once

#include <cmath>

namespace rc10 {

/// Angle of an axis by a sensor on it; while that is silent, by the motor, from the sensor's last word on:
/// what is to be looked at has the same angle before and after. A sensor that was never heard: the motor's.
class SensedAngle {
 public:
  /// `sensor_deg`: NaN while it is silent.
  [[nodiscard]] double step(double sensor_deg, double motor_deg) noexcept {
    if (!std::isfinite(sensor_deg)) return motor_deg + base_deg_;
    if (std::isfinite(motor_deg)) base_deg_ = sensor_deg - motor_deg;
    return sensor_deg;
  }
  /// By the motor alone, until the sensor says otherwise.
  void forget() noexcept { base_deg_ = 0.0; }

 private:
  double base_deg_ = 0.0;  ///< Angle of the chassis, by both.
};

}  // namespace rc10
