#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "config/load_config.hpp"
#include "config/report/report.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test {

/// One motor with these keys on a simulated bus, ACTIVE.
class OneMotor {
 public:
  explicit OneMotor(const std::string& keys, const std::string& bus_keys = "") {
    const auto outcome = parse(keys, bus_keys);
    EXPECT_TRUE(outcome.config) << outcome.errorText();
    config_ = outcome.config.value_or(twoWheelsAndYaw());
    robot_ = std::make_unique<VirtualRobot>(config_);
    for (int i = 0; i < 4000 && seen().status != MotorStatus::kReady; ++i) robot_->run(1);
    robot_->order(Operation::kEnable);
    EXPECT_EQ(seen().status, MotorStatus::kActive);
  }

  static ConfigOutcome parse(const std::string& keys, const std::string& bus_keys = "") {
    return parseRobotConfig("robot: one\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    " +
                                bus_keys + "motors:\n      - {name: motor, " + keys + "}\n",
                            "one.yaml");
  }

  void follow(ControlMode mode, double value, int ticks) {
    robot_->hold(0, {.mode = mode, .value = value}, ticks);
  }
  const MotorSnapshot& seen() { return robot_->motor(0); }
  [[nodiscard]] const MotorConfig& config() const { return config_.buses[0].motors[0]; }
  VirtualRobot& robot() { return *robot_; }

 private:
  RobotConfig config_;
  std::unique_ptr<VirtualRobot> robot_;
};

}  // namespace rc10::test
