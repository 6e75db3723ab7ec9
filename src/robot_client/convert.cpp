#include "robot_client/convert.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

[[nodiscard]] MotorState motorFrom(const motor_state_t& message) {
  MotorState motor;
  motor.name = message.name;
  motor.status = static_cast<MotorStatus>(message.status);
  motor.fault = message.fault;
  motor.fault_text = message.fault_text;
  motor.limits = static_cast<std::uint32_t>(message.limits);
  motor.mode = static_cast<Mode>(message.mode);
  motor.target = message.target;
  motor.owner = message.owner;
  motor.acting = static_cast<Acting>(message.acting);
  motor.stop_cause = static_cast<StopCause>(message.stop_cause);
  motor.stopped_by = message.stopped_by;
  motor.zeroed = message.zeroed != 0;
  visitTickReadings(kCopyReading, motor, message);
  visitFeedbackReadings(kCopyReading, motor, message);
  motor.feedback_age = std::chrono::microseconds{message.feedback_age_us};
  motor.feedback_age_at_use = std::chrono::microseconds{message.feedback_age_at_use_us};
  motor.command_age = std::chrono::microseconds{message.command_age_us};
  motor.command_unit = static_cast<CommandUnit>(message.command_unit);
  motor.feedback_hz = static_cast<double>(message.feedback_hz);
  return motor;
}

}  // namespace

RobotState fromLcm(const robot_state_t& message) {
  RobotState state;
  state.utime = message.utime;
  state.mono_us = message.mono_us;
  state.tick = message.tick;
  state.status = static_cast<RobotStatus>(message.state);
  state.realtime = message.realtime != 0;
  state.stop_cause = static_cast<StopCause>(message.stop_cause);
  state.stopped_by = message.stopped_by;
  state.stopped_mono_us = message.stopped_mono_us;
  state.estop_count = message.estop_count;
  state.conditions = static_cast<std::uint32_t>(message.conditions);
  state.version = message.version;
  state.config_hash = message.config_hash;
  state.motors.reserve(message.motors.size());
  for (const auto& motor : message.motors) state.motors.push_back(motorFrom(motor));
  return state;
}

Event fromLcm(const event_t& message) {
  return {.utime = message.utime,
          .mono_us = message.mono_us,
          .severity = static_cast<Severity>(message.severity),
          .code = message.code,
          .source = message.source,
          .client = message.client,
          .text = message.text};
}

setpoint_t toLcm(const MotorSetpoint& order) {
  setpoint_t message;
  message.motor = order.motor;
  message.mode = static_cast<std::int8_t>(order.setpoint.mode);
  message.value = order.setpoint.value;
  message.velocity_ff_rpm = static_cast<float>(order.setpoint.forward.velocity.value);
  message.torque_ff_nm = static_cast<float>(order.setpoint.forward.torque_nm);
  message.stiffness_nm_per_rad = static_cast<float>(order.setpoint.stiffness_nm_per_rad);
  message.damping_nms_per_rad = static_cast<float>(order.setpoint.damping_nms_per_rad);
  return message;
}

}  // namespace robot_client
}  // namespace rc10
