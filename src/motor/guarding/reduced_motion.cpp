#include "motor/guarding/reduced_motion.hpp"

#include <algorithm>
#include <cmath>

#include "motor/guarding/motor_guard.hpp"

namespace rc10 {
namespace {

// A client that lapses now and then does not begin the monitored time anew.
constexpr Duration kLastingResistance = std::chrono::milliseconds{500};

}  // namespace

bool ReducedMotion::step(bool reduced, Motion motion, const MotorFeedback& feedback,
                         const Tick& tick) noexcept {
  const bool moves = motion != Motion::kNone;
  const bool anew = endsResistance(motion, tick.now);
  if (!reduced) {
    acts_ = false;
    lift(tick.dt_s);
    return false;
  }
  const float speed_rpm = std::fabs(feedback.velocity_rpm);
  if (!moves || !acts_ || anew) begin(speed_rpm, tick.now);
  acts_ = moves;
  reduce(speed_rpm, tick);
  const bool due =
      motion == Motion::kLed && config_.velocity_rpm > 0.0F && tick.now - since_ >= config_.within;
  if (!due) {
    fast_samples_ = 0;
    samples_ = feedback.samples;
    return false;
  }
  return tooFast(feedback);
}

// A load may have spun the shaft up meanwhile: the target after it has the whole time to slow it down.
bool ReducedMotion::endsResistance(Motion motion, MonotonicTime now) noexcept {
  const bool resisted = motion == Motion::kResisted;
  if (resisted && !resisted_) resisted_since_ = now;
  const bool ends = resisted_ && !resisted;
  resisted_ = resisted;
  return ends && now - resisted_since_ >= kLastingResistance;
}

// From what is measured: a target that the shaft has not reached yet is no reason to gain speed.
void ReducedMotion::begin(float speed_rpm, MonotonicTime now) noexcept {
  since_ = now;
  if (!(config_.velocity_rpm > 0.0F)) return;
  const auto least = static_cast<double>(config_.velocity_rpm);
  ceiling_rpm_ = speed_rpm > config_.velocity_rpm ? static_cast<double>(speed_rpm) : least;
  comes_down_ = speed_rpm > config_.velocity_rpm + config_.tolerance_rpm;
  if (comes_down_) share_ = 1.0F;  // also where it was reduced while the shaft stood
  const auto slew_rpm_per_s = static_cast<double>(config_.slew_rpm_per_s);
  const double evenly_rpm_per_s = (ceiling_rpm_ - least) / static_cast<double>(seconds(config_.within / 2));
  // The slew is known to be quick enough from the highest speed that a target has; a load may be faster.
  const bool beyond = speed_rpm > config_.full_rpm + config_.tolerance_rpm;
  const bool by_slew = slew_rpm_per_s > 0.0 && !beyond;
  fall_rpm_per_s_ = by_slew ? slew_rpm_per_s : std::max(slew_rpm_per_s, evenly_rpm_per_s);
}

// The effort that brings the shaft down is full until it is slow, or should be.
void ReducedMotion::reduce(float speed_rpm, const Tick& tick) noexcept {
  if (config_.velocity_rpm > 0.0F) {
    ceiling_rpm_ = std::max(ceiling_rpm_ - fall_rpm_per_s_ * static_cast<double>(tick.dt_s),
                            static_cast<double>(config_.velocity_rpm));
  }
  const bool fast = speed_rpm > config_.velocity_rpm + config_.tolerance_rpm;
  comes_down_ = comes_down_ && fast && tick.now - since_ < config_.within;
  if (!comes_down_) share_ = config_.effort_share;
}

void ReducedMotion::lift(float dt_s) noexcept {
  const float part = dt_s / kLiftSeconds;
  share_ = std::min(1.0F, share_ + (1.0F - config_.effort_share) * part);
  if (!std::isfinite(ceiling_rpm_)) return;
  ceiling_rpm_ += static_cast<double>((config_.full_rpm - config_.velocity_rpm) * part);
  if (ceiling_rpm_ >= static_cast<double>(config_.full_rpm))
    ceiling_rpm_ = std::numeric_limits<double>::infinity();
}

bool ReducedMotion::tooFast(const MotorFeedback& feedback) noexcept {
  if (feedback.samples != samples_) {
    const bool fast = std::fabs(feedback.velocity_rpm) > config_.velocity_rpm + config_.tolerance_rpm;
    fast_samples_ = fast ? std::min(fast_samples_ + 1, kFastSamples) : 0;
  }
  samples_ = feedback.samples;
  return fast_samples_ >= kFastSamples;
}

}  // namespace rc10
