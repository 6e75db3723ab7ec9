#include "app/pid_incremental.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

// Long against the sample period, short against a change of load.
constexpr float kNoiseSeconds = 0.2F;
// Share of the range of outputs: a measurement that leaps is no noise.
constexpr float kMostNoise = 0.1F;

}  // namespace

float PID_Incremental::afterDeadband(float error) const noexcept {
  return std::abs(error) < config_.deadband ? 0.0F : error;
}

float PID_Incremental::step(float target, float measured, float dt_s, OutputRange range) noexcept {
  if (!std::isfinite(target) || !std::isfinite(measured)) {
    reset();
    return 0.0F;
  }
  if (!(dt_s > 0.0F)) return state_.output;
  if (!state_.running) start(0.0F, measured, target);
  const float dt = std::min(dt_s, kMaxStepSeconds);

  const float previous_rate = rate_.value();
  const float moved = saturate(measured - state_.measured);
  const float rate = rate_.step(saturate(moved / dt), dt);
  const float damping = saturate(config_.kd * saturate(rate - previous_rate));
  watchNoise(saturate(config_.kp * moved) + damping, dt);
  state_.measured = measured;

  state_.glide *= kStartGlideSeconds / (kStartGlideSeconds + dt);
  state_.target = target;
  state_.whole_error = saturate(saturate(tracker_.step(target, dt) - measured) + state_.glide);
  const float e = afterDeadband(state_.whole_error);

  const float increment =
      saturate(config_.kp * saturate(e - state_.error)) + saturate(config_.ki * e * dt) - damping;
  state_.error = e;
  const OutputRange allowed = range.within(config_.output_limit);
  const float slack = std::min(state_.noise, kMostNoise * saturate(allowed.high - allowed.low));
  const float memory = std::clamp(saturate(state_.output + state_.beyond + increment), allowed.low - slack,
                                  allowed.high + slack);
  state_.output = allowed.clamp(memory);
  state_.beyond = saturate(memory - state_.output);
  return state_.output;
}

// Steady acceleration pushes alike in each step; what changes from one to the next is noise, and its highest
// peak of late is above the noise's whole width.
void PID_Incremental::watchNoise(float push, float dt_s) noexcept {
  state_.noise *= kNoiseSeconds / (kNoiseSeconds + dt_s);
  state_.noise = std::max(state_.noise, saturate(std::abs(push - state_.push)));
  state_.push = push;
}

void PID_Incremental::start(float output_in_force, float measured, float target) noexcept {
  reset();
  if (!std::isfinite(output_in_force) || !std::isfinite(measured) || !std::isfinite(target)) return;
  state_.output = output_in_force;
  state_.measured = measured;
  // The differentiator itself brings the target from the measured value; without one the glide does.
  tracker_.reset(measured);
  state_.glide = tracker_.active() ? 0.0F : saturate(measured - target);
  state_.running = true;
}

void PID_Incremental::retune(const Config& config) noexcept {
  // The differentiator stands at the target while it is off; switched off on its way, the glide goes the
  // rest.
  const bool stops_tracking = tracker_.active() && !(config.tracking_rad_s > 0.0F);
  if (state_.running && stops_tracking) {
    state_.glide = saturate(state_.glide + saturate(tracker_.state().value - state_.target));
  }
  state_.beyond = 0.0F;
  state_.noise = 0.0F;
  config_ = config;
  tracker_.setBandwidth(config.tracking_rad_s);
  rate_.setBandwidth(config.derivative_filter_hz);
  if (state_.running) state_.error = afterDeadband(state_.whole_error);
}

void PID_Incremental::reset() noexcept {
  state_ = State{};
  rate_.reset(0.0F);
  tracker_.reset(0.0F);
}

}  // namespace rc10
