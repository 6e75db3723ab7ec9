// Groups that act together: a message that one member cannot follow moves none.

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "daemon/robot_of_text.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::supervisor_together_test {
namespace {

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr Target kTurn{.mode = ControlMode::kTotalAngle, .value = 200.0};
constexpr Target kCoast{.mode = ControlMode::kCoast};

constexpr const char* kDji = "model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 200";
constexpr const char* kVesc =
    "model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, feedback_hz: 500, feedback_timeout_ms: "
    "400";

/// A lift of two motors, each on its bus.
class MotorsOfOneThing : public ::testing::Test {
 protected:
  /// Both are ACTIVE then. `more` begins with a comma.
  void start(const std::string& motor, const std::string& more) {
    const auto bus = [&](const std::string& name, const std::string& motor_name) {
      return "  - {name: " + name + ", type: sim, motors: [{name: " + motor_name + ", " + motor + more +
             "}]}\n";
    };
    robot_.emplace(robotOfText("robot: lift\nrealtime: preferred\nbuses:\n" + bus("a", "left") +
                               bus("b", "right") +
                               "groups: [{name: lift, motors: [left, right], together: true}]\n"));
    robot_->run(100);
    robot_->order(Operation::kEnable);
    ASSERT_EQ(left().status, MotorStatus::kActive);
    ASSERT_EQ(right().status, MotorStatus::kActive);
  }
  const MotorSnapshot& left() { return robot_->motor(kLeft); }
  const MotorSnapshot& right() { return robot_->motor(kRight); }

  /// One message for both.
  void say(const Target& target) {
    Command command;
    command.client = "test";
    command.received = command.said = robot_->now();
    command.deadline = robot_->now() + std::chrono::milliseconds{50};
    command.count = 2;
    command.setpoints[0] = {kLeft, target};
    command.setpoints[1] = {kRight, target};
    ASSERT_TRUE(robot_->exchange().commands.push(command));
  }
  void stream(const Target& target, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      say(target);
      robot_->tick();
      EXPECT_EQ(left().target.mode, right().target.mode) << "both or none";
    }
  }
  bool told(std::size_t motor, SkipReason reason) {
    const auto events = robot_->events();
    return std::any_of(events.begin(), events.end(), [&](const Event& event) {
      return event.code == EventCode::kSetpointSkipped && event.source == static_cast<std::int16_t>(motor) &&
             event.value == static_cast<std::int32_t>(reason);
    });
  }

  std::optional<VirtualRobot> robot_;
};

TEST_F(MotorsOfOneThing, FollowNoAngleOnceTheReferenceOfOneIsLost) {
  start(kDji, ", on_timeout: brake, angle_slew_deg_per_s: 100");
  stream(kTurn, 500);
  ASSERT_EQ(left().target.mode, ControlMode::kTotalAngle);
  robot_->simBus(0).silence(0, true);
  stream(kTurn, 40);
  robot_->simBus(0).silence(0, false);
  stream(kTurn, 200);
  ASSERT_EQ(left().status, MotorStatus::kActive);
  ASSERT_FALSE(left().feedback.zeroed);
  EXPECT_EQ(right().target.mode, ControlMode::kCoast);
  EXPECT_EQ(right().acting, Acting::kBrake) << "its on_timeout";
  robot_->events();
  robot_->hold(kRight, kTurn, 20);
  EXPECT_EQ(right().target.mode, ControlMode::kCoast) << "in a message of its own";
  robot_->run(1000);
  robot_->hold(kRight, kTurn, 1);
  EXPECT_TRUE(told(kRight, SkipReason::kGroup));
  stream({.mode = ControlMode::kVelocity, .value = 20.0}, 20);
  EXPECT_EQ(right().target.mode, ControlMode::kVelocity) << "that needs no place";
}

TEST_F(MotorsOfOneThing, FollowNoMessageThatIsAFirstStepTooFarForOne) {
  start(kDji, ", max_first_step_deg: 30");
  for (int i = 0; i < 2000 && right().feedback.total_angle_deg > -10.0; ++i)
    robot_->hold(kRight, {.mode = ControlMode::kVelocity, .value = -10.0}, 1);
  ASSERT_LT(right().feedback.total_angle_deg, -9.0);
  robot_->run(200);
  robot_->events();
  stream({.mode = ControlMode::kTotalAngle, .value = 28.0}, 100);
  EXPECT_EQ(left().target.mode, ControlMode::kCoast) << "28 degrees are near enough for it alone";
  EXPECT_TRUE(told(kLeft, SkipReason::kGroup));
  stream({.mode = ControlMode::kTotalAngle, .value = 10.0}, 100);
  EXPECT_EQ(left().target.mode, ControlMode::kTotalAngle) << "near enough for both";
}

TEST_F(MotorsOfOneThing, AreNotLetGoOfBeforeAllAreActive) {
  start(kDji, ", on_estop: hold");
  robot_->order(Operation::kEstop);
  robot_->run(10);
  robot_->order(Operation::kClear);
  ASSERT_EQ(left().acting, Acting::kHold);
  robot_->freezeBus(1, true);
  robot_->beginEnabling(MotorSet{0b11});
  robot_->run(5);
  ASSERT_EQ(left().status, MotorStatus::kActive);
  ASSERT_EQ(right().status, MotorStatus::kEnabling) << "its first answer is not here yet";
  say(kCoast);
  robot_->tick();
  EXPECT_EQ(left().acting, Acting::kHold) << "the other still holds";
  EXPECT_EQ(right().acting, Acting::kHold);
  robot_->freezeBus(1, false);
  robot_->run(5);
  ASSERT_EQ(right().status, MotorStatus::kActive);
  say(kCoast);
  robot_->tick();
  EXPECT_EQ(left().acting, Acting::kNothing);
  EXPECT_EQ(right().acting, Acting::kNothing);
}

// Refused by its drive after it was ENABLING, one would stop the other, which would let go.
TEST_F(MotorsOfOneThing, AreHeldOnWhereOneOfThemMustRestBeforeItIsEnabled) {
  start(kVesc, ", on_disable: hold");
  robot_->simBus(0).silence(0, true);
  robot_->tick(330);  // a pause of the computer; another drive may have been plugged in
  robot_->simBus(0).silence(0, false);
  robot_->run(50);
  robot_->order(Operation::kDisable);
  const auto refused = robot_->order(Operation::kEnable);
  EXPECT_EQ(refused.motors[kLeft], Refusal::kRestFirst);
  EXPECT_EQ(refused.motors[kRight], Refusal::kGroup);
  robot_->run(50);
  EXPECT_EQ(left().acting, Acting::kHold);
  EXPECT_EQ(right().acting, Acting::kHold);
}

}  // namespace
}  // namespace rc10::test::supervisor_together_test
