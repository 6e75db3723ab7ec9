// Rules for targets: slew of each field, soft start, the first angle, the turn at power-up, zero.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "daemon/supervision/states.hpp"
#include "faults/oracle.hpp"

namespace rc10::test {
namespace {

using Field = TargetTrack::Field;

constexpr std::array<const char*, TargetTrack::kFields> kFieldWords{
    "effort", "speed", "place", "velocity feed-forward", "torque feed-forward"};
constexpr double kDegPerSPerRpm = 6.0;
constexpr std::uint64_t kMostPeriods = 5;  // of one tick
// Share of rounding in a float.
constexpr double kRounded = 1e-5;
constexpr std::uint32_t kOtherLimits = kLimitCurrent | kLimitVelocity | kLimitAngle | kLimitTemperature;
// Nearer to the middle of the gap than this the turn is not guessed (docs/safety.md), and its rounding.
constexpr double kDoubtDeg = 1.0;
constexpr double kDoubtSlackDeg = 0.1;
// A shaft moves between the sample that an order was judged by and the one that is seen.
constexpr double kMovedSeconds = 0.01;
constexpr double kFarthestDeg = 1e12;
// Duty that a current takes beside that of the speed.
constexpr double kDutyOfCurrent = 0.2;
// Limits move what a spring is told; afterwards it goes on from where its slew has come meanwhile.
constexpr int kLimitedTicks = 20;

[[nodiscard]] bool isOfAngle(ControlMode mode) {
  return mode == ControlMode::kAngle || mode == ControlMode::kTotalAngle || mode == ControlMode::kImpedance;
}

[[nodiscard]] bool isOfEffort(ControlMode mode) {
  return mode == ControlMode::kCurrent || mode == ControlMode::kVoltage || mode == ControlMode::kDuty;
}

[[nodiscard]] double within(double value, double most) {
  return most > 0.0 ? std::clamp(value, -most, most) : value;
}

[[nodiscard]] double nearestTurn(double value, double turn, double to) {
  return turn > 0.0 && std::isfinite(to) ? value - turn * std::round((value - to) / turn) : value;
}

// A spring need not have led its shaft to its place.
[[nodiscard]] bool isLed(const Target& before, const Target& asked) {
  if (!actsByPlace(before)) return false;
  if (before.mode != ControlMode::kImpedance) return true;
  return asked.mode == ControlMode::kImpedance && asked.stiffness_nm_per_rad <= before.stiffness_nm_per_rad;
}

}  // namespace

// Torque at the output, as the effort that makes it.
double Oracle::effortOf(const Motor& motor, double output_nm) const {
  const auto traits = motor.config->traits();
  const auto& settings = motor.config->settings;
  const double turns = settings.gear_ratio > 0.0 ? settings.gear_ratio / traits.gear_ratio : 1.0;
  const double per_a = static_cast<double>(traits.torque_nm_per_a) * turns;
  if (per_a > 0.0) return output_nm / per_a;
  return output_nm == 0.0 ? 0.0 : std::copysign(motor.limit, output_nm);
}

void Oracle::followTargets(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  auto& track = motor.track;
  if (seen.status == MotorStatus::kEnabling && motor.status != MotorStatus::kEnabling) track.soft = {};
  const auto periods = static_cast<std::int64_t>(std::min(periods_, kMostPeriods));
  const double dt_s = static_cast<double>(seconds(periods * config_.period()));
  track.lapse(before_, now_);
  const bool acts = seen.status == MotorStatus::kActive && seen.target.mode != ControlMode::kCoast;
  const auto mode = acts ? seen.target.mode : ControlMode::kCoast;
  const bool begins = acts && mode != track.mode;
  const bool by_place = acts && actsByPlace(seen.target);
  if (by_place && !isLed(track.leads, seen.target)) judgeFirstAngle(index, seen);
  track.leads = by_place ? seen.target : Target{};
  const auto turn_ticks = static_cast<std::uint64_t>(motor.config->settings.command_divider);
  const auto ticks = mode != track.mode ? track.change(mode, tick_, turn_ticks) : 1;
  track.places.take(seen.feedback.total_angle_deg);
  track.came.clear();
  if (!acts) {
    followHold(track, seen);
    return;
  }
  require(index, !isOfAngle(mode) || std::fabs(seen.target.value) <= kFarthestDeg,
          "a target that is too far away to be told");
  track.soft += periods * config_.period();
  track.limited_ticks =
      (seen.limits & kOtherLimits) != 0 ? kLimitedTicks : std::max(0, track.limited_ticks - 1);
  const auto& shaping = motor.config->shaping;
  const auto speed_per_s = static_cast<double>(shaping.velocity_slew_rpm_per_s);
  const std::array<double, TargetTrack::kFields> per_s{
      0.0, speed_per_s, static_cast<double>(shaping.angle_slew_deg_per_s), speed_per_s,
      static_cast<double>(shaping.effort_slew_per_s)};
  const auto begun = beginnings(motor, seen);
  // A target that lapses may be followed by another one in the same tick. A motor begins one in its turn.
  if (begins || track.lapsed || motor.of_module) track.begin_ticks = turn_ticks;
  const bool may_begin = track.begin_ticks > 0;
  if (may_begin) --track.begin_ticks;
  for (std::size_t i = 0; i < TargetTrack::kFields; ++i) {
    auto& field = track.fields[i];
    field.pass(may_begin ? begun[i] : Span{}, per_s[i] * dt_s * static_cast<double>(ticks));
    if (may_begin) field.start.take(begun[i]);
  }
  followAsked(motor, seen);
  track.held = {};
  if (by_place || !isOfAngle(mode)) return;
  // With a stiffness it begins where the shaft is then.
  auto& place = track.fields[Field::kPlace];
  place = {};
  place.unread = true;
  place.start.take(seen.feedback.total_angle_deg);
}

// A hold does not let its load go: a place begins where the hold began, or nearer.
void Oracle::followHold(TargetTrack& track, const MotorSnapshot& seen) {
  if (seen.acting != Acting::kHold) {
    track.held = {};
    return;
  }
  const double moved_deg =
      std::fabs(static_cast<double>(seen.feedback.velocity_rpm)) * kDegPerSPerRpm * kMovedSeconds;
  track.held.take(seen.feedback.total_angle_deg, 1e-3 + (track.held.empty() ? moved_deg : 0.0));
}

// From what is measured, or goes on from the effort that acts, or from a ramp.
std::array<Span, TargetTrack::kFields> Oracle::beginnings(const Motor& motor, const MotorSnapshot& seen) {
  std::array<Span, TargetTrack::kFields> begun;
  const auto& track = motor.track;
  const auto& wire = motor.wire->measured();
  for (const auto field : {Field::kEffort, Field::kPush}) {
    begun[field].take(0.0);
    begun[field].take(track.effort_before);
    begun[field].take(track.value_before);
  }
  for (const auto field : {Field::kEffort, Field::kPush})
    begun[field].take(static_cast<double>(seen.feedback.current_a));
  if (seen.target.mode == ControlMode::kDuty) {
    // At that of the shaft's speed, and what the drive's current makes of it.
    const auto traits = motor.config->traits();
    const double turns =
        motor.config->settings.gear_ratio > 0.0 ? motor.config->settings.gear_ratio : traits.gear_ratio;
    const double no_load_rpm = static_cast<double>(traits.no_load_rpm) * traits.gear_ratio / turns;
    const bool known = no_load_rpm > 0.0;
    begun[Field::kEffort].take(known ? wire.velocity_rpm / no_load_rpm : 0.0, known ? kDutyOfCurrent : 1.0);
  }
  begun[Field::kSpeed].take(wire.velocity_rpm, wire.velocity_step_rpm);
  begun[Field::kSpeed].take(static_cast<double>(seen.feedback.velocity_rpm));
  if (motor.actions.test(static_cast<std::size_t>(FallbackAction::kRamp))) {
    begun[Field::kSpeed].take(0.0);
    begun[Field::kSpeed].take(track.speed_before);
    begun[Field::kSpeed].take(motor.rpm_when_it_began, wire.velocity_step_rpm);
  }
  begun[Field::kPlace].take(seen.feedback.total_angle_deg);
  if (!track.held.empty()) begun[Field::kPlace].take(track.held);
  begun[Field::kLead].take(0.0);
  return begun;
}

void Oracle::followAsked(Motor& motor, const MotorSnapshot& seen) const {
  auto& fields = motor.track.fields;
  const auto& target = seen.target;
  const auto most_rpm = static_cast<double>(motor.config->settings.velocity_limit_rpm);
  const double push = within(effortOf(motor, static_cast<double>(target.torque_ff_nm)), motor.limit);
  fields[Field::kPush].asked.take(push);
  fields[Field::kLead].asked.take(within(static_cast<double>(target.velocity_ff_rpm), most_rpm));
  if (target.mode == ControlMode::kDuty) fields[Field::kEffort].asked.take(within(target.value, 1.0));
  if (target.mode == ControlMode::kCurrent || target.mode == ControlMode::kVoltage)
    fields[Field::kEffort].asked.take(
        within(target.value + effortOf(motor, static_cast<double>(target.torque_ff_nm)), motor.limit));
  if (target.mode == ControlMode::kVelocity) fields[Field::kSpeed].asked.take(within(target.value, most_rpm));
  auto& place = fields[Field::kPlace];
  if (target.mode != ControlMode::kAngle) {
    place.asked.take(target.value);
    return;
  }
  // The shortest way, from where it was or begins; near the half turn, or where a soft limit closes that,
  // either.
  for (const double from : {seen.feedback.total_angle_deg, place.last.low, place.last.high}) {
    if (!std::isfinite(from)) continue;
    const double way = std::remainder(target.value - from, 360.0);
    place.asked.take(from + way);
    if (std::fabs(way) > 90.0) place.asked.take(from + way - std::copysign(360.0, way));
    if (!isBounded(motor, seen)) continue;
    place.asked.take(from + way - 360.0);
    place.asked.take(from + way + 360.0);
  }
}

// The first of several in a tick decides.
void Oracle::judgeFirstAngle(std::size_t index, const MotorSnapshot& seen) {
  const auto& motor = motors_[index];
  const double most_deg = motor.config->shaping.max_first_step_deg;
  const auto& track = motor.track;
  if (!std::isfinite(most_deg)) return;
  ++visits_.first_angles;
  const double slack =
      1e-6 + std::fabs(static_cast<double>(seen.feedback.velocity_rpm)) * kDegPerSPerRpm * kMovedSeconds;
  const auto near = [&](const Target& asked) {
    if (!actsByPlace(asked)) return false;
    const double here_deg = seen.feedback.total_angle_deg;
    const double way = asked.mode == ControlMode::kAngle ? std::remainder(asked.value - here_deg, 360.0)
                                                         : asked.value - here_deg;
    return std::fabs(way) <= most_deg + slack;
  };
  const bool any = near(seen.target) || std::any_of(track.came.begin(), track.came.end(), near);
  require(index, any, "a first angle farther away than max_first_step_deg");
}

// Torque beside a soft limit or in reduced mode brakes at once; beside a spring, what limits leave of that.
void Oracle::judgeField(std::size_t index, Field which, const FieldSeen& seen) {
  auto& motor = motors_[index];
  auto& field = motor.track.fields[which];
  const auto& shaping = motor.config->shaping;
  const auto soft_s = static_cast<double>(shaping.soft_start_s);
  const double share =
      soft_s > 0.0 ? std::min(1.0, static_cast<double>(seconds(motor.track.soft)) / soft_s) : 1.0;
  const double from = field.last.empty() ? field.fresh.high : field.last.high;
  const double value = nearestTurn(seen.value, seen.turn, from);
  const double slack = seen.slack + kRounded * std::fabs(value);
  if (seen.per_s > 0.0 && field.known()) {
    ++visits_.slewed_fields[which];
    const auto allows = [&](double turned) {
      return field.slewAllows(turned, seen.towards, seen.most, slack);
    };
    // Places of a whole turn may be allowed: then this one is by one of its names.
    if (!seen.brakes && !allows(value) && !allows(value - seen.turn) && !allows(value + seen.turn)) {
      const auto& span = field.last.empty() ? field.fresh : field.last;
      fail(index, fmt::format("its {} leaps to {:.3f}, and may be from {:.3f} to {:.3f}", kFieldWords[which],
                              value, span.low, span.high));
    }
  }
  if (share < 1.0) {
    ++visits_.softened[which];
    const double middle = field.softStart(share).middle();
    const double round = nearestTurn(value, seen.turn, middle);
    const double rounded = kRounded * std::max(std::fabs(field.start.low), std::fabs(field.asked.low));
    const auto allows = [&](double turned) {
      return field.softStartAllows(turned, share, seen.towards, seen.most, slack + rounded);
    };
    // A shaft that turned on since leads it more than half a turn from there.
    if (!seen.brakes && !allows(round) && !allows(value)) {
      fail(index,
           fmt::format("its {} is at {:.3f} after {:.3f} of its soft start, from {:.3f} to {:.3f}, asked "
                       "for {:.3f} to {:.3f}",
                       kFieldWords[which], value, share, field.start.low, field.start.high, field.asked.low,
                       field.asked.high));
    }
  }
  field.told(value, seen.limited, slack);
}

void Oracle::judgeTargets(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  if (motor.track.mode != ControlMode::kCoast) {
    if (motor.track.mode == ControlMode::kVelocity) judgeSpeed(index, seen);
    if (isOfAngle(motor.track.mode)) judgePlace(index, seen);
    if (motor.frames > 0) judgeEfforts(index, seen);
  }
  const bool of_effort = seen.command_unit == CommandUnit::kAmpere || seen.command_unit == CommandUnit::kVolt;
  motor.track.value_before = of_effort ? static_cast<double>(seen.command_value) : 0.0;
  if (motor.frames == 0) return;
  const auto& told = motor.told;
  const bool summed = told.law == Told::Law::kSpring && std::isfinite(told.sum);
  motor.track.effort_before = told.law == Told::Law::kDuty ? 0.0 : summed ? told.sum : told.effort;
  motor.track.speed_before = told.velocity_rpm;
}

bool Oracle::isBounded(const Motor& motor, const MotorSnapshot& seen) const {
  const auto& shaping = motor.config->shaping;
  const bool soft = std::isfinite(shaping.angle_min_deg) || std::isfinite(shaping.angle_max_deg);
  return (soft && seen.feedback.zeroed) || isReduced(motor) || motor.was_hot || motor.cooled;
}

// A loop of rc10d tells an effort alone: then as the snapshot tells its target.
void Oracle::judgeSpeed(std::size_t index, const MotorSnapshot& seen) {
  const auto& motor = motors_[index];
  const auto& told = motor.told;
  const auto& measured = motor.wire->measured();
  const bool spring = told.law == Told::Law::kSpring && !told.stiff && told.damped;
  const auto most_rpm = static_cast<double>(motor.config->settings.velocity_limit_rpm);
  FieldSeen field{.per_s = static_cast<double>(motor.config->shaping.velocity_slew_rpm_per_s),
                  .limited = (seen.limits & kOtherLimits) != 0};
  if (told.law == Told::Law::kEffort && motor.config->traits().host_loops != nullptr) {
    field.value = seen.target_shaped;
    field.slack = 1e-3;
  } else if (motor.frames > 0 && (told.law == Told::Law::kVelocity || spring)) {
    field.value = told.velocity_rpm;
    field.slack = 1e-3 + told.velocity_step_rpm + measured.velocity_step_rpm;
    if (most_rpm > 0.0) field.most = most_rpm;
  }
  if (!std::isfinite(field.value)) return;
  field.brakes = spring && motor.track.limited_ticks > 0;
  if (isBounded(motor, seen)) field.towards.take(0.0);
  if (spring) field.towards.take(measured.velocity_rpm);
  judgeField(index, Field::kSpeed, field);
}

void Oracle::judgePlace(std::size_t index, const MotorSnapshot& seen) {
  const auto& motor = motors_[index];
  const auto& told = motor.told;
  const auto& shaping = motor.config->shaping;
  const double here_deg = seen.feedback.total_angle_deg;
  if (std::fabs(here_deg) > kFarthestDeg) return;  // no number tells a way from there
  const bool spring = told.law == Told::Law::kSpring;
  const bool limited = (seen.limits & kOtherLimits) != 0;
  const bool of_place = told.law == Told::Law::kAngle || (spring && told.stiff);
  // A spring whose torque is limited is told the place that leaves it within.
  FieldSeen place{.per_s = static_cast<double>(shaping.angle_slew_deg_per_s),
                  .brakes = spring && motor.track.limited_ticks > 0,
                  .limited = limited};
  const bool tells = of_place && std::isfinite(told.ahead_deg);
  if (tells && motor.frames > 0 && seen.feedback.received == motor.heard_at) {
    place.value = here_deg + told.ahead_deg;
    place.slack = 1e-3 + told.ahead_step_deg;
    // A shaft that is pushed half a turn away has another shortest way.
    const bool any_turn = seen.target.mode == ControlMode::kAngle && !isBounded(motor, seen);
    place.turn = any_turn && place.per_s == 0.0 ? 360.0 : told.ahead_turn_deg;
  } else if (!tells && !spring) {
    place.value = seen.target_shaped;
    place.slack = 1e-3;
    place.turn = seen.target.mode == ControlMode::kAngle ? 360.0 : 0.0;
  }
  if (spring || told.led) place.towards.take(here_deg);
  if (!actsByPlace(seen.target)) place.value = kUnsaid;
  // A shaft that is farther out than its limits may be led back at once, and not out again.
  if (isBounded(motor, seen)) place.towards.take(motor.track.places);
  if (std::isfinite(place.value)) judgeField(index, Field::kPlace, place);
  if (motor.frames == 0 || !of_place || (spring && !told.damped)) return;
  FieldSeen lead{.value = told.velocity_rpm,
                 .slack = 1e-3 + told.velocity_step_rpm + motor.wire->measured().velocity_step_rpm,
                 .per_s = static_cast<double>(shaping.velocity_slew_rpm_per_s),
                 .limited = limited};
  if (spring) lead.towards.take(motor.wire->measured().velocity_rpm);
  if (isBounded(motor, seen) || spring) lead.towards.take(0.0);
  judgeField(index, Field::kLead, lead);
  const double most_rpm = place.per_s / kDegPerSPerRpm;
  const bool leads = place.per_s > 0.0 && !(spring && limited);
  require(index, !leads || std::fabs(told.velocity_rpm) <= most_rpm + lead.slack,
          "its velocity feed-forward is faster than its angle may move");
}

// The feed-forward, and the soft start of an effort; judgeSlew() has its slew.
void Oracle::judgeEfforts(std::size_t index, const MotorSnapshot& seen) {
  const auto& motor = motors_[index];
  const auto& told = motor.told;
  const auto mode = motor.track.mode;
  const bool bounded = isBounded(motor, seen);
  FieldSeen push{.value = told.effort,
                 .slack = 2.0 * told.effort_step + 1e-4 * motor.limit,
                 .brakes = (bounded && told.effort * motor.wire->measured().velocity_rpm < 0.0) ||
                           (told.law == Told::Law::kSpring && motor.track.limited_ticks > 0),
                 .limited = (seen.limits & kOtherLimits) != 0};
  if (bounded || push.limited) push.towards.take(0.0);
  if (isOfEffort(mode)) {
    if (told.law == Told::Law::kEffort || told.law == Told::Law::kDuty)
      judgeField(index, Field::kEffort, push);
    return;
  }
  const bool beside = told.law == Told::Law::kVelocity || told.law == Told::Law::kAngle ||
                      told.law == Told::Law::kSpring ||
                      (told.law == Told::Law::kEffort && mode == ControlMode::kImpedance);
  if (!beside) return;
  push.per_s = static_cast<double>(motor.config->shaping.effort_slew_per_s);
  judgeField(index, Field::kPush, push);
}

// A Damiao drive tells its turns later than its angle: the first angle counts, as long as it went on from
// there.
double Oracle::followPlace(TargetTrack& track, const MotorSnapshot& seen) {
  const double angle_deg = seen.feedback.total_angle_deg;
  const double gap_s = static_cast<double>(seconds(seen.feedback.received - track.place_at)) + kMovedSeconds;
  const double way_deg = std::fabs(static_cast<double>(seen.feedback.velocity_rpm)) * kDegPerSPerRpm * gap_s;
  const bool goes_on = !track.turn_known && std::fabs(angle_deg - track.place_deg) <= 1.0 + 1.5 * way_deg;
  if (!goes_on) track.first_deg = angle_deg;
  track.place_deg = seen.feedback.samples > 0 ? angle_deg : std::numeric_limits<double>::quiet_NaN();
  track.place_at = seen.feedback.received;
  return track.first_deg;
}

// With both limits the first angle lies in the travel and half of the gap on each side, or the turn is not
// known. A zero that was asked for and a homing give another one.
void Oracle::judgeTurn(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& config = *motor.config;
  const auto traits = config.traits();
  const bool absolute =
      traits.absolute && !config.settings.zero_at_power_on &&
      (config.settings.gear_ratio <= 0.0 || config.settings.gear_ratio == traits.gear_ratio);
  const bool begins = seen.feedback.zeroed && !motor.track.turn_known;
  const double first_deg = followPlace(motor.track, seen);
  motor.track.turn_known = seen.feedback.zeroed;
  const double travel_deg = config.shaping.angle_max_deg - config.shaping.angle_min_deg;
  if (!absolute || !std::isfinite(travel_deg)) return;
  const bool enabled = seen.status == MotorStatus::kActive && motor.status != MotorStatus::kActive;
  require(index, !enabled || !seen.feedback.turn_unclear, "enabled though its turn is not known");
  const bool homes = std::any_of(joints_.begin(), joints_.end(),
                                 [index](const Joint& joint) { return joint.motor == index; });
  if (!begins || motor.zero_asked || homes) return;
  require(index, travel_deg < 360.0, "a turn that nobody can know");
  const double moved_deg =
      std::fabs(static_cast<double>(seen.feedback.velocity_rpm)) * kDegPerSPerRpm * kMovedSeconds;
  const double free_deg = (360.0 - travel_deg) / 2.0 - kDoubtDeg + kDoubtSlackDeg + moved_deg;
  ++visits_.turns;
  const auto in_travel = [&](double angle_deg) {
    return angle_deg >= config.shaping.angle_min_deg - free_deg &&
           angle_deg <= config.shaping.angle_max_deg + free_deg;
  };
  require(index, in_travel(first_deg) || in_travel(seen.feedback.total_angle_deg),
          "it is on another turn than its travel");
}

// Answers come in the tick in which the order was carried out.
void Oracle::judgeZero(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto zeros = std::exchange(motor.zeros, {});
  if (zeros.empty()) return;
  const bool stays_on = isOn(motor.status) && isOn(seen.status) && motor.disables_asked == 0 && !estop_asked_;
  for (const auto& zero : zeros) {
    ++visits_.zeros;
    require(index, !zero.accepted || !stays_on, "a zero was set while it was enabled");
    require(index, !zero.accepted || seen.feedback.samples > 0, "a zero was set without feedback");
  }
  motor.held_deg = kUnsaid;  // it is called otherwise now
  const auto& last = zeros.back();
  const double off_deg = std::fabs(seen.feedback.total_angle_deg - last.value_deg);
  require(index, !last.accepted || off_deg <= 1e-6 + 1e-9 * std::fabs(last.value_deg),
          "its angle is not the one that its zero was set to");
}

}  // namespace rc10::test
