#pragma once

#include <limits>

#include "app/limits.hpp"
#include "app/low_pass.hpp"
#include "app/step_time.hpp"

namespace rc10 {

/// After start() the reference glides from the measured value to the target with this time constant:
/// the output begins where it was, and the full error acts a few samples later.
inline constexpr float kStartGlideSeconds = 0.01F;

/// PID in position form: proportional to the error, trapezoidal integral, derivative of the
/// measurement. Gains are per second, so they hold at any rate.
///
/// dt <= 0 or NaN: the last output, nothing advances. A target or measurement that is not finite:
/// output 0, everything forgotten. Any finite input gives a finite output.
class PID_Position {
 public:
  /// E: unit of the error, O: unit of the output.
  struct Config {
    float kp = 0.0F;                    ///< O / E
    float ki = 0.0F;                    ///< O / (E s)
    float kd = 0.0F;                    ///< O s / E
    float integral_limit = 0.0F;        ///< O; bound of the integral's share. 0: none of its own.
    float integral_separation = 0.0F;   ///< E; beyond it the integral stands still. 0 or infinite: never.
    float deadband = 0.0F;              ///< E; a smaller error counts as 0.
    float output_limit = 0.0F;          ///< O; 0: none but the limit in force.
    float circular_period = 0.0F;       ///< E; 0: linear. 360: the error is the shortest way round.
    float derivative_filter_hz = 0.0F;  ///< Low-pass on the derivative. 0: none.
  };

  struct State {
    float integral = 0.0F;       ///< O
    float error = 0.0F;          ///< E; of the last step, after deadband.
    float whole_error = 0.0F;    ///< E; the same before it.
    float measured = 0.0F;       ///< E; of the last step().
    float glide = 0.0F;          ///< E; what is left of the way from the measured value at start().
    float output_offset = 0.0F;  ///< O; of the output in force at start() or retune(), what the terms lack.
    float output = 0.0F;         ///< O; of the last step.
    bool fades = false;          ///< Something may be left of `glide` or `output_offset`.
    bool running = false;        ///< A step or start() came since reset().
  };

  PID_Position() = default;
  explicit PID_Position(const Config& config) noexcept
      : config_(config), derivative_(config.derivative_filter_hz) {}

  /// One step. `range` is the limit in force at this step, which the anti-windup respects as well.
  float step(float target, float measured, float dt_s, OutputRange range) noexcept;
  float step(float target, float measured, float dt_s,
             float output_limit_in_force = std::numeric_limits<float>::infinity()) noexcept {
    return step(target, measured, dt_s, OutputRange::symmetric(output_limit_in_force));
  }

  /// The same for a caller that knows the error and the change of the measurement since the last
  /// step better than two floats can tell: a multi-turn angle in double.
  float stepError(float error, float measured_change, float dt_s, OutputRange range) noexcept;

  /// Begins without a bump: the next steps continue from the output in force.
  void start(float output_in_force, float measured, float target) noexcept;
  /// An effort that has acted beside it becomes a part of its output; without ki, or beyond the limit of the
  /// integral, it fades over kStartGlideSeconds.
  void takeOver(float effort) noexcept;
  /// Other gains from the next step on, without a bump: the integral keeps its share of the output, and
  /// what the new gains make of the last error appears over kStartGlideSeconds. Limits act at once. With
  /// ki 0 the integral goes as well. The part that a limit had cut off is not carried over.
  void retune(const Config& config) noexcept;
  void reset() noexcept;

  [[nodiscard]] const Config& config() const noexcept { return config_; }
  [[nodiscard]] const State& state() const noexcept { return state_; }

 private:
  void fade(float dt_s) noexcept;
  /// stepError() on finite numbers and a dt above 0.
  float advance(float error, float measured_change, float dt_s, OutputRange range) noexcept;
  void integrate(float mean, float others, float dt, OutputRange range) noexcept;
  [[nodiscard]] float errorOf(float target, float measured) const noexcept;
  [[nodiscard]] float afterDeadband(float error) const noexcept;
  [[nodiscard]] float proportionalAndDerivative() const noexcept;

  Config config_;
  State state_;
  LowPass derivative_;
};

}  // namespace rc10
