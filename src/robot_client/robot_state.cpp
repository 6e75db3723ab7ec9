#include "rc10/robot_state.hpp"

namespace rc10 {
inline namespace robot_client {
const MotorState* RobotState::find(std::string_view motor) const noexcept {
  for (const auto& candidate : motors) {
    if (candidate.name == motor) return &candidate;
  }
  return nullptr;
}

std::string RobotState::motorNames() const {
  std::string names;
  for (const auto& motor : motors) names += (names.empty() ? "" : ", ") + motor.name;
  return names.empty() ? "none" : names;
}

}  // namespace robot_client
}  // namespace rc10
