#pragma once

#include "rc10/event_t.hpp"
#include "rc10/robot_state.hpp"
#include "rc10/robot_state_t.hpp"
#include "rc10/setpoint_t.hpp"

namespace rc10 {
inline namespace robot_client {

/// Everything but RobotState::taken.
[[nodiscard]] RobotState fromLcm(const robot_state_t& message);
[[nodiscard]] Event fromLcm(const event_t& message);
[[nodiscard]] setpoint_t toLcm(const MotorSetpoint& order);

}  // namespace robot_client
}  // namespace rc10
