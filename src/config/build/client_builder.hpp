#pragma once

#include "config/keys/settings.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Reads `clients`, `tuning` and `clear`. `robot`: its buses and modules are complete.
void buildClients(const Settings& top, RobotConfig& robot, Problems& problems);

}  // namespace rc10
