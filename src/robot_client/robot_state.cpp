#include "rc10/robot_state.hpp"

#include <array>

namespace rc10 {
inline namespace robot_client {
namespace {

constexpr std::array kMotorStatuses{"OFFLINE", "READY", "ENABLING", "ACTIVE", "FAULT"};
constexpr std::array kRobotStatuses{"RUN", "ESTOP", "STOPPING"};

}  // namespace

const char* toString(MotorStatus status) noexcept {
  const auto index = static_cast<std::size_t>(status);
  return index < kMotorStatuses.size() ? kMotorStatuses[index] : "UNKNOWN";
}

const char* toString(RobotStatus status) noexcept {
  const auto index = static_cast<std::size_t>(status);
  return index < kRobotStatuses.size() ? kRobotStatuses[index] : "UNKNOWN";
}

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
