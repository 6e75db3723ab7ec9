#pragma once

#include <string>

#include "config/robot_config.hpp"

namespace rc10 {

/// Report of the robot for people: threads, buses with their predicted load, motors with ids, limits
/// and loops. Plain ASCII, aligned. `config` comes from loadRobotConfig().
[[nodiscard]] std::string describe(const RobotConfig& config);

}  // namespace rc10
