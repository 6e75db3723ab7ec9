#pragma once

#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Adds a group for each module whose motors depend on each other, named as the module. Declared groups win,
/// and of two modules the first; one that holds only some of a pair's motors is an error, of another module's
/// a warning.
void addImpliedGroups(RobotConfig& robot, Problems& problems);

}  // namespace rc10
