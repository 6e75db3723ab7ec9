// Targets and requests of clients.
#include <algorithm>

#include "daemon/exchange/events.hpp"
#include "daemon/supervision/supervisor.hpp"

namespace rc10 {
namespace {

// A drive that has not confirmed its enable sequence by then has failed it: several steps, each sent again a
// few times.
constexpr Duration kEnableTimeout = std::chrono::seconds{2};
// A clear request goes out, and the answer comes back, at the slowest command_divider and feedback rate.
constexpr Duration kClearPatience = std::chrono::milliseconds{250};

}  // namespace

void Supervisor::receiveOrders(const Tick& tick) noexcept {
  const auto contact = link_.estop_contact.look(tick.dt_s);
  if (contact.news) report(estopInputEvent(*contact.news, tick.now));
  if ((link_.estop.exchange(false, std::memory_order_acquire) || contact.stop) &&
      state_ == RobotState::kRun) {
    setRobotState(RobotState::kEstop, tick);
  }
  // Only what is there now: a client that floods the ring must not lengthen the tick without bound.
  for (auto n = link_.orders.read_available(); n > 0; --n) {
    link_.orders.consume_one([&](const Order& order) { carryOut(order, tick); });
  }
  for (auto n = link_.refusals.read_available(); n > 0; --n) {
    link_.refusals.consume_one([&](const Event& refusal) {
      if (recorder_ != nullptr) recorder_->event(refusal);
    });
  }
  for (auto n = link_.commands.read_available(); n > 0; --n) {
    link_.commands.consume_one([&](const Command& command) { apply(command, tick); });
  }
}

bool Supervisor::takeModuleCommand(const Command& command, const Tick& tick) noexcept {
  const Lease::Holder sender{command.client, command.session, command.priority};
  if (!mayCommand(command, sender, tick)) return false;
  for (std::size_t i = 0; i < command.count; ++i) apply(command.setpoints[i], sender, command, tick);
  return true;
}

void Supervisor::takeModuleOrder(const Order& order, const Tick& tick) noexcept { carryOut(order, tick); }

void Supervisor::answer(const OrderResult& result) noexcept {
  if (result.id != Order::kFromModule) link_.results.push(result);
}

// A message acts whole or not at all: one motor that is held by another client is enough.
bool Supervisor::mayCommand(const Command& command, const Lease::Holder& sender, const Tick& tick) noexcept {
  for (std::size_t i = 0; i < command.count; ++i) {
    const auto motor = command.setpoints[i].motor;
    if (controls_[motor].lease.allows(sender, tick.now)) continue;
    ++refused_commands_;
    if (tick.now - last_refusal_report_ >= kReportInterval) {
      last_refusal_report_ = tick.now;
      report({EventCode::kNotOwner, Severity::kWarning, static_cast<std::int16_t>(motor), 0, 0, tick.now,
              command.client});
    }
    return false;
  }
  return true;
}

void Supervisor::apply(const Command& command, const Tick& tick) noexcept {
  if (tick.now >= command.deadline) {
    ++expired_commands_;
    if (recorder_ != nullptr) recorder_->command(command, blackbox::Verdict::kExpired);
    return;
  }
  const Lease::Holder sender{command.client, command.session, command.priority};
  if (!mayCommand(command, sender, tick)) {
    if (recorder_ != nullptr) recorder_->command(command, blackbox::Verdict::kNotOwner);
    return;
  }
  std::bitset<kMaxMotors> skipped;
  for (std::size_t i = 0; i < command.count; ++i) {
    const auto before = skipped_setpoints_;
    apply(command.setpoints[i], sender, command, tick);
    skipped.set(i, skipped_setpoints_ != before);
  }
  if (recorder_ != nullptr) recorder_->command(command, blackbox::Verdict::kApplied, skipped);
}

void Supervisor::apply(const Command::Setpoint& setpoint, const Lease::Holder& sender, const Command& command,
                       const Tick& tick) noexcept {
  auto& control = controls_[setpoint.motor];
  // Letting go of a motor that is not held is no mistake: clients do it when they leave. While it
  // is valid it keeps others of a lower priority from moving the motor, as every setpoint does.
  if (setpoint.target.mode == ControlMode::kCoast) {
    robot_.motors()[setpoint.motor].motor->clearTarget();
    if (control.status == MotorStatus::kActive) control.fallback.end();
    control.lease.take(sender, command.deadline);
    return;
  }
  if (const auto reason = tryTarget(setpoint)) {
    ++skipped_setpoints_;
    if (tick.now - last_skip_report_[setpoint.motor] < kReportInterval) return;
    last_skip_report_[setpoint.motor] = tick.now;
    report({EventCode::kSetpointSkipped, Severity::kWarning, static_cast<std::int16_t>(setpoint.motor),
            static_cast<std::int32_t>(*reason),
            static_cast<std::int32_t>(setpoint.target.mode) + 256 * static_cast<std::int32_t>(control.status),
            tick.now});
    return;
  }
  control.fallback.end();
  control.lease.take(sender, command.deadline);
}

// Why it does not act; nothing if it does.
std::optional<SkipReason> Supervisor::tryTarget(const Command::Setpoint& setpoint) noexcept {
  auto& entry = robot_.motors()[setpoint.motor];
  auto& motor = *entry.motor;
  if (controls_[setpoint.motor].status != MotorStatus::kActive) return SkipReason::kNotActive;
  if (needsReference(setpoint.target.mode)) {
    if (!motor.feedback().zeroed) return SkipReason::kNoReference;
    const bool first = !needsReference(motor.target().mode);
    if (first && !entry.shaper.firstStepAllowed(setpoint.target, motor.feedback()))
      return SkipReason::kFirstStep;
  }
  if (!motor.setTarget(setpoint.target)) return SkipReason::kRefused;
  return std::nullopt;
}

void Supervisor::carryOut(const Order& order, const Tick& tick) noexcept {
  if (recorder_ != nullptr) recorder_->order(order);
  if (order.operation == Operation::kConfigure) return configure(order, tick);
  OrderResult result;
  result.id = order.id;
  MotorSet waiting;
  if (order.operation == Operation::kEstop) {
    if (state_ == RobotState::kRun) setRobotState(RobotState::kEstop, tick);
  } else if (order.operation == Operation::kClear && state_ == RobotState::kEstop &&
             order.motors.count() == robot_.motors().size() && !clearEstop(result, tick)) {
    answer(result);
    return;
  }
  for (std::size_t motor = 0; motor < robot_.motors().size(); ++motor) {
    if (!order.motors.test(motor)) continue;
    switch (order.operation) {
      case Operation::kEnable:
      case Operation::kEnableAlone: {
        const bool alone = order.operation == Operation::kEnableAlone;
        const auto refusal = alone ? enableAlone(motor, tick) : enable(motor, tick);
        result.motors[motor] = refusal;
        result.in_the_way |= inTheWay(motor, refusal);
        const bool enabling = controls_[motor].status == MotorStatus::kEnabling;
        if (refusal == Refusal::kNone && enabling) waiting.set(motor);
        break;
      }
      case Operation::kDisable: disable(motor, tick); break;
      case Operation::kClear: clear(motor, tick); break;
      case Operation::kZero: result.motors[motor] = zero(motor, order); break;
      case Operation::kSetGains: result.motors[motor] = setGains(motor, order, tick); break;
      case Operation::kEstop:
      case Operation::kConfigure: break;
    }
  }
  if (waiting.any()) {
    const auto place =
        std::find_if(pending_.begin(), pending_.end(), [](const auto& p) { return !p.in_use; });
    if (place != pending_.end()) {
      *place = PendingOrder{result, waiting, true};
      return;
    }
    result.refused = true;  // more enable requests under way than anyone sends
  }
  answer(result);
}

// The e-stop is the whole robot's: clearing one motor's fault leaves it. False: some
// motor still turns, or the e-stop input is open.
bool Supervisor::clearEstop(OrderResult& result, const Tick& tick) noexcept {
  if (link_.estop_contact.open()) {
    result.motors.fill(Refusal::kEstopInput);
    return false;
  }
  bool at_rest = true;
  for (std::size_t motor = 0; motor < robot_.motors().size(); ++motor) {
    if (lost(motor, tick) || standsStill(motor)) continue;
    result.motors[motor] = Refusal::kMoving;
    at_rest = false;
  }
  if (at_rest) setRobotState(RobotState::kRun, tick);
  return at_rest;
}

void Supervisor::disable(std::size_t motor, const Tick& tick) noexcept {
  auto& control = controls_[motor];
  // Once more lets go of a motor that is still being held or braked.
  if (control.status == MotorStatus::kReady) control.fallback.end();
  if (control.group != kNoGroup) groups_[control.group].rearm.reset();
  transition(motor, MotorEvent::kDisable, tick);
}

Refusal Supervisor::enable(std::size_t motor, const Tick& tick) noexcept {
  if (state_ == RobotState::kEstop) return Refusal::kEstop;
  if (state_ == RobotState::kStopping) return Refusal::kStopping;
  if (configuring_ && configuring_->motor == motor) return Refusal::kConfiguring;
  if (alone_ && *alone_ != motor) return Refusal::kAlone;
  auto& control = controls_[motor];
  switch (control.status) {
    case MotorStatus::kOffline: return Refusal::kOffline;
    case MotorStatus::kFault: return Refusal::kFaulted;
    case MotorStatus::kReady:
      if (!groupWhole(motor)) return Refusal::kGroup;
      dropTarget(motor);  // an old target must not act after enabling
      control.enabling_since = tick.now;
      control.enable_deadline = tick.now + kEnableTimeout;
      transition(motor, MotorEvent::kEnable, tick);
      return Refusal::kNone;
    case MotorStatus::kEnabling:
    case MotorStatus::kActive: return Refusal::kNone;
  }
  return Refusal::kFaulted;
}

void Supervisor::clear(std::size_t motor, const Tick& tick) noexcept {
  auto& control = controls_[motor];
  if (control.status == MotorStatus::kFault) {
    robot_.motors()[motor].motor->clearComplaint();
    control.clearing_until = tick.now + kClearPatience;
  }
  transition(motor, MotorEvent::kClear, tick);
}

// A motor that follows an angle would jump. A module that homes one knows that it does not.
Refusal Supervisor::zero(std::size_t motor, const Order& order) noexcept {
  const bool follows_angle = needsReference(robot_.motors()[motor].motor->target().mode) ||
                             needsReference(controls_[motor].in_force.mode);
  switch (controls_[motor].status) {
    case MotorStatus::kEnabling: return Refusal::kActive;
    case MotorStatus::kActive:
      if (!order.fromModule() || follows_angle) return Refusal::kActive;
      break;
    case MotorStatus::kOffline: return Refusal::kNoPosition;
    case MotorStatus::kReady:
    case MotorStatus::kFault: break;
  }
  return robot_.motors()[motor].motor->setZero(order.value) ? Refusal::kNone : Refusal::kNoPosition;
}

}  // namespace rc10
