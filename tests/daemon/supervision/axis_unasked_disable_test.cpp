// A disable that nobody asked for: the end of a program, a remote that is not heard.

#include <cmath>

#include <gtest/gtest.h>

#include "daemon/supervision/fallback_bench.hpp"

namespace rc10::test::axis_unasked_disable_test {
namespace {

using namespace std::chrono_literals;
using namespace fallback_bench;

class UnaskedDisableTest : public FallbackBench {};

const Order kUnasked{
    .operation = Operation::kDisable, .motors = MotorSet{}.set(kLeft), .asked = Asked::kUnasked};

TEST_F(UnaskedDisableTest, ADisableThatNobodyAskedForLeavesWhatIsHeldInEachStatus) {
  const FallbackConfig config{.on_timeout = FallbackAction::kHold, .on_estop = FallbackAction::kHold};
  start(config, 2.0F);
  robot->run(500);  // silence
  ASSERT_EQ(robot->motor(kLeft).status, MotorStatus::kActive);
  ASSERT_GT(std::fabs(currentA()), 1.0F);
  robot->carryOut(kUnasked);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kReady);
  for (int i = 0; i < 500; ++i) {
    robot->tick();
    ASSERT_GT(std::fabs(currentA()), 1.0F) << i;
  }
  robot->beginEnabling(MotorSet{}.set(kLeft));
  robot->tick();
  ASSERT_EQ(robot->motor(kLeft).status, MotorStatus::kEnabling);
  robot->carryOut(kUnasked);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kReady);
  EXPECT_GT(std::fabs(currentA()), 1.0F);
  robot->order(Operation::kDisable);
  EXPECT_EQ(currentA(), 0.0F);
}

TEST_F(UnaskedDisableTest, TheFirstDisableThatSomebodyAsksForDoesItsOnDisable) {
  for (const auto timeout : {FallbackAction::kHold, FallbackAction::kCoast}) {
    start({.on_timeout = timeout, .on_disable = FallbackAction::kBrake}, 2.0F);
    if (timeout == FallbackAction::kHold) robot->run(500);  // silence
    robot->carryOut(kUnasked);
    robot->run(100);
    robot->order(Operation::kDisable);
    EXPECT_EQ(robot->motor(kLeft).acting, Acting::kBrake);
    robot->order(Operation::kDisable);
    EXPECT_EQ(robot->motor(kLeft).acting, Acting::kNothing) << "once more";
  }
}

TEST_F(UnaskedDisableTest, WhatHoldsOnAfterADisableThatNobodyAskedForEndsWithItsTime) {
  start({.on_timeout = FallbackAction::kHold, .on_disable = FallbackAction::kHold, .hold_max = 1s});
  robot->run(500);
  robot->carryOut(kUnasked);
  robot->run(100);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  robot->run(1500);
  expectAtRest();
  robot->order(Operation::kDisable);
  robot->run(10);
  expectAtRest();  // nothing is left to let go of, and nothing begins
}

TEST_F(UnaskedDisableTest, ADisableThatNobodyAskedForCutsNoRampShort) {
  start({.on_timeout = FallbackAction::kRamp, .ramp = 2s});
  robot->run(500);
  robot->carryOut(kUnasked);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kRamp);
  robot->run(1000);
  EXPECT_LT(rpm(), 60.0F);
  EXPECT_GT(rpm(), 10.0F);
  robot->run(1000);
  expectAtRest();
}

TEST_F(UnaskedDisableTest, ALoadThatSinksDampedIsDampedUntilItLiesAlsoIfNobodyAskedForTheDisable) {
  start({.on_timeout = FallbackAction::kDamp}, 2.0F);
  robot->run(500);
  robot->carryOut(kUnasked);
  robot->run(1000);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kReady);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kDamp);
  start({.on_timeout = FallbackAction::kDamp});
  robot->run(500);
  robot->carryOut(kUnasked);
  robot->run(5000);
  expectAtRest();  // it stands still
}

TEST_F(UnaskedDisableTest, AnEstopThatDampsIsNotLetGoByTheEndOfAProgram) {
  start({.on_estop = FallbackAction::kDamp});
  robot->order(Operation::kEstop);
  robot->run(3000);
  robot->order(Operation::kClear);
  enableFor(1);
  robot->carryOut(kUnasked);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kDamp);
}

TEST_F(UnaskedDisableTest, InAnEstopAfterTheEndOfAProgramOneDisableLetsGo) {
  for (const auto action : {FallbackAction::kDamp, FallbackAction::kBrake, FallbackAction::kHold}) {
    start({.on_timeout = FallbackAction::kHold, .on_disable = FallbackAction::kHold, .on_estop = action},
          2.0F);
    robot->run(500);  // silence
    robot->carryOut(kUnasked);
    robot->order(Operation::kEstop);
    robot->run(500);
    const auto acting = robot->motor(kLeft).acting;
    ASSERT_EQ(acting, action == FallbackAction::kDamp    ? Acting::kDamp
                      : action == FallbackAction::kBrake ? Acting::kBrake
                                                         : Acting::kHold);
    robot->carryOut(kUnasked);
    EXPECT_EQ(robot->motor(kLeft).acting, acting) << "it waits for one that somebody asks for";
    robot->order(Operation::kDisable);
    EXPECT_EQ(robot->motor(kLeft).acting, Acting::kNothing) << "and does no on_disable";
  }
}

TEST_F(UnaskedDisableTest, ADisableThatNobodyAskedForStopsWhatMoves) {
  start({.on_timeout = FallbackAction::kHold}, 2.0F);
  robot->carryOut(kUnasked);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kReady);
  EXPECT_EQ(currentA(), 0.0F) << "its on_disable";
}

}  // namespace
}  // namespace rc10::test::axis_unasked_disable_test
