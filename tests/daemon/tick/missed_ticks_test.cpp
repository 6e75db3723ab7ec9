// Late ticks are reported together, at most once a second: a busy computer must not flood the log.

#include <gtest/gtest.h>

#include <algorithm>

#include "daemon/virtual_robot.hpp"
#include "support/dji_frames.hpp"

namespace rc10::test::missed_ticks_test {
namespace {

using namespace std::chrono_literals;

class MissedTicksTest : public ::testing::Test {
 protected:
  /// The values of all reports since the last call.
  std::vector<std::int32_t> reports() {
    std::vector<std::int32_t> out;
    for (const auto& event : robot.events()) {
      if (event.code == EventCode::kTicksMissed) out.push_back(event.value);
    }
    return out;
  }

  /// All motors are ACTIVE, and from now on their drives say nothing.
  void enableAndSilence() {
    robot.run(100);
    ASSERT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
    robot.freezeSimulation(true);
  }

  VirtualRobot robot{twoWheelsAndYaw()};
};

// The RX thread may come after the tick in which this thread runs again.
TEST_F(MissedTicksTest, AfterAPauseNoMotorIsLostBeforeItsFeedbackCouldBeRead) {
  robot.run(100);
  ASSERT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
  for (int pause = 0; pause < 20; ++pause) {
    robot.freezeSimulation(true);
    robot.tick(50);
    EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
    robot.run(2);
    robot.freezeSimulation(false);
    robot.run(20);
    EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
    EXPECT_TRUE(robot.motor(0).feedback.zeroed);
  }
}

TEST_F(MissedTicksTest, AMotorThatIsSilentAfterAPauseIsLostOnceItsTimeHasRun) {
  enableAndSilence();
  robot.tick(50);
  robot.run(15);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
  robot.run(3);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kOffline);
}

// A loose plug: shorter gaps than the timeout before and after the pause.
TEST_F(MissedTicksTest, GapsAroundAPauseInWhichADriveSpokeAreNoLoss) {
  enableAndSilence();
  robot.run(12);
  for (const auto& port : robot.robot().simPorts()) port->step(robot.now() + 1ms);
  robot.tick(40);
  robot.run(12);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
}

TEST_F(MissedTicksTest, OneGapWithAPauseInItIsNoLoss) {
  enableAndSilence();
  robot.run(8);
  robot.tick(40);
  robot.run(6);
  robot.freezeSimulation(false);
  robot.run(20);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
}

// With `receive: thread` what came in the pause may be read a tick after the one that ends it.
TEST_F(MissedTicksTest, FeedbackOfAPauseThatIsReadATickLaterIsHeard) {
  enableAndSilence();
  robot.run(12);
  const auto spoke = robot.now() + 20ms;  // in the middle of the pause
  robot.tick(40);
  const auto frame = makeDjiFeedback(kM3508, 1, {}, spoke);
  robot.inboxes()[0].frames.push(&frame, 1);
  robot.run(12);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
}

// Each of them, where the drive was heard in time between them.
TEST_F(MissedTicksTest, FeedbackOfEveryPauseIsHeard) {
  for (int pause = 0; pause < 3; ++pause) {
    robot.freezeSimulation(false);
    robot.run(100);
    if (pause == 0) {
      ASSERT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
    }
    robot.freezeSimulation(true);
    robot.run(12);
    const auto frame = makeDjiFeedback(kM3508, 1, {}, robot.now() + 10ms);
    robot.inboxes()[0].frames.push(&frame, 1);
    robot.tick(40);
    robot.run(12);
    EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive) << pause;
  }
}

// The same, read in time: the control of the test above.
TEST_F(MissedTicksTest, FeedbackOfAPauseThatIsReadAtItsEndIsHeardThoughItIsOld) {
  enableAndSilence();
  robot.run(12);
  const auto frame = makeDjiFeedback(kM3508, 1, {}, robot.now() + 20ms);
  robot.inboxes()[0].frames.push(&frame, 1);
  robot.tick(40);
  robot.run(12);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
}

// A fresh sample, but half a timeout old.
TEST_F(MissedTicksTest, TheAgeOfTheLastSampleIsPartOfItsTimeout) {
  enableAndSilence();
  robot.run(9);
  const auto frame = makeDjiFeedback(kM3508, 1, {}, robot.now() - 8ms);
  robot.inboxes()[0].frames.push(&frame, 1);
  robot.run(12);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
  robot.run(2);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kOffline);
}

TEST_F(MissedTicksTest, ASilentMotorIsLostWithinTenTicksHoweverLateEachIs) {
  for (const std::uint64_t periods : {1U, 2U, 3U, 10U, 50U, 200U}) {
    SCOPED_TRACE(periods);
    robot.freezeSimulation(false);
    robot.run(300);
    ASSERT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
    robot.freezeSimulation(true);
    const int most = periods == 1 ? 21 : 10;
    for (int i = 0; i < most; ++i) robot.tick(periods);
    EXPECT_EQ(robot.motor(0).status, MotorStatus::kOffline);
  }
}

// Pauses of different length between punctual ticks: no pause gives the silence back.
TEST_F(MissedTicksTest, PausesInARowDoNotMakeASilentMotorHeard) {
  enableAndSilence();
  for (int i = 0; i < 6; ++i) {
    robot.run(1);
    robot.tick(7 + 30 * static_cast<std::uint64_t>(i));
  }
  robot.run(1);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kOffline);
}

// A drive that speaks once in each pause, always old when it is read.
TEST_F(MissedTicksTest, AMotorWhoseEverySampleIsOlderThanItsTimeoutIsNotActiveForEver) {
  enableAndSilence();
  for (int i = 0; i < 100; ++i) {
    const auto frame = makeDjiFeedback(kM3508, 1, {}, robot.now() + 1ms);
    robot.inboxes()[0].frames.push(&frame, 1);
    robot.tick(50);
  }
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kOffline);
}

// docs/safety.md: fallbacks "need fresh feedback. Without it: zero".
TEST_F(MissedTicksTest, AFallbackGivesNoTorqueByFeedbackThatIsOlderThanItsTimeout) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[0].fallback.on_timeout = FallbackAction::kHold;
  config.buses[0].motors[0].fallback.hold_max = 1000s;
  VirtualRobot late{config};
  late.run(100);
  ASSERT_EQ(late.order(Operation::kEnable).motors[0], Refusal::kNone);
  late.hold(0, {.mode = ControlMode::kVelocity, .value = 0.0}, 10);
  late.run(100);
  ASSERT_EQ(late.motor(0).acting, Acting::kHold);
  late.freezeSimulation(true);
  int pushes = 0;
  for (int i = 0; i < 100; ++i) {
    const auto encoder = static_cast<std::uint16_t>(5 * i);  // a load moves it on
    const auto frame = makeDjiFeedback(kM3508, 1, {.position = encoder}, late.now() + 1ms);
    late.inboxes()[0].frames.push(&frame, 1);
    late.tick(50);
    if (i > 20 && late.motor(0).command_value != 0.0F) ++pushes;
  }
  EXPECT_EQ(pushes, 0) << "of 79 ticks, the last with " << late.motor(0).command_value;
}

TEST_F(MissedTicksTest, ALongPauseMovesATargetNoFartherThanFivePeriods) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[0].shaping.velocity_slew_rpm_per_s = 1000.0F;
  VirtualRobot slow{config};
  slow.run(10);
  ASSERT_EQ(slow.order(Operation::kEnable).motors[0], Refusal::kNone);
  slow.hold(0, {.mode = ControlMode::kVelocity, .value = 400.0}, 100);
  const double before_rpm = slow.motor(0).target_shaped;
  slow.tick(3);
  EXPECT_NEAR(slow.motor(0).target_shaped, before_rpm + 3.0, 1e-3);
  slow.tick(40);
  EXPECT_NEAR(slow.motor(0).target_shaped, before_rpm + 8.0, 1e-3);
}

TEST_F(MissedTicksTest, AMotorThatIsSilentIsLostAlsoIfEveryTickIsLate) {
  enableAndSilence();
  for (int i = 0; i < 11; ++i) robot.tick(2);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kOffline);
}

TEST_F(MissedTicksTest, DrivesOfASimulationThatHadNoProcessorAreNotSilent) {
  auto& steps = robot.robot().simulationSteps();
  ++steps;
  robot.run(100);
  ++steps;
  ASSERT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
  ++steps;
  robot.tick();
  robot.freezeSimulation(true);
  robot.run(900);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
  robot.freezeSimulation(false);
  ++steps;
  robot.run(10);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
}

TEST_F(MissedTicksTest, ASimulationThatHasEndedIsSilent) {
  ++robot.robot().simulationSteps();
  enableAndSilence();
  robot.run(1100);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kOffline);
}

TEST_F(MissedTicksTest, SilentDrivesOfASimulationThatRunsAreLost) {
  enableAndSilence();
  for (int i = 0; i < 25; ++i) {
    ++robot.robot().simulationSteps();
    robot.tick();
  }
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kOffline);
}

TEST_F(MissedTicksTest, WhatTurnedBeforeAPauseIsNoMotorAtRest) {
  robot.run(100);
  ASSERT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
  robot.hold(0, Target{.mode = ControlMode::kVelocity, .value = 120.0}, 500);
  robot.exchange().estop.store(true);
  robot.tick();
  robot.freezeSimulation(true);
  Order clear;
  clear.id = 77;
  clear.operation = Operation::kClear;
  clear.motors.set();
  clear.whole_robot = true;
  robot.exchange().orders.push(clear);
  robot.tick(50);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
}

TEST_F(MissedTicksTest, TheFirstLateTickIsReportedAtOnce) {
  robot.run(10);
  EXPECT_TRUE(reports().empty());
  robot.tick(4);
  EXPECT_EQ(reports(), std::vector<std::int32_t>{3});
}

TEST_F(MissedTicksTest, LaterOnesAreAddedUpAndReportedOnceASecond) {
  robot.tick(2);
  ASSERT_EQ(reports(), std::vector<std::int32_t>{1});
  for (int i = 0; i < 499; ++i) robot.tick(2);  // 998 ms: every tick is late
  EXPECT_TRUE(reports().empty());
  robot.tick(2);
  EXPECT_EQ(reports(), std::vector<std::int32_t>{500});
}

TEST_F(MissedTicksTest, NothingIsLostWhenTheLastLateTickIsFollowedByPunctualOnes) {
  robot.tick(2);
  robot.run(10);
  robot.tick(6);
  (void)reports();
  robot.run(983);  // 999 ms after the first report
  EXPECT_TRUE(reports().empty());
  robot.tick();
  EXPECT_EQ(reports(), std::vector<std::int32_t>{5});
  robot.run(3000);
  EXPECT_TRUE(reports().empty());
}

TEST_F(MissedTicksTest, AllReportsTogetherAreTheCountInTheSnapshot) {
  for (std::uint64_t i = 0; i < 3000; ++i) robot.tick(1 + i % 4);
  robot.run(1000);
  std::uint64_t sum = 0;
  const auto seen = reports();
  for (const auto missed : seen) sum += static_cast<std::uint64_t>(missed);
  EXPECT_EQ(sum, robot.snapshot().missed_ticks);
  EXPECT_EQ(sum, 4500U);
  EXPECT_LE(seen.size(), 9U);  // 8.5 s
}

}  // namespace
}  // namespace rc10::test::missed_ticks_test
