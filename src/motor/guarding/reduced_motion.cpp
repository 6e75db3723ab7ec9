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
  const bool anew = endsResistance(motion, feedback, tick.now);
  if (!reduced) {
    acts_ = false;
    lift(tick.dt_s);
    return false;
  }
  if (!moves || !acts_ || anew) begin(feedback, tick.now);
  acts_ = moves;
  reduce(feedback, tick);
  const bool due = moves && config_.velocity_rpm > 0.0F && tick.now - since_ >= config_.within;
  if (!due) fast_samples_ = 0;
  if (due && motion == Motion::kLed) return tooFast(feedback);
  samples_ = feedback.samples;  // no evidence, neither for nor against
  return false;
}

// A load may have spun the shaft up meanwhile: the target after it has the whole time to slow it down.
bool ReducedMotion::endsResistance(Motion motion, const MotorFeedback& feedback, MonotonicTime now) noexcept {
  const bool resisted = motion == Motion::kResisted;
  if (resisted && !resisted_) {
    resisted_since_ = now;
    resisted_fast_ = fast(feedback);
  }
  const bool ends = resisted_ && !resisted;
  resisted_ = resisted;
  const bool spun_up = !resisted_fast_ && fast(feedback);
  return ends && (spun_up || now - resisted_since_ >= kLastingResistance);
}

bool ReducedMotion::fast(const MotorFeedback& feedback) const noexcept {
  return std::fabs(feedback.velocity_rpm) > config_.velocity_rpm + config_.tolerance_rpm;
}

// From what is measured: a target that the shaft has not reached yet is no reason to gain speed.
void ReducedMotion::begin(const MotorFeedback& feedback, MonotonicTime now) noexcept {
  since_ = now;
  fast_samples_ = 0;
  if (!(config_.velocity_rpm > 0.0F)) return;
  const float speed_rpm = std::fabs(feedback.velocity_rpm);
  const auto least = static_cast<double>(config_.velocity_rpm);
  ceiling_rpm_ = speed_rpm > config_.velocity_rpm ? static_cast<double>(speed_rpm) : least;
  comes_down_ = fast(feedback);
  if (comes_down_) share_ = 1.0F;  // also where it was reduced while the shaft stood
  const auto slew_rpm_per_s = static_cast<double>(config_.slew_rpm_per_s);
  const double evenly_rpm_per_s = (ceiling_rpm_ - least) / static_cast<double>(seconds(config_.within / 2));
  // The slew is known to be quick enough from the highest speed that a target has; a load may be faster.
  const bool beyond = speed_rpm > config_.full_rpm + config_.tolerance_rpm;
  const bool by_slew = slew_rpm_per_s > 0.0 && !beyond;
  fall_rpm_per_s_ = by_slew ? slew_rpm_per_s : std::max(slew_rpm_per_s, evenly_rpm_per_s);
}

// The effort that brings the shaft down is full until it is slow, or should be.
void ReducedMotion::reduce(const MotorFeedback& feedback, const Tick& tick) noexcept {
  if (config_.velocity_rpm > 0.0F) {
    ceiling_rpm_ = std::max(ceiling_rpm_ - fall_rpm_per_s_ * static_cast<double>(tick.dt_s),
                            static_cast<double>(config_.velocity_rpm));
  }
  comes_down_ = comes_down_ && fast(feedback) && tick.now - since_ < config_.within;
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
  if (feedback.samples != samples_)
    fast_samples_ = fast(feedback) ? std::min(fast_samples_ + 1, kFastSamples) : 0;
  samples_ = feedback.samples;
  return fast_samples_ >= kFastSamples;
}

}  // namespace rc10
