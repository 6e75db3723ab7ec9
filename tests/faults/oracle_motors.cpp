// Rules for one motor: its status, commands of strangers, torque at rest.
#include <cmath>
#include <utility>

#include "faults/oracle.hpp"

namespace rc10::test {

void Oracle::judgeStatus(std::size_t index, const MotorSnapshot& seen, RobotStatus robot) {
  const auto& motor = motors_[index];
  const auto before = motor.status;
  const auto after = seen.status;
  require(index, !overdue(motor) || lost(after), "stale feedback, and neither OFFLINE nor FAULT");
  require(index, !fresh(motor) || after != MotorStatus::kOffline, "OFFLINE with fresh feedback");
  const bool between = !fresh(motor) && !overdue(motor);
  require(index, !between || after != MotorStatus::kOffline || lost(before),
          "OFFLINE before its feedback could be read");
  require(index, !between || before != MotorStatus::kOffline || lost(after), "back without feedback");
  if (before == MotorStatus::kFault && after != MotorStatus::kFault) {
    require(index, motor.clear_asked, "left FAULT unasked");
  }
  if (after == MotorStatus::kActive && before != MotorStatus::kActive) {
    require(index, before == MotorStatus::kEnabling, "ACTIVE without enabling");
  }
  if (after == MotorStatus::kEnabling && before != MotorStatus::kEnabling && !motor.enable_asked) {
    const bool rearms = motor.group != kNoGroup && groups_[motor.group].may_rearm.test(index);
    require(index, rearms, "enabled itself");
  }
  if (now_ >= motor.owned_until) require(index, seen.owner.view().empty(), "owned by a client that is gone");
  if (after == MotorStatus::kActive || after == MotorStatus::kEnabling)
    require(index, robot == RobotStatus::kRun, "enabled although the robot is stopped");
  if (seen.target.mode != ControlMode::kCoast) {
    require(index, after == MotorStatus::kActive, "a target although it is not ACTIVE");
    require(index, now_ < motor.driven_until, "a target without a valid command");
  }
}

// Three within the time end ACTIVE, READY and ENABLING, and fewer do not.
void Oracle::judgeForeign(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& limit = config_.buses[motor.bus].foreign;
  const bool suspicious = suspicious_ == index;
  const auto enough = [&limit, suspicious](const std::deque<MonotonicTime>& times) {
    const auto frames = static_cast<std::size_t>(suspicious ? 1 : limit.frames);
    for (std::size_t i = frames - 1; i < times.size(); ++i)
      if (times[i] - times[i - frames + 1] <= limit.within) return true;
    return false;
  };
  const bool newly = seen.fault == FaultCode::kForeignCommands && motor.fault != seen.fault;
  if (newly) ++motor.visits->foreign;
  require(index, !newly || enough(motor.perhaps_foreign), "in FAULT for commands that nobody has sent");
  const bool there = !lost(motor.status) && seen.status != MotorStatus::kOffline;
  require(index, !there || !enough(motor.foreign) || seen.status == MotorStatus::kFault,
          "somebody else commands its drive, and it is not in FAULT");
  const auto forget = [&](std::deque<MonotonicTime>& times) {
    while (!times.empty() && now_ - times.front() > limit.within) times.pop_front();
  };
  forget(motor.perhaps_foreign);
  forget(motor.foreign);
  // Frames seen by a lost motor may or may not have been counted.
  if (lost(seen.status)) motor.foreign.clear();
}

// Reports of its drive while nothing is asked of it, against the thresholds of the configuration.
void Oracle::judgeRest(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& rest = motor.config->rest;
  const auto& feedback = seen.feedback;
  const bool rested =
      std::exchange(motor.rests, seen.acting == Acting::kNothing && seen.status != MotorStatus::kEnabling &&
                                     (motor.wire->idlesAtRest() || seen.status != MotorStatus::kActive)) &&
      fresh(motor);
  const bool newly = seen.fault == FaultCode::kNotAtRest && motor.fault != seen.fault;
  double sign = 0.0;
  if (rested && std::fabs(feedback.current_a) > rest.current_a && rest.current_a > 0.0F) {
    const bool stands = std::fabs(feedback.velocity_rpm) < motor.config->standstill_rpm;
    if (stands || feedback.current_a * feedback.velocity_rpm > 0.0F)
      sign = std::copysign(1.0, static_cast<double>(feedback.current_a));
  }
  if (sign != motor.torque_sign) {
    motor.torque_sign = sign;
    motor.torque_since = motor.torque_counts_since = feedback.received;
    motor.torque_samples = 0;
  }
  if (motor.new_sample && sign != 0.0) ++motor.torque_samples;
  // A clear forgives what was before it.
  if (motor.clear_asked) motor.torque_counts_since = feedback.received;
  const auto lasting = feedback.received - motor.torque_since;
  // The first sample may have come with the order.
  const auto slack = motor.config->feedback_timeout / 2 + 2 * config_.period();
  require(index, !newly || (sign != 0.0 && lasting >= rest.time - slack),
          "in FAULT for torque at rest that it does not report");
  const auto counts = feedback.received - motor.torque_counts_since;
  // rc10d counts from the next one, which may be as late as a motor that is not lost allows.
  const auto counts_later = motor.config->feedback_timeout + 2 * config_.period();
  const bool proven = sign != 0.0 && motor.torque_samples > 4 && counts > rest.time + counts_later;
  require(index, !proven || !fresh(motor) || lost(seen.status),
          "its drive reports torque at rest, and it is not in FAULT");
}

}  // namespace rc10::test
