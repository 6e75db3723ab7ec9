#pragma once

#include "config/problem.hpp"
#include "config/robot_config.hpp"
#include "config/settings.hpp"

namespace rc10 {

/// Reads `estop_gpio` and `heartbeat_gpio`. Call it when the robot's rate is known.
void buildGpio(const Settings& top, RobotConfig& robot, Problems& problems);

}  // namespace rc10
