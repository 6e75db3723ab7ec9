#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "fake_rc10d.hpp"
#include "rc10/robot.hpp"

namespace rc10 {
inline namespace robot_client {
namespace test {

using namespace std::chrono_literals;

/// A robot and its rc10d on one memq link. Validity and silence are long: this machine may pause.
class RobotTest : public testing::Test {
 protected:
  static RobotOptions options() {
    RobotOptions options;
    options.client = "tester";
    options.priority = 7;
    options.validity = 1000ms;
    options.on_problem = [](const std::string&) {};
    return options;
  }

  void connect(RobotOptions options = RobotTest::options()) {
    robot_ = std::make_unique<Robot>("hero", link_, std::move(options));
    ASSERT_TRUE(robot_->status()) << robot_->status().error().message;
  }
  /// Has a state published and waits until the robot has it: handlers are called in the order in which they
  /// were subscribed.
  void see(std::chrono::milliseconds after = 5ms) {
    std::promise<void> seen;
    auto future = seen.get_future();
    bool first = true;
    const auto last = link_.subscribe(rc10d_.channel("state"), [&](auto) {
      if (std::exchange(first, false)) seen.set_value();
    });
    rc10d_.publishState(after);
    ASSERT_EQ(future.wait_for(kPatience), std::future_status::ready);
  }
  void connectEnabled(RobotOptions options = RobotTest::options()) {
    connect(std::move(options));
    ASSERT_TRUE(robot_->enable());
  }
  motor_state_t& fakeMotor(const std::string& name) { return rc10d_.motors[name]; }

  LcmLink link_{"memq://"};
  FakeRc10d rc10d_{link_};
  std::unique_ptr<Robot> robot_;
};

}  // namespace test
}  // namespace robot_client
}  // namespace rc10
