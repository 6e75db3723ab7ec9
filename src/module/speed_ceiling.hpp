#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "module/module_robot.hpp"

namespace rc10 {

/// Limit of the speed of motors that share one motion: `limit_rpm`, or less while the reduced mode leaves one
/// of them less. Divided below it, the motion keeps its direction.
[[nodiscard]] inline double sharedLimitRpm(const ModuleRobot& robot, std::span<const std::size_t> motors,
                                           double limit_rpm) noexcept {
  for (const auto motor : motors) limit_rpm = std::min(limit_rpm, robot.speedCeilingRpm(motor));
  return limit_rpm;
}

}  // namespace rc10
