#pragma once

#include <cstddef>
#include <vector>

#include "config/robot_config.hpp"

namespace rc10 {

/// The motors that the module's keys name, as their places in the robot's list.
[[nodiscard]] std::vector<std::size_t> motorsNamedBy(const ModuleConfig& module);

}  // namespace rc10
