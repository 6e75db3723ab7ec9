#include "app/pid_position.hpp"

#include <algorithm>
#include <cmath>

#include "app/angle.hpp"

namespace rc10 {
namespace {

// In any of the units: far below the resolution of a drive, and reached a quarter of a second after a start.
constexpr float kFaded = 1e-6F;

[[nodiscard]] float faded(float value, float fade) noexcept {
  const float left = value * fade;
  return std::fabs(left) < kFaded ? 0.0F : left;
}

[[nodiscard]] bool bothFinite(float a, float b) noexcept {
  if (std::isfinite(a - b)) return true;  // one comparison, for nearly all
  return std::isfinite(a) && std::isfinite(b);
}

}  // namespace

inline float PID_Position::errorOf(float target, float measured) const noexcept {
  if (config_.circular_period > 0.0F) {
    return saturate(shortestWay(measured, target, config_.circular_period));
  }
  return saturate(target - measured);
}

inline float PID_Position::afterDeadband(float error) const noexcept {
  return std::abs(error) < config_.deadband ? 0.0F : error;
}

inline float PID_Position::proportionalAndDerivative() const noexcept {
  return saturate(config_.kp * state_.error - config_.kd * derivative_.value());
}

float PID_Position::step(float target, float measured, float dt_s, OutputRange range) noexcept {
  if (!bothFinite(target, measured)) {
    reset();
    return 0.0F;
  }
  if (!(dt_s > 0.0F)) return state_.output;
  const float change = errorOf(measured, state_.measured);  // circular as well: no jump at the wrap
  state_.measured = measured;
  return advance(errorOf(target, measured), change, dt_s, range);
}

float PID_Position::stepError(float error, float measured_change, float dt_s, OutputRange range) noexcept {
  if (!bothFinite(error, measured_change)) {
    reset();
    return 0.0F;
  }
  if (!(dt_s > 0.0F)) return state_.output;
  return advance(error, measured_change, dt_s, range);
}

// Over a while after a start.
void PID_Position::fade(float dt_s) noexcept {
  const float left = kStartGlideSeconds / (kStartGlideSeconds + dt_s);
  state_.glide = faded(state_.glide, left);
  state_.output_offset = faded(state_.output_offset, left);
  state_.fades = state_.glide != 0.0F || state_.output_offset != 0.0F;
}

[[gnu::always_inline]] inline void PID_Position::integrate(float mean, float others, float dt,
                                                           OutputRange range) noexcept {
  const bool separated =
      config_.integral_separation > 0.0F && std::abs(state_.error) > config_.integral_separation;
  float gain = separated ? 0.0F : saturate(config_.ki * mean * dt);
  // Anti-windup: what would push beyond the limit is not accumulated, and after the limit has come
  // down the integral alone never holds the output beyond it.
  const float sum = others + state_.integral;
  if (gain > 0.0F) gain = std::clamp(range.high - sum, 0.0F, gain);
  if (gain < 0.0F) gain = std::clamp(range.low - sum, gain, 0.0F);
  state_.integral += gain;
  const OutputRange hold{std::min(range.low, 0.0F), std::max(range.high, 0.0F)};
  state_.integral = hold.within(config_.integral_limit).clamp(saturate(state_.integral));
}

// Inlined, or every number of its callers would be put away for the call.
[[gnu::always_inline]] inline float PID_Position::advance(float error, float measured_change, float dt_s,
                                                          OutputRange range) noexcept {
  const float dt = std::min(dt_s, kMaxStepSeconds);

  if (state_.fades) fade(dt);
  state_.whole_error = error + state_.glide;
  const float e = afterDeadband(state_.whole_error);
  if (!state_.running) {
    state_.error = e;
    measured_change = 0.0F;
  }
  range = range.within(config_.output_limit);

  derivative_.step(measured_change / dt, dt);
  const float mean = 0.5F * (e + state_.error);
  state_.error = e;
  const float others = proportionalAndDerivative() + state_.output_offset;

  // Without an integral gain, as angle loops mostly are, there is nothing to accumulate.
  if (config_.ki != 0.0F || state_.integral != 0.0F) integrate(mean, others, dt, range);
  state_.output = range.clamp(others + state_.integral);
  state_.running = true;
  return state_.output;
}

void PID_Position::takeOver(float effort) noexcept {
  const float carried = finiteOr0(effort);
  const float before = state_.integral;
  if (config_.ki > 0.0F)
    state_.integral = OutputRange{}.within(config_.integral_limit).clamp(saturate(before + carried));
  state_.output_offset = saturate(state_.output_offset + carried - (state_.integral - before));
  state_.output = saturate(state_.output + carried);
  state_.fades = true;
}

void PID_Position::start(float output_in_force, float measured, float target) noexcept {
  reset();
  if (!std::isfinite(output_in_force) || !std::isfinite(measured) || !std::isfinite(target)) return;
  const OutputRange carried = OutputRange{}.within(config_.integral_limit);
  state_.integral = config_.ki > 0.0F ? carried.clamp(output_in_force) : 0.0F;
  state_.output_offset = saturate(output_in_force - state_.integral);
  state_.glide = -errorOf(target, measured);
  state_.measured = measured;
  state_.output = output_in_force;
  state_.fades = state_.running = true;
}

void PID_Position::retune(const Config& config) noexcept {
  const float asked = proportionalAndDerivative() + state_.output_offset + state_.integral;
  config_ = config;
  derivative_.setBandwidth(config.derivative_filter_hz);
  if (!state_.running) return;
  const OutputRange carried = OutputRange{}.within(config.integral_limit);
  state_.integral = config.ki > 0.0F ? carried.clamp(state_.integral) : 0.0F;
  state_.error = afterDeadband(state_.whole_error);
  // The limited output is carried over, not the output asked for: that would go on pushing after the error
  // has changed its sign.
  const float gap = saturate(state_.output - (proportionalAndDerivative() + state_.integral));
  if (asked > state_.output) {
    state_.output_offset = std::max(gap, 0.0F);
  } else if (asked < state_.output) {
    state_.output_offset = std::min(gap, 0.0F);
  } else {
    state_.output_offset = gap;
  }
  state_.fades = true;
}

void PID_Position::reset() noexcept {
  state_ = State{};
  derivative_.reset(0.0F);
}

}  // namespace rc10
