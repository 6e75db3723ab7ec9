// Targets and requests of clients.
#include <algorithm>
#include <utility>

#include "daemon/exchange/events.hpp"
#include "daemon/supervision/supervisor.hpp"

namespace rc10 {
namespace {

// A mode input that flutters, as a loose wire does, counts as open: neither the way down nor the monitored
// time of reduced mode begins anew each time.
constexpr Duration kSteadilyClosed = std::chrono::milliseconds{500};

[[nodiscard]] Lease::Term termOf(const Command& command) noexcept {
  return {command.received, command.deadline};
}

}  // namespace

void Supervisor::receiveOrders(const Tick& tick) noexcept {
  client_silent_.step(tick);
  const auto contact = link_.estop_contact.look(tick.dt_s);
  if (contact.news) report(estopInputEvent(*contact.news, tick.now));
  if (contact.opened) estop({StopCause::kInput}, tick);
  const auto mode = link_.mode_contact.look(tick.dt_s);
  if (mode.news) report(modeInputEvent(*mode.news, tick.now));
  if (mode.opened) mode_opened_ = tick.now;
  reduced_ = mode.opened || (reduced_ && tick.now - mode_opened_ < kSteadilyClosed);
  if (link_.estop.exchange(false, std::memory_order_acquire))
    estop({StopCause::kRequest, link_.estop_client.read()}, tick);
  if (link_.estop_datagram.exchange(false, std::memory_order_acquire))
    estop({StopCause::kRequest, link_.estop_datagram_client.read()}, tick);
  // Only what is there now: a client that floods the ring must not lengthen the tick without bound.
  for (auto n = link_.orders.read_available(); n > 0; --n) {
    link_.orders.consume_one([&](const Order& order) { carryOut(order, tick); });
  }
  for (auto n = link_.refusals.read_available(); n > 0; --n) {
    link_.refusals.consume_one([&](const Event& refusal) {
      if (recorder_ != nullptr) recorder_->event(refusal);
    });
  }
  std::size_t setpoints = 0;
  for (auto n = link_.commands.read_available(); n > 0 && setpoints < kSetpointsPerTick; --n) {
    link_.commands.consume_one([&](const Command& command) {
      setpoints += command.count;
      apply(command, tick);
    });
  }
}

bool Supervisor::takeModuleCommand(const Command& command, const Tick& tick) noexcept {
  const Lease::Holder sender{command.client, command.session, command.priority};
  if (!mayCommand(command, sender, tick)) return false;
  // Motors of a module are one mechanism: half of its targets would rack it.
  for (std::size_t i = 0; i < command.count; ++i) {
    const auto& setpoint = command.setpoints[i];
    const auto reason = whySkipped(setpoint);
    if (reason) skip(setpoint, *reason, tick);
    if (reason || followsThePast(setpoint, command)) {
      letGo(command, sender, tick);
      return true;
    }
  }
  for (std::size_t i = 0; i < command.count; ++i) (void)follow(command.setpoints[i], sender, command, tick);
  return true;
}

// Inputs of a module from before its motor was enabled: that is no mistake of the module.
bool Supervisor::followsThePast(const Command::Setpoint& setpoint, const Command& command) const noexcept {
  return setpoint.target.mode != ControlMode::kCoast && axes_[setpoint.motor].predatesEnabling(command.said);
}

// Letting go is never withheld.
void Supervisor::letGo(const Command& command, const Lease::Holder& sender, const Tick& tick) noexcept {
  for (std::size_t i = 0; i < command.count; ++i) {
    if (command.setpoints[i].target.mode == ControlMode::kCoast)
      (void)follow(command.setpoints[i], sender, command, tick);
  }
}

void Supervisor::takeModuleOrder(const Order& order, const Tick& tick) noexcept { carryOut(order, tick); }

void Supervisor::answer(const OrderResult& result) noexcept {
  if (result.id != Order::kFromModule) link_.results.push(result);
}

// A message acts whole or not at all: one motor that is held by another client is enough. An end acts for
// those that its sender holds.
bool Supervisor::mayCommand(const Command& command, const Lease::Holder& sender, const Tick& tick) noexcept {
  const auto term = termOf(command);
  if (term.ends()) return true;
  for (std::size_t i = 0; i < command.count; ++i) {
    const auto motor = command.setpoints[i].motor;
    if (axes_[motor].allows(sender, term, tick.now)) continue;
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
  hearClient();
  const Lease::Holder sender{command.client, command.session, command.priority};
  if (tick.now >= command.deadline) {
    ++expired_commands_;
    if (recorder_ != nullptr) recorder_->command(command, blackbox::Verdict::kExpired);
    for (std::size_t i = 0; i < command.count; ++i)
      axes_[command.setpoints[i].motor].outdate(sender, command.deadline);
    return;
  }
  if (!mayCommand(command, sender, tick)) {
    if (recorder_ != nullptr) recorder_->command(command, blackbox::Verdict::kNotOwner);
    return;
  }
  const MotorSet held_back = heldBackBy(command);
  std::bitset<kMaxMotors> skipped;
  for (std::size_t i = 0; i < command.count; ++i) {
    const auto& setpoint = command.setpoints[i];
    if (held_back.test(setpoint.motor) && setpoint.target.mode != ControlMode::kCoast) {
      skip(setpoint, whySkipped(setpoint).value_or(SkipReason::kGroup), tick);
      skipped.set(i);
    } else {
      skipped.set(i, !follow(setpoint, sender, command, tick));
    }
  }
  if (recorder_ != nullptr) recorder_->command(command, blackbox::Verdict::kApplied, skipped);
}

// A message that one motor of a group cannot follow moves none of the group: half of it would rack the load.
MotorSet Supervisor::heldBackBy(const Command& command) const noexcept {
  MotorSet held_back;
  if (groups_.empty()) return held_back;  // most often
  for (std::size_t i = 0; i < command.count; ++i) {
    const auto& setpoint = command.setpoints[i];
    const auto* group = groupOf(setpoint.motor);
    if (group == nullptr || !group->together || !group->required.test(setpoint.motor)) continue;
    if (alone_ && groupOf(*alone_) == group) continue;
    if (!whySkipped(setpoint) && !followsThePast(setpoint, command)) continue;
    for (const auto member : group->motors) held_back.set(member);
  }
  return held_back;
}

// A COAST before all of a group are ACTIVE would free those that are, while the others still hold the load.
bool Supervisor::waits(const Command::Setpoint& setpoint) const noexcept {
  if (groups_.empty()) return false;  // most often
  const auto& axis = axes_[setpoint.motor];
  if (axis.status() != MotorStatus::kActive) return false;
  const bool lets_go = setpoint.target.mode == ControlMode::kCoast;
  if (waitsForGroup(setpoint.motor)) return !lets_go || axis.fallbackActs();
  return needsReference(setpoint.target.mode) && groupLostPlace(setpoint.motor);
}

std::optional<SkipReason> Supervisor::whySkipped(const Command::Setpoint& setpoint) const noexcept {
  return waits(setpoint) ? SkipReason::kGroup : axes_[setpoint.motor].whySkipped(setpoint.target);
}

bool Supervisor::follow(const Command::Setpoint& setpoint, const Lease::Holder& sender,
                        const Command& command, const Tick& tick) noexcept {
  const auto term = termOf(command);
  if (term.ends() && !axes_[setpoint.motor].allows(sender, term, tick.now)) {
    ++skipped_setpoints_;
    return false;
  }
  const auto reason = waits(setpoint)
                          ? SkipReason::kGroup
                          : axes_[setpoint.motor].follow(setpoint.target, command.said, sender, term);
  if (reason) skip(setpoint, *reason, tick);
  return !reason;
}

void Supervisor::skip(const Command::Setpoint& setpoint, SkipReason reason, const Tick& tick) noexcept {
  auto& axis = axes_[setpoint.motor];
  ++skipped_setpoints_;
  if (!axis.mayReportSkip(tick.now)) return;
  report({EventCode::kSetpointSkipped, Severity::kWarning, static_cast<std::int16_t>(setpoint.motor),
          static_cast<std::int32_t>(reason), ExtraPair{setpoint.target.mode, axis.status()}.extra(),
          tick.now});
}

void Supervisor::carryOut(const Order& order, const Tick& tick) noexcept {
  if (recorder_ != nullptr) recorder_->order(order);
  if (!order.fromModule()) hearClient();
  if (order.operation == Operation::kConfigure) return configure(order, tick);
  if (order.operation == Operation::kScan) return scan(order, tick);
  OrderResult result;
  result.id = order.id;
  MotorSet waiting;
  const bool enables = order.operation == Operation::kEnable || order.operation == Operation::kEnableAlone;
  // Modules wait for no answer.
  const bool may_wait = enables && !order.fromModule();
  if (may_wait && pending_.full()) {
    result.refused = true;
    answer(result);
    return;
  }
  if (order.operation == Operation::kEstop) {
    estop({StopCause::kRequest, order.client}, tick);
  } else if (order.operation == Operation::kClear && state_ == RobotStatus::kEstop && order.whole_robot &&
             !clearEstop(order, result, tick)) {
    answer(result);
    return;
  }
  result.estop_stays = order.operation == Operation::kClear && state_ == RobotStatus::kEstop;
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    if (!order.motors.test(motor)) continue;
    switch (order.operation) {
      case Operation::kEnable:
      case Operation::kEnableAlone: {
        const bool alone = order.operation == Operation::kEnableAlone;
        const bool was_on = isOn(axes_[motor].status());
        const auto refusal = alone ? enableAlone(motor, tick) : enable(motor, order.motors, tick);
        result.motors[motor] = refusal;
        const bool switched_on = !was_on && refusal == Refusal::kNone;
        result.switched_on.set(motor, switched_on);
        if (switched_on) axes_[motor].noteEnabledBy(order.id);
        result.in_the_way |= inTheWay(motor, refusal, order.motors);
        const bool enabling = axes_[motor].status() == MotorStatus::kEnabling;
        if (refusal == Refusal::kNone && enabling) waiting.set(motor);
        break;
      }
      case Operation::kDisable: disable(motor, order, tick); break;
      case Operation::kClear: clear(motor, tick); break;
      case Operation::kZero:
        result.motors[motor] = axes_[motor].zero(order);
        if (order.motors.count() == 1) result.zero_deg = axes_[motor].zeroForFile();
        break;
      case Operation::kSetGains: result.motors[motor] = setGains(motor, order, tick); break;
      case Operation::kEstop:
      case Operation::kConfigure:
      case Operation::kGetConfig:
      case Operation::kDriveSettings:
      case Operation::kHand:
      case Operation::kLoad:
      case Operation::kScan: break;
    }
  }
  if (waiting.none()) return answer(result);
  if (may_wait) pending_.add(result, waiting);
}

void Supervisor::estop(const Stop& why, const Tick& tick) noexcept {
  estop_asked_ = true;
  if (state_ == RobotStatus::kRun) setRobotState(RobotStatus::kEstop, why, tick);
  // The end of the program goes on; what holds a motor meanwhile is what an e-stop begins, once.
  if (state_ != RobotStatus::kStopping || std::exchange(estop_in_force_, true)) return;
  estop_began_ = tick.now;
  for (auto& axis : axes_) axis.estopFallback(tick);
}

// The e-stop is the whole robot's: clearing the faults of motors leaves it, even of all that there are.
// False: it stays, and the result says why.
bool Supervisor::clearEstop(const Order& order, OrderResult& result, const Tick& tick) noexcept {
  if (link_.estop_contact.open()) {
    result.motors.fill(Refusal::kEstopInput);
    return false;
  }
  if (estop_asked_) {
    result.motors.fill(Refusal::kEstopAsked);
    return false;
  }
  bool at_rest = true;
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    result.motors[motor] = axes_[motor].motionRefusal(tick);
    if (result.motors[motor] != Refusal::kNone) at_rest = false;
  }
  if (at_rest) setRobotState(RobotStatus::kRun, {StopCause::kNone, order.client}, tick);
  return at_rest;
}

void Supervisor::disable(std::size_t motor, const Order& order, const Tick& tick) noexcept {
  auto& axis = axes_[motor];
  auto* group = groupOf(motor);
  if (order.asked != Asked::kUnasked || axis.status() == MotorStatus::kEnabling) ++disables_;
  // Once more lets go of a motor that is still being held or braked; the first time may have been its
  // group's. A request that is repeated since its answer was lost is no second one.
  // One in the tick in which an e-stop begins is no second one either.
  const bool anew = order.asked == Asked::kAnew;
  const bool once_more =
      anew && tick.now != estop_began_ && (group == nullptr || !group->isFirstDisable(motor, order));
  if (axis.status() == MotorStatus::kReady && once_more) {
    if (group == nullptr || !group->together) {
      axis.disableOnceMore(tick);
    } else if (std::exchange(group->let_go, order.id) != order.id) {
      // Motors that move one thing let go together; for one that this request disables it is the first.
      for (const auto member : group->motors)
        if (axes_[member].status() == MotorStatus::kReady && !group->left.test(member))
          axes_[member].disableOnceMore(tick);
    }
  }
  if (group != nullptr) {
    group->rearm.reset();
    if (anew) group->takeDisable(motor, order);
    group->disable_asked = true;
  }
  const auto event = order.asked == Asked::kUnasked ? MotorEvent::kDisableUnasked : MotorEvent::kDisable;
  transition(motor, event, {StopCause::kRequest, order.client}, tick);
}

Refusal Supervisor::ownRefusal(std::size_t motor) const noexcept {
  if (state_ == RobotStatus::kEstop) return Refusal::kEstop;
  if (state_ == RobotStatus::kStopping) return Refusal::kStopping;
  if (configuring_ && configuring_->motor == motor) return Refusal::kConfiguring;
  if (alone_ && *alone_ != motor) return Refusal::kAlone;
  switch (axes_[motor].status()) {
    case MotorStatus::kOffline: return Refusal::kOffline;
    case MotorStatus::kFault: return Refusal::kFaulted;
    case MotorStatus::kReady:
      if (axes_[motor].turnUnclear()) return Refusal::kTurnUnclear;
      return axes_[motor].mustRestFirst() ? Refusal::kRestFirst : Refusal::kNone;
    case MotorStatus::kEnabling:
    case MotorStatus::kActive: return Refusal::kNone;
  }
  return Refusal::kFaulted;
}

Refusal Supervisor::enable(std::size_t motor, const MotorSet& asked, const Tick& tick) noexcept {
  if (const auto refusal = ownRefusal(motor); refusal != Refusal::kNone) return refusal;
  if (isOn(axes_[motor].status())) return Refusal::kNone;
  if (const auto refusal = groupRefusal(motor, asked); refusal != Refusal::kNone) return refusal;
  if (auto* group = groupOf(motor)) group->rests_with_it.reset(motor);
  axes_[motor].prepareEnabling(tick);
  transition(motor, MotorEvent::kEnable, tick);
  return Refusal::kNone;
}

void Supervisor::clear(std::size_t motor, const Tick& tick) noexcept {
  axes_[motor].clearFault(tick);
  transition(motor, MotorEvent::kClear, tick);
}

}  // namespace rc10
