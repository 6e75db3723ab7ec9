// The cause of a stop, and the client behind it: in the state, and in the event.

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/virtual_robot.hpp"

namespace rc10::test::supervisor_stop_cause_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr Target kVelocity60{.mode = ControlMode::kVelocity, .value = 60.0};

RobotConfig withFallbacks() {
  auto config = twoWheelsAndYaw();
  auto& left = config.buses[0].motors[0].fallback;
  left.on_timeout = FallbackAction::kHold;
  left.on_disable = FallbackAction::kBrake;
  left.on_estop = FallbackAction::kDamp;
  config.groups.push_back(leftAndRight());
  return config;
}

class StopCauseTest : public ::testing::Test {
 protected:
  StopCauseTest() {
    robot.run(5);
    robot.order(Operation::kEnable);
    robot.hold(kLeft, kVelocity60, 500);
    robot.events();
  }
  OrderResult asked(Operation operation, const char* client, MotorSet motors, bool whole_robot) {
    Order order;
    order.operation = operation;
    order.motors = motors;
    order.client = client;
    order.whole_robot = whole_robot;
    return robot.carryOut(order);
  }
  std::vector<std::string> told() {
    std::vector<std::string> texts;
    for (const auto& event : robot.events()) texts.push_back(describe(event));
    return texts;
  }
  const Stop& stopOf(std::size_t motor) { return robot.motor(motor).stop; }

  VirtualRobot robot{withFallbacks()};
};

TEST_F(StopCauseTest, AMotorThatObeysHasNone) {
  robot.command(kLeft, kVelocity60);
  robot.tick();
  EXPECT_EQ(stopOf(kLeft).cause, StopCause::kNone);
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kTarget);
  EXPECT_EQ(robot.motor(kLeft).target_shaped, 60.0);
}

TEST_F(StopCauseTest, ALapsedCommandLeavesItActiveAndHeld) {
  robot.run(60);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
  EXPECT_EQ(stopOf(kLeft).cause, StopCause::kTimeout);
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kHold);
  EXPECT_TRUE(std::isnan(robot.motor(kLeft).target_shaped));
  robot.command(kLeft, kVelocity60);
  robot.tick();
  EXPECT_EQ(stopOf(kLeft).cause, StopCause::kNone);
}

TEST_F(StopCauseTest, DisablingNamesTheClientAndTheMotorOfTheGroup) {
  asked(Operation::kDisable, "teleop", MotorSet{}.set(kLeft), false);
  EXPECT_EQ(stopOf(kLeft).cause, StopCause::kRequest);
  EXPECT_EQ(stopOf(kLeft).by.view(), "teleop");
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kBrake) << "READY, and not without torque";
  EXPECT_EQ(stopOf(kRight).cause, StopCause::kGroup);
  EXPECT_EQ(stopOf(kRight).by.view(), "left");
  const auto texts = told();
  EXPECT_THAT(texts, Contains("ACTIVE -> READY (asked for by 'teleop')"));
  EXPECT_THAT(texts, Contains("ACTIVE -> READY (its group stopped for 'left')"));
}

TEST_F(StopCauseTest, AnEstopNamesWhoAskedForItAndWhoClearedIt) {
  asked(Operation::kEstop, "judge", {}, true);
  EXPECT_EQ(robot.snapshot().stop.cause, StopCause::kRequest);
  EXPECT_EQ(robot.snapshot().stop.by.view(), "judge");
  EXPECT_EQ(robot.snapshot().estops, 1U);
  EXPECT_EQ(stopOf(kLeft).cause, StopCause::kEstop);
  EXPECT_EQ(stopOf(kLeft).by.view(), "judge");
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kDamp);
  EXPECT_THAT(told(), Contains("RUN -> ESTOP (asked for by 'judge')"));
  robot.run(2000);
  asked(Operation::kClear, "captain", {}, true);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun);
  EXPECT_EQ(robot.snapshot().stop.cause, StopCause::kNone);
  EXPECT_EQ(robot.snapshot().stopped, MonotonicTime{});
  EXPECT_EQ(robot.snapshot().estops, 1U);
  EXPECT_EQ(stopOf(kLeft).cause, StopCause::kEstop) << "why it is not enabled";
  EXPECT_THAT(told(), Contains("ESTOP -> RUN (by 'captain')"));
}

TEST_F(StopCauseTest, AnEstopPastAFullRingIsNamedToo) {
  robot.exchange().estop_client.slot() = "judge";
  robot.exchange().estop_client.publish();
  robot.exchange().estop.store(true);
  robot.tick();
  EXPECT_EQ(robot.snapshot().stop.by.view(), "judge");
  EXPECT_EQ(robot.snapshot().stopped, robot.now());
}

TEST_F(StopCauseTest, AnEstopByDatagramIsNamedAndVetoesAClearOfItsTick) {
  const auto sent = [this](std::string_view client) {
    robot.exchange().estop_datagram_client.slot() = client;
    robot.exchange().estop_datagram_client.publish();
    robot.exchange().estop_datagram.store(true);
  };
  sent("pult");
  robot.tick();
  EXPECT_EQ(robot.snapshot().stop.by.view(), "pult");
  robot.run(2000);
  sent("again");
  EXPECT_EQ(asked(Operation::kClear, "captain", {}, true).motors[kLeft], Refusal::kEstopAsked);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
  EXPECT_EQ(robot.snapshot().stop.by.view(), "pult");
  asked(Operation::kClear, "captain", {}, true);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun) << "once";
}

TEST_F(StopCauseTest, TheInputIsACauseOfItsOwn) {
  robot.exchange().estop_contact.show(ContactState::kOpen);
  robot.tick();
  EXPECT_EQ(robot.snapshot().stop.cause, StopCause::kInput);
  EXPECT_TRUE(robot.snapshot().conditions & kConditionInputOpen);
  EXPECT_THAT(told(), Contains("RUN -> ESTOP (the e-stop input)"));
}

TEST_F(StopCauseTest, WhatTheGuardHasToldToRestIsNotTakenUpAgain) {
  link::GuardPage page;
  robot.scheduler().watchedBy(page);
  robot.tick();
  EXPECT_EQ(page.ticks.load(), robot.scheduler().ticks());
  page.acted.store(true);
  robot.tick();
  EXPECT_EQ(robot.snapshot().stop.cause, StopCause::kGuard);
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kNothing) << "not its fallback either";
  EXPECT_FALSE(page.acted.load()) << "once";
  EXPECT_THAT(told(),
              Contains("RUN -> ESTOP (rc10-guard told the drives to rest, has ended, or stands still)"));
}

TEST_F(StopCauseTest, WithoutItsGuardTheRobotStopsWithItsFallbacks) {
  robot.exchange().guard_lost.store(true);
  robot.tick();
  EXPECT_EQ(robot.snapshot().stop.cause, StopCause::kGuard);
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kDamp);
}

TEST_F(StopCauseTest, AStopOfTheComputerVetoesAClearOfItsTick) {
  robot.exchange().guard_lost.store(true);
  const auto result = asked(Operation::kClear, "captain", {}, true);
  EXPECT_EQ(result.motors[kLeft], Refusal::kEstopAsked);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
}

TEST_F(StopCauseTest, ASilentDriveIsToldFromAFault) {
  robot.freezeBus(0, true);
  robot.run(200);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kOffline);
  EXPECT_EQ(stopOf(kLeft).cause, StopCause::kSilence);
  EXPECT_EQ(robot.motor(kLeft).acting, Acting::kNothing);
  EXPECT_THAT(told(), Contains("ACTIVE -> OFFLINE (its drive is not heard)"));
}

TEST_F(StopCauseTest, TheEndOfRc10dIsAShutdown) {
  robot.scheduler().beginStop();
  robot.tick();
  EXPECT_EQ(robot.snapshot().stop.cause, StopCause::kShutdown);
  EXPECT_EQ(stopOf(kLeft).cause, StopCause::kShutdown);
}

TEST_F(StopCauseTest, EnablingEndsIt) {
  asked(Operation::kDisable, "teleop", MotorSet{}.set(kLeft).set(kRight), false);
  robot.run(1000);
  robot.order(Operation::kEnable);
  EXPECT_EQ(stopOf(kLeft).cause, StopCause::kNone);
  EXPECT_EQ(stopOf(kRight).cause, StopCause::kNone);
}

TEST_F(StopCauseTest, TheAgeOfACommandIsCountedFromItsReceipt) {
  robot.command(kLeft, kVelocity60);
  robot.tick();
  EXPECT_EQ(commandAgeUs(robot.motor(kLeft), robot.now()), 1000);
  robot.run(4);
  EXPECT_EQ(commandAgeUs(robot.motor(kLeft), robot.now()), 5000);
  robot.run(60);
  EXPECT_EQ(commandAgeUs(robot.motor(kLeft), robot.now()), -1) << "none is in force";
}

TEST(NeverHeardTest, ADriveThatNeverAnswersIsToldOnceWithWhatToCheck) {
  VirtualRobot robot{twoWheelsAndYaw()};
  robot.simBus().silence(kRight, true);
  robot.run(2900);
  const auto early = robot.events();
  EXPECT_TRUE(std::none_of(early.begin(), early.end(),
                           [](const Event& event) { return event.code == EventCode::kNeverHeard; }));
  robot.run(3000);
  std::vector<Event> missing;
  for (const auto& event : robot.events()) {
    if (event.code == EventCode::kNeverHeard) missing.push_back(event);
  }
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing[0].source, static_cast<std::int16_t>(kRight));
  EXPECT_THAT(describe(missing[0]), HasSubstr("check its power"));
  EXPECT_THAT(describe(missing[0]), HasSubstr("its id is 2"));
}

}  // namespace
}  // namespace rc10::test::supervisor_stop_cause_test
