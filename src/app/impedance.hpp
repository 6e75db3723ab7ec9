#pragma once

#include "app/limits.hpp"

namespace rc10 {

/// A virtual spring and damper between target and motor: torque = stiffness * angle error + damping *
/// velocity error + feedforward. The load may push the motor away from the target.
///
/// Stiffness and damping that are not above 0 are 0: a negative one would drive the motor away. Input
/// that is not finite: torque 0.
class Impedance {
 public:
  struct Config {
    float stiffness_nm_per_rad = 0.0F;
    float damping_nms_per_rad = 0.0F;
    float torque_limit_nm = 0.0F;  ///< 0: none but the limit in force.
    bool circular = false;         ///< The angle is within a turn: the spring pulls the shortest way.
  };
  struct Target {
    double angle_deg = 0.0;
    float velocity_rpm = 0.0F;
    float torque_nm = 0.0F;  ///< Feedforward.
  };
  struct Measured {
    double angle_deg = 0.0;
    float velocity_rpm = 0.0F;
  };

  Impedance() = default;
  explicit Impedance(const Config& config) noexcept : config_(config) {}

  /// N m. `range` is the limit in force.
  [[nodiscard]] float torque(const Target& target, const Measured& measured,
                             OutputRange range = {}) const noexcept;

 private:
  Config config_;
};

}  // namespace rc10
