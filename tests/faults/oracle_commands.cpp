// Rules for commands: limits, slew, soft limits, fallbacks.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "daemon/supervision/states.hpp"
#include "faults/oracle.hpp"

namespace rc10::test {
namespace {

using namespace std::chrono_literals;

// Ticks in which a loop turns its effort round: it starts without a jump.
constexpr int kUnbrakedTicks = 300;
constexpr double kFarFromHoldDeg = 20.0;
constexpr double kFast = 0.3;  ///< Share of the no-load speed: a brake must oppose this.

// Share of the time of a ramp and of the full speed: feedback is younger or older than what the oracle sees.
constexpr double kRampSlack = 0.1;
// Standstill that a ramp waits for after its time; and a frame may be on its way.
constexpr Duration kRampEnd = 260ms;

// Time beyond `reduced_within_ms` for a drive that gets commands in some ticks only.
constexpr Duration kReducedSlack = 100ms;
// Time in which speed and effort come back when the mode input is closed (docs/gpio.md), and some.
constexpr Duration kFullAgain = 1700ms;

// An angle may be so far beyond a soft limit: rounding, and what the shaft has moved since the sample.
constexpr double kAngleSlackDeg = 1.0;

// A spring whose sum is at its limit is told a speed, and a place, on the way from the shaft's own to those
// that were wanted.
[[nodiscard]] bool followsShaft(const Told& told, double measured_rpm) {
  return told.law == Told::Law::kSpring && told.velocity_rpm * measured_rpm >= 0.0 &&
         std::fabs(told.velocity_rpm) <= std::fabs(measured_rpm) + told.velocity_step_rpm;
}

[[nodiscard]] bool slows(const Told& told, double measured_rpm) {
  return followsShaft(told, measured_rpm) && std::fabs(told.effort) <= told.effort_step;
}

// It stays where it is, as far as the drive can: without a speed or an effort of its own. A drive keeps its
// last frame when a cable tears: a damping with a speed would push then.
[[nodiscard]] bool staysPut(const Told& told, double measured_rpm) {
  if (told.resistsAtMost()) return true;
  const bool to_a_place = told.law == Told::Law::kAngle || (told.law == Told::Law::kSpring && told.stiff);
  const bool by_itself =
      std::fabs(told.velocity_rpm) <= told.velocity_step_rpm && std::fabs(told.effort) <= told.effort_step;
  return to_a_place && (by_itself || slows(told, measured_rpm));
}

// A VESC that is too fast for the shortest way to a place is slowed down first.
[[nodiscard]] bool brakesToHold(const Told& told, double measured_rpm) {
  return told.law == Told::Law::kVelocity && told.velocity_rpm * measured_rpm > 0.0 &&
         std::fabs(told.velocity_rpm) <= 0.5 * std::fabs(measured_rpm) + told.velocity_step_rpm;
}

}  // namespace

bool ofHost(const MotorConfig& config, FallbackAction action) {
  const auto& frames = config.traits().frames;
  // A ramp is a velocity: in the loop that brakes, too.
  const auto kind = action == FallbackAction::kRamp ? FrameKind::kBrake : frameKindOf(action);
  return frames.of(kind) == Provision::kHostLoop;
}

// It gets frames in its turn only, of ticks in which its bus carries frames.
bool Oracle::mayLag(const Motor& motor, std::uint64_t ticks) {
  const auto lag_ticks = static_cast<std::uint64_t>(motor.config->settings.command_divider);
  return std::min(ticks, motor.carried_ticks) < lag_ticks;
}

bool Oracle::damps(const Motor& motor) const {
  const double per_rpm = motor.wire->dampPerRpm();
  const double measured_rpm = motor.wire->measured().velocity_rpm;
  if (std::isnan(per_rpm)) return motor.told.resistsAtMost();
  const double bounded = std::clamp(-measured_rpm * per_rpm, -motor.limit, motor.limit);
  const double slack = 1.5 * motor.told.effort_step;
  if (std::fabs(motor.told.effort - bounded) <= slack) return true;
  // A hot motor gets less, and one whose effort comes back after reduced mode.
  const double reduced = isReduced(motor) ? static_cast<double>(motor.config->reduced.effort_share) : 1.0;
  const double share = motor.was_hot ? 0.0 : reduced;
  return motor.told.effort * bounded >= 0.0 && std::fabs(motor.told.effort) <= std::fabs(bounded) + slack &&
         std::fabs(motor.told.effort) >= std::min(std::fabs(bounded), share * motor.limit) - slack;
}

// Or its speed and effort come back.
bool Oracle::isReduced(const Motor& motor) const {
  return motor.config->reduced.any() && now_ - mode_last_open_ < kFullAgain;
}

void Oracle::judgeCommand(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& guard = motor.config->guard;
  const double celsius = motor.wire->measured().temperature_c;
  const bool watched = guard.temperature_trip_c > 0.0F && motor.config->traits().reports_temperature;
  const auto derate_c = static_cast<double>(guard.temperature_derate_c);
  // The limit is back at most 5 s after the motor is 3 C cooler (docs/safety.md).
  motor.cooled = motor.was_hot;
  if (watched && celsius > derate_c) motor.was_hot = true;
  motor.cool_periods = celsius <= derate_c - 3.0 ? motor.cool_periods + periods_ : 0;
  const double cool_s =
      static_cast<double>(seconds(config_.period())) * static_cast<double>(motor.cool_periods);
  if (cool_s > 5.1 && seen.status == MotorStatus::kActive) motor.was_hot = false;
  motor.cooled = motor.cooled && !motor.was_hot;
  judgeLimits(index);
  judgeTold(index, seen);
  judgeSlew(index, seen);
  judgeTargets(index, seen);
  judgeReduced(index, seen);
  if (lost(seen.status)) {
    require(index, mayLag(motor, motor.lost_ticks) || motor.told.rests(), "a command that is not rest");
    return;
  }
  if (motor.frames == 0) return;  // it was not its turn
  judgeSoftLimits(index, seen);
  if (watched && celsius >= static_cast<double>(guard.temperature_trip_c))
    require(index, motor.told.rests(), "driven although it is too hot");
  if (seen.target.mode == ControlMode::kCoast) judgeFallback(index, seen);
}

// Every field that can move the shaft, whatever the law. Of a spring its sum alone, so that a feed-forward
// may be beyond the limit while the damping opposes it.
void Oracle::judgeLimits(std::size_t index) {
  const auto& motor = motors_[index];
  const auto& told = motor.told;
  const double slack = told.effort_step + 1e-6 * motor.limit;
  if (told.law == Told::Law::kOff) return;
  if (told.law == Told::Law::kDuty) {
    require(index, std::fabs(told.effort) <= 1.0, "a duty of more than all");
  } else if (told.law != Told::Law::kSpring) {
    require(index, std::fabs(told.effort) <= motor.limit + slack, "beyond its limit");
  }
  const double rounded = told.sum_step + slack;
  const bool summed = told.law == Told::Law::kSpring && std::isfinite(told.sum) && motor.frames > 0;
  require(index, !summed || std::fabs(told.sum) <= motor.limit + rounded, "its sum is beyond its limit");
  const bool bounded = std::isfinite(told.most_effort);
  require(index, !bounded || told.most_effort <= motor.limit + slack + 1e-4 * motor.limit,
          "told a bound beyond its limit");
  const bool leads = std::isfinite(told.most_ahead_deg) && motor.frames > 0;
  require(index, !leads || std::fabs(told.ahead_deg) <= told.most_ahead_deg + told.ahead_step_deg,
          "the point of its velocity is too far ahead");
  const auto most_rpm = static_cast<double>(motor.config->settings.velocity_limit_rpm);
  if (most_rpm <= 0.0 || motor.frames == 0) return;  // its last frame was judged by what it knew
  const double slack_rpm = told.velocity_step_rpm + 1e-4 * most_rpm;
  const double measured_rpm = motor.wire->measured().velocity_rpm;
  const bool pushed_on = told.sum * std::copysign(1.0, measured_rpm) > rounded;
  const bool by_itself = std::fabs(told.effort) <= 2.0 * told.effort_step;
  const bool brakes = told.law == Told::Law::kSpring && (!pushed_on || !by_itself || told.stiff) &&
                      told.velocity_rpm * measured_rpm > 0.0;  // see followsShaft(); a feed-forward is a hole
  const double fastest_rpm = brakes ? std::max(most_rpm, std::fabs(measured_rpm)) : most_rpm;
  require(index, std::fabs(told.velocity_rpm) <= fastest_rpm + slack_rpm, "beyond its velocity limit");
  // Whole degrees a second, of the rotor or of the output.
  const bool way_bounded = std::isfinite(told.most_rpm);
  require(index, !way_bounded || told.most_rpm <= most_rpm + slack_rpm + 1.0 / 6.0,
          "told a bound beyond its velocity limit");
}

void Oracle::judgeTold(std::size_t index, const MotorSnapshot& seen) {
  const auto& motor = motors_[index];
  const auto& told = motor.told;
  if (motor.frames == 0 || motor.config->settings.command_divider > 1) return;
  const bool of_effort = seen.command_unit == CommandUnit::kAmpere || seen.command_unit == CommandUnit::kVolt;
  const auto value = static_cast<double>(seen.command_value);
  if (told.law == Told::Law::kEffort && of_effort && !std::isfinite(told.most_effort)) {
    require(index, std::fabs(value - told.effort) <= told.effort_step + 1e-5 * std::fabs(value),
            "the snapshot says another command than the frame");
  }
  if (told.law == Told::Law::kSpring && of_effort && std::isfinite(told.sum)) {
    if (std::fabs(value - told.sum) > told.sum_step + told.effort_step)
      fail(index, fmt::format("the snapshot says another sum than the frame, {:.3f}", value));
  }
}

// A current or a voltage rises no faster than allowed, whatever is asked and whatever has limited it before,
// and falls no faster either, but where soft limits, reduced mode or heat take it away or brake the shaft:
// that acts at once, and the end of a brake too. Fallbacks and loops change it as they like.
void Oracle::judgeSlew(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const bool follows =
      seen.status == MotorStatus::kActive && motor.told.law == Told::Law::kEffort &&
      (seen.target.mode == ControlMode::kCurrent || seen.target.mode == ControlMode::kVoltage);
  const auto& shaping = motor.config->shaping;
  const auto per_s = static_cast<double>(shaping.effort_slew_per_s);
  const bool soft = std::isfinite(shaping.angle_min_deg) || std::isfinite(shaping.angle_max_deg);
  const bool bounded = soft || isReduced(motor) || motor.was_hot || motor.cooled;
  constexpr std::uint64_t kMostPeriods = 5;  // of one tick
  motor.periods_untold += std::min(periods_, kMostPeriods);
  motor.followed_effort = motor.followed_effort && follows;
  if (motor.frames == 0) return;
  const double dt_s =
      static_cast<double>(seconds(config_.period())) * static_cast<double>(motor.periods_untold);
  const double most = per_s * dt_s + 2.0 * motor.told.effort_step;
  if (per_s > 0.0 && motor.followed_effort) {
    const double effort = motor.told.effort;
    const double change = effort - motor.effort_before;
    const bool brakes = effort * motor.wire->measured().velocity_rpm < 0.0;
    const double sign = std::copysign(1.0, effort);
    const double risen = std::fabs(effort) - std::max(sign * motor.effort_before, 0.0);
    const bool allowed = bounded ? risen <= most || brakes : std::fabs(change) <= most;
    if (!allowed) fail(index, fmt::format("its effort changes too fast, from {:.3f}", motor.effort_before));
    ++visits_.slewed;
  }
  motor.followed_effort = follows;
  motor.effort_before = motor.told.effort;
  motor.periods_untold = 0;
}

// Beyond a soft limit, and not on its way back, nothing pushes on: no effort, no speed, no angle.
void Oracle::judgeSoftLimits(std::size_t index, const MotorSnapshot& seen) {
  const auto& motor = motors_[index];
  const auto& shaping = motor.config->shaping;
  const auto& told = motor.told;
  const double angle_deg = seen.feedback.total_angle_deg;
  const bool limited = std::isfinite(shaping.angle_min_deg) || std::isfinite(shaping.angle_max_deg);
  const bool known =
      seen.status == MotorStatus::kActive && seen.target.mode != ControlMode::kCoast && seen.feedback.zeroed;
  if (!known || !limited) return;
  judgeLimitedPlace(index, seen);
  const bool above = angle_deg >= shaping.angle_max_deg && seen.feedback.velocity_rpm >= 0.0F;
  const bool below = angle_deg <= shaping.angle_min_deg && seen.feedback.velocity_rpm <= 0.0F;
  if (!above && !below) return;
  const double outwards = above ? 1.0 : -1.0;
  judgeFeedForward(index, outwards);
  const auto mode = seen.target.mode;
  const bool follows_effort =
      mode == ControlMode::kCurrent || mode == ControlMode::kVoltage || mode == ControlMode::kDuty;
  const bool follows_speed = mode == ControlMode::kVelocity;
  // A loop of rc10d tells an effort, which may hold a load there: of its speed the state tells.
  if (follows_speed && std::isfinite(seen.target_shaped)) {
    ++visits_.bounded;
    require(index, outwards * seen.target_shaped <= told.velocity_step_rpm + 1e-3,
            "its speed leads on beyond a soft limit");
  }
  // A drive whose speed of an effort is not known is told a speed in its place.
  const bool by_speed = told.law == Told::Law::kVelocity;
  if (!follows_effort && !(follows_speed && by_speed)) return;
  ++visits_.bounded;
  const double push = by_speed ? told.velocity_rpm : told.effort;
  const double step = by_speed ? told.velocity_step_rpm : told.effort_step;
  require(index, outwards * push <= step, "it is pushed on beyond a soft limit");
}

// As its frames tell it, of a spring, too, and as the state does. A shaft that is beyond a limit is held
// where its target has led it from its beginning.
void Oracle::judgeLimitedPlace(std::size_t index, const MotorSnapshot& seen) {
  const auto& motor = motors_[index];
  const auto& shaping = motor.config->shaping;
  const auto& told = motor.told;
  const double here_deg = seen.feedback.total_angle_deg;
  const auto& start = motor.track.fields[TargetTrack::kPlace].start;
  const bool above = here_deg > shaping.angle_max_deg - kAngleSlackDeg && !start.empty();
  const bool below = here_deg < shaping.angle_min_deg + kAngleSlackDeg && !start.empty();
  const double high_deg = std::max({shaping.angle_max_deg, here_deg, above ? start.high : here_deg});
  const double low_deg = std::min({shaping.angle_min_deg, here_deg, below ? start.low : here_deg});
  const double slack_deg = kAngleSlackDeg + told.ahead_step_deg;
  const auto within = [&](double place_deg) {
    ++visits_.bounded;
    return place_deg <= high_deg + slack_deg && place_deg >= low_deg - slack_deg;
  };
  const bool spring = told.law == Told::Law::kSpring && told.stiff;
  const bool of_now = seen.feedback.received == motor.heard_at;
  if ((told.law == Told::Law::kAngle || (spring && of_now)) && std::isfinite(told.ahead_deg)) {
    // Limits of its torque may move it past the shaft, where it pulls no more.
    const bool yields = spring && motor.track.limited_ticks > 0 && std::isfinite(told.sum) &&
                        told.sum * told.ahead_deg <= 0.0;
    require(index, yields || within(here_deg + told.ahead_deg), "sent to a place beyond a soft limit");
  }
  if (actsByPlace(seen.target) && std::isfinite(seen.target_shaped))
    require(index, within(seen.target_shaped), "led to a place beyond a soft limit");
}

// While the mode input is open, and the motor has had its time to come down: no more speed and effort are
// told than its file says, and it stays ACTIVE at none above.
void Oracle::judgeReduced(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& reduced = motor.config->reduced;
  const auto& frames = motor.config->traits().frames;
  const bool fast = std::fabs(seen.feedback.velocity_rpm) > reduced.velocity_rpm + reduced.tolerance_rpm;
  // An action that only resists is not taken away, and takes the place of a fallback that is dragged along.
  const bool brakes = seen.acting == Acting::kBrake || seen.target.mode == ControlMode::kBrake;
  const bool resisted = seen.acting == Acting::kDamp || (brakes && resists(FrameKind::kBrake, frames));
  const bool led = seen.target.mode == ControlMode::kCoast && motor.actions != only(FallbackAction::kCoast);
  if (reduced.velocity_rpm > 0.0F && mode_open_ && fast && led && resisted)
    motor.actions |= only(seen.acting == Acting::kDamp ? FallbackAction::kDamp : FallbackAction::kBrake);
  if (seen.status != MotorStatus::kActive || resisted) motor.active_since = now_;
  const MonotonicTime since = std::max(mode_open_since_, motor.active_since);
  // The tick after a pause may see it closed where this one does not yet.
  const bool may_lift = now_ - mode_last_open_ >= std::chrono::milliseconds{490};
  if (!reduced.any() || !mode_open_ || may_lift || now_ - since < reduced.within + kReducedSlack) {
    motor.fast_samples = 0;
    return;
  }
  const auto most_rpm = static_cast<double>(reduced.velocity_rpm);
  if (most_rpm > 0.0 && motor.new_sample) {
    motor.fast_samples = fast ? motor.fast_samples + 1 : 0;
    require(index, motor.fast_samples <= kFastSamples + 2, "it goes on, faster than reduced mode allows");
  }
  if (motor.frames == 0) return;
  ++visits_.reduced;
  const auto& told = motor.told;
  const bool by_speed = most_rpm > 0.0 && told.law == Told::Law::kVelocity;
  require(index,
          !by_speed || std::fabs(told.velocity_rpm) <= most_rpm + told.velocity_step_rpm + 1e-4 * most_rpm,
          "told more than its reduced speed");
  judgeReducedEffort(index);
}

// In every field that can move the shaft, as judgeLimits() has it for the whole limit.
void Oracle::judgeReducedEffort(std::size_t index) {
  const auto& motor = motors_[index];
  const auto& told = motor.told;
  if (motor.config->reduced.effort_share >= 1.0F) return;
  const double most = motor.limit * static_cast<double>(motor.config->reduced.effort_share);
  const double slack = told.effort_step + 1e-4 * motor.limit;
  const bool by_effort = told.law == Told::Law::kEffort;
  const bool by_sum = told.law == Told::Law::kSpring && std::isfinite(told.sum);
  const bool bounded = std::isfinite(told.most_effort);
  if (by_effort || by_sum || bounded) ++visits_.reduced_efforts;
  require(index, !by_effort || std::fabs(told.effort) <= most + slack, "told more than its reduced effort");
  require(index, !by_sum || std::fabs(told.sum) <= most + told.sum_step + slack,
          "told a sum of more than its reduced effort");
  require(index, !bounded || told.most_effort <= most + slack, "told a bound beyond its reduced effort");
}

// A field beside a speed, a place or a spring moves the shaft, too.
void Oracle::judgeFeedForward(std::size_t index, double outwards) {
  const auto& told = motors_[index].told;
  const bool beside =
      told.law == Told::Law::kVelocity || told.law == Told::Law::kAngle || told.law == Told::Law::kSpring;
  if (!beside) return;
  ++visits_.bounded;
  require(index, outwards * told.effort <= 2.0 * told.effort_step,
          "a torque feed-forward pushes on beyond a soft limit");
  if (told.law == Told::Law::kVelocity) return;
  // A spring that pulls back with all that it may is told a speed between the shaft's own and the one wanted.
  const double measured_rpm = motors_[index].wire->measured().velocity_rpm;
  const bool pulls_back = outwards * told.sum <= told.sum_step + told.effort_step;
  if (followsShaft(told, measured_rpm) && pulls_back) return;
  require(index, outwards * told.velocity_rpm <= told.velocity_step_rpm,
          "a velocity feed-forward leads on beyond a soft limit");
}

bool Oracle::fits(const Motor& motor, FallbackAction action) const {
  const auto& told = motor.told;
  const double measured_rpm = motor.wire->measured().velocity_rpm;
  switch (action) {
    case FallbackAction::kCoast:
      if (told.rests()) return true;
      return !motor.wire->idlesAtRest() && isOn(motor.status) && told.resistsAtMost();
    case FallbackAction::kDamp: return damps(motor);
    case FallbackAction::kBrake:
      if (resists(FrameKind::kBrake, motor.config->traits().frames)) return told.resistsAtMost();
      return motor.host_brakes || staysPut(told, measured_rpm);
    case FallbackAction::kHold:
      return motor.host_holds || staysPut(told, measured_rpm) || brakesToHold(told, measured_rpm);
    case FallbackAction::kRamp: return ramps(motor);
  }
  return false;
}

// No faster than in proportion to the time that is left; a loop of rc10d tells an effort, which its limits
// bound.
bool Oracle::ramps(const Motor& motor) const {
  if (motor.told.rests()) return true;
  if (motor.told.law == Told::Law::kEffort) return motor.host_brakes;
  if (motor.told.law != Told::Law::kVelocity && motor.told.law != Told::Law::kSpring) return false;
  const double left = 1.0 - static_cast<double>(seconds(now_ - motor.acts_since)) /
                                static_cast<double>(seconds(motor.config->fallback.ramp));
  const double most_rpm = std::fabs(motor.rpm_when_it_began) * std::max(left + kRampSlack, 0.0);
  // The no-load speed of some models is not known.
  const float full_rpm =
      std::max(motor.config->traits().no_load_rpm, motor.config->settings.velocity_limit_rpm);
  const double slack_rpm = motor.told.velocity_step_rpm + kRampSlack * static_cast<double>(full_rpm);
  return std::fabs(motor.told.velocity_rpm) <= most_rpm + slack_rpm;
}

void Oracle::judgeFallback(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& fallback = motor.config->fallback;
  auto actions = motor.actions;
  if (motor.began_unmeasured && fresh(motor)) {
    motor.rpm_when_it_began = motor.wire->measured().velocity_rpm;
    motor.began_unmeasured = false;
  }
  // A load that was held moves after that at the earliest.
  const bool holds = motor.actions == only(FallbackAction::kHold);
  const bool may_end = holds ? now_ - motor.acts_since >= fallback.hold_max + kSettled : motor.stood;
  if (motor.ends_at_standstill && may_end) actions |= only(FallbackAction::kCoast);
  const bool damps = motor.config->traits().frames.damp != Provision::kUnsupported;
  const auto bounded = [&](FallbackAction action, Duration most) {
    const auto bit = static_cast<std::size_t>(action);
    if (!actions.test(bit) || now_ - motor.acts_since < most) return;
    actions |= only(damps ? FallbackAction::kDamp : FallbackAction::kBrake);
    const bool ends = action == FallbackAction::kHold || (motor.of_estop && damps);
    if (ends && now_ - motor.acts_since >= most + 60ms) actions.reset(bit);
  };
  bounded(FallbackAction::kHold, fallback.hold_max);
  bounded(FallbackAction::kBrake, fallback.brake_max);
  constexpr auto kRamp = static_cast<std::size_t>(FallbackAction::kRamp);
  if (actions.test(kRamp) && now_ - motor.acts_since >= fallback.ramp) {
    actions |= only(FallbackAction::kCoast);
    if (now_ - motor.acts_since >= fallback.ramp + kRampEnd) actions.reset(kRamp);
  }
  if (state_ == RobotStatus::kStopping && now_ - stopping_since_ >= kLongestFallback)
    actions = only(FallbackAction::kCoast);
  bool any = false;
  std::string words;
  for (std::size_t i = 0; i < actions.size(); ++i) {
    if (!actions.test(i)) continue;
    const auto action = static_cast<FallbackAction>(i);
    any = any || fits(motor, action);
    words += fmt::format(" {}", wordOf(action));
  }
  if (!any && !mayLag(motor, tick_ - motor.acts_since_tick + 1))
    fail(index, "nobody commands it, and its command is not that of its fallback:" + words);
  judgeLettingGo(index, actions);
  judgeBrake(index, actions);
  judgeHold(index, seen, actions);
}

// Rest fits everything that only resists; a motor that is to hold, brake, damp or ramp is not let go for
// that. A loop of rc10d, and a damping that is an effort, give none where there is nothing to oppose.
void Oracle::judgeLettingGo(std::size_t index, Actions actions) {
  auto& motor = motors_[index];
  const bool one = actions.count() == 1 && actions != only(FallbackAction::kCoast);
  const bool lags = mayLag(motor, tick_ - motor.acts_since_tick + 1);
  if (!one || motor.was_hot || !fresh(motor) || lags) return;
  for (std::size_t i = 0; i < actions.size(); ++i)
    if (actions.test(i) && ofHost(*motor.config, static_cast<FallbackAction>(i))) return;
  ++visits_.kept;
  require(index, !motor.told.rests(), "its fallback lets go");
}

// A loop of rc10d that brakes opposes a fast motor before long.
void Oracle::judgeBrake(std::size_t index, Actions actions) {
  auto& motor = motors_[index];
  const double rpm = motor.wire->measured().velocity_rpm;
  const auto no_load_rpm = static_cast<double>(motor.config->traits().no_load_rpm);
  const bool fast = std::fabs(rpm) > kFast * no_load_rpm;
  const bool must_brake = actions == only(FallbackAction::kBrake) && !motor.was_hot && motor.host_brakes &&
                          motor.told.law == Told::Law::kEffort;
  const bool opposes = motor.told.effort * rpm < 0.0;
  // Its loop runs on new samples only.
  if (!must_brake || !fast || opposes) motor.unbraked_ticks = 0;
  if (must_brake && fast && !opposes && motor.new_sample) ++motor.unbraked_ticks;
  require(index, motor.unbraked_ticks < kUnbrakedTicks, "its brake does not act");
}

// And one that holds a shaft which is far from where that began, and comes no nearer. Where a reading leaps,
// its zero or its turn may be another one, and a motor that loses its place holds anew: the place is unknown
// until another hold begins.
void Oracle::judgeHold(std::size_t index, const MotorSnapshot& seen, Actions actions) {
  auto& motor = motors_[index];
  const bool acts = seen.acting == Acting::kHold;
  const bool must_hold = acts && actions == only(FallbackAction::kHold) && !motor.was_hot && motor.host_holds;
  const double here_deg = seen.feedback.total_angle_deg;
  const auto gap = seen.feedback.received - std::exchange(motor.held_at, seen.feedback.received);
  const double way_deg = std::fabs(here_deg - std::exchange(motor.last_deg, here_deg));
  const double rpm = std::fabs(motor.wire->measured().velocity_rpm);
  const bool follows =
      gap <= motor.config->feedback_timeout && way_deg <= 1.0 + 9.0 * rpm * static_cast<double>(seconds(gap));
  const auto losses = seen.feedback.losses + seen.feedback.jumps;
  const bool lost = losses != std::exchange(motor.held_losses, losses);
  if (!std::exchange(motor.held, acts)) motor.held_deg = here_deg + (misplaced_ == index ? 90.0 : 0.0);
  if (!acts || !follows || lost) motor.held_deg = kUnsaid;
  if (!must_hold || !motor.new_sample) return;
  const double away_deg = here_deg - motor.held_deg;
  const auto& told = motor.told;
  const double push = told.law == Told::Law::kVelocity ? told.velocity_rpm : told.effort;
  const bool opposes = push * away_deg < 0.0 || motor.wire->measured().velocity_rpm * away_deg < 0.0;
  if (std::fabs(away_deg) > kFarFromHoldDeg) ++visits_.held_far;
  const bool fails = std::fabs(away_deg) > kFarFromHoldDeg && !opposes;
  motor.unheld_ticks = fails ? motor.unheld_ticks + 1 : 0;
  require(index, motor.unheld_ticks < kUnbrakedTicks, "its hold does not act");
}

}  // namespace rc10::test
