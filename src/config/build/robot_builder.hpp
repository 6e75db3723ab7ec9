#pragma once

#include "config/robot_config.hpp"
#include "config/yaml/problem.hpp"
#include "config/yaml/yaml_node.hpp"

namespace rc10 {

/// Makes the configuration from a document that has been held against the tables. Reports what only
/// shows when keys are seen together; complete only if there are no errors.
[[nodiscard]] RobotConfig buildRobot(const YamlNode& root, Problems& problems);

}  // namespace rc10
