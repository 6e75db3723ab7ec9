// Motors that stop together.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "daemon/virtual_robot.hpp"

namespace rc10::test::group_test {
namespace {

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr std::size_t kYaw = 2;
constexpr Target kVelocity120{.mode = ControlMode::kVelocity, .value = 120.0};

/// `left` and `right` are coupled, on buses of their own; `yaw` shares the bus of `left`.
RobotConfig coupled(GroupConfig::Return on_return, const GuardConfig& guard = {}) {
  auto config = twoWheelsAndYaw();
  BusConfig other = config.buses[0];
  other.name = "other";
  other.motors = {makeMotor("right", kM3508, 2)};
  config.buses[0].motors = {makeMotor("left", kM3508, 1)};
  config.buses[0].motors[0].guard = guard;
  other.motors.push_back(makeMotor("yaw", kGM6020, 5));
  config.buses.push_back(std::move(other));
  GroupConfig group;
  group.name = "drive";
  group.motors = {kLeft, kRight};
  group.on_return = on_return;
  config.groups.push_back(std::move(group));
  return config;
}

class GroupTest : public ::testing::Test {
 protected:
  void start(GroupConfig::Return on_return, const GuardConfig& guard = {}) {
    robot = std::make_unique<VirtualRobot>(coupled(on_return, guard));
    robot->run(5);
    robot->order(Operation::kEnable);
    drive(1000);
  }
  void drive(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      for (const auto motor : {kLeft, kRight, kYaw}) robot->command(motor, {kVelocity120.mode, 60.0});
      robot->tick();
    }
  }
  MotorStatus status(std::size_t motor) { return robot->motor(motor).status; }
  /// Feedback of the bus of `left` is missing for so long.
  void losePower(int ticks) {
    robot->freezeBus(0, true);
    robot->run(ticks);
    robot->freezeBus(0, false);
  }
  bool told(EventCode code) {
    const auto events = robot->events();
    return std::any_of(events.begin(), events.end(), [code](const Event& e) { return e.code == code; });
  }

  std::unique_ptr<VirtualRobot> robot;
};

TEST_F(GroupTest, AMemberThatGoesOfflineStopsTheOthersInTheSameTick) {
  start(GroupConfig::Return::kRequest);
  robot->freezeBus(0, true);
  for (int i = 0; i < 100 && status(kLeft) == MotorStatus::kActive; ++i) drive(1);
  EXPECT_EQ(status(kLeft), MotorStatus::kOffline);
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
  EXPECT_EQ(robot->motor(kRight).command_value, 0.0F);
  EXPECT_EQ(status(kYaw), MotorStatus::kActive);
  EXPECT_TRUE(told(EventCode::kGroupStopped));
}

TEST_F(GroupTest, AMemberInFaultStopsTheOthers) {
  start(GroupConfig::Return::kRearmAtRest, {.overspeed_rpm = 90.0F});
  for (int i = 0; i < 1000; ++i) {
    robot->command(kLeft, kVelocity120);
    drive(1);
    robot->command(kLeft, kVelocity120);
    robot->tick();
  }
  EXPECT_EQ(status(kLeft), MotorStatus::kFault);
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
}

TEST_F(GroupTest, NoMemberIsEnabledWhileAnotherIsMissing) {
  start(GroupConfig::Return::kRequest);
  robot->freezeBus(0, true);
  robot->run(50);
  const auto result = robot->order(Operation::kEnable);
  EXPECT_EQ(result.motors[kLeft], Refusal::kOffline);
  EXPECT_EQ(result.motors[kRight], Refusal::kGroup);
  EXPECT_EQ(result.motors[kYaw], Refusal::kNone);
}

TEST_F(GroupTest, ByDefaultItWaitsForARequest) {
  start(GroupConfig::Return::kRequest);
  losePower(300);
  robot->run(20'000);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
  EXPECT_EQ(robot->order(Operation::kEnable).motors[kRight], Refusal::kNone);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
}

TEST_F(GroupTest, RearmAtRestWaitsUntilEveryMemberStandsStill) {
  start(GroupConfig::Return::kRearmAtRest);
  losePower(300);
  robot->run(5);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
  int ticks = 0;
  while (status(kRight) != MotorStatus::kActive && ++ticks < 30'000) {
    ASSERT_EQ(robot->motor(kRight).command_value, 0.0F);
    robot->tick();
  }
  EXPECT_EQ(status(kLeft), MotorStatus::kActive);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
  EXPECT_LT(std::fabs(robot->motor(kLeft).feedback.velocity_rpm), 10.0F);
  EXPECT_LT(std::fabs(robot->motor(kRight).feedback.velocity_rpm), 10.0F);
  EXPECT_TRUE(told(EventCode::kGroupRearmed));
  drive(1000);
  EXPECT_NEAR(robot->motor(kRight).feedback.velocity_rpm, 60.0F, 3.0F);
}

TEST_F(GroupTest, MembersThatAreLostTogetherAreEnabledTogether) {
  start(GroupConfig::Return::kRearmAtRest);
  robot->freezeSimulation(true);
  robot->run(50);
  EXPECT_EQ(status(kLeft), MotorStatus::kOffline);
  EXPECT_EQ(status(kRight), MotorStatus::kOffline);
  robot->freezeSimulation(false);
  for (int i = 0; i < 30'000 && status(kRight) != MotorStatus::kActive; ++i) robot->tick();
  EXPECT_EQ(status(kLeft), MotorStatus::kActive);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
}

TEST_F(GroupTest, AnEstopThatIsClearedInTheNextTickEndsTheRearmingToo) {
  start(GroupConfig::Return::kRearmAtRest);
  for (int i = 0; i < 2000; ++i) {
    for (const auto motor : {kLeft, kRight, kYaw}) robot->command(motor, {.mode = ControlMode::kBrake});
    robot->tick();
  }
  robot->freezeSimulation(true);
  robot->run(25);
  EXPECT_EQ(status(kLeft), MotorStatus::kOffline);
  robot->freezeSimulation(false);
  robot->run(5);  // there and still, though not for long enough
  robot->exchange().estop.store(true);
  robot->tick();
  robot->order(Operation::kClear);
  EXPECT_EQ(robot->snapshot().state, RobotStatus::kRun);
  robot->run(2000);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
}

TEST_F(GroupTest, AnEstopOrADisableInBetweenEndsTheRearming) {
  for (const bool estop : {true, false}) {
    start(GroupConfig::Return::kRearmAtRest);
    losePower(300);
    if (estop) {
      robot->exchange().estop.store(true);
      robot->run(5000);
      robot->order(Operation::kClear);
    } else {
      robot->order(Operation::kDisable);
    }
    robot->run(20'000);
    EXPECT_EQ(robot->snapshot().state, RobotStatus::kRun);
    EXPECT_EQ(status(kLeft), MotorStatus::kReady) << estop;
    EXPECT_EQ(status(kRight), MotorStatus::kReady) << estop;
  }
}

}  // namespace
}  // namespace rc10::test::group_test
