#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "app/units.hpp"
#include "app/vocabulary.hpp"

namespace rc10 {
inline namespace robot_client {

using Mode = ControlMode;

/// Addition to a loop's output. 0: none.
struct FeedForward {
  Rpm velocity{};          ///< Velocity of the trajectory, added to the angle loop's output.
  double torque_nm = 0.0;  ///< At the output shaft, added after the loops.
};

/// One order to one motor, at the output shaft, counter-clockwise positive.
struct Setpoint {
  Mode mode = Mode::kCoast;
  double value = 0.0;  ///< In the unit of the mode.
  FeedForward forward;
  double stiffness_nm_per_rad = std::numeric_limits<double>::quiet_NaN();
  double damping_nms_per_rad = std::numeric_limits<double>::quiet_NaN();

  /// No torque.
  [[nodiscard]] static Setpoint coast() { return {}; }
  /// Resist motion.
  [[nodiscard]] static Setpoint brake() { return make(Mode::kBrake, 0.0); }
  [[nodiscard]] static Setpoint current(Amperes current) { return make(Mode::kCurrent, current.value); }
  [[nodiscard]] static Setpoint velocity(Rpm velocity, FeedForward forward = {}) {
    return make(Mode::kVelocity, velocity.value, forward);
  }
  /// The shortest way round: 370 degrees are 10.
  [[nodiscard]] static Setpoint angle(Degrees angle, FeedForward forward = {}) {
    return make(Mode::kAngle, angle.value, forward);
  }
  /// Multi-turn: 720 degrees are two turns from 0.
  [[nodiscard]] static Setpoint totalAngle(Degrees angle, FeedForward forward = {}) {
    return make(Mode::kTotalAngle, angle.value, forward);
  }
  /// Holds an angle like a spring and a damper would.
  [[nodiscard]] static Setpoint impedance(Degrees angle, double stiffness_nm_per_rad,
                                          double damping_nms_per_rad, FeedForward forward = {}) {
    auto setpoint = make(Mode::kImpedance, angle.value, forward);
    setpoint.stiffness_nm_per_rad = stiffness_nm_per_rad;
    setpoint.damping_nms_per_rad = damping_nms_per_rad;
    return setpoint;
  }
  [[nodiscard]] static Setpoint voltage(Volts voltage) { return make(Mode::kVoltage, voltage.value); }
  /// -1 to 1.
  [[nodiscard]] static Setpoint duty(double duty) { return make(Mode::kDuty, duty); }

  /// Reason why no motor can be given this: a number that is not finite, or outside the range of its mode.
  [[nodiscard]] Result<void> check() const;

 private:
  static Setpoint make(Mode mode, double value, FeedForward forward = {}) {
    Setpoint setpoint;
    setpoint.mode = mode;
    setpoint.value = value;
    setpoint.forward = forward;
    return setpoint;
  }
};

struct MotorSetpoint {
  std::string motor;
  Setpoint setpoint;
};

/// Setpoints of one message: they act in the same tick, or none does.
using MotorSetpoints = std::vector<MotorSetpoint>;

}  // namespace robot_client
}  // namespace rc10
