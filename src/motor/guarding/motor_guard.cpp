#include "motor/guarding/motor_guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/angle.hpp"

namespace rc10 {
namespace {

// A motor at rest repeats its frame for ever, one with a current repeats it for less than this.
constexpr Duration kFrozenTime = std::chrono::milliseconds{200};

// Hysteresis of derating against noise of a degree, and the share by which torque comes back in a second,
// without a jerk of the load.
constexpr float kCoolerC = 3.0F;
constexpr float kRecoveryPerSecond = 0.2F;

constexpr double kQuarterTurnDeg = 90.0;

}  // namespace

bool MotorGuard::same(const Readings& a, const Readings& b) noexcept {
  if (a.total_angle_deg != b.total_angle_deg || a.velocity_rpm != b.velocity_rpm ||
      a.current_a != b.current_a)
    return false;
  return a.temperature_c == b.temperature_c || (std::isnan(a.temperature_c) && std::isnan(b.temperature_c));
}

void MotorGuard::reset() noexcept {
  begun_ = false;
  fast_samples_ = 0;
  opposed_ = false;
  forgetGain();
  stall_.reset();
  behind_.reset();
  frozen_.reset();
}

MotorGuard::Verdict MotorGuard::look(const Observation& seen) noexcept {
  const MotorFeedback& feedback = seen.feedback;
  if (!begun_) jumps_ = feedback.jumps;
  const bool new_sample = !begun_ || feedback.samples != samples_;
  begun_ = true;
  Verdict verdict;
  // Comparisons with NaN, which is what a drive does not report, are false.
  if (config_.temperature_trip_c > 0.0F) {
    verdict.derating = derate(feedback.temperature_c, seen.now);
    if (verdict.derating < 1.0F) verdict.limits |= kLimitTemperature;
    if (tooHot(feedback)) verdict.fault = FaultCode::kOverheated;
  }
  if (stalled(seen)) {
    verdict.limits |= kLimitStall;
    if (config_.stall_trips) verdict.fault = FaultCode::kStalled;
  }
  if (const auto fault = motionFault(seen, new_sample); fault != FaultCode::kNone) verdict.fault = fault;
  samples_ = feedback.samples;
  return verdict;
}

// The last fault found tells most about the cause.
FaultCode MotorGuard::motionFault(const Observation& seen, bool new_sample) noexcept {
  auto fault = FaultCode::kNone;
  if (fallsBehind(seen)) fault = FaultCode::kFollowingError;
  if (frozen(seen, new_sample)) fault = FaultCode::kFrozen;
  if (tooFast(seen.feedback, new_sample)) fault = FaultCode::kOverspeed;
  if (runsAway(seen)) fault = FaultCode::kRunaway;
  if (config_.encoder_jumps && seen.feedback.jumps != jumps_) fault = FaultCode::kEncoderJump;
  jumps_ = seen.feedback.jumps;
  return fault;
}

bool MotorGuard::tooFast(const MotorFeedback& feedback, bool new_sample) noexcept {
  if (!(config_.overspeed_rpm > 0.0F)) return false;
  if (new_sample) {
    fast_samples_ = std::fabs(feedback.velocity_rpm) > config_.overspeed_rpm
                        ? std::min(fast_samples_ + 1, kFastSamples)
                        : 0;
  }
  return fast_samples_ >= kFastSamples;
}

bool MotorGuard::stalled(const Observation& seen) noexcept {
  if (config_.stall_time <= Duration{0}) return false;
  const bool pushes =
      (seen.limits & kLimitCurrent) != 0 && std::fabs(seen.feedback.velocity_rpm) < config_.stall_rpm;
  return stall_.step(pushes, seen.now, config_.stall_time);
}

double MotorGuard::errorDeg(const Observation& seen) noexcept {
  if (seen.target.mode == ControlMode::kTotalAngle) return seen.target.value - seen.feedback.total_angle_deg;
  if (seen.target.mode != ControlMode::kAngle) return 0.0;
  return shortestAngle(static_cast<double>(seen.feedback.angle_deg), seen.target.value);
}

bool MotorGuard::moveIsAsked(const Observation& seen) const noexcept {
  const Target& target = seen.target;
  const auto velocity_rpm = static_cast<double>(seen.feedback.velocity_rpm);
  double most_rpm = config_.velocity_limit_rpm > 0.0F ? static_cast<double>(config_.velocity_limit_rpm)
                                                      : std::numeric_limits<double>::infinity();
  double way = errorDeg(seen);
  // Far from an angle within a turn both ways are about as long, and a shaft that runs away passes there.
  if (target.mode == ControlMode::kAngle && std::fabs(way) > kQuarterTurnDeg) return false;
  if (target.mode == ControlMode::kVelocity) {
    way = target.value;
    most_rpm = std::min(most_rpm, std::fabs(target.value));
  } else if (target.mode == ControlMode::kImpedance && actsByPlace(target)) {
    way = target.value - seen.feedback.total_angle_deg;
  }
  return way * velocity_rpm > 0.0 && std::fabs(velocity_rpm) <= most_rpm;
}

bool MotorGuard::fallsBehind(const Observation& seen) noexcept {
  if (!(config_.following_error_deg > 0.0)) return false;
  const bool behind = std::fabs(errorDeg(seen)) > config_.following_error_deg;
  return behind_.step(behind, seen.now, config_.following_error_time);
}

// A drive whose readings stand still, to the last bit, while its current should be another.
bool MotorGuard::frozen(const Observation& seen, bool new_sample) noexcept {
  if (!(config_.frozen_a > 0.0F)) return false;
  if (new_sample) {
    const Readings now{seen.feedback.total_angle_deg, seen.feedback.velocity_rpm, seen.feedback.current_a,
                       seen.feedback.temperature_c};
    // At its no-load speed a shaft changes nothing but its angle.
    const bool unseen = seen.feedback.angle_at_end && seen.feedback.velocity_rpm != 0.0F;
    unchanged_ = samples_ > 0 && !unseen && same(last_, now);
    last_ = now;
  }
  const bool off = seen.unit == CommandUnit::kAmpere &&
                   std::fabs(seen.effort - seen.feedback.current_a) > config_.frozen_a;
  return frozen_.step(unchanged_ && off, seen.now, kFrozenTime);
}

// A reversed encoder or wrong phases: all the torque there is, and it gains speed the other way. Brakes and
// loads that push slow it down, or at most keep its speed; a heavy load that is let down gains speed, as
// asked.
bool MotorGuard::runsAway(const Observation& seen) noexcept {
  if (!(config_.runaway_rpm > 0.0F)) return false;
  const float velocity_rpm = seen.feedback.velocity_rpm;
  // A target of the drive's own loop says nothing about its torque: -16 deg from 215 is 199.
  const bool of_effort = seen.unit == CommandUnit::kAmpere || seen.unit == CommandUnit::kVolt;
  const float effort = of_effort ? seen.effort : seen.feedback.current_a;
  followLoop(of_effort, seen.target.mode);
  const bool opposed =
      (seen.limits & kLimitCurrent) != 0 && effort * velocity_rpm < 0.0F && !moveIsAsked(seen);
  if (opposed && !opposed_) opposed_rpm_ = std::fabs(velocity_rpm);
  opposed_ = opposed;
  if (!opposed && gained_rpm_ == 0.0F) return false;  // as nearly always
  bool gained = false;
  if (opposed) {
    opposed_rpm_ = std::min(opposed_rpm_, std::fabs(velocity_rpm));
    gained = std::fabs(velocity_rpm) > opposed_rpm_ + config_.runaway_rpm;
  }
  if (of_effort) return gained;
  if (gained) gained_current_a_ = std::max(gained_current_a_, std::fabs(effort));
  // A newer report that drives it along: the one that opposed was of before.
  constexpr float kDrives = 0.25F;  // share of that current: noise of a runaway at its no-load speed is less
  const float along_a = velocity_rpm < 0.0F ? -effort : effort;
  const bool driven = along_a > kDrives * gained_current_a_;
  // Within a turn the way to an angle turns with the shaft, each half turn of it.
  const bool keeps = !driven && keepsGain(velocity_rpm, gained) &&
                     (seen.target.mode == ControlMode::kAngle || !moveIsAsked(seen));
  if (!keeps) forgetGain();
  return runaway_.step(keeps, seen.now, config_.runaway_time) && !(along_a > 0.0F);
}

void MotorGuard::forgetGain() noexcept {
  gained_rpm_ = 0.0F;
  gained_current_a_ = 0.0F;
  runaway_.reset();
}

// A gain belongs to the loop that saw it.
void MotorGuard::followLoop(bool of_effort, ControlMode mode) noexcept {
  if (of_effort == of_effort_ && mode == loop_mode_) return;
  if (of_effort != of_effort_) opposed_ = false;
  of_effort_ = of_effort;
  loop_mode_ = mode;
  forgetGain();
}

bool MotorGuard::keepsGain(float velocity_rpm, bool gained) noexcept {
  constexpr float kKept = 0.25F;  // share of the gain: noise, less than a push that is over loses
  if (gained_rpm_ == 0.0F) {
    if (gained) gained_rpm_ = velocity_rpm;
    return gained;
  }
  const float along_rpm = std::copysign(1.0F, gained_rpm_) * velocity_rpm;
  const float fastest_rpm = std::max(std::fabs(gained_rpm_), along_rpm);
  gained_rpm_ = std::copysign(fastest_rpm, gained_rpm_);
  return along_rpm >= fastest_rpm - kKept * config_.runaway_rpm;
}

float MotorGuard::derate(float temperature_c, MonotonicTime now) noexcept {
  const Duration since_step = now - derated_at_;
  derated_at_ = now;
  const float cooler = factorAt(temperature_c + kCoolerC);
  if (cooler == 1.0F && derating_ == 1.0F) return derating_;  // as nearly always
  const float most = derating_ + kRecoveryPerSecond * seconds(since_step);
  derating_ = std::min(factorAt(temperature_c), std::max(derating_, std::min(cooler, most)));
  return derating_;
}

float MotorGuard::factorAt(float temperature_c) const noexcept {
  const float span_c = config_.temperature_trip_c - config_.temperature_derate_c;
  if (!(temperature_c > config_.temperature_derate_c) || !(span_c > 0.0F)) return 1.0F;
  return std::max((config_.temperature_trip_c - temperature_c) / span_c, 0.0F);
}

}  // namespace rc10
