// The end of an e-stop of a robot that a slope moves.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::axis_unrest_test {
namespace {

constexpr std::size_t kWheel = 0;
constexpr Target kForwards{.mode = ControlMode::kVelocity, .value = 60.0};

/// A wheel on a slope, which runs down for two seconds at most.
RobotConfig onASlope(const std::string& keys) {
  auto outcome = parseRobotConfig(
      "robot: slope\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    motors:\n"
      "      - {name: wheel, model: M3508, id: 1, run_down_s: 2, " +
          keys + ", simulated: {load_torque_nm: 1.5}}\n",
      "slope.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

void stopWhileItDrives(VirtualRobot& robot) {
  robot.run(10);
  ASSERT_EQ(robot.order(Operation::kEnable).motors[kWheel], Refusal::kNone);
  robot.hold(kWheel, kForwards, 500);
  robot.exchange().estop.store(true);
  robot.tick();
}

TEST(ClearOnASlope, IsTakenOnceWhatStillTurnsIsPulledAndResisted) {
  for (const char* keys : {"on_estop: brake, brake_max_s: 0.5", "on_estop: damp"}) {
    VirtualRobot robot(onASlope(keys));
    stopWhileItDrives(robot);
    robot.run(1000);
    EXPECT_LT(robot.motor(kWheel).feedback.velocity_rpm, -15.0F) << "it rolls, damped";
    EXPECT_EQ(robot.order(Operation::kClear).motors[kWheel], Refusal::kMoving) << "it may be running down";
    robot.run(1000);
    const float rolls_rpm = robot.motor(kWheel).feedback.velocity_rpm;
    EXPECT_EQ(robot.order(Operation::kClear).motors[kWheel], Refusal::kNone);
    EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun);
    EXPECT_EQ(robot.motor(kWheel).status, MotorStatus::kReady);
    // Nothing has been taken off, and nothing moves by itself.
    robot.run(500);
    EXPECT_EQ(robot.motor(kWheel).acting, Acting::kDamp);
    EXPECT_NEAR(robot.motor(kWheel).feedback.velocity_rpm, rolls_rpm, 5.0F);
    // The driver has it back.
    ASSERT_EQ(robot.order(Operation::kEnable).motors[kWheel], Refusal::kNone);
    robot.hold(kWheel, {.mode = ControlMode::kVelocity, .value = 0.0}, 1000);
    EXPECT_NEAR(robot.motor(kWheel).feedback.velocity_rpm, 0.0F, 3.0F);
  }
}

TEST(ClearOnASlope, IsRefusedAsLongAsNothingResists) {
  VirtualRobot robot(onASlope("on_estop: coast"));
  stopWhileItDrives(robot);
  for (int i = 0; i < 10; ++i) {
    robot.run(500);
    EXPECT_EQ(robot.order(Operation::kClear).motors[kWheel], Refusal::kMoving);
  }
}

}  // namespace
}  // namespace rc10::test::axis_unrest_test
