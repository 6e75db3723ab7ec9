#include "motor/guarding/target_shaper.hpp"

#include <algorithm>
#include <cmath>

#include "app/angle.hpp"
#include "app/units.hpp"

namespace rc10 {
namespace {

[[nodiscard]] bool isEffort(ControlMode mode) noexcept {
  return mode == ControlMode::kCurrent || mode == ControlMode::kVoltage || mode == ControlMode::kDuty;
}

[[nodiscard]] double distanceDeg(const Target& asked, const MotorFeedback& feedback) noexcept {
  return asked.mode == ControlMode::kAngle
             ? shortestAngle(static_cast<double>(feedback.angle_deg), asked.value)
             : asked.value - feedback.total_angle_deg;
}

}  // namespace

bool TargetShaper::firstStepAllowed(const Target& asked, const MotorFeedback& feedback) const noexcept {
  return !needsReference(asked.mode) ||
         !(std::fabs(distanceDeg(asked, feedback)) > config_.max_first_step_deg);
}

TargetShaper::Shaped TargetShaper::step(const Target& asked, const MotorFeedback& feedback,
                                        float effort_in_force, float dt_s) noexcept {
  if (asked.mode != mode_) {
    mode_ = asked.mode;
    if (isEffort(mode_)) value_ = static_cast<double>(effort_in_force);
    if (mode_ == ControlMode::kVelocity) value_ = static_cast<double>(feedback.velocity_rpm);
    if (needsReference(mode_)) value_ = feedback.total_angle_deg;
    if (!std::isfinite(value_)) value_ = 0.0;
  }
  if (isEffort(mode_)) return shapeEffort(asked, feedback, dt_s);
  if (mode_ == ControlMode::kVelocity) return shapeVelocity(asked, feedback, dt_s);
  if (needsReference(mode_)) return shapeAngle(asked, feedback, dt_s);
  return {asked, 0};
}

bool TargetShaper::bounded(const MotorFeedback& feedback) const noexcept {
  return feedback.zeroed && (std::isfinite(config_.angle_min_deg) || std::isfinite(config_.angle_max_deg));
}

TargetShaper::Envelope TargetShaper::envelope(double total_angle_deg) const noexcept {
  const auto slope = static_cast<double>(config_.approach_rpm_per_deg);
  return {std::min(0.0, (config_.angle_min_deg - total_angle_deg) * slope),
          std::max(0.0, (config_.angle_max_deg - total_angle_deg) * slope)};
}

// The next value on the way to the goal. True: the limit acts.
bool TargetShaper::slew(double goal, float per_second, float dt_s) noexcept {
  const double most = static_cast<double>(per_second) * static_cast<double>(dt_s);
  const bool limited = per_second > 0.0F && std::fabs(goal - value_) > most;
  value_ = limited ? value_ + std::copysign(most, goal - value_) : goal;
  return limited;
}

TargetShaper::Shaped TargetShaper::shapeEffort(Target asked, const MotorFeedback& feedback,
                                               float dt_s) noexcept {
  // One effort, so that no part of it passes the limits by.
  if (config_.effort_per_nm > 0.0F) {
    asked.value += static_cast<double>(asked.torque_ff_nm) * static_cast<double>(config_.effort_per_nm);
    asked.torque_ff_nm = 0.0F;
  }
  Shaped out{asked, slew(asked.value, config_.effort_slew_per_s, dt_s) ? kLimitSlew : 0U};
  out.target.value = value_;
  if (!bounded(feedback)) return out;
  // A push outwards fades as the speed nears what is allowed, and brakes beyond it. A push inwards always
  // acts.
  const Envelope allowed = envelope(feedback.total_angle_deg);
  const double inside =
      std::clamp(value_, effortFor(allowed.low_rpm, feedback), effortFor(allowed.high_rpm, feedback));
  if (inside != value_) out.limits |= kLimitAngle;
  out.target.value = inside;
  return out;
}

double TargetShaper::effortFor(double allowed_rpm, const MotorFeedback& feedback) const noexcept {
  return allowed_rpm * static_cast<double>(config_.effort_per_rpm) +
         (allowed_rpm - static_cast<double>(feedback.velocity_rpm)) *
             static_cast<double>(config_.approach_effort_per_rpm);
}

TargetShaper::Shaped TargetShaper::shapeVelocity(Target asked, const MotorFeedback& feedback,
                                                 float dt_s) noexcept {
  Shaped out{asked, slew(asked.value, config_.velocity_slew_rpm_per_s, dt_s) ? kLimitSlew : 0U};
  if (bounded(feedback)) {
    const Envelope allowed = envelope(feedback.total_angle_deg);
    const double inside = std::clamp(value_, allowed.low_rpm, allowed.high_rpm);
    if (inside != value_) out.limits |= kLimitAngle;
    value_ = inside;
  }
  out.target.value = value_;
  return out;
}

// The nearest angle to the goal that is allowed; any turn of it if the turn does not matter.
double TargetShaper::reachable(double goal_deg, bool any_turn) const noexcept {
  const double inside = std::clamp(goal_deg, config_.angle_min_deg, config_.angle_max_deg);
  if (inside == goal_deg || !any_turn) return inside;
  const double other_way = goal_deg + std::copysign(kDegPerTurn, inside - goal_deg);
  const bool allowed = other_way >= config_.angle_min_deg && other_way <= config_.angle_max_deg;
  return allowed ? other_way : inside;
}

TargetShaper::Shaped TargetShaper::shapeAngle(Target asked, const MotorFeedback& feedback,
                                              float dt_s) noexcept {
  const bool limited = bounded(feedback);
  if (!limited && !(config_.angle_slew_deg_per_s > 0.0F)) return {asked, 0};
  // From here on in multi-turn angles: the shortest way may lead through what is not allowed.
  const bool any_turn = asked.mode == ControlMode::kAngle;
  const double goal = any_turn ? value_ + shortestAngle(value_, asked.value) : asked.value;
  const double allowed = limited ? reachable(goal, any_turn) : goal;
  Shaped out{asked, 0};
  if (any_turn ? wrapDegrees(allowed) != wrapDegrees(goal) : allowed != goal) {
    out.limits |= kLimitAngle;
    out.target.velocity_ff_rpm = 0.0F;  // it would lead on
  } else if (limited) {
    const Envelope towards = envelope(feedback.total_angle_deg);
    out.target.velocity_ff_rpm = static_cast<float>(
        std::clamp(static_cast<double>(asked.velocity_ff_rpm), towards.low_rpm, towards.high_rpm));
  }
  if (slew(allowed, config_.angle_slew_deg_per_s, dt_s)) out.limits |= kLimitSlew;
  if (any_turn) out.target.mode = ControlMode::kTotalAngle;
  out.target.value = value_;
  return out;
}

}  // namespace rc10
