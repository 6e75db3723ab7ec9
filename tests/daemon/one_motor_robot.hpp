#pragma once

#include <string>

#include "config/robot_config.hpp"
#include "daemon/robot_of_text.hpp"

namespace rc10::test {

/// A robot with one simulated motor: `motor` are its keys but for the name, `top` those of the robot.
inline RobotConfig oneMotorRobot(const std::string& motor, const std::string& top = "") {
  const bool fd = motor.find("model: moteus") == 0;
  return robotOfText("robot: one\nrealtime: preferred\n" + top + "buses:\n  - name: bench\n    type: sim\n" +
                     (fd ? "    data_bitrate: 5000000\n" : "") + "    motors:\n      - {name: motor, " +
                     motor + "}\n");
}

}  // namespace rc10::test
