#pragma once

namespace rc10 {

/// Effort that a planned motion needs: added to a controller's output, which then only corrects the error. O:
/// unit of the output, A or N m.
///
/// A setpoint that is not finite, or numbers so large that the sum is not: 0.
class Feedforward {
 public:
  struct Config {
    float per_rpm = 0.0F;       ///< O / rpm; viscous friction, and the counter-voltage where O is V.
    float per_rpm_s = 0.0F;     ///< O / (rpm / s); inertia.
    float friction = 0.0F;      ///< O; Coulomb friction, in the direction of the motion.
    float friction_rpm = 1.0F;  ///< The friction is 76 % there at this velocity: tanh(1). 0: all at once.
    float gravity = 0.0F;       ///< O; what holds the arm where gravity pulls most.
    float gravity_deg = 0.0F;   ///< The angle where gravity pulls most: the arm is level.
  };
  /// Where the motion should be, not where it is.
  struct Setpoint {
    double angle_deg = 0.0;
    float velocity_rpm = 0.0F;
    float acceleration_rpm_s = 0.0F;
  };

  Feedforward() = default;
  explicit Feedforward(const Config& config) noexcept : config_(config) {}

  [[nodiscard]] float output(const Setpoint& setpoint) const noexcept;

 private:
  Config config_;
};

}  // namespace rc10
