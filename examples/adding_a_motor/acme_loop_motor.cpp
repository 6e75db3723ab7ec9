#include "acme_loop_motor.hpp"

#include <algorithm>

namespace acme {

using namespace rc10;

namespace {

/// Feedback periods after which the loops rest: they must not act on old feedback, whoever else notices.
constexpr int kPatiencePeriods = 4;

}  // namespace

ACME_LoopMotor::ACME_LoopMotor(const MotorSettings& settings, const MotorTraits& traits)
    : ACME_Motor(settings, traits), loops_(settings.loops), spacing_(feedbackPeriod()) {}

FrameVerdict ACME_LoopMotor::updateFeedback(const CanFrame& frame) noexcept {
  const bool first = feedback_.samples == 0;
  const MonotonicTime before = feedback_.received;
  const FrameVerdict verdict = ACME_Motor::updateFeedback(frame);
  if (verdict == FrameVerdict::kAccepted) spacing_.add(first ? Duration{0} : frame.received - before);
  return verdict;
}

void ACME_LoopMotor::update(const Tick& tick) noexcept {
  limits_ = 0;
  const float sample_dt_s = spacing_.take();  // 0: no sample since the last tick
  const Target target = wanted();
  switch (target.mode) {
    case ControlMode::kVelocity:
    case ControlMode::kTotalAngle: return runLoops(target, tick, sample_dt_s);
    case ControlMode::kBrake: return runLoops({.mode = ControlMode::kVelocity}, tick, sample_dt_s);
    case ControlMode::kCurrent: loops_.reset(); return obeyCurrent(currentWithinLimit(target));
    default: loops_.reset(); return obeyCurrent(0.0);
  }
}

// The loops advance on samples, not on ticks; in between the current stays.
void ACME_LoopMotor::runLoops(const Target& target, const Tick& tick, float sample_dt_s) noexcept {
  if (feedback_.samples == 0 || tick.now - feedback_.received > kPatiencePeriods * feedbackPeriod()) {
    loops_.reset();
    return obeyCurrent(0.0);
  }
  float current_a = commandValue();
  if (sample_dt_s > 0.0F) {
    const Cascade::Measured measured{.angle_deg = feedback_.angle_deg,
                                     .total_angle_deg = feedback_.total_angle_deg,
                                     .velocity_rpm = feedback_.velocity_rpm};
    const float ff_a = target.torque_ff_nm / torqueNmPerA();
    current_a = loops_.step(target, measured, sample_dt_s, effortLimit(), current_a, ff_a);
  }
  if (loops_.effortLimited()) limits_ |= kLimitCurrent;
  if (loops_.velocityLimited()) limits_ |= kLimitVelocity;
  // The limit may have come down since the last sample: a hot motor gets less.
  obeyCurrent(static_cast<double>(std::clamp(current_a, -effortLimit(), effortLimit())));
}

bool ACME_LoopMotor::setZero(double angle_deg) noexcept {
  loops_.reset();
  return ACME_Motor::setZero(angle_deg);
}

}  // namespace acme
