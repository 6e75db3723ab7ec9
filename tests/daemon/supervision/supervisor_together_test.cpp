// Groups that act together: a message that one member cannot follow moves none.

#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::supervisor_together_test {
namespace {

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr Target kTurn{.mode = ControlMode::kTotalAngle, .value = 200.0};
constexpr Target kCoast{.mode = ControlMode::kCoast};

/// A lift of two motors, each on its bus.
RobotConfig lift(const std::string& more, const std::string& group = "") {
  const auto motor = [&more](const std::string& name) {
    return "    type: sim\n    motors: [{name: " + name +
           ", model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 200" + more + "}]\n";
  };
  const auto outcome = parseRobotConfig(
      "robot: lift\nrealtime: preferred\nbuses:\n  - name: a\n" + motor("left") + "  - name: b\n" +
          motor("right") + "groups: [{name: lift, motors: [left, right], together: true" + group + "}]\n",
      "lift.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

/// One message for both.
void say(VirtualRobot& robot, const Target& left, const Target& right) {
  Command command;
  command.client = "test";
  command.received = command.said = robot.now();
  command.deadline = robot.now() + std::chrono::milliseconds{50};
  command.count = 2;
  command.setpoints[0] = {kLeft, left};
  command.setpoints[1] = {kRight, right};
  ASSERT_TRUE(robot.exchange().commands.push(command));
}

void stream(VirtualRobot& robot, const Target& target, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    say(robot, target, target);
    robot.tick();
    EXPECT_EQ(robot.motor(kLeft).target.mode, robot.motor(kRight).target.mode) << "both or none";
  }
}

bool told(VirtualRobot& robot, std::size_t motor, SkipReason reason) {
  for (const auto& event : robot.events()) {
    if (event.code == EventCode::kSetpointSkipped && event.source == static_cast<std::int16_t>(motor) &&
        event.value == static_cast<std::int32_t>(reason))
      return true;
  }
  return false;
}

TEST(MotorsOfOneThing, FollowNoAngleOnceTheReferenceOfOneIsLost) {
  VirtualRobot robot{lift(", on_timeout: brake, angle_slew_deg_per_s: 100")};
  robot.run(5);
  robot.order(Operation::kEnable);
  stream(robot, kTurn, 500);
  ASSERT_EQ(robot.motor(kLeft).target.mode, ControlMode::kTotalAngle);
  robot.simBus(0).silence(0, true);
  stream(robot, kTurn, 40);
  robot.simBus(0).silence(0, false);
  stream(robot, kTurn, 200);
  ASSERT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
  ASSERT_FALSE(robot.motor(kLeft).feedback.zeroed);
  EXPECT_EQ(robot.motor(kRight).target.mode, ControlMode::kCoast);
  EXPECT_EQ(robot.motor(kRight).acting, Acting::kBrake) << "its on_timeout";
  robot.events();
  robot.hold(kRight, kTurn, 20);
  EXPECT_EQ(robot.motor(kRight).target.mode, ControlMode::kCoast) << "in a message of its own";
  robot.run(1000);
  robot.hold(kRight, kTurn, 1);
  EXPECT_TRUE(told(robot, kRight, SkipReason::kGroup));
  stream(robot, {.mode = ControlMode::kVelocity, .value = 20.0}, 20);
  EXPECT_EQ(robot.motor(kRight).target.mode, ControlMode::kVelocity) << "that needs no place";
}

TEST(MotorsOfOneThing, FollowNoMessageThatIsAFirstStepTooFarForOne) {
  VirtualRobot robot{lift(", max_first_step_deg: 30")};
  robot.run(5);
  robot.order(Operation::kEnable);
  for (int i = 0; i < 2000 && robot.motor(kRight).feedback.total_angle_deg > -10.0; ++i)
    robot.hold(kRight, {.mode = ControlMode::kVelocity, .value = -10.0}, 1);
  ASSERT_LT(robot.motor(kRight).feedback.total_angle_deg, -9.0);
  robot.run(200);
  robot.events();
  stream(robot, {.mode = ControlMode::kTotalAngle, .value = 28.0}, 100);
  EXPECT_EQ(robot.motor(kLeft).target.mode, ControlMode::kCoast) << "28 degrees are near enough for it alone";
  EXPECT_TRUE(told(robot, kLeft, SkipReason::kGroup));
  stream(robot, {.mode = ControlMode::kTotalAngle, .value = 10.0}, 100);
  EXPECT_EQ(robot.motor(kLeft).target.mode, ControlMode::kTotalAngle) << "near enough for both";
}

TEST(MotorsOfOneThing, AreNotLetGoOfBeforeAllAreActive) {
  VirtualRobot robot{lift(", on_estop: hold")};
  robot.run(5);
  robot.order(Operation::kEnable);
  robot.run(10);
  robot.order(Operation::kEstop);
  robot.run(10);
  robot.order(Operation::kClear);
  ASSERT_EQ(robot.motor(kLeft).acting, Acting::kHold);
  robot.freezeBus(1, true);
  robot.beginEnabling(MotorSet{0b11});
  robot.run(5);
  ASSERT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
  ASSERT_EQ(robot.motor(kRight).status, MotorStatus::kEnabling) << "its first answer is not here yet";
  say(robot, kCoast, kCoast);
  robot.tick();
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kHold) << "the other still holds";
  EXPECT_EQ(robot.motor(kRight).acting, Acting::kHold);
  robot.freezeBus(1, false);
  robot.run(5);
  ASSERT_EQ(robot.motor(kRight).status, MotorStatus::kActive);
  say(robot, kCoast, kCoast);
  robot.tick();
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kNothing);
  EXPECT_EQ(robot.motor(kRight).acting, Acting::kNothing);
}

// Refused by its drive after it was ENABLING, one would stop the other, which would let go.
TEST(MotorsOfOneThing, AreHeldOnWhereOneOfThemMustRestBeforeItIsEnabled) {
  const auto motor = [](const char* name) {
    return std::string{"    type: sim\n    motors: [{name: "} + name +
           ", model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, feedback_hz: 500, "
           "feedback_timeout_ms: 400, on_disable: hold}]\n";
  };
  const auto outcome = parseRobotConfig("robot: lift\nrealtime: preferred\nbuses:\n  - name: a\n" +
                                            motor("left") + "  - name: b\n" + motor("right") +
                                            "groups: [{name: lift, motors: [left, right], together: true}]\n",
                                        "lift.yaml");
  ASSERT_TRUE(outcome.config) << outcome.errorText();
  VirtualRobot robot{*outcome.config};
  robot.run(100);
  ASSERT_EQ(robot.order(Operation::kEnable).motors[kLeft], Refusal::kNone);
  robot.simBus(0).silence(0, true);
  robot.tick(330);  // a pause of the computer; another drive may have been plugged in
  robot.simBus(0).silence(0, false);
  robot.run(50);
  robot.order(Operation::kDisable);
  const auto refused = robot.order(Operation::kEnable);
  EXPECT_EQ(refused.motors[kLeft], Refusal::kRestFirst);
  EXPECT_EQ(refused.motors[kRight], Refusal::kGroup);
  robot.run(50);
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kHold);
  EXPECT_EQ(robot.motor(kRight).acting, Acting::kHold);
}

}  // namespace
}  // namespace rc10::test::supervisor_together_test
