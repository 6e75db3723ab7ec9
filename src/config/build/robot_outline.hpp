#pragma once

#include "config/robot_config.hpp"

namespace rc10 {

/// Robot, as modules may know it before it runs.
[[nodiscard]] RobotOutline outlineOf(const RobotConfig& robot);

}  // namespace rc10
