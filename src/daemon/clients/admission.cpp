#include "daemon/clients/admission.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "link/words.hpp"

namespace rc10 {
namespace {

[[nodiscard]] bool finite(const Target& target) noexcept {
  const bool impedance = target.mode == ControlMode::kImpedance;
  return (!usesValue(target.mode) || std::isfinite(target.value)) && !std::isinf(target.velocity_ff_rpm) &&
         !std::isinf(target.torque_ff_nm) &&
         // An optional field that is not given is NaN; IMPEDANCE has no use without these two.
         (!impedance ||
          (std::isfinite(target.stiffness_nm_per_rad) && std::isfinite(target.damping_nms_per_rad)));
}

[[nodiscard]] bool hasUnused(const Target& target) noexcept {
  const TargetFields used = fieldsOf(target.mode);
  const auto given = [](float value) { return !std::isnan(value) && value != 0.0F; };
  return (!used.velocity_ff && given(target.velocity_ff_rpm)) ||
         (!used.torque_ff && given(target.torque_ff_nm)) ||
         (!used.spring && (given(target.stiffness_nm_per_rad) || given(target.damping_nms_per_rad)));
}

// Modes or gains that the motor takes instead; empty after another refusal.
[[nodiscard]] std::string choiceOf(const RobotDescription::Motor& motor, CommandRefusal refusal) {
  if (refusal == CommandRefusal::kUnsupportedMode) return "; it has " + link::modeWords(motor.modes.bits());
  if (refusal == CommandRefusal::kGainsBeyondDrive)
    return fmt::format(": 0 to {:.6g} Nm/rad, 0 to {:.6g} Nms/rad", motor.spring_range.stiffness_nm_per_rad,
                       motor.spring_range.damping_nms_per_rad);
  return {};
}

}  // namespace

const char* toString(CommandRefusal refusal) noexcept {
  switch (refusal) {
    case CommandRefusal::kNone: return "accepted";
    case CommandRefusal::kMalformed: return "malformed";
    case CommandRefusal::kUnknownMotor: return "unknown motor";
    case CommandRefusal::kUnknownMode: return "unknown mode";
    case CommandRefusal::kUnsupportedMode: return "unsupported mode";
    case CommandRefusal::kNotFinite: return "not finite";
    case CommandRefusal::kExpired: return "expired";
    case CommandRefusal::kOldSequence: return "old sequence";
    case CommandRefusal::kRingFull: return "too many commands";
    case CommandRefusal::kUnknownModule: return "unknown module";
    case CommandRefusal::kUnknownSignal: return "unknown signal";
    case CommandRefusal::kUnusedField: return "unused field";
    case CommandRefusal::kNotPermitted: return "not permitted";
    case CommandRefusal::kGainsBeyondDrive: return "gains beyond drive";
  }
  return "unknown";
}

const char* describe(CommandRefusal refusal) noexcept {
  switch (refusal) {
    case CommandRefusal::kNone: break;
    case CommandRefusal::kMalformed:
      return "malformed: it needs 1 to 128 setpoints, each motor once (for a module: 1 to 32 values, each "
             "once), "
             "and a validity of 1 to 1000 ms";
    case CommandRefusal::kUnknownMotor: return "unknown motor; `rc10ctl watch` shows the names";
    case CommandRefusal::kUnknownMode: return "unknown mode";
    case CommandRefusal::kUnsupportedMode: return "the motor's drive does not support the mode";
    case CommandRefusal::kNotFinite: return "a value is not finite";
    case CommandRefusal::kExpired: return "older than its validity when it came in";
    case CommandRefusal::kOldSequence: return "its sequence number is not above the last of its session";
    case CommandRefusal::kRingFull: return "too many commands for the scheduler; send fewer";
    case CommandRefusal::kUnknownModule: return "unknown module; `rc10ctl modules` shows the names";
    case CommandRefusal::kUnknownSignal:
      return "the module has no input of that name; `rc10ctl modules` shows the names";
    case CommandRefusal::kUnusedField:
      return "a feed-forward, stiffness or damping that its mode does not use was ignored; "
             "docs/lcm.md#modes has what each mode uses";
    case CommandRefusal::kNotPermitted: return "`clients` in the robot's file does not grant it";
    case CommandRefusal::kGainsBeyondDrive: return "stiffness or damping out of what the motor's drive takes";
  }
  return toString(refusal);
}

Admission::Admission(const RobotDescription& robot, Permissions permissions)
    : robot_(robot), permissions_(std::move(permissions)), budget_(robot.period()) {
  for (std::size_t i = 0; i < robot.motors.size(); ++i)
    index_.emplace(robot.motors[i].name, static_cast<int>(i));
}

int Admission::indexOf(std::string_view name) const {
  const auto found = index_.find(std::string(name));
  return found == index_.end() ? -1 : found->second;
}

CommandRefusal Admission::admit(const link::Command& message, const Speaker& speaker, MonotonicTime now,
                                Command& out) {
  culprit_.clear();
  choice_.clear();
  late_but_new_ = false;
  const auto deadline = deadlineOf(message.received_ns, message.validity_ms, now);
  if (message.setpoint_count == 0 || message.setpoint_count > kMaxMotors || !deadline)
    return CommandRefusal::kMalformed;
  MotorSet named;
  cleared_field_ = false;
  out.count = message.setpoint_count;
  for (std::size_t i = 0; i < out.count; ++i) {
    const auto refusal = translate(message.setpoints[i], out.setpoints[i]);
    if (refusal != CommandRefusal::kNone) {
      const auto& setpoint = message.setpoints[i];
      culprit_ = std::string{setpoint.motor.view()};
      if (refusal != CommandRefusal::kUnknownMotor) {
        culprit_ += std::string{": "} + toString(setpoint.target.mode);
        choice_ = choiceOf(robot_.motors[out.setpoints[i].motor], refusal);
      }
      return refusal;
    }
    cleared_field_ = cleared_field_ || hasUnused(message.setpoints[i].target);
    if (named.test(out.setpoints[i].motor)) return CommandRefusal::kMalformed;
    named.set(out.setpoints[i].motor);
  }
  out.deadline = *deadline;
  out.received = out.said = receivedAt(message.received_ns, now);
  out.client = message.client;
  const auto client = message.client.view();
  not_permitted_ = permissions_.whyNoCommand(speaker, client, named, message.priority);
  if (!not_permitted_.empty()) return CommandRefusal::kNotPermitted;
  const bool late = now >= out.deadline;
  if (!budget_.spend(speaker.account(client), out.count, now))
    return late ? CommandRefusal::kExpired : CommandRefusal::kRingFull;
  out.session = message.session;
  out.priority = message.priority;
  switch (sessions_.accept(speaker.owner(), client, message.session, message.seq)) {
    case SessionNumbers::Verdict::kNew:
      late_but_new_ = late;
      return late ? CommandRefusal::kExpired : CommandRefusal::kNone;
    case SessionNumbers::Verdict::kOld: return late ? CommandRefusal::kExpired : CommandRefusal::kOldSequence;
    case SessionNumbers::Verdict::kOfAnother: break;
  }
  not_permitted_ = permissions_.whyOtherSession(client);
  return CommandRefusal::kNotPermitted;
}

CommandRefusal Admission::translate(const link::Setpoint& in, Command::Setpoint& out) const {
  const int motor = indexOf(in.motor.view());
  if (motor < 0) return CommandRefusal::kUnknownMotor;
  out.motor = static_cast<std::uint16_t>(motor);
  const auto& known = robot_.motors[out.motor];
  const auto mode = in.target.mode;
  if (static_cast<int>(mode) >= kControlModeCount) return CommandRefusal::kUnknownMode;
  if (mode != ControlMode::kCoast && !known.modes.contains(mode)) {
    return CommandRefusal::kUnsupportedMode;
  }
  if (!finite(in.target)) return CommandRefusal::kNotFinite;
  if (mode == ControlMode::kImpedance &&
      !known.spring_range.has(in.target.stiffness_nm_per_rad, in.target.damping_nms_per_rad))
    return CommandRefusal::kGainsBeyondDrive;
  out.target = normalised(in.target);
  return CommandRefusal::kNone;
}

}  // namespace rc10
