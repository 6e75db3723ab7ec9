#pragma once

#include "config/keys/settings.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Reads `estop_gpio` and `heartbeat_gpio`. Call it when the robot's rate is known.
void buildGpio(const Settings& top, RobotConfig& robot, Problems& problems);

}  // namespace rc10
