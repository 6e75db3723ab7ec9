#pragma once

#include <cmath>

namespace rc10 {

/// Angle of an axis: the sensor's, and while that is silent the motor's plus their last difference, so that
/// it does not jump. Before the sensor is first heard: the motor's alone.
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
  double base_deg_ = 0.0;  ///< Their last difference: the angle of the chassis.
};

}  // namespace rc10
