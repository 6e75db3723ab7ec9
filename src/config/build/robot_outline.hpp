#pragma once

#include "config/robot_config.hpp"

namespace rc10 {

/// What modules may know of a robot before it runs.
[[nodiscard]] RobotOutline outlineOf(const RobotConfig& robot);

}  // namespace rc10
