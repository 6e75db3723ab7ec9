#pragma once

#include <optional>
#include <string>

#include "app/result.hpp"
#include "rc10/robot_state.hpp"
#include "rc10/setpoint.hpp"

namespace rc10 {
inline namespace robot_client {

/// Reason why a motor would not act on a setpoint of this mode, in words that tell what to do. Its holder
/// does not count: a higher priority takes it over.
[[nodiscard]] std::optional<std::string> obstacle(const RobotState& state, const std::string& motor,
                                                  Mode mode);

/// The motors that there are, and the one that was meant.
[[nodiscard]] std::string noMotor(const RobotState& state, const std::string& motor);

/// Reason why these setpoints would not all be acted on.
[[nodiscard]] Result<void> checkSetpoints(const RobotState& state, const MotorSetpoints& setpoints);

}  // namespace robot_client
}  // namespace rc10
