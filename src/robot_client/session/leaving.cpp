#include "robot_client/session/leaving.hpp"

#include "robot_client/session/outgoing.hpp"

namespace rc10 {
inline namespace robot_client {
namespace {

[[nodiscard]] bool knows(const RobotState* state, const std::string& motor) {
  return state != nullptr && state->find(motor) != nullptr;
}

}  // namespace

void Leaving::commanded(const MotorSetpoints& setpoints) {
  for (const auto& order : setpoints) commanded_.insert(order.motor);
}

void Leaving::enabled(const std::vector<std::string>& motors) {
  enabled_all_ = enabled_all_ || motors.empty();
  enabled_.insert(motors.begin(), motors.end());
}

void Leaving::disabled(const std::vector<std::string>& motors) {
  if (motors.empty()) {
    enabled_.clear();
    enabled_all_ = false;
  }
  for (const auto& motor : motors) enabled_.erase(motor);
}

MotorSetpoints Leaving::coasts(const RobotState* state) const {
  MotorSetpoints coasts;
  for (const auto& motor : commanded_) {
    if (knows(state, motor)) coasts.push_back({motor, Setpoint::coast()});
  }
  return coasts;
}

std::optional<std::string> Leaving::toDisable(const RobotState* state) const {
  if (enabled_all_) return "";
  std::vector<std::string> motors;
  for (const auto& motor : enabled_) {
    // Without a state the names that rc10d has answered for: one too many is better than one too few.
    if (state == nullptr || knows(state, motor)) motors.push_back(motor);
  }
  return motors.empty() ? std::nullopt : std::optional(joined(motors));
}

}  // namespace robot_client
}  // namespace rc10
