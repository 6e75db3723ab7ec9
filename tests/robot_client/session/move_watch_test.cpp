#include "robot_client/session/move_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace move_watch_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Outcome = MoveResult::Outcome;

constexpr MonotonicTime kStart{1000s};

/// A lift on its way to 720 deg, seen at times after the start.
class MoveWatchTest : public testing::Test {
 protected:
  MoveWatchTest() {
    MotorState motor;
    motor.name = "lift";
    motor.status = MotorStatus::kActive;
    motor.zeroed = true;
    motor.owner = "me";
    motor.mode = Mode::kTotalAngle;
    motor.target = 720.0;
    motor.total_angle_deg = 0.0;
    motor.angle_deg = 0.0;
    state_.motors.push_back(motor);
  }

  MotorState& lift() { return state_.motors[0]; }
  std::optional<MoveResult> see(Duration after) {
    state_.taken = kStart + after;
    state_.mono_us = std::chrono::duration_cast<std::chrono::microseconds>(after).count();
    return watch_.onState(state_, kStart + after);
  }

  RobotState state_;
  MoveWatch watch_{{.motor = "lift", .target_deg = 720.0, .tolerance_deg = 2.0, .timeout = 5s}, "me", kStart};
};

TEST_F(MoveWatchTest, IsDoneAfterStandingWithinTheTolerance) {
  EXPECT_FALSE(see(100ms));
  lift().total_angle_deg = 718.5;
  EXPECT_FALSE(see(200ms));
  EXPECT_FALSE(see(259ms));
  const auto result = see(260ms);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->outcome, Outcome::kDone);
  EXPECT_EQ(result->angle_deg, 718.5);
  EXPECT_TRUE(*result);
}

TEST_F(MoveWatchTest, PassingThroughIsNotArriving) {
  lift().total_angle_deg = 720.0;
  EXPECT_FALSE(see(100ms));
  lift().total_angle_deg = 730.0;
  EXPECT_FALSE(see(150ms));
  lift().total_angle_deg = 720.0;
  EXPECT_FALSE(see(170ms));
  EXPECT_FALSE(see(229ms));
  EXPECT_TRUE(see(230ms));
}

TEST_F(MoveWatchTest, TheShortestWayRoundCountsForAnAngle) {
  watch_ = MoveWatch(
      {.motor = "lift", .mode = Mode::kAngle, .target_deg = 359.5, .tolerance_deg = 2.0, .timeout = 5s}, "me",
      kStart);
  lift().mode = Mode::kAngle;
  lift().target = 359.5;
  lift().angle_deg = 0.5;
  EXPECT_FALSE(see(100ms));
  EXPECT_TRUE(see(200ms));
}

TEST_F(MoveWatchTest, TimesOutAndSaysWhereItIs) {
  lift().total_angle_deg = 300.0;
  EXPECT_FALSE(see(4999ms));
  const auto result = watch_.onTime(kStart + 5s);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->outcome, Outcome::kTimeout);
  EXPECT_EQ(result->reason, "lift is at 300 deg and not at 720 after 5 s");
}

TEST_F(MoveWatchTest, FailsWithTheFaultOfTheMotor) {
  lift().status = MotorStatus::kFault;
  lift().fault_text = "stalled";
  const auto result = see(100ms);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->outcome, Outcome::kFailed);
  EXPECT_THAT(result->reason, HasSubstr("in FAULT (stalled)"));
}

TEST_F(MoveWatchTest, FailsWhenAnotherClientHoldsTheMotor) {
  lift().owner = "remote";
  EXPECT_FALSE(see(300ms)) << "the target may be on its way";
  const auto result = see(301ms);
  ASSERT_TRUE(result);
  EXPECT_THAT(result->reason, HasSubstr("held by the client 'remote'"));
}

TEST_F(MoveWatchTest, GoesOnAfterATargetThatLapsedForAMoment) {
  EXPECT_FALSE(see(1000ms));
  lift().owner.clear();
  lift().mode = Mode::kCoast;
  EXPECT_FALSE(see(1020ms)) << "a busy computer has renewed it late";
  EXPECT_FALSE(see(1300ms));
  const auto result = see(1301ms);
  ASSERT_TRUE(result);
  EXPECT_THAT(result->reason, HasSubstr("lost the target"));
}

TEST_F(MoveWatchTest, FailsWhenASecondProgramRunsUnderTheSameName) {
  lift().target = 10.0;
  const auto result = see(400ms);
  ASSERT_TRUE(result);
  EXPECT_THAT(result->reason, HasSubstr("second program run under this client name"));
}

TEST_F(MoveWatchTest, FailsWithWhatRc10dSaysAboutTheSetpoint) {
  lift().mode = Mode::kCoast;
  lift().owner.clear();
  watch_.onEvent({.code = 103, .source = "yaw", .text = "not of this motor"});
  watch_.onEvent({.code = 103, .source = "lift", .text = "farther than max_first_step_deg"});
  const auto result = see(400ms);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->reason, "lift did not take the target: farther than max_first_step_deg");
}

TEST_F(MoveWatchTest, FailsWithoutAReference) {
  lift().zeroed = false;
  const auto result = see(10ms);
  ASSERT_TRUE(result);
  EXPECT_THAT(result->reason, HasSubstr("no reference"));
}

TEST_F(MoveWatchTest, FailsWithoutStates) {
  EXPECT_FALSE(see(10ms));
  EXPECT_FALSE(watch_.onTime(kStart + 1009ms));
  const auto result = watch_.onTime(kStart + 1010ms);
  ASSERT_TRUE(result);
  EXPECT_THAT(result->reason, HasSubstr("no state of the robot"));
}

TEST_F(MoveWatchTest, AStateFromBeforeItProvesNothing) {
  lift().status = MotorStatus::kReady;
  EXPECT_FALSE(see(-10ms));
}

}  // namespace
}  // namespace move_watch_test
}  // namespace robot_client
}  // namespace rc10
