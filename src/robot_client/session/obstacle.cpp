#include "robot_client/session/obstacle.hpp"

#include <string_view>
#include <vector>

#include "app/nearest.hpp"
#include "app/target.hpp"

namespace rc10 {
inline namespace robot_client {

std::string noMotor(const RobotState& state, const std::string& motor) {
  std::vector<std::string_view> names;
  names.reserve(state.motors.size());
  for (const auto& each : state.motors) names.emplace_back(each.name);
  return "there is no motor '" + motor + "'; the motors are: " + state.motorNames() +
         didYouMean(motor, names);
}

std::optional<std::string> obstacle(const RobotState& state, const std::string& motor, Mode mode) {
  const auto* found = state.find(motor);
  if (found == nullptr) return noMotor(state, motor);
  if (state.status == RobotStatus::kEstop) return "the robot is in ESTOP: clear it, then enable the motors";
  if (state.status == RobotStatus::kStopping) return "rc10d is stopping";
  switch (found->status) {
    case MotorStatus::kOffline:
      return motor + " is OFFLINE: no feedback from the drive; check power, wiring and id";
    case MotorStatus::kReady: return motor + " is READY: enable it first";
    case MotorStatus::kEnabling: return motor + " is ENABLING: wait until it is ACTIVE";
    case MotorStatus::kFault:
      return motor + " is in FAULT (" + found->fault_text + "): clear it, then enable it";
    case MotorStatus::kActive: break;
  }
  if (needsReference(mode) && !found->zeroed) {
    return motor + " has no reference for angles: home it, or zero it while it is disabled, or write zero: " +
           "power_on in the configuration";
  }
  return std::nullopt;
}

Result<void> checkSetpoints(const RobotState& state, const MotorSetpoints& setpoints) {
  if (setpoints.empty()) return fail("a command needs at least one setpoint");
  for (std::size_t i = 0; i < setpoints.size(); ++i) {
    const auto& [motor, setpoint] = setpoints[i];
    if (auto checked = setpoint.check(); !checked) return fail(motor + ": " + checked.error().message);
    for (std::size_t j = 0; j < i; ++j) {
      if (setpoints[j].motor == motor) return fail("two setpoints for " + motor);
    }
    // Coasting needs nothing but a motor.
    if (setpoint.mode == Mode::kCoast && state.find(motor) != nullptr) continue;
    if (auto reason = obstacle(state, motor, setpoint.mode)) return fail(*reason);
  }
  return {};
}

}  // namespace robot_client
}  // namespace rc10
