#pragma once

#include <vector>

#include "config/keys/settings.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// The modules of a robot whose buses have been read. References to motors become their places.
[[nodiscard]] std::vector<ModuleConfig> buildModules(const Settings& robot,
                                                     const std::vector<BusConfig>& buses, Problems& problems);

/// Builds and connects every module of a configuration that is right so far, and throws them away: what a
/// module itself demands is said before the start.
void checkModules(const RobotConfig& robot, Problems& problems);

}  // namespace rc10
