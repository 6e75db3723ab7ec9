#pragma once

#include <string>

#include <gtest/gtest.h>

#include "config/load_config.hpp"
#include "config/robot_config.hpp"

namespace rc10::test {

/// A robot with one simulated motor: `motor` are its keys but for the name, `top` those of the robot.
inline RobotConfig oneMotorRobot(const std::string& motor, const std::string& top = "") {
  const bool fd = motor.find("model: moteus") == 0;
  auto outcome = parseRobotConfig(
      "robot: one\nrealtime: preferred\n" + top + "buses:\n  - name: bench\n    type: sim\n" +
          (fd ? "    data_bitrate: 5000000\n" : "") + "    motors:\n      - {name: motor, " + motor + "}\n",
      "one.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(RobotConfig{});
}

}  // namespace rc10::test
