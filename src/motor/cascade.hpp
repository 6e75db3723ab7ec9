#pragma once

#include <cstdint>
#include <variant>

#include "app/limits.hpp"
#include "app/pid_incremental.hpp"
#include "app/pid_position.hpp"
#include "app/target.hpp"

namespace rc10 {

/// The loops of a motor whose drive only obeys an effort: current in A, or voltage in V.
struct CascadeConfig {
  std::variant<PID_Incremental::Config, PID_Position::Config> velocity;  ///< rpm in, effort out.
  PID_Position::Config angle;                                            ///< deg in, rpm out.
  float velocity_limit_rpm = 0.0F;  ///< Bounds every velocity target, also the angle loop's output. 0: none.
};

[[nodiscard]] inline float velocityKp(const CascadeConfig& loops) noexcept {
  if (const auto* incremental = std::get_if<PID_Incremental::Config>(&loops.velocity)) return incremental->kp;
  const auto* position = std::get_if<PID_Position::Config>(&loops.velocity);
  return position != nullptr ? position->kp : 0.0F;
}

/// Angle -> velocity -> effort, shared by all motors whose loops run on the host.
/// Gains are per second and per unit, independent of the rate.
class Cascade {
 public:
  /// New sample, at the output shaft.
  struct Measured {
    float angle_deg = 0.0F;
    double total_angle_deg = 0.0;
    float velocity_rpm = 0.0F;
  };

  explicit Cascade(const CascadeConfig& config);

  /// One step on a new sample. `dt_s` is the samples' own spacing; `effort_limit` the limit in force,
  /// which the anti-windup respects; `effort_in_force` what the drive was told last, from which a
  /// change of mode starts without a bump; `effort_ff` is added after the loops, inside the limit.
  /// Modes: velocity, angle, total angle; any other one, or an input that is not finite, gives 0.
  // Not inlined, and flat: no floating-point register outlives a call, few are in use where it begins, and
  // both loops keep theirs.
  [[nodiscard, gnu::noinline, gnu::flatten]] float step(const Target& target, const Measured& measured,
                                                        float dt_s, float effort_limit, float effort_in_force,
                                                        float effort_ff = 0.0F) noexcept;

  /// Range of the velocity loop's targets from the next step on, in rpm. An effort that accelerates the shaft
  /// beyond it is halved in each step, whatever the integral: a load keeps the part that balances it.
  void boundSpeeds(const OutputRange& speeds_rpm) noexcept;

  /// Before a stop. What the loops have built up ends if it is at its limit, and drives a shaft with less
  /// than half of the speed that it was asked for: true, and the effort in force is to be 0. A smaller speed
  /// than `least_rpm` counts as none. Else the effort in force goes on, with what acted beside the loops.
  [[nodiscard]] bool dropWindup(float effort_in_force, float measured_rpm, float least_rpm) noexcept;

  /// Other gains from the next step on, without a bump. The type of the velocity loop stays: a config of
  /// another one is ignored.
  void retune(const CascadeConfig& config) noexcept;

  /// Forget everything: the next step starts anew.
  void reset() noexcept;

  /// Whether the last step ran into the velocity or effort limit.
  [[nodiscard]] bool velocityLimited() const noexcept { return velocity_limited_; }
  [[nodiscard]] bool effortLimited() const noexcept { return effort_limited_; }

  [[nodiscard]] const CascadeConfig& config() const noexcept { return config_; }

 private:
  [[nodiscard]] float velocityTarget(const Target& target, const Measured& measured, float dt_s) noexcept;

  CascadeConfig config_;
  OutputRange velocity_range_;  ///< Range of the velocity limit and of speeds_rpm_.
  OutputRange speeds_rpm_;
  std::variant<PID_Incremental, PID_Position> velocity_;
  PID_Position angle_;
  double last_total_angle_deg_ = 0.0;
  ControlMode active_mode_ = ControlMode::kCoast;
  bool velocity_limited_ = false;
  bool effort_limited_ = false;
};

}  // namespace rc10
