#pragma once

#include <string>

#include "app/result.hpp"
#include "rc10/robot.hpp"

namespace rc10 {
inline namespace robot_client {

/// Reason why a program cannot command a robot of this name with these options.
[[nodiscard]] Result<void> checkSession(const std::string& robot, const RobotOptions& options);

/// The program's name, where the options name no client.
[[nodiscard]] RobotOptions withClient(RobotOptions options);

}  // namespace robot_client
}  // namespace rc10
