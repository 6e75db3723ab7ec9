#include "motor/guarding/target_shaper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/angle.hpp"
#include "app/limits.hpp"
#include "app/units.hpp"

namespace rc10 {
namespace {

// Share of the remaining way that a target keeps when a speed ceiling begins. Drives' springs and profiles
// turn faster than the loop assumed here: with a quarter, a moteus reaches 34 rpm instead of 20.
constexpr double kFirstLeadShare = 0.1;
// Time within which a torque feed-forward comes back that was taken away for the speed.
constexpr double kFeedForwardBackSeconds = 0.5;
// Effort outwards fades over this speed, where the effort that keeps a lower one is not known.
constexpr double kEffortFadesRpm = 20.0;
// Share of the way to a soft limit that goes by before a sample counts as late: frames are not on time.
constexpr double kLateShare = 0.75;
// Share of the allowed speed below which an effort acts again, after the speed was bounded.
constexpr double kEffortAgainShare = 0.8;

[[nodiscard]] bool isEffort(ControlMode mode) noexcept {
  return mode == ControlMode::kCurrent || mode == ControlMode::kVoltage || mode == ControlMode::kDuty;
}

[[nodiscard]] double distanceDeg(const Target& asked, const MotorFeedback& feedback) noexcept {
  return asked.mode == ControlMode::kAngle
             ? shortestAngle(static_cast<double>(feedback.angle_deg), asked.value)
             : asked.value - feedback.total_angle_deg;
}

// The next value on the way to the goal; 0 per second: at once. True: the limit acts.
[[nodiscard]] bool slewTowards(double goal, double per_second, float dt_s, double& value) noexcept {
  const double most = per_second * static_cast<double>(dt_s);
  const bool limited = per_second > 0.0 && std::fabs(goal - value) > most;
  value = limited ? value + std::copysign(most, goal - value) : goal;
  return limited;
}

// Between the bounds of a magnitude; 0: there are none.
[[nodiscard]] double within(double value, double most) noexcept {
  return most > 0.0 ? std::clamp(value, -most, most) : value;
}

// Goal of a slew that is at `value`: at the limit it ends, and what ran on beyond would have to come back
// before a target acts. From beyond the limit it is not led back faster than was asked.
[[nodiscard]] double slewGoal(double asked, double value, double most) noexcept {
  return most > 0.0 ? std::clamp(asked, std::min(-most, value), std::max(most, value)) : asked;
}

// Part of an effort that its limits have let through: `told`; 0 if they brake in its place.
[[nodiscard]] double leftOf(double effort, double told) noexcept {
  const double most = std::fabs(effort);
  return effort < 0.0 ? std::clamp(told, -most, 0.0) : std::clamp(told, 0.0, most);
}

// Whether `before` has led the shaft by a place already. A spring need not have: one that becomes stiffer,
// and an angle, begin anew.
[[nodiscard]] bool goesOnFrom(const Target& before, const Target& asked) noexcept {
  if (!actsByPlace(before)) return false;
  if (before.mode != ControlMode::kImpedance) return true;
  return asked.mode == ControlMode::kImpedance && !(asked.stiffness_nm_per_rad > before.stiffness_nm_per_rad);
}

[[nodiscard]] bool isUnitOf(CommandUnit unit, ControlMode mode) noexcept {
  return (mode == ControlMode::kCurrent && unit == CommandUnit::kAmpere) ||
         (mode == ControlMode::kVoltage && unit == CommandUnit::kVolt);
}

}  // namespace

bool TargetShaper::firstStepAllowed(const Target& asked, const Target& before,
                                    const MotorFeedback& feedback) const noexcept {
  if (!actsByPlace(asked) || goesOnFrom(before, asked)) return true;
  const double asked_deg = distanceDeg(asked, feedback);
  if (std::fabs(asked_deg) > config_.max_first_step_deg) return false;
  if (asked.mode != ControlMode::kAngle || !bounded(feedback)) return true;
  // Beyond a soft limit the shortest way may be closed, and the other one the way.
  const double here_deg = feedback.total_angle_deg;
  const Travel travel{std::min(config_.angle_min_deg, here_deg), std::max(config_.angle_max_deg, here_deg)};
  return !(std::fabs(reachable(here_deg + asked_deg, true, travel) - here_deg) > config_.max_first_step_deg);
}

std::uint32_t TargetShaper::step(Target& target, const MotorFeedback& feedback, const InForce& in_force,
                                 float dt_s) noexcept {
  if (!follows(target.mode)) begin(target, feedback, in_force);
  if (mode_ == ControlMode::kImpedance) stiffen(target, feedback);
  if (!(share_ < 1.0)) return shape(target, feedback, in_force, dt_s);
  soften(target, feedback, dt_s);
  return shape(target, feedback, in_force, dt_s) | kLimitSlew;
}

std::uint32_t TargetShaper::slowDown(Target& target, const MotorFeedback& feedback, const InForce& in_force,
                                     float dt_s) noexcept {
  if (!follows(target.mode)) begin(target, feedback, in_force);
  if (mode_ == ControlMode::kVelocity) value_ = target.value;  // its own time, whatever the slew limit
  const auto limits = shape(target, feedback, in_force, dt_s);
  soft_ = value_;
  return limits;
}

// A spring that becomes stiffer keeps its torque: a place that is slewed goes on from where the new stiffness
// gives the same. Without stiffness there is no place, and it begins at the shaft.
void TargetShaper::stiffen(const Target& asked, const MotorFeedback& feedback) noexcept {
  const bool led = config_.angle_slew_deg_per_s > 0.0F || reduced() || share_ < 1.0;
  const double before = std::exchange(stiffness_nm_per_rad_, static_cast<double>(asked.stiffness_nm_per_rad));
  const bool stiff = actsByPlace(asked);
  if (stiff && !(led && stiffness_nm_per_rad_ > before)) return;
  const double share = stiff ? std::max(before, 0.0) / stiffness_nm_per_rad_ : 0.0;
  const double here_deg = feedback.total_angle_deg;
  value_ = here_deg + share * (value_ - here_deg);
  soft_ = here_deg + share * (soft_ - here_deg);
  openTravel(value_);
}

// Share of the target by the time since the motor was enabled, from where it is on its way: a target that
// changes meanwhile never leads back. A spring is stiff at once, and begins where the shaft is or is held.
void TargetShaper::soften(Target& asked, const MotorFeedback& feedback, float dt_s) noexcept {
  const double left = 1.0 - share_;
  share_ = std::min(1.0, share_ + static_cast<double>(dt_s / config_.soft_start_s));
  const bool moves = isEffort(mode_) || mode_ == ControlMode::kVelocity || needsReference(mode_);
  if (!moves) return;
  boundAsked(asked);
  asked.velocity_ff_rpm *= static_cast<float>(share_);
  if (!(share_ < 1.0)) return;
  const double part = 1.0 - (1.0 - share_) / left;
  soft_ff_nm_ += (static_cast<double>(asked.torque_ff_nm) - soft_ff_nm_) * part;
  asked.torque_ff_nm = static_cast<float>(soft_ff_nm_);
  const bool any_turn = mode_ == ControlMode::kAngle;
  double goal = any_turn ? soft_ + shortestAngle(soft_, asked.value) : asked.value;
  const bool limited = any_turn && bounded(feedback);
  if (limited) goal = reachable(goal, any_turn, travel_);
  soft_ += (goal - soft_) * part;
  // On the turn that was chosen: the shortest way from the next place may be another one.
  if (limited) asked.mode = ControlMode::kTotalAngle;
  asked.value = any_turn && !limited ? wrapDegrees(soft_) : soft_;
}

// A share of a target far beyond the limit would be the limit itself.
void TargetShaper::boundAsked(Target& asked) const noexcept {
  const auto rpm = static_cast<double>(config_.velocity_limit_rpm);
  const auto effort = static_cast<double>(config_.effort_limit);
  const auto per_nm = static_cast<double>(config_.effort_per_nm);
  const double most_nm = per_nm > 0.0 ? effort / per_nm : 0.0;
  if (mode_ == ControlMode::kCurrent) {
    asked.value += static_cast<double>(asked.torque_ff_nm) * per_nm;
    asked.torque_ff_nm = 0.0F;
  }
  if (mode_ == ControlMode::kVelocity) asked.value = within(asked.value, rpm);
  if (isEffort(mode_)) asked.value = within(asked.value, mode_ == ControlMode::kDuty ? 1.0 : effort);
  asked.velocity_ff_rpm = static_cast<float>(within(static_cast<double>(asked.velocity_ff_rpm), rpm));
  asked.torque_ff_nm = static_cast<float>(within(static_cast<double>(asked.torque_ff_nm), most_nm));
}

std::uint32_t TargetShaper::shape(Target& asked, const MotorFeedback& feedback, const InForce& in_force,
                                  float dt_s) noexcept {
  if (isEffort(mode_)) return shapeEffort(asked, feedback, in_force, dt_s);
  if (mode_ != ControlMode::kVelocity && !needsReference(mode_)) return 0;
  const bool feeds_forward = feeds_forward_ || asked.velocity_ff_rpm != 0.0F || asked.torque_ff_nm != 0.0F ||
                             asked.mode == ControlMode::kImpedance;
  return feeds_forward ? shapeWithFeedForward(asked, feedback, dt_s) : shapeMotion(asked, feedback, dt_s);
}

inline std::uint32_t TargetShaper::shapeMotion(Target& asked, const MotorFeedback& feedback,
                                               float dt_s) noexcept {
  return mode_ == ControlMode::kVelocity ? shapeVelocity(asked, feedback, dt_s)
                                         : shapeAngle(asked, feedback, dt_s);
}

// From what acts, in the unit of the mode: the last command may have been a speed.
void TargetShaper::begin(const Target& target, const MotorFeedback& feedback,
                         const InForce& in_force) noexcept {
  const auto mode = target.mode;
  mode_ = mode;
  speed_bounds_effort_ = false;
  value_ = velocity_ff_rpm_ = torque_ff_nm_ = 0.0;
  feeds_forward_ = false;
  stiffness_nm_per_rad_ = static_cast<double>(target.stiffness_nm_per_rad);
  if (mode == ControlMode::kCurrent) {
    const bool told = in_force.unit == CommandUnit::kAmpere;
    value_ = static_cast<double>(told ? in_force.value : feedback.current_a);
  }
  if (mode == ControlMode::kVoltage && in_force.unit == CommandUnit::kVolt)
    value_ = static_cast<double>(in_force.value);
  if (mode == ControlMode::kDuty) {
    const float by_speed = feedback.velocity_rpm * config_.duty_per_rpm;
    value_ = within(static_cast<double>(std::isfinite(in_force.duty) ? in_force.duty : by_speed), 1.0);
  }
  if (mode == ControlMode::kVelocity) value_ = static_cast<double>(feedback.velocity_rpm);
  if (needsReference(mode)) value_ = feedback.total_angle_deg;
  if (!std::isfinite(value_)) value_ = 0.0;
  const double here = value_;
  if (std::isfinite(in_force.held_deg)) takeOver(target, feedback, in_force);
  if (needsReference(mode)) openTravel(here);
  soft_ = value_;
  soft_ff_nm_ = torque_ff_nm_;
}

void TargetShaper::openTravel(double here_deg) noexcept {
  travel_ = {std::min({config_.angle_min_deg, here_deg, value_}),
             std::max({config_.angle_max_deg, here_deg, value_})};
}

// A load that a fallback holds stays held: an angle goes on from the held one, beside which a loaded spring
// is. Torque in force that the spring of an impedance does not give, or the damper of a speed, begins as a
// feed-forward.
void TargetShaper::takeOver(const Target& target, const MotorFeedback& feedback,
                            const InForce& in_force) noexcept {
  const auto mode = target.mode;
  if (mode == ControlMode::kAngle || mode == ControlMode::kTotalAngle) value_ = in_force.held_deg;
  const bool told = in_force.unit == CommandUnit::kAmpere;
  const bool damped = mode == ControlMode::kVelocity && config_.springs && told;
  if (!(damped || mode == ControlMode::kImpedance) || !(config_.effort_per_nm > 0.0F)) return;
  double missing_nm =
      finiteOr0(static_cast<double>((told ? in_force.value : feedback.current_a) / config_.effort_per_nm));
  // The asked feed-forward is in force already: what the spring gave in its place would fade sooner.
  const double fed_nm = leftOf(missing_nm, finiteOr0(static_cast<double>(target.torque_ff_nm)));
  missing_nm -= fed_nm;
  if (mode == ControlMode::kImpedance && target.stiffness_nm_per_rad > 0.0F) {
    const auto stiffness = static_cast<double>(target.stiffness_nm_per_rad);
    const double most_rad = std::fabs(in_force.held_deg - feedback.total_angle_deg) * kRadPerDeg;
    const double spring_rad = std::clamp(missing_nm / stiffness, -most_rad, most_rad);
    value_ += spring_rad / kRadPerDeg;
    missing_nm -= spring_rad * stiffness;
  }
  torque_ff_nm_ = fed_nm + missing_nm;
  feeds_forward_ = torque_ff_nm_ != 0.0;
}

TargetShaper::Envelope TargetShaper::envelope(double total_angle_deg) const noexcept {
  const double slope = approach_rpm_per_deg_;
  return {std::min(0.0, (config_.angle_min_deg - total_angle_deg + unseen_deg_) * slope),
          std::max(0.0, (config_.angle_max_deg - total_angle_deg - unseen_deg_) * slope)};
}

// A speed is told by a sample that may be a period old, and kept until the next command.
void TargetShaper::boundApproach() noexcept {
  const double spacing_s =
      static_cast<double>(config_.feedback_period_s) + static_cast<double>(config_.command_period_s);
  approach_rpm_per_deg_ = static_cast<double>(config_.approach_rpm_per_deg);
  if (spacing_s > 0.0)
    approach_rpm_per_deg_ = std::min(approach_rpm_per_deg_,
                                     static_cast<double>(kApproachOfSpacing) / (kDegPerSPerRpm * spacing_s));
  late_s_ =
      kLateShare / (kDegPerSPerRpm * approach_rpm_per_deg_) - static_cast<double>(config_.command_period_s);
}

// The command of before the sample may still act.
void TargetShaper::reckon(const MotorFeedback& feedback, MonotonicTime now) noexcept {
  const bool came = std::exchange(samples_, feedback.samples) != feedback.samples;
  if (came) fastest_rpm_ = std::fabs(static_cast<double>(finiteOr0(feedback.velocity_rpm)));
  if (mode_ == ControlMode::kVelocity) fastest_rpm_ = std::max(fastest_rpm_, std::fabs(value_));
  const auto age_s = static_cast<double>(seconds(now - feedback.received));
  unseen_deg_ = age_s > late_s_ ? fastest_rpm_ * kDegPerSPerRpm * age_s : 0.0;
}

TargetShaper::Envelope TargetShaper::softEnvelope(const MotorFeedback& feedback) const noexcept {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return bounded(feedback) ? envelope(feedback.total_angle_deg) : Envelope{-kNone, kNone};
}

TargetShaper::Envelope TargetShaper::allowedSpeeds(const MotorFeedback& feedback) const noexcept {
  const Envelope soft = softEnvelope(feedback);
  return {std::max(soft.low_rpm, -ceiling_rpm_), std::min(soft.high_rpm, ceiling_rpm_)};
}

// A place is approached at its gain, which is above that of a soft limit. A speed is not exceeded on the way
// to one: there is no room to brake.
OutputRange TargetShaper::speedBounds(const MotorFeedback& feedback, std::optional<double> from_rpm,
                                      double standstill_rpm) const noexcept {
  constexpr double kTolerance = 0.125;
  Envelope most{-ceiling_rpm_, ceiling_rpm_};
  const auto include = [&most](double low_rpm, double high_rpm) noexcept {
    most.low_rpm = std::max(most.low_rpm, std::min(low_rpm, 0.0));
    most.high_rpm = std::min(most.high_rpm, std::max(high_rpm, 0.0));
  };
  if (bounded(feedback)) {
    const bool by_speed = mode_ == ControlMode::kVelocity;
    const double share = by_speed ? 1.0 : 1.0 / static_cast<double>(kApproachOfAngleGain);
    const Envelope soft = envelope(feedback.total_angle_deg);
    include(share * soft.low_rpm, share * soft.high_rpm);
    if (by_speed) include(value_, value_);
  }
  if (from_rpm) include(*from_rpm, *from_rpm);
  // Tolerance for a hand that touches a carried load; in reduced mode below that of its fault.
  constexpr double kTouchRpm = 20.0;
  const double least_rpm = 0.5 * standstill_rpm;
  const double slack_rpm = reduced() ? least_rpm : std::clamp(kTouchRpm, least_rpm, 2.0 * standstill_rpm);
  return {static_cast<float>((1.0 + kTolerance) * most.low_rpm - slack_rpm),
          static_cast<float>((1.0 + kTolerance) * most.high_rpm + slack_rpm)};
}

bool TargetShaper::slew(double goal, float per_second, float dt_s) noexcept {
  return slewTowards(goal, static_cast<double>(per_second), dt_s, value_);
}

std::uint32_t TargetShaper::shapeWithFeedForward(Target& asked, const MotorFeedback& feedback,
                                                 float dt_s) noexcept {
  const auto limits = shapeVelocityFf(asked, dt_s) | shapeTorqueFf(asked, feedback, dt_s);
  feeds_forward_ = velocity_ff_rpm_ != 0.0 || torque_ff_nm_ != 0.0;
  return limits | shapeMotion(asked, feedback, dt_s);
}

// The velocity of a trajectory: no faster than the angle may move, and no jump.
std::uint32_t TargetShaper::shapeVelocityFf(Target& asked, float dt_s) noexcept {
  if (asked.velocity_ff_rpm == 0.0F && velocity_ff_rpm_ == 0.0) return 0;
  const auto wanted_rpm = static_cast<double>(asked.velocity_ff_rpm);
  const double allowed_rpm = within(std::clamp(wanted_rpm, -ceiling_rpm_, ceiling_rpm_),
                                    static_cast<double>(config_.velocity_limit_rpm));
  const double goal_rpm =
      within(allowed_rpm, static_cast<double>(config_.angle_slew_deg_per_s) / kDegPerSPerRpm);
  std::uint32_t limits = allowed_rpm != wanted_rpm ? kLimitVelocity : 0U;
  if (goal_rpm != allowed_rpm) limits |= kLimitSlew;
  if (slewTowards(goal_rpm, static_cast<double>(config_.velocity_slew_rpm_per_s), dt_s, velocity_ff_rpm_))
    limits |= kLimitSlew;
  asked.velocity_ff_rpm = static_cast<float>(velocity_ff_rpm_);
  return limits;
}

// A feed-forward is an effort as any other: it rises at the rate of one, and fades towards a soft limit and
// towards the ceiling. An impedance has no loop that holds the speed: there it brakes what its spring drives
// too fast, too.
std::uint32_t TargetShaper::shapeTorqueFf(Target& asked, const MotorFeedback& feedback, float dt_s) noexcept {
  const bool springs = asked.mode == ControlMode::kImpedance;
  if (!springs && asked.torque_ff_nm == 0.0F && torque_ff_nm_ == 0.0) return 0;
  const auto per_nm = static_cast<double>(config_.effort_per_nm);
  const double nm_per_s = per_nm > 0.0 ? static_cast<double>(config_.effort_slew_per_s) / per_nm : 0.0;
  const auto wanted_nm = static_cast<double>(asked.torque_ff_nm);
  const double goal_nm =
      nm_per_s > 0.0 ? slewGoal(wanted_nm, torque_ff_nm_, static_cast<double>(config_.effort_limit) / per_nm)
                     : wanted_nm;
  std::uint32_t limits = goal_nm != wanted_nm ? kLimitCurrent : 0U;
  if (slewTowards(goal_nm, nm_per_s, dt_s, torque_ff_nm_)) limits |= kLimitSlew;
  if (bounded(feedback) || reduced()) {
    const Envelope allowed = springs ? allowedSpeeds(feedback) : softEnvelope(feedback);
    double low_nm = -mostTorqueFf(springs, feedback, allowed.low_rpm, -1.0);
    double high_nm = mostTorqueFf(springs, feedback, allowed.high_rpm, 1.0);
    if (reduced() && !springs) {
      const double most_nm = torqueUnderCeiling(feedback, dt_s);
      low_nm = std::max(low_nm, -most_nm);
      high_nm = std::min(high_nm, most_nm);
    }
    const double inside_nm = std::clamp(torque_ff_nm_, low_nm, std::max(low_nm, high_nm));
    if (inside_nm != torque_ff_nm_)
      limits |= limitOf(inside_nm < torque_ff_nm_ ? allowed.high_rpm : allowed.low_rpm);
    torque_ff_nm_ = inside_nm;
  }
  asked.torque_ff_nm = static_cast<float>(torque_ff_nm_);
  return limits;
}

// Bound of the feed-forward in the direction of `sign`. Below 0 it brakes, where a spring may be too soft.
double TargetShaper::mostTorqueFf(bool springs, const MotorFeedback& feedback, double allowed_rpm,
                                  double sign) const noexcept {
  double most_nm = 0.0;
  if (!std::isfinite(allowed_rpm)) {
    most_nm = std::numeric_limits<double>::infinity();
  } else if (config_.effort_per_nm > 0.0F) {
    most_nm = sign * effortFor(allowed_rpm, feedback) / static_cast<double>(config_.effort_per_nm);
  } else if (sign * (allowed_rpm - static_cast<double>(feedback.velocity_rpm)) > 0.0) {
    most_nm = std::numeric_limits<double>::infinity();
  }
  return springs ? most_nm : std::max(most_nm, 0.0);
}

// Share of the feed-forward: all at standstill, to hold a load; none at the ceiling, where the loop keeps the
// speed. It comes back slowly: otherwise a light shaft would be driven back and forth.
double TargetShaper::torqueUnderCeiling(const MotorFeedback& feedback, float dt_s) noexcept {
  if (!(config_.effort_per_nm > 0.0F)) return std::numeric_limits<double>::infinity();
  const auto full_nm = static_cast<double>(config_.effort_full_scale / config_.effort_per_nm);
  const double towards_rpm = std::copysign(1.0, torque_ff_nm_) * static_cast<double>(feedback.velocity_rpm);
  const double share = std::clamp(1.0 - towards_rpm / ceiling_rpm_, 0.0, 1.0);
  const double back_nm = full_nm * static_cast<double>(dt_s) / kFeedForwardBackSeconds;
  ceiling_nm_ = std::min(share * full_nm, ceiling_nm_ + back_nm);
  return ceiling_nm_;
}

std::uint32_t TargetShaper::shapeEffort(Target& asked, const MotorFeedback& feedback, const InForce& in_force,
                                        float dt_s) noexcept {
  if (in_force.limited && isUnitOf(in_force.unit, mode_))
    value_ = leftOf(value_, static_cast<double>(in_force.value));
  // One effort, so that no part of it passes the limits by.
  asked.value += static_cast<double>(asked.torque_ff_nm) * static_cast<double>(config_.effort_per_nm);
  asked.torque_ff_nm = 0.0F;
  const bool duty = mode_ == ControlMode::kDuty && config_.effort_full_scale > 0.0F;
  const double scale = duty ? 1.0 / static_cast<double>(config_.effort_full_scale) : 1.0;
  const double per_s = scale * static_cast<double>(config_.effort_slew_per_s);
  // More than all does nothing, and would have to be slewed back.
  const double goal = duty ? slewGoal(asked.value, value_, 1.0) : asked.value;
  std::uint32_t limits = slewTowards(goal, per_s, dt_s, value_) ? kLimitSlew : 0U;
  asked.value = value_;
  if (!bounded(feedback) && !reduced()) return limits;
  if (!config_.knowsBrakingEffort() && config_.has_velocity_loop)
    return limits | boundBySpeed(asked, feedback);
  // A push outwards fades as the speed nears what is allowed, and brakes beyond it. A push inwards always
  // acts.
  const Envelope allowed = allowedSpeeds(feedback);
  const double inside = std::clamp(value_, scale * effortTowards(allowed.low_rpm, -1.0, feedback),
                                   scale * effortTowards(allowed.high_rpm, 1.0, feedback));
  if (inside != value_) limits |= limitOf(inside < value_ ? allowed.high_rpm : allowed.low_rpm);
  asked.value = inside;
  value_ = leftOf(value_, inside);
  return limits;
}

// A drive of unknown speed per effort may have a velocity loop: that brakes a shaft that is faster than
// allowed, until it is clearly slower.
std::uint32_t TargetShaper::boundBySpeed(Target& asked, const MotorFeedback& feedback) noexcept {
  const Envelope allowed = allowedSpeeds(feedback);
  const auto rpm = static_cast<double>(feedback.velocity_rpm);
  const double share = speed_bounds_effort_ ? kEffortAgainShare : 1.0;
  const bool high = rpm > share * allowed.high_rpm && rpm > 0.0;
  const bool low = rpm < share * allowed.low_rpm && rpm < 0.0;
  speed_bounds_effort_ = high || low;
  if (speed_bounds_effort_) {
    const double most_rpm = high ? allowed.high_rpm : allowed.low_rpm;
    asked = Target{.mode = ControlMode::kVelocity, .value = most_rpm};
    // It goes on from what is measured then.
    if (mode_ == ControlMode::kCurrent && config_.effort_slew_per_s > 0.0F)
      value_ = finiteOr0(static_cast<double>(feedback.current_a));
    return limitOf(most_rpm);
  }
  // Soft limits end a push, reduced speed does not.
  const Envelope soft = softEnvelope(feedback);
  const double outward_rpm = std::fabs(value_ > 0.0 ? soft.high_rpm : soft.low_rpm);
  if (!(outward_rpm < kEffortFadesRpm)) return 0;
  asked.value = value_ * outward_rpm / kEffortFadesRpm;
  return value_ != 0.0 ? kLimitAngle : 0U;
}

// Where neither a gain nor a loop of the speed is known: a push ends where the shaft is too fast, or may go
// no farther. Back it always acts.
double TargetShaper::effortTowards(double allowed_rpm, double sign,
                                   const MotorFeedback& feedback) const noexcept {
  if (config_.knowsBrakingEffort()) return effortFor(allowed_rpm, feedback);
  const bool slower = sign * (allowed_rpm - static_cast<double>(feedback.velocity_rpm)) > 0.0;
  return slower && sign * allowed_rpm > 0.0 ? sign * std::numeric_limits<double>::infinity() : 0.0;
}

double TargetShaper::effortFor(double allowed_rpm, const MotorFeedback& feedback) const noexcept {
  return allowed_rpm * static_cast<double>(config_.effort_per_rpm) +
         (allowed_rpm - static_cast<double>(feedback.velocity_rpm)) *
             static_cast<double>(config_.approach_effort_per_rpm);
}

std::uint32_t TargetShaper::shapeVelocity(Target& asked, const MotorFeedback& feedback, float dt_s) noexcept {
  const bool slews = config_.velocity_slew_rpm_per_s > 0.0F;
  const double goal_rpm =
      slews ? slewGoal(asked.value, value_, static_cast<double>(config_.velocity_limit_rpm)) : asked.value;
  std::uint32_t limits = goal_rpm != asked.value ? kLimitVelocity : 0U;
  if (slew(goal_rpm, config_.velocity_slew_rpm_per_s, dt_s)) limits |= kLimitSlew;
  if (bounded(feedback) || reduced()) {
    const Envelope allowed = allowedSpeeds(feedback);
    const double inside = std::clamp(value_, allowed.low_rpm, allowed.high_rpm);
    if (inside != value_) limits |= limitOf(inside);
    value_ = inside;
  }
  asked.value = value_;
  return limits;
}

// A shaft that was beyond a soft limit, where its stop is or where gravity had let it sag, comes back as its
// targets lead it, and not in one leap to the limit; never farther out than it is or is led. A load that
// pulls it back is held meanwhile. Inside, nothing leads out.
void TargetShaper::followFromOutside(const MotorFeedback& feedback) noexcept {
  const double here_deg = feedback.total_angle_deg;
  const double low_deg = std::max(travel_.low_deg, std::min(here_deg, value_));
  const double high_deg = std::min(travel_.high_deg, std::max(here_deg, value_));
  travel_.low_deg =
      here_deg < config_.angle_min_deg ? std::min(config_.angle_min_deg, low_deg) : config_.angle_min_deg;
  travel_.high_deg =
      here_deg > config_.angle_max_deg ? std::max(config_.angle_max_deg, high_deg) : config_.angle_max_deg;
}

// The nearest angle to the goal that is allowed; any turn of it if the turn does not matter.
double TargetShaper::reachable(double goal_deg, bool any_turn, const Travel& travel) const noexcept {
  const double inside = std::clamp(goal_deg, travel.low_deg, travel.high_deg);
  if (!any_turn || inside == goal_deg) return inside;
  const double other_way = goal_deg + std::copysign(kDegPerTurn, inside - goal_deg);
  const bool allowed = other_way >= config_.angle_min_deg && other_way <= config_.angle_max_deg;
  return allowed ? other_way : inside;
}

std::uint32_t TargetShaper::shapeAngle(Target& asked, const MotorFeedback& feedback, float dt_s) noexcept {
  if (soft_limits_) followFromOutside(feedback);
  if (bounded(feedback) || reduced() || config_.angle_slew_deg_per_s > 0.0F)
    return boundAngle(asked, feedback, dt_s);
  const double here_deg = feedback.total_angle_deg;
  value_ = asked.mode == ControlMode::kAngle ? here_deg + shortestAngle(here_deg, asked.value) : asked.value;
  return 0;
}

std::uint32_t TargetShaper::boundAngle(Target& asked, const MotorFeedback& feedback, float dt_s) noexcept {
  const bool limited = bounded(feedback);
  const bool any_turn = asked.mode == ControlMode::kAngle;
  // From here on in multi-turn angles: the shortest way may lead through what is not allowed.
  const double goal = any_turn ? value_ + shortestAngle(value_, asked.value) : asked.value;
  const double allowed = limited ? reachable(goal, any_turn, travel_) : goal;
  const double before_deg = value_;
  std::uint32_t limits = 0;
  if (any_turn ? wrapDegrees(allowed) != wrapDegrees(goal) : allowed != goal) {
    limits = kLimitAngle;
    asked.velocity_ff_rpm = 0.0F;  // it would lead on
  } else if (limited) {
    const Envelope towards = envelope(feedback.total_angle_deg);
    asked.velocity_ff_rpm = static_cast<float>(
        std::clamp(static_cast<double>(asked.velocity_ff_rpm), towards.low_rpm, towards.high_rpm));
  }
  if (slew(allowed, config_.angle_slew_deg_per_s, dt_s)) limits |= kLimitSlew;
  // A shaft that came back by itself, faster than the slew, is not led out again.
  if (limited) value_ = std::clamp(value_, travel_.low_deg, travel_.high_deg);
  if (any_turn) asked.mode = ControlMode::kTotalAngle;
  asked.value = value_;
  if (reduced()) limits |= shorten(asked, before_deg, feedback, dt_s);
  velocity_ff_rpm_ = static_cast<double>(asked.velocity_ff_rpm);  // its slew goes on from what limits leave
  return limits;
}

// Under a ceiling the angle moves no faster than the ceiling, and leads a shaft that moves towards it by no
// more than the distance at which the loop asks for that speed. A shaft that lags, or is pushed the other
// way, keeps the whole lead, and so its spring. When the ceiling begins, a target that runs on or is far away
// leads by a share of it. A motor with a velocity loop below the angle loop holds a load by itself, and is
// never led farther.
std::uint32_t TargetShaper::shorten(Target& shaped, double before_deg, const MotorFeedback& feedback,
                                    float dt_s) noexcept {
  const double asked_deg = value_;
  const double most_deg = ceiling_rpm_ * kDegPerSPerRpm * static_cast<double>(dt_s);
  value_ = std::clamp(value_, before_deg - most_deg, before_deg + most_deg);
  const double rpm_per_deg = static_cast<double>(config_.approach_rpm_per_deg / kApproachOfAngleGain);
  double ahead_deg = value_ - feedback.total_angle_deg;
  const double towards_rpm = std::copysign(1.0, ahead_deg) * static_cast<double>(feedback.velocity_rpm);
  const bool begins = std::exchange(enters_, false);
  if (rpm_per_deg > 0.0 && (begins || config_.lead_is_speed || towards_rpm > ceiling_rpm_ / 2)) {
    const double far_deg = ceiling_rpm_ / rpm_per_deg;
    // A target that moves on or is far away holds no load at its place.
    const bool runs = std::fabs(asked_deg - before_deg) > most_deg || std::fabs(ahead_deg) > far_deg;
    const double lead_deg = begins && runs ? kFirstLeadShare * far_deg : far_deg;
    ahead_deg = std::clamp(ahead_deg, -lead_deg, lead_deg);
    value_ = feedback.total_angle_deg + ahead_deg;
  }
  shaped.value = value_;
  // The speed that the angle leads to and that of the trajectory are one.
  const auto ff_rpm = static_cast<double>(shaped.velocity_ff_rpm);
  const double sign = std::copysign(1.0, ff_rpm);
  const double left_rpm = std::max(ceiling_rpm_ - sign * ahead_deg * rpm_per_deg, 0.0);
  if (std::fabs(ff_rpm) > left_rpm) shaped.velocity_ff_rpm = static_cast<float>(sign * left_rpm);
  return value_ != asked_deg || std::fabs(ff_rpm) > left_rpm ? kLimitVelocity : 0U;
}

}  // namespace rc10
