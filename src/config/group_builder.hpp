#pragma once

#include <vector>

#include "config/problem.hpp"
#include "config/robot_config.hpp"
#include "config/settings.hpp"

namespace rc10 {

/// Reads the groups of motors that stop together. `buses`: of the same file, complete.
[[nodiscard]] std::vector<GroupConfig> buildGroups(const Settings& robot, const std::vector<BusConfig>& buses,
                                                   Problems& problems);

}  // namespace rc10
