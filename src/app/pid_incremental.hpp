#pragma once

#include <limits>

#include "app/limits.hpp"
#include "app/low_pass.hpp"
#include "app/pid_position.hpp"
#include "app/tracking_differentiator.hpp"

namespace rc10 {

/// PID in velocity form: each step adds to the output what the change of the error, the error and
/// the change of the measurement's rate ask for. The memory is the output itself, so that clamping
/// it to the limit in force is the anti-windup. It may go past the limit by as much as the measurement's
/// noise moves it: cut off there, noise would only ever take effort away. Gains are per second, so they hold
/// at any rate.
///
/// A step of the target that drives the output into its limit loses the clamped part of the
/// proportional share: the approach is slow and without overshoot. With `tracking_rad_s` the target
/// arrives smoothly instead.
///
/// dt and inputs that are not finite: as in PID_Position.
class PID_Incremental {
 public:
  /// E: unit of the error, O: unit of the output.
  struct Config {
    float kp = 0.0F;                    ///< O / E
    float ki = 0.0F;                    ///< O / (E s)
    float kd = 0.0F;                    ///< O s / E
    float deadband = 0.0F;              ///< E; a smaller error counts as 0.
    float tracking_rad_s = 0.0F;        ///< Bandwidth of a tracking differentiator on the target. 0: none.
    float output_limit = 0.0F;          ///< O; 0: none but the limit in force.
    float derivative_filter_hz = 0.0F;  ///< Low-pass on the measurement's rate. 0: none.
  };

  struct State {
    float output = 0.0F;       ///< O; of the last step, clamped.
    float error = 0.0F;        ///< E; of the last step, after deadband.
    float whole_error = 0.0F;  ///< E; the same before it.
    float target = 0.0F;       ///< E; of the last step.
    float measured = 0.0F;     ///< E
    float glide = 0.0F;        ///< E; what is left of a way that begins at start() or retune().
    float beyond = 0.0F;       ///< O; what the memory has past the limit.
    float noise = 0.0F;        ///< O; how far the measurement's noise moves the output.
    float push = 0.0F;         ///< O; what the measurement alone added in the last step.
    bool running = false;      ///< A step or start() came since reset().
  };

  PID_Incremental() = default;
  explicit PID_Incremental(const Config& config) noexcept
      : config_(config), tracker_(config.tracking_rad_s), rate_(config.derivative_filter_hz) {}

  /// One step. `range` is the limit in force at this step.
  float step(float target, float measured, float dt_s, OutputRange range) noexcept;
  float step(float target, float measured, float dt_s,
             float output_limit_in_force = std::numeric_limits<float>::infinity()) noexcept {
    return step(target, measured, dt_s, OutputRange::symmetric(output_limit_in_force));
  }

  /// Begins without a bump: the next steps continue from the output in force. A first step() without
  /// start() begins at output 0.
  void start(float output_in_force, float measured, float target) noexcept;
  /// An effort that has acted beside it becomes a part of its output.
  void takeOver(float effort) noexcept { state_.output = saturate(state_.output + finiteOr0(effort)); }
  /// Other gains from the next step on, without a bump: the output is the memory, and goes on from where it
  /// is. Limits act at once.
  void retune(const Config& config) noexcept;
  void reset() noexcept;

  [[nodiscard]] const Config& config() const noexcept { return config_; }
  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  [[nodiscard]] float afterDeadband(float error) const noexcept;
  void watchNoise(float push, float dt_s) noexcept;

  Config config_;
  State state_;
  TrackingDifferentiator tracker_;
  LowPass rate_;
};

}  // namespace rc10
