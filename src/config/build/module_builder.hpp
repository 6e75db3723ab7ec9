#pragma once

#include <vector>

#include "config/keys/settings.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// The modules of a robot whose buses have been read. References to motors become their places.
[[nodiscard]] std::vector<ModuleConfig> buildModules(const Settings& robot,
                                                     const std::vector<BusConfig>& buses, Problems& problems);

/// Builds every module that is right so far, as are the buses, and throws it away: what a module itself
/// demands is said before the start, together with the errors of others. Connects them if all is right.
void checkModules(const RobotConfig& robot, Problems& problems);

}  // namespace rc10
