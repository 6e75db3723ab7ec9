// Motors that stop together.

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::supervisor_groups_test {
namespace {

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr std::size_t kYaw = 2;
MotorSet only(std::size_t motor) { return MotorSet{}.set(motor); }

constexpr Target kVelocity120{.mode = ControlMode::kVelocity, .value = 120.0};

/// `left` and `right` are coupled, on two buses; `yaw` shares the bus of `right`.
RobotConfig coupled(GroupConfig::Return on_return, const GuardConfig& guard = {}) {
  auto config = twoWheelsAndYaw();
  BusConfig other = config.buses[0];
  other.name = "other";
  other.motors = {makeMotor("right", kM3508, 2)};
  config.buses[0].motors = {makeMotor("left", kM3508, 1)};
  config.buses[0].motors[0].guard = guard;
  other.motors.push_back(makeMotor("yaw", kGM6020, 5));
  config.buses.push_back(std::move(other));
  config.groups.push_back(leftAndRight(on_return));
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
  /// Feedback of the bus of `left` is missing for this time.
  void losePower(int ticks) {
    robot->freezeBus(0, true);
    robot->run(ticks);
    robot->freezeBus(0, false);
  }
  /// Somebody else commands the drive of `left`.
  void foreignCommands() {
    CanFrame frame = makeClassicFrame({0x200, false}, std::array<std::uint8_t, 8>{1});
    for (int i = 0; i < 3; ++i) {
      frame.received = robot->now();
      ASSERT_TRUE(robot->inboxes()[0].frames.push(frame));
      robot->tick();
    }
  }
  bool told(EventCode code) {
    const auto events = robot->events();
    return std::any_of(events.begin(), events.end(), [code](const Event& e) { return e.code == code; });
  }

  void expectNoReturn() {
    robot->run(20'000);
    EXPECT_EQ(status(kLeft), MotorStatus::kReady);
    EXPECT_EQ(status(kRight), MotorStatus::kReady);
    EXPECT_FALSE(told(EventCode::kGroupRearmed));
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

TEST_F(GroupTest, AMemberThatHoldsStaysSoWhenAnotherIsDisabledAndNobodyAskedForIt) {
  for (const auto asked : {Asked::kAnew, Asked::kUnasked}) {
    auto config = coupled(GroupConfig::Return::kRequest);
    config.buses[1].motors[0].fallback.on_timeout = FallbackAction::kHold;
    robot = std::make_unique<VirtualRobot>(config);
    robot->run(5);
    robot->order(Operation::kEnable);
    drive(100);
    robot->run(200);  // silence
    ASSERT_EQ(robot->motor(kRight).acting, Acting::kHold);
    robot->carryOut({.operation = Operation::kDisable, .motors = only(kLeft), .asked = asked});
    EXPECT_EQ(status(kRight), MotorStatus::kReady);
    EXPECT_EQ(robot->motor(kRight).acting, asked == Asked::kAnew ? Acting::kNothing : Acting::kHold);
  }
}

TEST_F(GroupTest, AMemberThatHoldsAfterADisableStopsWithOneThatIsLost) {
  for (const auto asked : {Asked::kAnew, Asked::kUnasked}) {
    auto config = coupled(GroupConfig::Return::kRequest);
    auto& right = config.buses[1].motors[0].fallback;
    right.on_timeout = right.on_disable = FallbackAction::kHold;
    right.on_estop = FallbackAction::kDamp;
    robot = std::make_unique<VirtualRobot>(config);
    robot->run(5);
    robot->order(Operation::kEnable);
    drive(100);
    if (asked == Asked::kUnasked) robot->run(200);  // silence
    robot->carryOut({.operation = Operation::kDisable, .motors = only(kLeft).set(kRight), .asked = asked});
    robot->run(100);
    (void)robot->events();
    robot->freezeBus(0, true);
    for (int i = 0; i < 100 && status(kLeft) != MotorStatus::kOffline; ++i, robot->tick())
      EXPECT_EQ(robot->motor(kRight).acting, Acting::kHold);
    EXPECT_EQ(robot->motor(kRight).acting, Acting::kDamp) << "in that tick";
    EXPECT_TRUE(told(EventCode::kGroupStopped));
    robot->run(100);
    EXPECT_FALSE(told(EventCode::kGroupStopped)) << "once";
    robot->carryOut({.operation = Operation::kDisable, .motors = only(kRight), .asked = Asked::kAnew});
    EXPECT_EQ(robot->motor(kRight).acting, Acting::kNothing) << "one disable lets go";
  }
}

TEST_F(GroupTest, AMemberThatIsHeldWhileAnotherWasMissingBeforeIsNotLetGo) {
  auto config = coupled(GroupConfig::Return::kRequest);
  config.buses[1].motors[0].fallback.on_disable = FallbackAction::kHold;
  robot = std::make_unique<VirtualRobot>(config);
  robot->freezeBus(0, true);
  robot->run(5);
  ASSERT_EQ(robot->orderFor(only(kRight), Operation::kEnableAlone).motors[kRight], Refusal::kNone);
  robot->hold(kRight, kVelocity120, 100);
  robot->orderFor(only(kRight), Operation::kDisable);
  robot->run(100);
  EXPECT_EQ(robot->motor(kRight).acting, Acting::kHold);
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

TEST_F(GroupTest, AfterALongLossItWaitsForARequest) {
  start(GroupConfig::Return::kRearmAtRest);
  losePower(4000);
  expectNoReturn();
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

// A fault of a member that is back waits for a person, who clears it and enables them himself.
TEST_F(GroupTest, AFaultOfAMemberEndsTheRearming) {
  start(GroupConfig::Return::kRearmAtRest);
  losePower(50);
  robot->run(5);
  ASSERT_EQ(status(kLeft), MotorStatus::kReady);
  foreignCommands();
  ASSERT_EQ(status(kLeft), MotorStatus::kFault);
  robot->orderFor(only(kLeft), Operation::kClear);
  expectNoReturn();
}

TEST_F(GroupTest, MembersThatStandWaitForOneThatIsLost) {
  start(GroupConfig::Return::kRearmAtRest);
  for (int i = 0; i < 2000; ++i) {
    for (const auto motor : {kLeft, kRight}) robot->command(motor, {.mode = ControlMode::kBrake});
    robot->tick();
  }
  losePower(1500);
  ASSERT_EQ(status(kRight), MotorStatus::kReady);
  robot->run(1000);
  EXPECT_EQ(status(kLeft), MotorStatus::kActive);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
}

/// An optional member, while the others come back.
class OptionalMemberTest : public GroupTest {
 protected:
  /// `right` falls silent, and meanwhile this happens to `left`, which is optional and was ACTIVE.
  template <typename Happens>
  void loseRightAnd(const Happens& happens) {
    auto config = coupled(GroupConfig::Return::kRearmAtRest);
    config.buses[0].motors[0].optional = true;
    robot = std::make_unique<VirtualRobot>(config);
    robot->run(5);
    robot->order(Operation::kEnable);
    drive(100);
    robot->freezeBus(1, true);
    robot->run(50);
    ASSERT_EQ(status(kLeft), MotorStatus::kReady) << "it stops with its group";
    happens();
    robot->freezeBus(1, false);
    robot->run(20'000);
  }
};

TEST_F(OptionalMemberTest, ThatIsSilentIsNotWaitedFor) {
  loseRightAnd([this] { robot->simBus(0).silence(0, true); });
  EXPECT_EQ(status(kLeft), MotorStatus::kOffline);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
}

TEST_F(OptionalMemberTest, InFaultKeepsNobodyFromComingBack) {
  loseRightAnd([this] { foreignCommands(); });
  EXPECT_EQ(status(kLeft), MotorStatus::kFault);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
}

// ---- All or none

TEST_F(GroupTest, AMemberThatIsLostBeforeItObeysStopsTheOthers) {
  start(GroupConfig::Return::kRearmAtRest);
  robot->orderFor(only(kLeft) | only(kRight), Operation::kDisable);
  robot->run(3000);
  ASSERT_EQ(robot->orderFor(only(kRight), Operation::kEnable).motors[kRight], Refusal::kNone);
  ASSERT_EQ(status(kLeft), MotorStatus::kReady);
  ASSERT_EQ(status(kRight), MotorStatus::kActive);
  robot->freezeBus(0, true);
  int ticks = 0;
  while (status(kLeft) == MotorStatus::kReady && ++ticks < 100) {
    ASSERT_EQ(status(kRight), MotorStatus::kActive);
    drive(1);
  }
  EXPECT_EQ(status(kLeft), MotorStatus::kOffline);
  EXPECT_EQ(status(kRight), MotorStatus::kReady) << "in the same tick";
}

TEST_F(GroupTest, OneThatIsDisabledDisablesTheOthers) {
  start(GroupConfig::Return::kRearmAtRest);
  robot->orderFor(only(kLeft), Operation::kDisable);
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
  EXPECT_EQ(status(kYaw), MotorStatus::kActive);
  EXPECT_TRUE(told(EventCode::kGroupStopped));
  robot->run(20'000);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady) << "and it does not come back by itself";
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
}

TEST_F(GroupTest, WhatStopsWithADisabledMotorDoesWhatItDoesWhenDisabledAndItsOwnDisableLetsNothingGo) {
  auto config = coupled(GroupConfig::Return::kRequest);
  for (auto& motor : config.buses[1].motors) {
    motor.fallback.on_disable = FallbackAction::kBrake;
    motor.fallback.on_estop = FallbackAction::kCoast;
  }
  robot = std::make_unique<VirtualRobot>(config);
  robot->run(5);
  robot->order(Operation::kEnable);
  drive(1000);
  robot->orderFor(only(kLeft), Operation::kDisable);
  robot->run(3);
  EXPECT_LT(robot->motor(kRight).command_value, -0.1F) << "it brakes";
  robot->orderFor(only(kRight), Operation::kDisable);
  robot->run(3);
  EXPECT_LT(robot->motor(kRight).command_value, -0.1F) << "the request that follows was meant to do that";
  robot->orderFor(only(kRight), Operation::kDisable);
  robot->run(3);
  EXPECT_EQ(robot->motor(kRight).command_value, 0.0F) << "once more lets go";
}

TEST_F(GroupTest, AnOptionalMemberStopsWithTheOthersAndNothingStopsForIt) {
  auto config = coupled(GroupConfig::Return::kRequest);
  config.buses[0].motors[0].optional = true;
  robot = std::make_unique<VirtualRobot>(config);
  robot->run(5);
  robot->order(Operation::kEnable);
  drive(100);
  losePower(50);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
  robot->run(5);
  ASSERT_EQ(robot->orderFor(only(kLeft), Operation::kEnable).motors[kLeft], Refusal::kNone);
  robot->orderFor(only(kRight), Operation::kDisable);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
}

TEST_F(GroupTest, MembersThatAPersonHasEnabledFirstAreNotSaidToComeBackByThemselves) {
  start(GroupConfig::Return::kRearmAtRest);
  robot->order(Operation::kEnable);
  losePower(50);
  robot->run(50);
  robot->events();
  ASSERT_EQ(robot->order(Operation::kEnable).motors[kLeft], Refusal::kNone);
  robot->run(1000);
  EXPECT_EQ(status(kLeft), MotorStatus::kActive);
  for (const auto& event : robot->events()) EXPECT_NE(event.code, EventCode::kGroupRearmed);
}

TEST_F(GroupTest, AMemberThatIsHeldWhileItIsEnabledStopsAsItsGroupDoes) {
  auto config = coupled(GroupConfig::Return::kRequest);
  config.buses[0].motors[0].fallback = {.on_disable = FallbackAction::kHold,
                                        .on_estop = FallbackAction::kDamp};
  robot = std::make_unique<VirtualRobot>(config);
  robot->run(5);
  robot->order(Operation::kEnable);
  drive(500);
  robot->order(Operation::kDisable);
  robot->run(100);
  ASSERT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  robot->freezeBus(1, true);
  robot->run(5);
  robot->beginEnabling(only(kLeft) | only(kRight));
  for (int i = 0; i < 200 && status(kRight) != MotorStatus::kOffline; ++i) robot->tick();
  ASSERT_EQ(status(kRight), MotorStatus::kOffline);
  robot->run(2);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kDamp);
}

TEST_F(GroupTest, AMemberThatIsMissingIsNamed) {
  start(GroupConfig::Return::kRequest);
  robot->freezeBus(0, true);
  robot->run(50);
  EXPECT_EQ(robot->orderFor(only(kRight), Operation::kEnable).in_the_way, only(kLeft));
}

class TogetherTest : public GroupTest {
 protected:
  void SetUp() override {
    auto config = coupled(GroupConfig::Return::kRearmAtRest);
    config.groups[0].together = true;
    robot = std::make_unique<VirtualRobot>(config);
    robot->run(5);
  }
};

TEST_F(TogetherTest, AllAreEnabledOrNone) {
  const auto alone = robot->orderFor(only(kLeft) | only(kYaw), Operation::kEnable);
  EXPECT_EQ(alone.motors[kLeft], Refusal::kTogether);
  EXPECT_EQ(alone.in_the_way, only(kRight));
  EXPECT_EQ(alone.motors[kYaw], Refusal::kNone) << "it is in no group";
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
  const auto both = robot->orderFor(only(kLeft) | only(kRight), Operation::kEnable);
  EXPECT_EQ(both.motors[kLeft], Refusal::kNone);
  EXPECT_EQ(both.motors[kRight], Refusal::kNone);
  EXPECT_EQ(robot->orderFor(only(kLeft), Operation::kEnable).motors[kLeft], Refusal::kNone) << "once more";
}

TEST_F(TogetherTest, ADisableLetsGoOfAllOrNone) {
  auto config = coupled(GroupConfig::Return::kRequest);
  config.groups[0].together = true;
  for (const auto place : {0U, 1U}) {
    for (auto& motor : config.buses[place].motors) motor.fallback.on_disable = FallbackAction::kHold;
  }
  robot = std::make_unique<VirtualRobot>(config);
  robot->run(5);
  robot->orderFor(only(kLeft) | only(kRight), Operation::kEnable);
  robot->run(50);
  robot->orderFor(only(kLeft), Operation::kDisable);
  robot->run(3);
  ASSERT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  ASSERT_EQ(robot->motor(kRight).acting, Acting::kHold);
  robot->orderFor(only(kLeft) | only(kRight), Operation::kDisable);
  robot->run(3);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kHold) << "for the right one it was the first";
  EXPECT_EQ(robot->motor(kRight).acting, Acting::kHold);
  robot->orderFor(only(kLeft), Operation::kDisable);
  robot->run(3);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kNothing);
  EXPECT_EQ(robot->motor(kRight).acting, Acting::kNothing) << "together";
}

TEST_F(TogetherTest, TheFirstDisableThatSomebodyAsksForDoesTheOnDisableOfAll) {
  auto config = coupled(GroupConfig::Return::kRequest);
  config.groups[0].together = true;
  for (const auto place : {0U, 1U}) {
    for (auto& motor : config.buses[place].motors)
      motor.fallback = {.on_timeout = FallbackAction::kHold, .on_disable = FallbackAction::kHold};
  }
  robot = std::make_unique<VirtualRobot>(config);
  robot->run(5);
  const auto both = only(kLeft) | only(kRight);
  robot->orderFor(both, Operation::kEnable);
  robot->run(50);
  robot->carryOut({.operation = Operation::kDisable, .motors = both, .asked = Asked::kUnasked});
  robot->run(3);
  for (const auto acting : {Acting::kHold, Acting::kNothing}) {
    robot->orderFor(both, Operation::kDisable);
    robot->run(3);
    EXPECT_EQ(robot->motor(kLeft).acting, acting) << "names both, once";
    EXPECT_EQ(robot->motor(kRight).acting, acting);
  }
}

TEST_F(TogetherTest, AnOptionalMemberThatRestsDoesNotMakeTheFirstDisableOfTheOthersASecondOne) {
  auto config = coupled(GroupConfig::Return::kRequest);
  config.groups[0].together = true;
  for (const auto place : {0U, 1U}) {
    for (auto& motor : config.buses[place].motors) motor.fallback.on_disable = FallbackAction::kHold;
  }
  config.buses[1].motors[0].optional = true;
  robot = std::make_unique<VirtualRobot>(config);
  robot->run(5);
  robot->orderFor(only(kLeft), Operation::kEnable);
  robot->run(50);
  ASSERT_EQ(status(kLeft), MotorStatus::kActive);
  robot->orderFor(only(kLeft) | only(kRight), Operation::kDisable);
  robot->run(3);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kHold);
}

TEST_F(TogetherTest, NoneIsEnabledWhileOneCannotBe) {
  robot->freezeBus(0, true);
  robot->run(50);
  const auto result = robot->order(Operation::kEnable);
  EXPECT_EQ(result.motors[kLeft], Refusal::kOffline);
  EXPECT_EQ(result.motors[kRight], Refusal::kGroup);
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
}

TEST_F(TogetherTest, AMemberIsEnabledAloneWithoutTheOthers) {
  robot->freezeBus(0, true);
  robot->run(50);
  EXPECT_EQ(robot->orderFor(only(kRight), Operation::kEnableAlone).motors[kRight], Refusal::kNone);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
  drive(100);
  EXPECT_EQ(robot->motor(kRight).target.mode, ControlMode::kVelocity);
}

/// An arm whose drive takes some ticks to be enabled, and a wheel whose drive takes none, each on its bus.
RobotConfig lifter(const std::string& more_of_arm) {
  const auto outcome = parseRobotConfig(
      "robot: lifter\nrealtime: preferred\nbuses:\n  - name: a\n    type: sim\n    motors:\n"
      "      - {name: arm, model: DM4310, id: 1, master_id: 17" +
          more_of_arm +
          "}\n  - name: b\n    type: sim\n    motors: [{name: wheel, model: M3508, id: 2}]\n"
          "groups: [{name: both, motors: [arm, wheel], together: true, on_return: rearm_at_rest}]\n",
      "lifter.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

TEST(GroupThatActsTogether, FollowsNoTargetBeforeAllAreActive) {
  VirtualRobot robot{lifter("")};
  robot.run(100);
  robot.beginEnabling(only(0) | only(1));
  bool waited = false;
  for (int i = 0; i < 500 && robot.motor(0).target.mode == ControlMode::kCoast; ++i) {
    for (const auto motor : {0U, 1U}) robot.command(motor, {.mode = ControlMode::kVelocity, .value = 5.0});
    robot.tick();
    const auto arm = robot.motor(0).status;
    const auto wheel = robot.motor(1).status;
    if (arm == MotorStatus::kActive && wheel == MotorStatus::kActive) continue;
    waited |= wheel == MotorStatus::kActive && arm == MotorStatus::kEnabling;
    EXPECT_EQ(robot.motor(0).target.mode, ControlMode::kCoast);
    EXPECT_EQ(robot.motor(1).target.mode, ControlMode::kCoast);
  }
  EXPECT_TRUE(waited);
  EXPECT_EQ(robot.motor(0).target.mode, ControlMode::kVelocity);
  EXPECT_EQ(robot.motor(1).target.mode, ControlMode::kVelocity);
}

TEST(GroupThatActsTogether, DoesNotComeBackInPartIfItWasNotWhole) {
  VirtualRobot robot{lifter("")};
  robot.run(100);
  robot.beginEnabling(only(0) | only(1));
  for (int i = 0; i < 10 && robot.motor(1).status != MotorStatus::kActive; ++i) robot.tick();
  ASSERT_EQ(robot.motor(1).status, MotorStatus::kActive);
  ASSERT_EQ(robot.motor(0).status, MotorStatus::kEnabling);
  robot.freezeBus(0, true);
  robot.run(50);
  ASSERT_EQ(robot.motor(0).status, MotorStatus::kOffline);
  robot.freezeBus(0, false);
  robot.run(2000);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kReady);
  EXPECT_EQ(robot.motor(1).status, MotorStatus::kReady);
}

TEST(GroupThatActsTogether, IsNotSaidToBeEnabledAgainWhileADriveIsConfigured) {
  VirtualRobot robot{lifter(", feedback_timeout_ms: 1000")};
  robot.run(100);
  robot.order(Operation::kEnable);
  ASSERT_EQ(robot.motor(0).status, MotorStatus::kActive);
  robot.freezeBus(1, true);
  robot.run(50);
  robot.freezeBus(1, false);
  robot.run(290);                    // of 300 ms at rest
  robot.simBus(0).silence(0, true);  // the drive does not answer
  Order order;
  order.id = 77;
  order.operation = Operation::kConfigure;
  order.motors.set(0);
  order.drive.count = 1;
  order.drive.values[0] = {0, 100.0};
  ASSERT_TRUE(robot.exchange().orders.push(order));
  robot.run(30);
  OrderResult result;
  ASSERT_FALSE(robot.exchange().results.pop(result)) << "it is being configured";
  bool stopped = false;
  for (const auto& event : robot.events()) {
    stopped |= event.code == EventCode::kGroupStopped;
    EXPECT_NE(event.code, EventCode::kGroupRearmed);
  }
  EXPECT_TRUE(stopped);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kReady);
  EXPECT_EQ(robot.motor(1).status, MotorStatus::kReady);
}

}  // namespace
}  // namespace rc10::test::supervisor_groups_test
