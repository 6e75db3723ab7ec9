#pragma once

#include <cstddef>

#include "config/robot_config.hpp"

namespace rc10::test {

/// The robots of the chaos: each family, each way to control it, each fallback, each limit, modules.
inline constexpr std::size_t kRobotCount = 9;
[[nodiscard]] RobotConfig robotOf(std::size_t index);
/// A robot for a contest: all families, defaults wherever there is one.
[[nodiscard]] RobotConfig matchRobot();

}  // namespace rc10::test
