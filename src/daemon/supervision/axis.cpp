#include "daemon/supervision/axis.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/angle.hpp"
#include "motor/drive_configuring.hpp"

namespace rc10 {
namespace {

// A drive that has not confirmed its enable sequence by then has failed it: several steps, each sent again a
// few times.
constexpr Duration kEnableTimeout = std::chrono::seconds{2};
// A clear request goes out, and the answer comes back, at the slowest command_divider and feedback rate.
constexpr Duration kClearPatience = std::chrono::milliseconds{250};

// A shaft so near to its target is held there, sagging under its load.
constexpr double kThereDeg = 10.0;

// Drives that boot with the computer have answered by then.
constexpr Duration kFirstAnswer = std::chrono::seconds{3};

}  // namespace

Axis::Axis(const Robot::MotorEntry& entry, const Robot::BusEntry& bus) noexcept
    : entry_(entry),
      bus_(bus),
      motor_(*entry.motor),
      guard_(entry.guard),
      rest_(entry.rest),
      reduced_(entry.reduced),
      shaper_(entry.shaping),
      speeds_bounded_(limitsSpeed()) {}

void Axis::fill(MotorSnapshot& snapshot) const noexcept {
  snapshot.feedback = motor_.feedback();
  snapshot.target = motor_.target();
  snapshot.command_value = motor_.commandValue();
  snapshot.command_unit = motor_.commandUnit();
  snapshot.limits = motor_.limits() | limits_;
  snapshot.fault = fault_;
  snapshot.status = status_;
  snapshot.owner = lease_.client();
  snapshot.acting = acting();
  // A speed that bounds an effort is not in the unit of the target.
  const bool same_unit = needsReference(motor_.target().mode) || in_force_.mode == motor_.target().mode;
  snapshot.target_shaped = snapshot.acting == Acting::kTarget && same_unit
                               ? in_force_.value
                               : std::numeric_limits<double>::quiet_NaN();
  snapshot.command_received = lease_.received();
  snapshot.stop = stop_;
  snapshot.enabled_by = enabled_by_;
}

Acting Axis::acting() const noexcept {
  const auto ordered = motor_.ordered();
  if (ordered == FrameKind::kCommand) return ramps() ? Acting::kRamp : Acting::kTarget;  // most often
  switch (ordered) {
    case FrameKind::kHold: return Acting::kHold;
    case FrameKind::kDamp: return Acting::kDamp;
    case FrameKind::kBrake: return Acting::kBrake;
    // It waits for a place or a speed, and acts as far as others are concerned.
    case FrameKind::kIdle:
      return fallback_.kind() == FrameKind::kHold      ? Acting::kHold
             : fallback_.kind() == FrameKind::kCommand ? Acting::kRamp
                                                       : Acting::kNothing;
    case FrameKind::kCommand:
    case FrameKind::kRest:
    case FrameKind::kPoll:
    case FrameKind::kEnable:
    case FrameKind::kDisable: break;
  }
  return Acting::kNothing;
}

// ---- Feedback

bool Axis::listen(const Tick& tick, const Since& since) noexcept {
  const auto& feedback = motor_.feedback();
  const bool came = feedback.samples != samples_;
  samples_ = feedback.samples;
  const Duration age = tick.now - feedback.received;
  // Samples that are old when they come are not heard: they could be old for ever.
  const bool heard = came && age <= entry_.oldest_heard;
  restarted_ = heard && unheard_ >= entry_.restart_unheard && (isOn(status_) || fallback_.acts());
  if (!heard) {
    goUnheard(came, since);
    return fresh(tick);
  }
  unheard_ = age;
  pause_forgiven_ = false;
  on_since_heard_ = isOn(status_) || fallback_.acts();
  return !bus_.held && !restarted_;
}

// Only at rest: nothing is written to a drive that is on.
bool Axis::silenceExcused() noexcept {
  if (isOn(status_) || fallback_.acts()) return false;
  const auto* const configuring = motor_.driveConfiguring();
  return configuring != nullptr && configuring->excusesSilence();
}

// A sample of a pause could not be heard earlier. One pause is forgiven: later ones would hide a computer
// that never runs in time.
void Axis::goUnheard(bool came, const Since& since) noexcept {
  const bool could_speak = !since.simulation_late || !bus_.simulated;
  if (could_speak && !silenceExcused()) unheard_ += since.ran;
  if (!came || !(motor_.feedback().received > since.before)) return;
  if (!pause_forgiven_) unheard_ = {};
  pause_forgiven_ = true;
}

bool Axis::fresh(const Tick& tick) const noexcept {
  const auto& feedback = motor_.feedback();
  // Out of reach is as bad as unheard: whatever it was told last, it must be enabled anew.
  return !bus_.held && feedback.samples > 0 && tick.now - feedback.received <= entry_.feedback_timeout;
}

// After a pause of the process, or of the computer, what came meanwhile may be unread, and drives that answer
// were not asked. By the clock alone each such pause would be a fault of every motor.
bool Axis::lost(const Tick& tick) const noexcept {
  if (restarted_) return true;
  if (fresh(tick)) return false;
  return bus_.held || motor_.feedback().samples == 0 || unheard_ > entry_.most_unheard;
}

// A bus that carries nothing is itself the news, not its motors.
bool Axis::missesDrive(const Tick& tick) noexcept {
  if (missed_ || motor_.feedback().samples > 0) return false;
  if (first_tick_ == MonotonicTime{}) first_tick_ = tick.now;
  if (bus_.held || tick.now - first_tick_ < kFirstAnswer) return false;
  missed_ = true;
  return true;
}

bool Axis::standsStill() const noexcept {
  return std::fabs(motor_.feedback().velocity_rpm) < entry_.standstill_rpm;
}

// The last speed of a motor that was on says nothing: it may have begun to move since. One that its fallback
// resists, and that turns on after its time to run down, is pulled by a slope or a load: waiting does not end
// that, and the fallback goes on acting after the e-stop.
Refusal Axis::motionRefusal(const Tick& tick) const noexcept {
  if (fresh(tick)) {
    const bool pulled = fallback_.resistsFor(entry_.run_down, tick.now);
    return standsStill() || pulled ? Refusal::kNone : Refusal::kMoving;
  }
  const auto& feedback = motor_.feedback();
  if (feedback.samples == 0 || (standsStill() && !on_since_heard_)) return Refusal::kNone;
  return tick.now - feedback.received < entry_.run_down ? Refusal::kMayTurn : Refusal::kNone;
}

// ---- Once a tick

Axis::Loss Axis::noteReference(const Tick& tick) noexcept {
  const auto& feedback = motor_.feedback();
  // An absolute one may have been found again within this tick.
  const bool lost = reference_known_ && (!feedback.zeroed || feedback.losses != losses_);
  reference_known_ = feedback.zeroed;
  losses_ = feedback.losses;
  if (!lost) return Loss::kNone;
  if (!needsReference(motor_.target().mode)) return Loss::kReference;
  dropTarget();
  beginTimeoutFallback({StopCause::kReference}, tick);
  return Loss::kPlace;
}

void Axis::endPlace(const Stop& why, const Tick& tick) noexcept {
  if (status_ != MotorStatus::kActive || !needsReference(motor_.target().mode)) return;
  dropTarget();
  beginTimeoutFallback(why, tick);
}

// After a clear request an old one is ignored until the request can have taken effect.
std::optional<std::uint32_t> Axis::noteComplaint(const DriveComplaint& complaint, const Tick& tick) noexcept {
  if (status_ == MotorStatus::kOffline || status_ == MotorStatus::kFault) return std::nullopt;
  if (tick.now < clearing_until_) return std::nullopt;
  fault_ = complaint.fault;
  return complaint.native_code;
}

std::optional<MotorEvent> Axis::endsEnabling(const Tick& tick) const noexcept {
  if (status_ != MotorStatus::kEnabling) return std::nullopt;
  // The sequence runs in the motor from the tick in which it is first ordered; only then ask.
  // One that is held runs none: any answer since says that it obeys.
  const bool held = heldWhileEnabling() && motor_.feedback().received > enabling_since_ && fresh(tick);
  if (motor_.ordered() != FrameKind::kEnable && !held) return std::nullopt;
  switch (motor_.sequenceProgress()) {
    case SequenceProgress::kDone: return turnUnclear() ? MotorEvent::kEnableFailed : MotorEvent::kEnableDone;
    case SequenceProgress::kFailed: return MotorEvent::kEnableFailed;
    case SequenceProgress::kPending: break;
  }
  if (tick.now >= enable_deadline_) return MotorEvent::kEnableFailed;
  return std::nullopt;
}

Axis::Trip Axis::trips(bool reduced, const Tick& tick) noexcept {
  limits_ = 0;
  // A fallback that brakes or holds after an e-stop is a loop as well.
  const bool moves = status_ == MotorStatus::kActive ||
                     (status_ == MotorStatus::kReady && fallback_.acts()) || heldWhileEnabling();
  const Trip when_reduced = reduced_.any() ? tripsWhenReduced(reduced, moves, tick) : Trip::kNone;
  if (!moves) {
    guard_.reset();
    // Limits that a drive is told while it is enabled are already those of reduced mode.
    if (reduced_.any()) motor_.derate(reduced_.effortShare());
    // Before its drive answers its group may let go of it, and its fallback goes on.
    if (status_ != MotorStatus::kEnabling || !guard_.tooHot(motor_.feedback())) return Trip::kNone;
    fault_ = FaultCode::kOverheated;
    return Trip::kFault;
  }
  const auto verdict = guard_.step({.feedback = motor_.feedback(),
                                    .target = in_force_,
                                    .effort = motor_.commandValue(),
                                    .unit = motor_.commandUnit(),
                                    .limits = motor_.limits(),
                                    .now = tick.now});
  limits_ = verdict.limits;
  motor_.derate(std::min(verdict.derating, reduced_.effortShare()));
  const auto fault = verdict.fault != FaultCode::kNone ? verdict.fault
                     : when_reduced == Trip::kFault    ? FaultCode::kReducedSpeed
                                                       : FaultCode::kNone;
  if (fault == FaultCode::kNone) return when_reduced;
  fault_ = fault;
  return Trip::kFault;
}

Axis::Trip Axis::tripsWhenReduced(bool reduced, bool moves, const Tick& tick) noexcept {
  using Motion = ReducedMotion::Motion;
  // A resistance is not ended for a speed: a load would fall.
  const bool brakes = !fallback_.acts() && in_force_.mode == ControlMode::kBrake;
  const bool resists_it = brakes ? resists(FrameKind::kBrake, motor_.driveFrames())
                                 : fallback_.acts() && resists(fallback_.kind(), motor_.driveFrames());
  const Motion motion = !moves ? Motion::kNone : resists_it ? Motion::kResisted : Motion::kLed;
  const bool too_fast = reduced_.step(reduced, motion, motor_.feedback(), tick);
  shaper_.setCeiling(reduced_.ceilingRpm());
  if (!too_fast) return Trip::kNone;
  const FrameKind resistance = resistanceOf(motor_.driveFrames());
  if (!fallback_.acts() || resistance == FrameKind::kRest) return Trip::kFault;
  fallback_.giveWay(resistance);
  return Trip::kResists;
}

RestCheck::Verdict Axis::checkRest(const Tick& tick) noexcept {
  const auto ordered = motor_.ordered();
  const bool rests = ordered == FrameKind::kRest || ordered == FrameKind::kPoll ||
                     (ordered == FrameKind::kIdle && motor_.driveFrames().idle_rests);
  const auto verdict = rest_.step(motor_.feedback(), rests && fresh(tick), entry_.standstill_rpm);
  if (verdict == RestCheck::Verdict::kDriven && status_ != MotorStatus::kFault)
    fault_ = FaultCode::kNotAtRest;
  return verdict;
}

// A motor that is OFFLINE has to be enabled anyway before it moves.
bool Axis::yields() noexcept {
  if (status_ == MotorStatus::kOffline || status_ == MotorStatus::kFault) return false;
  fault_ = FaultCode::kForeignCommands;
  return true;
}

bool Axis::lapses(const Tick& tick) noexcept {
  if (!lease_.taken() || lease_.held(tick.now)) return false;
  const bool coasts = motor_.target().mode == ControlMode::kCoast;
  dropTarget();
  if (coasts) return false;
  beginTimeoutFallback({StopCause::kTimeout}, tick);
  return true;
}

void Axis::order(RobotStatus robot, const Tick& tick) noexcept {
  if (shaper_.hasSoftLimits()) shaper_.reckon(motor_.feedback(), tick.now);
  if (fallback_.acts()) {
    const auto& feedback = motor_.feedback();
    fallback_.step({standsStill(), feedback.total_angle_deg, feedback.received}, tick.now);
  }
  auto kind = frameKind(robot);
  if (awaitsFeedback(kind, tick)) kind = FrameKind::kIdle;
  if (kind == FrameKind::kHold && leadsHold(tick)) return;
  if (kind != FrameKind::kCommand) {
    shaper_.reset();
    in_force_ = Target{};
    motor_.order(kind);
    if (speeds_bounded_ || kind == FrameKind::kBrake) boundSpeeds(kind == FrameKind::kBrake, tick.now);
    return;
  }
  const bool ramps_down = ramps();
  in_force_ = ramps_down ? Target{.mode = ControlMode::kVelocity, .value = fallback_.rampRpm(tick.now)}
                         : motor_.target();
  // First, so that soft limits act in this tick already.
  if (!motor_.feedback().zeroed) motor_.restoreReference(in_force_.mode);
  const bool limited = (motor_.limits() & kLimitCurrent) != 0;
  const auto told =
      shaper_.follows(in_force_.mode) && !limited ? TargetShaper::InForce{} : commandInForce(limited);
  limits_ |= ramps_down ? shaper_.slowDown(in_force_, motor_.feedback(), told, tick.dt_s)
                        : shaper_.step(in_force_, motor_.feedback(), told, tick.dt_s);
  motor_.order(kind, in_force_);
  const bool stops = ramps_down || in_force_.mode == ControlMode::kBrake;
  if (stops || speeds_bounded_) boundSpeeds(stops, tick.now);
}

// After a pause a hold begins at a place, and a ramp at a speed, that is measured then, unless the shaft had
// no reason to leave the one of before it: a load would sink meanwhile.
bool Axis::beginsUnmeasured(FrameKind kind, const Tick& tick) noexcept {
  if (kind == FrameKind::kHold) return motor_.ordered() != FrameKind::kHold && !fresh(tick) && !stood();
  if (kind != FrameKind::kCommand || !ramps()) return false;
  const bool measured = fresh(tick);
  if (!measured && !stood()) return true;
  ramp_unmeasured_ = false;
  fallback_.rampFrom(measured ? static_cast<double>(finiteOr0(motor_.feedback().velocity_rpm)) : 0.0);
  return false;
}

bool Axis::stood() const noexcept {
  if (!standsStill()) return false;
  const auto ordered = motor_.ordered();
  if (ordered == FrameKind::kBrake || ordered == FrameKind::kDamp) return true;
  const double angle_deg = motor_.feedback().total_angle_deg;
  switch (in_force_.mode) {
    case ControlMode::kBrake: return true;
    case ControlMode::kVelocity: return in_force_.value == 0.0;
    case ControlMode::kAngle: return std::fabs(shortestAngle(angle_deg, in_force_.value)) < kThereDeg;
    case ControlMode::kTotalAngle: return std::fabs(in_force_.value - angle_deg) < kThereDeg;
    default: return false;
  }
}

// A loop that has wound up against a hand, or to brake a heavy wheel, would push on: past a soft limit,
// beyond reduced speed, or past the standstill of a stop and back.
void Axis::boundSpeeds(bool stops, MonotonicTime now) noexcept {
  const auto measured_rpm = static_cast<double>(finiteOr0(motor_.feedback().velocity_rpm));
  if (stops && !stops_) {
    stop_from_rpm_ = measured_rpm;
    dropWindup();
  }
  // A shaft that has slowed down is not driven up again.
  const double slowest_rpm = std::min(std::fabs(stop_from_rpm_), std::fabs(measured_rpm));
  stop_from_rpm_ = stop_from_rpm_ * measured_rpm > 0.0 ? std::copysign(slowest_rpm, measured_rpm) : 0.0;
  stops_ = stops;
  speeds_bounded_ = stops || limitsSpeed();
  const double from_rpm = ramps() ? fallback_.rampRpm(now) : stop_from_rpm_;
  motor_.boundSpeeds(shaper_.speedBounds(motor_.feedback(), stops ? std::optional{from_rpm} : std::nullopt,
                                         static_cast<double>(entry_.standstill_rpm)));
}

// A shaft that was pushed away from where it is held comes back no faster than reduced mode allows. Its first
// tick holds it where it is.
bool Axis::leadsHold(const Tick& tick) noexcept {
  const double held_deg = motor_.heldAngleDeg();
  if (!std::isfinite(reduced_.ceilingRpm()) || !std::isfinite(held_deg)) return false;
  if (held_deg != hold_goal_deg_) shaper_.reset();  // held anew, or zeroed
  hold_goal_deg_ = held_deg;
  Target place{.mode = ControlMode::kTotalAngle, .value = held_deg};
  limits_ |= shaper_.slowDown(place, motor_.feedback(), commandInForce(false), tick.dt_s);
  in_force_ = Target{};  // nothing that a client asked for
  motor_.orderHold(place.value);
  boundSpeeds(false, tick.now);
  return true;
}

TargetShaper::InForce Axis::commandInForce(bool limited) const noexcept {
  return {.value = motor_.commandValue(),
          .unit = motor_.commandUnit(),
          .limited = limited,
          .held_deg = motor_.heldAngleDeg(),
          .duty = motor_.reportedDuty()};
}

FrameKind Axis::frameKind(RobotStatus robot) const noexcept {
  if (status_ == MotorStatus::kActive && motor_.target().mode != ControlMode::kCoast)
    return FrameKind::kCommand;  // most often
  switch (status_) {
    case MotorStatus::kEnabling: return heldWhileEnabling() ? fallback_.kind() : FrameKind::kEnable;
    case MotorStatus::kActive: return fallback_.acts() ? fallback_.kind() : FrameKind::kIdle;
    case MotorStatus::kReady:
      if (fallback_.acts()) return fallback_.kind();
      break;
    case MotorStatus::kOffline:
    case MotorStatus::kFault: break;
  }
  const bool polls = motor_.driveFrames().poll == Provision::kFrame && robot != RobotStatus::kStopping;
  return polls ? FrameKind::kPoll : FrameKind::kRest;
}

// A drive that a fallback commands obeys already, since it was ACTIVE: an enable sequence would let go of its
// load, and leave it so in an e-stop that comes meanwhile.
bool Axis::heldWhileEnabling() const noexcept {
  return status_ == MotorStatus::kEnabling && fallback_.acts();
}

// ---- Changes

std::optional<MotorStatus> Axis::handle(MotorEvent event, RobotStatus robot, const Stop& stop,
                                        const Tick& tick) noexcept {
  const auto before = status_;
  // A motor that is held is on already: a request to rest does not depend on the tick in which it is ACTIVE.
  const bool rests_while_held = heldWhileEnabling() && (isDisable(event) || event == MotorEvent::kGroupStop);
  status_ = next(before, event);
  if (status_ == before) return std::nullopt;
  if (before == MotorStatus::kFault) {
    fault_ = FaultCode::kNone;
    rest_.reset();  // a drive that still does not rest is a fault again
  }
  if (isOn(status_)) stop_ = {};
  const bool stopped = isOn(before) && !isOn(status_);
  if (stopped || status_ == MotorStatus::kFault) stop_ = stop;
  if (status_ != MotorStatus::kActive) dropTarget();
  const bool rests = (before == MotorStatus::kActive || rests_while_held) && status_ == MotorStatus::kReady;
  if (rests && event == MotorEvent::kDisableUnasked && fallback_.acts()) {
    rested_ = Rested::kStayed;
    fallback_.disabled();
  } else if (rests) {
    rested_ = event == MotorEvent::kDisableUnasked ? Rested::kUnasked : Rested::kAsked;
    const auto& config = entry_.fallback;
    const bool asked = isDisable(event) || robot == RobotStatus::kStopping;
    const auto action = asked ? config.on_disable : config.on_estop;
    beginFallback(action, asked ? Fallback::Until::kStandstill : Fallback::Until::kEnded,
                  robot == RobotStatus::kEstop && event == MotorEvent::kEstop, tick);
  }
  // Without feedback there is nothing to brake by.
  if (status_ == MotorStatus::kOffline || status_ == MotorStatus::kFault) fallback_.end();
  return before;
}

// Somebody asks for it the first time where only a program's end had: that is no second disable. Nor is one
// in the tick of the first: a request may name this motor and one that rests already, which moves the same
// thing.
void Axis::disableOnceMore(const Tick& tick) noexcept {
  switch (std::exchange(rested_, Rested::kAsked)) {
    case Rested::kAsked:
      if (fallback_.begun() != tick.now) fallback_.end();
      return;
    case Rested::kUnasked: return;
    case Rested::kStayed:
      // Its hold may have ended since: then nothing begins anew.
      if (!fallback_.acts()) return;
      return beginFallback(entry_.fallback.on_disable, Fallback::Until::kStandstill, false, tick);
  }
}

void Axis::prepareEnabling(const Tick& tick) noexcept {
  dropTarget();  // an old target must not act after enabling
  shaper_.restart();
  on_since_heard_ = true;
  enabling_since_ = tick.now;
  enable_deadline_ = tick.now + kEnableTimeout;
}

void Axis::clearFault(const Tick& tick) noexcept {
  if (status_ != MotorStatus::kFault) return;
  motor_.clearComplaint();
  clearing_until_ = tick.now + kClearPatience;
}

std::optional<SkipReason> Axis::follow(const Target& target, MonotonicTime said, const Lease::Holder& sender,
                                       const Lease::Term& term) noexcept {
  const bool late = predatesEnabling(said);
  if (target.mode == ControlMode::kCoast) {
    if (late) return std::nullopt;
    // Letting go of a motor that is not held is no mistake: clients do it when they leave. While it is valid
    // it keeps others of a lower priority from moving the motor, as every setpoint does.
    motor_.clearTarget();
    if (status_ == MotorStatus::kActive) fallback_.end();
  } else {
    if (late) return SkipReason::kNotActive;
    if (const auto reason = whyNotNow(target)) return reason;
    if (!motor_.setTarget(target)) return SkipReason::kRefused;
    fallback_.end();
    stop_ = {};
  }
  lease_.take(sender, term);
  return std::nullopt;
}

std::optional<SkipReason> Axis::whySkipped(const Target& target) const noexcept {
  if (target.mode == ControlMode::kCoast) return std::nullopt;
  if (const auto reason = whyNotNow(target)) return reason;
  return motor_.acceptsTarget(target) ? std::nullopt : std::optional{SkipReason::kRefused};
}

std::optional<SkipReason> Axis::whyNotNow(const Target& target) const noexcept {
  if (status_ != MotorStatus::kActive) return SkipReason::kNotActive;
  if (needsReference(target.mode)) {
    if (!(std::fabs(target.value) <= kFarthestAngleDeg)) return SkipReason::kTooFar;
    if (!motor_.feedback().zeroed) return SkipReason::kNoReference;
    if (!shaper_.firstStepAllowed(target, motor_.target(), motor_.feedback())) return SkipReason::kFirstStep;
  }
  return std::nullopt;
}

bool Axis::mayReportSkip(MonotonicTime now) noexcept {
  if (now - last_skip_report_ < kReportInterval) return false;
  last_skip_report_ = now;
  return true;
}

// A motor that follows an angle would jump. A module that homes one knows that it does not.
Refusal Axis::zero(const Order& order) noexcept {
  const bool follows_angle = needsReference(motor_.target().mode) || needsReference(in_force_.mode);
  switch (status_) {
    case MotorStatus::kEnabling: return Refusal::kActive;
    case MotorStatus::kActive:
      if (!order.fromModule() || follows_angle) return Refusal::kActive;
      break;
    case MotorStatus::kOffline: return Refusal::kNoPosition;
    case MotorStatus::kReady:
    case MotorStatus::kFault: break;
  }
  if (motor_.setZero(order.value)) return Refusal::kNone;
  return motor_.feedback().samples == 0 ? Refusal::kNoPosition : Refusal::kOutOfReach;
}

double Axis::zeroForFile() const noexcept {
  const double travel_deg = entry_.shaping.angle_max_deg - entry_.shaping.angle_min_deg;
  const bool any_turn = std::isfinite(travel_deg) && travel_deg >= kDegPerTurn;
  return any_turn ? std::numeric_limits<double>::quiet_NaN() : motor_.zeroForFile();
}

// Asked for, so that it is no loss that anybody has to be told of.
void Axis::forgetReference() noexcept {
  motor_.forgetReference();
  reference_known_ = false;
}

void Axis::retune(const CascadeConfig& loops) noexcept {
  motor_.retune(loops);
  shaper_.setGains(loops.angle.kp, velocityKp(loops));
}

void Axis::dropTarget() noexcept {
  motor_.clearTarget();
  lease_.release();
}

void Axis::beginTimeoutFallback(const Stop& why, const Tick& tick) noexcept {
  stop_ = why;
  beginFallback(entry_.fallback.on_timeout, Fallback::Until::kEnded, false, tick);
}

// From what is measured, whatever the target was that it follows.
void Axis::beginFallback(FallbackAction action, Fallback::Until until, bool estop,
                         const Tick& tick) noexcept {
  const auto& config = entry_.fallback;
  const Fallback::Ramp ramp{static_cast<double>(finiteOr0(motor_.feedback().velocity_rpm)), config.ramp};
  ramp_unmeasured_ = action == FallbackAction::kRamp && !fresh(tick);
  fallback_.begin(action, until, boundOf(action, estop, config, motor_.driveFrames()), ramp, tick.now);
  shaper_.reset();
  stops_ = false;  // another stop, from now on
  dropWindup();
}

}  // namespace rc10
