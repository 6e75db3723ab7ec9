// Rules for groups, for a motor enabled alone, and for the actions that a motor may be doing.
#include <utility>

#include "daemon/supervision/states.hpp"
#include "faults/oracle.hpp"

namespace rc10::test {

// As long as a motor that was enabled alone is ENABLING or ACTIVE, no other is.
void Oracle::judgeAlone(const Snapshot& snapshot) {
  const bool stopped = estop_asked_ || stop_asked_;
  was_alone_ = alone_.has_value();
  // It may have ended within the tick, and begun anew as one of many.
  if (alone_ && (stopped || motors_[*alone_].disables_asked > 0)) alone_.reset();
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const auto& motor = motors_[i];
    const bool rearms = motor.group != kNoGroup && groups_[motor.group].may_rearm.test(i);
    const bool begun = !isOn(motor.status) && isOn(snapshot.motors[i].status);
    if (begun && motor.alone_asked && !rearms) alone_ = i;
  }
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    auto& motor = motors_[i];
    motor.perhaps_alone = (motor.perhaps_alone || motor.alone_asked) && isOn(snapshot.motors[i].status);
  }
  if (alone_ && !isOn(snapshot.motors[*alone_].status)) alone_.reset();
  if (!alone_) return;
  was_alone_ = true;
  ++visits_.alone;
  for (std::size_t i = 0; i < motors_.size(); ++i)
    require(i, i == *alone_ || !isOn(snapshot.motors[i].status),
            "enabled beside a motor that is enabled alone");
}

// All or none: while a required member is missing, and in the tick in which one leaves, none is on. A motor
// that is enabled alone needs no group.
void Oracle::judgeGroups(const Snapshot& snapshot) {
  for (auto& group : groups_) {
    bool missing = false;
    bool newly_lost = false;
    bool refused = false;
    bool leaves = false;
    bool disable_asked = false;
    bool faulted = false;
    group.stops_now = group.rests_now = group.disable_asked = group.first_disable = false;
    MotorSet active;
    MotorSet enabling;  // it may have become ACTIVE within the tick
    MotorSet rearmed;
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      if (!group.members.test(i)) continue;
      const auto& motor = motors_[i];
      const auto before = motor.status;
      const auto after = snapshot.motors[i].status;
      if (before == MotorStatus::kActive) active.set(i);
      if (before == MotorStatus::kEnabling) enabling.set(i);
      disable_asked |= motor.disables_asked > 0;
      group.first_disable |= motor.disables_asked > 0 && motor.rests_with_group;
      if (after == MotorStatus::kEnabling && !motor.enable_asked && before != MotorStatus::kEnabling)
        rearmed.set(i);
      if (!group.required.test(i)) continue;
      missing |= lost(after);
      faulted |= after == MotorStatus::kFault;
      newly_lost |= lost(after) && !lost(before);
      refused |= before == MotorStatus::kEnabling && !isOn(after) && motor.disables_asked == 0;
      leaves |= isOn(before) && (!isOn(after) || motor.disables_asked > 0);
      group.rests_now |= motor.disables_asked > 0 && (isOn(before) || motor.enable_asked);
    }
    group.disable_asked = disable_asked;
    bool alone = alone_ && group.members.test(*alone_);
    for (std::size_t i = 0; i < motors_.size(); ++i)
      alone |= group.members.test(i) && motors_[i].perhaps_alone;
    group.stops_now = newly_lost || refused;
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      if (!group.members.test(i) || alone || !isOn(snapshot.motors[i].status)) continue;
      require(i, !missing, "enabled although a motor of its group is missing");
      require(i, !leaves || was_alone_, "enabled although its group has stopped");
    }
    if (group.together && !alone) judgeTogether(group, snapshot);
    if (rearmed.any()) {
      for (std::size_t i = 0; i < motors_.size(); ++i) {
        const bool left_out = group.must_rearm.test(i) && snapshot.motors[i].status == MotorStatus::kReady;
        require(i, !left_out, "its group was enabled again without it");
      }
      group.may_rearm.reset();
      ++visits_.rearmed;
    }
    if (newly_lost && group.rearms && (active | enabling).any()) {
      group.may_rearm = active | enabling | (active.any() ? MotorSet{} : group.may_rearm);
      group.must_rearm = active;
    }
    if (faulted || disable_asked || was_alone_ || estop_asked_ || snapshot.state != RobotStatus::kRun)
      group.may_rearm.reset();
  }
}

void Oracle::judgeTogether(const Group& group, const Snapshot& snapshot) {
  bool whole = true;
  bool asked = true;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    if (!group.required.test(i)) continue;
    whole = whole && snapshot.motors[i].status == MotorStatus::kActive;
    asked = asked && (motors_[i].enable_asked || isOn(motors_[i].status) || group.may_rearm.test(i));
  }
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    if (!group.members.test(i)) continue;
    require(i, whole || snapshot.motors[i].target.mode == ControlMode::kCoast,
            "a target although its group is not enabled as a whole");
    const bool begun = !isOn(motors_[i].status) && isOn(snapshot.motors[i].status);
    require(i, asked || !begun, "enabled without its group");
  }
}

// Permitted action of a motor without a target, from now on.
void Oracle::followActions(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& fallback = motor.config->fallback;
  const auto coast = only(FallbackAction::kCoast);
  const auto before = motor.status;
  const auto after = seen.status;
  if (lost(after) || lost(before) || seen.target.mode != ControlMode::kCoast) motor.held_deg = kUnsaid;
  if (lost(after) || lost(before)) return setActions(motor, coast);
  if (seen.target.mode != ControlMode::kCoast) return setActions(motor, only(fallback.on_timeout));
  if (before == MotorStatus::kActive && after != MotorStatus::kActive) {
    Actions actions;
    const bool with_group = motor.group != kNoGroup && groups_[motor.group].rests_now;
    const bool asked = motor.disables_asked > 0 || stop_asked_ || with_group;
    motor.rests_with_group = with_group && (motor.disables_asked == 0 || motor.enable_asked);
    if (asked) actions |= only(fallback.on_disable);
    if (motor.disables_asked > 1) actions |= coast;
    if (estop_asked_ || (motor.group != kNoGroup && groups_[motor.group].stops_now))
      actions |= only(fallback.on_estop);
    require(index, actions.any(), "no longer ACTIVE for no reason");
    setActions(motor, actions);
    motor.ends_at_standstill = asked;
    motor.of_estop = estop_asked_ && actions == only(fallback.on_estop) &&
                     (motor.group == kNoGroup || !groups_[motor.group].stops_now);
    return;
  }
  // A hold after a disable stops with its group.
  const bool held = (motor.actions & only(FallbackAction::kHold)).any() && motor.ends_at_standstill;
  if (held && motor.group != kNoGroup && groups_[motor.group].stops_now)
    setActions(motor, motor.actions | only(fallback.on_estop));
  // A fallback that acts already gives way to that of an e-stop, once.
  const bool gives_way =
      state_ == RobotStatus::kRun || (state_ == RobotStatus::kStopping && !estop_in_force_);
  if (estop_asked_ && gives_way && motor.actions != coast) {
    auto actions = only(fallback.on_estop);
    const bool ramp_over = motor.actions.test(static_cast<std::size_t>(FallbackAction::kRamp)) &&
                           now_ - motor.acts_since >= fallback.ramp;
    const bool may_have_ended = motor.ends_at_standstill || ramp_over || (motor.actions & coast).any();
    if (may_have_ended || motor.disables_asked > 0 || motor.enable_asked || motor.coast_asked)
      actions |= coast;
    if (motor.disables_asked > 0 || motor.enable_asked) actions |= motor.actions | only(fallback.on_disable);
    setActions(motor, actions);
    motor.of_estop = actions == only(fallback.on_estop);
    return;
  }
  // Enabled and stopped within a tick.
  const bool stopped_with_group =
      motor.group != kNoGroup && (groups_[motor.group].stops_now || groups_[motor.group].rests_now);
  const bool stopped_while_enabling = (before == MotorStatus::kEnabling || motor.enable_asked) &&
                                      (stopped_with_group || motor.disables_asked > 0);
  if (stopped_while_enabling) {
    const bool stood = motor.stood;  // one that had ended before does not begin anew
    setActions(motor, motor.actions | only(fallback.on_estop) | only(fallback.on_disable));
    motor.ends_at_standstill = true;
    motor.stood = stood;
    motor.rests_with_group =
        motor.disables_asked == 0 && motor.group != kNoGroup && groups_[motor.group].rests_now;
  }
  if (motor.mode != ControlMode::kCoast) {  // its target has just gone
    auto actions = only(fallback.on_timeout);
    if (motor.coast_asked) actions |= coast;
    return setActions(motor, actions);
  }
  const auto* group =
      motor.group != kNoGroup && groups_[motor.group].together ? &groups_[motor.group] : nullptr;
  const bool others_asked = group != nullptr && group->disable_asked;
  if (motor.coast_asked || motor.disables_asked > 0 || others_asked) motor.actions |= coast;
  // A target that came and went within the tick cannot be; one that was taken back by COAST can.
  if (after == MotorStatus::kReady && motor.disables_asked > 0 && motor.disables_asked < 2 &&
      before == MotorStatus::kReady && !motor.enable_asked) {
    const bool first = group != nullptr && group->first_disable;
    if (std::exchange(motor.rests_with_group, false) || first) {
      motor.actions |= coast;
    } else {
      setActions(motor, coast);
    }
  }
}

}  // namespace rc10::test
