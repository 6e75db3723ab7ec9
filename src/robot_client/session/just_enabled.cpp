#include "robot_client/session/just_enabled.hpp"

#include <utility>

namespace rc10 {
inline namespace robot_client {

void JustEnabled::answered(const std::vector<std::string>& motors, std::uint64_t states) {
  for (const auto& motor : motors) newer_from_[motor] = states + kMayBeOlder + 1;
}

std::shared_ptr<const RobotState> JustEnabled::corrected(std::shared_ptr<const RobotState> newest,
                                                         std::uint64_t states) const {
  std::shared_ptr<RobotState> copy;
  for (std::size_t i = 0; newest && i < newest->motors.size(); ++i) {
    const auto& motor = newest->motors[i];
    const auto found = newer_from_.find(motor.name);
    if (found == newer_from_.end() || states >= found->second || motor.status == MotorStatus::kActive)
      continue;
    if (!copy) copy = std::make_shared<RobotState>(*newest);
    copy->motors[i].status = MotorStatus::kActive;
    copy->motors[i].zeroed = true;  // a zero may have come before it was enabled
  }
  return copy ? copy : std::move(newest);
}

}  // namespace robot_client
}  // namespace rc10
