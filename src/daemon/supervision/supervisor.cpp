#include "daemon/supervision/supervisor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rc10 {
namespace {

// A simulation that does nothing for so long has ended, and its drives are silent.
constexpr Duration kDeadSimulation = std::chrono::seconds{1};

}  // namespace

Supervisor::Supervisor(Robot& robot, LinkExchange& link, FlightRecorder* recorder)
    : robot_(robot), link_(link), recorder_(recorder) {
  for (const auto& config : robot.groups()) {
    Group group;
    group.on_return = config.on_return;
    for (const auto motor : config.motors) {
      group.members.set(motor);
      controls_[motor].group = groups_.size();
    }
    groups_.push_back(group);
  }
}

void Supervisor::decide(const Tick& tick) noexcept {
  watchSimulation(tick);
  for (std::size_t motor = 0; motor < robot_.motors().size(); ++motor) {
    watchFeedback(motor, tick);
    watchComplaint(motor, tick);
    watchEnabling(motor, tick);
    watchGuard(motor, tick);
    watchDeadline(motor, tick);
  }
  for (std::size_t group = 0; group < groups_.size(); ++group) watchGroup(group, tick);
  watchConfiguring(tick);
  for (std::size_t motor = 0; motor < robot_.motors().size(); ++motor) orderMotor(motor, tick);
}

void Supervisor::orderMotor(std::size_t motor, const Tick& tick) noexcept {
  auto& control = controls_[motor];
  auto& entry = robot_.motors()[motor];
  control.fallback.step(standsStill(motor), tick.now);
  const auto kind = frameKind(motor);
  if (kind != FrameKind::kCommand) {
    entry.shaper.reset();
    control.in_force = Target{};
    entry.motor->order(kind);
    return;
  }
  // First, so that soft limits act in this tick already.
  entry.motor->restoreReference(entry.motor->target().mode);
  const auto shaped = entry.shaper.step(entry.motor->target(), entry.motor->feedback(),
                                        entry.motor->commandValue(), tick.dt_s);
  control.limits |= shaped.limits;
  control.in_force = shaped.target;
  entry.motor->order(kind, shaped.target);
}

bool Supervisor::fresh(std::size_t motor, const Tick& tick) const noexcept {
  const auto& entry = robot_.motors()[motor];
  const auto& feedback = entry.motor->feedback();
  // Out of reach is as bad as unheard: whatever it was told last, it must be enabled anew.
  return !robot_.buses()[entry.bus].held && feedback.samples > 0 &&
         tick.now - feedback.received <= entry.feedback_timeout;
}

// After a pause of the process, or of the computer, what came meanwhile may be unread, and drives that answer
// were not asked. By the clock alone each such pause would be a fault of every motor.
bool Supervisor::lost(std::size_t motor, const Tick& tick) const noexcept {
  const auto& entry = robot_.motors()[motor];
  if (fresh(motor, tick)) return false;
  return robot_.buses()[entry.bus].held || entry.motor->feedback().samples == 0 ||
         controls_[motor].unheard_ticks > entry.feedback_timeout_ticks;
}

// Drives of a simulation whose thread had no processor are not silent: they make up for it.
void Supervisor::watchSimulation(const Tick& tick) noexcept {
  const auto steps = robot_.simulationSteps().load(std::memory_order_relaxed);
  if (steps != simulation_steps_) simulation_stepped_at_ = tick.now;
  simulation_late_ =
      steps != 0 && steps == simulation_steps_ && tick.now - simulation_stepped_at_ < kDeadSimulation;
  simulation_steps_ = steps;
}

void Supervisor::listen(std::size_t motor, const Tick& tick) noexcept {
  auto& control = controls_[motor];
  const auto& entry = robot_.motors()[motor];
  const auto& feedback = entry.motor->feedback();
  // Samples that are old when they come are not heard: they could be old for ever.
  const bool heard =
      feedback.samples != control.samples && tick.now - feedback.received <= entry.feedback_timeout / 2;
  const bool could_speak = !simulation_late_ || !robot_.buses()[entry.bus].simulated;
  if (could_speak) ++control.unheard_ticks;
  if (heard) control.unheard_ticks = 0;
  control.samples = feedback.samples;
}

bool Supervisor::standsStill(std::size_t motor) const noexcept {
  const auto& entry = robot_.motors()[motor];
  return std::fabs(entry.motor->feedback().velocity_rpm) < entry.standstill_rpm;
}

void Supervisor::watchFeedback(std::size_t motor, const Tick& tick) noexcept {
  const auto& entry = robot_.motors()[motor];
  const auto& feedback = entry.motor->feedback();
  listen(motor, tick);
  if (fresh(motor, tick)) transition(motor, MotorEvent::kFeedbackFresh, tick);
  if (lost(motor, tick)) transition(motor, MotorEvent::kFeedbackLost, tick);
  auto& control = controls_[motor];
  if (control.reference_known && !feedback.zeroed) {
    if (needsReference(entry.motor->target().mode)) {
      dropTarget(motor);
      beginTimeoutFallback(motor, tick);
    }
    report({EventCode::kReferenceLost, Severity::kWarning, static_cast<std::int16_t>(motor), 0, 0, tick.now});
  }
  control.reference_known = feedback.zeroed;
}

void Supervisor::watchEnabling(std::size_t motor, const Tick& tick) noexcept {
  auto& control = controls_[motor];
  if (control.status != MotorStatus::kEnabling) return;
  // The sequence runs in the motor from the tick in which it is first ordered; only then ask.
  auto& drive = *robot_.motors()[motor].motor;
  const bool held = heldWhileEnabling(motor) && tick.now > control.enabling_since;
  if (drive.ordered() != FrameKind::kEnable && !held) return;
  switch (drive.sequenceProgress()) {
    case SequenceProgress::kDone: transition(motor, MotorEvent::kEnableDone, tick); break;
    case SequenceProgress::kFailed: transition(motor, MotorEvent::kEnableFailed, tick); break;
    case SequenceProgress::kPending:
      if (tick.now >= control.enable_deadline) transition(motor, MotorEvent::kEnableFailed, tick);
      break;
  }
}

// Faults that the drive reports. After a clear request an old one is ignored until the request can have
// taken effect.
void Supervisor::watchComplaint(std::size_t motor, const Tick& tick) noexcept {
  auto& control = controls_[motor];
  if (control.status == MotorStatus::kOffline || control.status == MotorStatus::kFault) return;
  if (tick.now < control.clearing_until) return;
  const auto complaint = robot_.motors()[motor].motor->complaint();
  if (complaint.fault == FaultCode::kNone) return;
  control.fault = complaint.fault;
  report({EventCode::kMotorFault, Severity::kError, static_cast<std::int16_t>(motor),
          static_cast<std::int32_t>(complaint.fault), static_cast<std::int32_t>(complaint.native_code),
          tick.now});
  transition(motor, MotorEvent::kFault, tick);
}

void Supervisor::watchGuard(std::size_t motor, const Tick& tick) noexcept {
  auto& control = controls_[motor];
  auto& entry = robot_.motors()[motor];
  control.limits = 0;
  // A fallback that brakes or holds after an e-stop is a loop as well.
  const bool moves = control.status == MotorStatus::kActive ||
                     (control.status == MotorStatus::kReady && control.fallback.acts()) ||
                     heldWhileEnabling(motor);
  if (!moves) {
    entry.guard.reset();
    return;
  }
  const auto verdict = entry.guard.step({.feedback = entry.motor->feedback(),
                                         .target = control.in_force,
                                         .effort = entry.motor->commandValue(),
                                         .unit = entry.motor->commandUnit(),
                                         .limits = entry.motor->limits(),
                                         .now = tick.now});
  control.limits = verdict.limits;
  entry.motor->derate(verdict.derating);
  if (verdict.fault == FaultCode::kNone) return;
  control.fault = verdict.fault;
  report({EventCode::kMotorFault, Severity::kError, static_cast<std::int16_t>(motor),
          static_cast<std::int32_t>(verdict.fault), 0, tick.now});
  transition(motor, MotorEvent::kFault, tick);
}

void Supervisor::watchDeadline(std::size_t motor, const Tick& tick) noexcept {
  auto& control = controls_[motor];
  if (!control.lease.taken() || control.lease.held(tick.now)) return;
  const bool coasts = robot_.motors()[motor].motor->target().mode == ControlMode::kCoast;
  dropTarget(motor);
  if (coasts) return;
  beginTimeoutFallback(motor, tick);
  report({EventCode::kCommandTimeout, Severity::kWarning, static_cast<std::int16_t>(motor),
          static_cast<std::int32_t>(robot_.motors()[motor].fallback.on_timeout), 0, tick.now});
}

// A drive that needs no enabling is not let go for the tick in which its motor becomes ACTIVE.
bool Supervisor::heldWhileEnabling(std::size_t motor) const noexcept {
  const auto& control = controls_[motor];
  return control.status == MotorStatus::kEnabling && control.fallback.acts() &&
         robot_.motors()[motor].motor->driveFrames().enable == Provision::kNothing;
}

FrameKind Supervisor::frameKind(std::size_t motor) const noexcept {
  const auto& drive = *robot_.motors()[motor].motor;
  const auto& control = controls_[motor];
  const bool polls = drive.driveFrames().poll == Provision::kFrame && state_ != RobotState::kStopping;
  const auto rest = polls ? FrameKind::kPoll : FrameKind::kRest;
  switch (control.status) {
    case MotorStatus::kEnabling:
      return heldWhileEnabling(motor) ? control.fallback.kind() : FrameKind::kEnable;
    case MotorStatus::kActive:
      if (drive.target().mode != ControlMode::kCoast) return FrameKind::kCommand;
      return control.fallback.acts() ? control.fallback.kind() : FrameKind::kIdle;
    case MotorStatus::kReady: return control.fallback.acts() ? control.fallback.kind() : rest;
    case MotorStatus::kOffline:
    case MotorStatus::kFault: break;
  }
  return rest;
}

void Supervisor::beginTimeoutFallback(std::size_t motor, const Tick& tick) noexcept {
  const auto& config = robot_.motors()[motor].fallback;
  controls_[motor].fallback.begin(config.on_timeout, Fallback::Until::kEnded, config.hold_max, tick.now);
}

void Supervisor::beginFallback(std::size_t motor, MotorEvent cause, const Tick& tick) noexcept {
  const auto& config = robot_.motors()[motor].fallback;
  const bool asked = cause == MotorEvent::kDisable || state_ == RobotState::kStopping;
  controls_[motor].fallback.begin(asked ? config.on_disable : config.on_estop,
                                  asked ? Fallback::Until::kStandstill : Fallback::Until::kEnded,
                                  config.hold_max, tick.now);
}

void Supervisor::transition(std::size_t motor, MotorEvent event, const Tick& tick) noexcept {
  auto& control = controls_[motor];
  const auto before = control.status;
  const auto after = next(before, event);
  if (after == before) return;
  control.status = after;
  if (before == MotorStatus::kFault) control.fault = FaultCode::kNone;
  if (after != MotorStatus::kActive) dropTarget(motor);
  if (before == MotorStatus::kActive && after == MotorStatus::kReady) beginFallback(motor, event, tick);
  const bool was_alone = alone_ == motor;
  if (was_alone && !isOn(after)) alone_.reset();
  const bool lost = after == MotorStatus::kOffline || after == MotorStatus::kFault;
  if (lost) control.fallback.end();  // without feedback there is nothing to brake by
  // The group of one that was enabled alone rests already, and does not come back by itself.
  if (lost && before == MotorStatus::kActive && control.group != kNoGroup && !was_alone)
    groups_[control.group].lost.set(motor);
  if (before == MotorStatus::kEnabling) {
    settle(motor, after == MotorStatus::kActive     ? Refusal::kNone
                  : after == MotorStatus::kOffline  ? Refusal::kOffline
                  : after == MotorStatus::kFault    ? Refusal::kFaulted
                  : event == MotorEvent::kEstop     ? Refusal::kEstop
                  : event == MotorEvent::kGroupStop ? Refusal::kGroup
                                                    : Refusal::kDriveRefused);
  }
  const bool worrying =
      after == MotorStatus::kFault || (after == MotorStatus::kOffline && before == MotorStatus::kActive);
  report({EventCode::kMotorStatus, worrying ? Severity::kError : Severity::kInfo,
          static_cast<std::int16_t>(motor), static_cast<std::int32_t>(after),
          static_cast<std::int32_t>(before), tick.now});
}

// Answers every pending enable order for which this was the last motor.
void Supervisor::settle(std::size_t motor, Refusal outcome) noexcept {
  for (auto& pending : pending_) {
    if (!pending.in_use || !pending.waiting.test(motor)) continue;
    pending.result.motors[motor] = outcome;
    pending.waiting.reset(motor);
    if (pending.waiting.none()) {
      answer(pending.result);
      pending.in_use = false;
    }
  }
}

void Supervisor::setRobotState(RobotState state, const Tick& tick) noexcept {
  const auto before = state_;
  state_ = state;
  if (state != RobotState::kRun) {
    for (auto& group : groups_) group.rearm.reset();  // even if it is cleared within this tick
    for (std::size_t motor = 0; motor < robot_.motors().size(); ++motor) {
      transition(motor, MotorEvent::kEstop, tick);
    }
  }
  report({EventCode::kRobotState, state == RobotState::kEstop ? Severity::kError : Severity::kInfo, -1,
          static_cast<std::int32_t>(state), static_cast<std::int32_t>(before), tick.now});
}

void Supervisor::beginStop(const Tick& tick) noexcept {
  if (state_ != RobotState::kStopping) setRobotState(RobotState::kStopping, tick);
}

bool Supervisor::fallbackActs() const noexcept {
  return std::any_of(controls_.begin(), controls_.end(), [](const Control& c) { return c.fallback.acts(); });
}

void Supervisor::endFallbacks() noexcept {
  for (auto& control : controls_) control.fallback.end();
}

void Supervisor::dropTarget(std::size_t motor) noexcept {
  robot_.motors()[motor].motor->clearTarget();
  controls_[motor].lease.release();
}

void Supervisor::report(Event event) noexcept {
  if (recorder_ != nullptr) recorder_->event(event);
  if (!link_.events.push(event)) ++events_dropped_;
}

void Supervisor::fillSnapshot(Snapshot& snapshot) const noexcept {
  snapshot.state = state_;
  snapshot.expired_commands = expired_commands_;
  snapshot.refused_commands = refused_commands_;
  snapshot.skipped_setpoints = skipped_setpoints_;
  snapshot.events_dropped = events_dropped_;
  snapshot.motor_count = robot_.motors().size();
  for (std::size_t i = 0; i < snapshot.motor_count; ++i) {
    const auto& motor = *robot_.motors()[i].motor;
    auto& out = snapshot.motors[i];
    out.feedback = motor.feedback();
    out.target = motor.target();
    out.command_value = motor.commandValue();
    out.command_unit = motor.commandUnit();
    out.limits = motor.limits() | controls_[i].limits;
    out.fault = controls_[i].fault;
    out.status = controls_[i].status;
    out.owner = controls_[i].lease.client();
  }
}

}  // namespace rc10
