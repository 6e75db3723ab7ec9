#pragma once

#include <vector>

#include "config/keys/settings.hpp"
#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"

namespace rc10 {

/// Reads the groups of motors that stop together. `buses`: of the same file, complete.
[[nodiscard]] std::vector<GroupConfig> buildGroups(const Settings& robot, const std::vector<BusConfig>& buses,
                                                   Problems& problems);

}  // namespace rc10
