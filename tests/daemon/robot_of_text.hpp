#pragma once

#include <string>

#include <gtest/gtest.h>

#include "config/load_config.hpp"
#include "config/robot_config.hpp"

namespace rc10::test {

/// The robot of a file with this text, which has no mistake.
inline RobotConfig robotOfText(const std::string& text) {
  auto outcome = parseRobotConfig(text, "robot.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(RobotConfig{});
}

}  // namespace rc10::test
