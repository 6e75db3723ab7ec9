#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/exchange/robot_description.hpp"

namespace rc10::test {

/// A robot with these motors, as the link thread knows it.
inline RobotDescription describedRobot(std::initializer_list<std::string_view> motors) {
  RobotDescription robot;
  for (const auto name : motors) robot.motors.emplace_back().name = name;
  return robot;
}

inline void addModule(RobotDescription& robot, std::string_view name, std::vector<std::string> inputs) {
  auto& module = robot.modules.emplace_back();
  module.name = name;
  module.signals.inputs = std::move(inputs);
}

}  // namespace rc10::test
