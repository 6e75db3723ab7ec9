#include "motor/guarding/rest_check.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

// Fewer are no state but a glitch, however far apart they come.
constexpr int kFewestSamples = 3;

}  // namespace

void RestCheck::reset() noexcept {
  told_ = false;
  sign_ = 0.0F;
  driven_reported_ = false;
  gain_reported_ = false;
}

RestCheck::Verdict RestCheck::look(const MotorFeedback& feedback, float standstill_rpm) noexcept {
  const bool begins = !told_;
  told_ = true;
  if (begins) {
    seen_ = feedback.samples;
    slowest_rpm_ = std::fabs(feedback.velocity_rpm);
  }
  if (feedback.samples == seen_) return Verdict::kRests;
  seen_ = feedback.samples;
  if (driven(feedback, standstill_rpm)) return Verdict::kDriven;
  return gains(feedback, standstill_rpm) ? Verdict::kGainsSpeed : Verdict::kRests;
}

// The sign of a current that is torque; 0: it is none. Comparisons with NaN, which is what a drive does not
// report, are false.
float RestCheck::torqueSign(const MotorFeedback& feedback, float standstill_rpm) const noexcept {
  if (!(config_.current_a > 0.0F) || !(std::fabs(feedback.current_a) > config_.current_a)) return 0.0F;
  const bool stands = std::fabs(feedback.velocity_rpm) < standstill_rpm;
  const bool motors = feedback.current_a * feedback.velocity_rpm > 0.0F;
  return stands || motors ? std::copysign(1.0F, feedback.current_a) : 0.0F;
}

// Noise changes its sign; by the samples' own times, so that a pause of this process proves nothing.
bool RestCheck::driven(const MotorFeedback& feedback, float standstill_rpm) noexcept {
  const float sign = torqueSign(feedback, standstill_rpm);
  if (sign != sign_) {
    sign_ = sign;
    since_ = feedback.received;
    samples_ = 0;
    if (sign == 0.0F) driven_reported_ = false;
  }
  if (sign == 0.0F) return false;
  samples_ = std::min(samples_ + 1, kFewestSamples);
  if (driven_reported_ || samples_ < kFewestSamples || feedback.received - since_ < config_.time)
    return false;
  driven_reported_ = true;
  return true;
}

bool RestCheck::gains(const MotorFeedback& feedback, float standstill_rpm) noexcept {
  const float speed_rpm = std::fabs(feedback.velocity_rpm);
  if (std::isnan(slowest_rpm_) || speed_rpm < slowest_rpm_) slowest_rpm_ = speed_rpm;
  if (speed_rpm < standstill_rpm) gain_reported_ = false;
  if (gain_reported_ || !(config_.gained_rpm > 0.0F) || !(speed_rpm > slowest_rpm_ + config_.gained_rpm))
    return false;
  gain_reported_ = true;
  return true;
}

}  // namespace rc10
