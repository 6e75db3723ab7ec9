#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

#include "module/module_robot.hpp"
#include "module/module_type.hpp"

namespace rc10 {

// Limits of the speed of motors that share one motion. Divided below the lowest, the motion keeps its
// direction; beyond, each motor would be held to its own.

/// Lowest `velocity_limit_rpm` of the motors; infinite where none has one.
[[nodiscard]] inline double lowestLimitRpm(const RobotOutline& robot,
                                           std::span<const std::size_t> motors) noexcept {
  double limit_rpm = std::numeric_limits<double>::infinity();
  for (const auto motor : motors) {
    const auto own_limit_rpm = static_cast<double>(robot.motors[motor].velocity_limit_rpm);
    if (own_limit_rpm > 0.0) limit_rpm = std::min(limit_rpm, own_limit_rpm);
  }
  return limit_rpm;
}

/// `limit_rpm`, or less while the reduced mode leaves one of the motors less.
[[nodiscard]] inline double sharedLimitRpm(const ModuleRobot& robot, std::span<const std::size_t> motors,
                                           double limit_rpm) noexcept {
  for (const auto motor : motors) limit_rpm = std::min(limit_rpm, robot.speedCeilingRpm(motor));
  return limit_rpm;
}

}  // namespace rc10
