#pragma once

#include "config/robot_config.hpp"

namespace rc10 {

/// Adds a group for each module whose motors depend on each other, named as the module: of those of its
/// motors that are in no group yet, if there are two. Declared groups win, and of two modules the first.
void addImpliedGroups(RobotConfig& robot);

}  // namespace rc10
