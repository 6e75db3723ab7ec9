// Groups that are enabled again by themselves: only while somebody still expects it.
#include <gtest/gtest.h>

#include <string>

#include "daemon/robot_of_text.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::supervisor_return_test {
namespace {

/// Two wheels, on a bus each.
class ReturnTest : public ::testing::Test {
 protected:
  VirtualRobot robot{
      robotOfText("robot: cart\nrealtime: preferred\nbuses:\n"
                  "  - {name: a, type: sim, motors: [{name: left, model: M3508, id: 1}]}\n"
                  "  - {name: b, type: sim, motors: [{name: right, model: M3508, id: 1}]}\n"
                  "groups: [{name: wheels, motors: [left, right], on_return: rearm_at_rest}]\n")};
};

/// Seconds for which one is pushed.
class PushedReturnTest : public ReturnTest, public ::testing::WithParamInterface<int> {};

TEST_P(PushedReturnTest, IsOverTenSecondsAfterTheLossHoweverTheTimeWasSpent) {
  robot.run(100);
  ASSERT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
  robot.run(50);
  const auto enabled_by = robot.motor(0).enabled_by;
  EXPECT_NE(enabled_by, 0U);
  robot.freezeBus(1, true);
  robot.run(100);
  robot.freezeBus(1, false);
  // It is pushed.
  auto& shaft = robot.simBus(0).drive(0).physics();
  shaft.take({.by_deg = 360.0 * GetParam(), .speed_rpm = 60.0, .torque_nm = 500.0});
  robot.run(5);
  while (shaft.held()) {
    robot.run(1);
    if (GetParam() > 10) {
      ASSERT_EQ(robot.motor(1).status, MotorStatus::kReady);
    }
  }
  robot.run(4000);
  const auto expected = GetParam() < 10 ? MotorStatus::kActive : MotorStatus::kReady;
  for (std::size_t motor = 0; motor < 2; ++motor) EXPECT_EQ(robot.motor(motor).status, expected);
  EXPECT_EQ(robot.motor(0).enabled_by, enabled_by) << "a return is no order";
  robot.order(Operation::kEnable);
  EXPECT_EQ(robot.motor(0).enabled_by != enabled_by, expected == MotorStatus::kReady)
      << "an order that switches it on";
}

TEST_F(ReturnTest, ComesOnlyWhenRestWasSeenNotAfterATimeInWhichNothingWas) {
  robot.run(100);
  ASSERT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
  robot.run(50);
  robot.freezeBus(1, true);
  robot.run(100);
  robot.freezeBus(1, false);
  robot.run(20);
  ASSERT_EQ(robot.motor(1).status, MotorStatus::kReady);
  robot.freezeSimulation(true);
  robot.tick(600);
  for (std::size_t motor = 0; motor < 2; ++motor) EXPECT_EQ(robot.motor(motor).status, MotorStatus::kReady);
  robot.freezeSimulation(false);
  robot.run(400);
  for (std::size_t motor = 0; motor < 2; ++motor) EXPECT_EQ(robot.motor(motor).status, MotorStatus::kActive);
}

INSTANTIATE_TEST_SUITE_P(Seconds, PushedReturnTest, ::testing::Values(2, 11, 30),
                         [](const auto& each) { return "For" + std::to_string(each.param) + "Seconds"; });

}  // namespace
}  // namespace rc10::test::supervisor_return_test
