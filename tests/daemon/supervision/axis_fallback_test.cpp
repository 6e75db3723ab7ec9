// A motor without a target, on the simulated robot.

#include <cmath>

#include <gtest/gtest.h>

#include "daemon/supervision/fallback_bench.hpp"

namespace rc10::test::axis_fallback_test {
namespace {

using namespace std::chrono_literals;
using namespace fallback_bench;

class FallbackTest : public FallbackBench {};

// docs/safety.md: "One more `disable` lets go", also when the request to enable was a tick ahead of it.
TEST_F(FallbackTest, ADisableRightAfterAnEnableLetsGoOfAMotorThatIsHeld) {
  for (int later = 0; later <= 3; ++later) {
    SCOPED_TRACE(later);
    start({.on_estop = FallbackAction::kHold}, 1.0F);
    robot->order(Operation::kEstop);
    robot->run(500);
    ASSERT_EQ(robot->motor(kLeft).acting, Acting::kHold);
    robot->order(Operation::kClear);
    enableFor(later);
    robot->orderFor(MotorSet{}.set(kLeft), Operation::kDisable);
    robot->run(10);
    expectAtRest();
  }
}

TEST_F(FallbackTest, AnEstopReplacesWhatActsAfterADisable) {
  const auto actingInAnEstop = [&](FallbackAction disabled, FallbackAction stopped) {
    start({.on_disable = disabled, .on_estop = stopped, .brake_max = 1s}, 1.0F);
    robot->order(Operation::kDisable);
    robot->run(100);
    EXPECT_NE(robot->motor(kLeft).acting, Acting::kNothing);
    estop();
    robot->run(2);
    return robot->motor(kLeft).acting;
  };
  EXPECT_EQ(actingInAnEstop(FallbackAction::kHold, FallbackAction::kCoast), Acting::kNothing);
  EXPECT_EQ(currentA(), 0.0F);
  EXPECT_EQ(actingInAnEstop(FallbackAction::kBrake, FallbackAction::kRamp), Acting::kRamp);
  EXPECT_EQ(actingInAnEstop(FallbackAction::kDamp, FallbackAction::kHold), Acting::kHold);
  EXPECT_EQ(actingInAnEstop(FallbackAction::kBrake, FallbackAction::kBrake), Acting::kBrake);
  robot->run(1100);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kDamp) << "brake_max_s of an e-stop";
}

TEST_F(FallbackTest, AnEstopReplacesWhatActsWhileAHeldMotorIsEnabled) {
  for (int later = 0; later <= 3; ++later) {
    SCOPED_TRACE(later);
    start({.on_disable = FallbackAction::kHold}, 1.0F);
    robot->order(Operation::kDisable);
    robot->run(100);
    enableFor(later);
    estop();
    robot->run(5);
    expectAtRest();
  }
}

TEST_F(FallbackTest, AnEstopThatIsRepeatedDoesNotBeginItsTimeAnew) {
  start({.on_estop = FallbackAction::kBrake, .brake_max = 1s}, 1.0F);
  for (int i = 0; i < 11; ++i) {
    estop();
    robot->run(100);
  }
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kDamp);
}

TEST_F(FallbackTest, ADisableLetsGoWhileTheContactOfTheEstopIsOpen) {
  start({.on_estop = FallbackAction::kHold}, 1.0F);
  robot->exchange().estop_contact.show(ContactState::kOpen);
  robot->run(100);
  ASSERT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  robot->order(Operation::kDisable);
  robot->run(2);
  expectAtRest();
}

TEST_F(FallbackTest, AnEstopWhileTheProgramEndsReplacesWhatActs) {
  start({.on_disable = FallbackAction::kHold, .on_estop = FallbackAction::kDamp}, 1.0F);
  robot->scheduler().beginStop();
  robot->run(100);
  ASSERT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  estop();
  robot->run(2);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kDamp);
  EXPECT_EQ(robot->snapshot().state, RobotStatus::kStopping);
}

TEST_F(FallbackTest, AnEstopThatIsRepeatedWhileTheProgramEndsBeginsNoRampAnew) {
  start({.on_disable = FallbackAction::kHold, .on_estop = FallbackAction::kRamp, .ramp = 100ms}, 1.0F);
  robot->scheduler().beginStop();
  robot->run(10);
  for (int i = 0; i < 500; ++i) {
    estop();
    robot->tick();
  }
  expectAtRest();
}

TEST_F(FallbackTest, TheFirstDisableInTheTickOfAnEstopLetsGoOfNothing) {
  start({.on_disable = FallbackAction::kHold, .on_estop = FallbackAction::kHold}, 1.0F);
  estop();
  robot->order(Operation::kDisable);
  robot->run(100);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kHold);
}

// Its hold ended with its feedback, and it may fall.
TEST_F(FallbackTest, AnEstopIsNotClearedWhileALoadThatItHeldIsNotHeard) {
  start({.on_estop = FallbackAction::kHold}, 1.0F);
  estop();
  robot->run(1000);
  ASSERT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  ASSERT_LT(std::fabs(rpm()), 2.0F);
  robot->simBus().silence(kLeft, true);
  robot->run(100);
  ASSERT_EQ(robot->motor(kLeft).status, MotorStatus::kOffline);
  EXPECT_EQ(robot->order(Operation::kClear).motors[kLeft], Refusal::kMayTurn);
}

// The brake of a disable ends at standstill, as docs/configuration.md says of on_disable.
TEST_F(FallbackTest, ABrakeOfTheProgramsEndIsThatOfADisable) {
  const auto ticksOf = [&](auto stop) {
    start({.on_disable = FallbackAction::kBrake, .brake_max = 100ms});
    stop();
    int ticks = 0;
    for (; ticks < 5000 && robot->motor(kLeft).acting != Acting::kNothing; ++ticks) {
      robot->tick();
      EXPECT_NE(robot->motor(kLeft).acting, Acting::kDamp) << "only an e-stop bounds a brake";
    }
    return ticks;
  };
  const int disabled = ticksOf([&] { robot->order(Operation::kDisable); });
  const int ended = ticksOf([&] {
    robot->scheduler().beginStop();
    robot->tick();
  });
  EXPECT_GT(disabled, 300);
  EXPECT_NEAR(ended, disabled, 5);
}

TEST_F(FallbackTest, AnEstopIsNotClearedWhileARampLeads) {
  start({.on_estop = FallbackAction::kRamp, .ramp = 20s});
  estop();
  robot->run(5000);
  ASSERT_GT(rpm(), 50.0F);
  EXPECT_EQ(robot->order(Operation::kClear).motors[kLeft], Refusal::kMoving);
}

TEST_F(FallbackTest, TheTimeToRunDownBeginsWithTheEstop) {
  start({.on_disable = FallbackAction::kDamp, .on_estop = FallbackAction::kDamp}, 1.0F);
  robot->order(Operation::kDisable);
  robot->run(5000);
  ASSERT_GT(std::fabs(rpm()), 10.0F);
  estop();
  robot->tick();
  EXPECT_EQ(robot->order(Operation::kClear).motors[kLeft], Refusal::kMoving);
}

TEST_F(FallbackTest, CoastMeansNoCurrentAtAll) {
  start({});
  robot->run(49);
  robot->tick();
  for (int i = 0; i < 500; ++i) {
    robot->tick();
    ASSERT_EQ(currentA(), 0.0F);
  }
}

TEST_F(FallbackTest, BrakeStopsSoonerThanDampAndDampSoonerThanCoast) {
  start({.on_timeout = FallbackAction::kBrake});
  const int brake = ticksToStop();
  start({.on_timeout = FallbackAction::kDamp});
  const int damp = ticksToStop();
  start({.on_timeout = FallbackAction::kCoast});
  const int coast = ticksToStop();
  EXPECT_LT(brake, damp);
  EXPECT_LT(damp, coast);
}

TEST_F(FallbackTest, DampNeverPushes) {
  start({.on_timeout = FallbackAction::kDamp});
  robot->run(51);
  for (int i = 0; i < 1000; ++i) {
    const float before_rpm = rpm();
    robot->tick();
    ASSERT_LE(currentA() * before_rpm, 0.0F);
  }
}

TEST_F(FallbackTest, HoldStaysWhereItWasAndGivesWayAfterItsTime) {
  start({.on_timeout = FallbackAction::kHold, .hold_max = 2s}, 1.0F);
  robot->run(1500);
  const double held_deg = angleDeg();
  robot->run(500);
  EXPECT_NEAR(angleDeg(), held_deg, 1.0);
  robot->run(2000);
  EXPECT_LT(angleDeg(), held_deg - 10.0);  // damped: the load pulls it down, slowly
  EXPECT_LT(std::fabs(rpm()), 100.0F);
}

TEST_F(FallbackTest, ALoadThatADisableHoldsSinksAfterwardsAndDoesNotFall) {
  start({.on_disable = FallbackAction::kHold, .hold_max = 2s}, 1.0F);
  robot->order(Operation::kDisable);
  robot->run(1900);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  EXPECT_NEAR(rpm(), 0.0F, 2.0F);
  robot->run(200);
  for (int i = 0; i < 1000; ++i) {
    robot->tick();
    ASSERT_EQ(robot->motor(kLeft).acting, Acting::kDamp) << i;
  }
  const float sinking_rpm = rpm();
  EXPECT_LT(sinking_rpm, -1.0F);
  robot->run(500);
  EXPECT_NEAR(rpm(), sinking_rpm, 1.0F) << "it grows no faster";
}

// Its drive may have let go of it meanwhile.
TEST_F(FallbackTest, AnEstopIsNotClearedInTheTickAfterAPauseWhileNothingIsHeard) {
  start({.on_estop = FallbackAction::kHold, .hold_max = 10s}, 1.0F);
  estop();
  robot->run(1000);
  Order clear;
  clear.id = 1000;
  clear.operation = Operation::kClear;
  clear.whole_robot = true;
  robot->freezeSimulation(true);
  ASSERT_TRUE(robot->exchange().orders.push(clear));
  robot->tick(600);
  EXPECT_EQ(robot->snapshot().state, RobotStatus::kEstop);
  robot->freezeSimulation(false);
  robot->run(50);
  robot->order(Operation::kClear);
  EXPECT_EQ(robot->snapshot().state, RobotStatus::kRun);
}

TEST_F(FallbackTest, ALoadThatSinksIsDampedThroughAPause) {
  start({.on_disable = FallbackAction::kDamp}, 1.0F);
  robot->order(Operation::kDisable);
  robot->run(500);
  EXPECT_LT(rpm(), -1.0F);
  robot->freezeSimulation(true);
  robot->tick(330);
  robot->freezeSimulation(false);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kDamp);
  robot->run(500);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kDamp);
}

TEST_F(FallbackTest, ABrakeInAnEstopDampsAfterItsTimeAndNeverCoasts) {
  start({.on_estop = FallbackAction::kBrake, .brake_max = 2s}, 1.0F);
  estop();
  robot->run(1900);
  const float braked_rpm = std::fabs(rpm());
  robot->run(2000);
  EXPECT_GT(std::fabs(rpm()), braked_rpm + 1.0F) << "the load pulls it down, slowly";
  EXPECT_LT(std::fabs(rpm()), 100.0F);
  EXPECT_NE(currentA(), 0.0F);
}

TEST_F(FallbackTest, ACoastThatComesInAnEstopDoesNotLetGoOfWhatIsHeld) {
  start({.on_estop = FallbackAction::kHold, .hold_max = 5s}, 1.0F);
  estop();
  robot->run(1000);
  ASSERT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  const double held_deg = angleDeg();
  robot->hold(kLeft, {.mode = ControlMode::kCoast}, 500);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  EXPECT_NEAR(angleDeg(), held_deg, 1.0);
}

TEST_F(FallbackTest, ARampTakesTheSpeedToZeroInItsTimeAndThenTheTorque) {
  start({.on_estop = FallbackAction::kRamp, .ramp = 1s});
  estop();
  robot->run(500);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kRamp);
  EXPECT_NEAR(rpm(), 60.0F, 6.0F);
  robot->run(500);
  EXPECT_NEAR(rpm(), 0.0F, 6.0F);
  robot->run(201);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kNothing);
  for (int i = 0; i < 500; ++i) {
    robot->tick();
    ASSERT_EQ(currentA(), 0.0F);
  }
}

TEST_F(FallbackTest, ARampEndsWithoutTorqueWhateverPulls) {
  start({.on_estop = FallbackAction::kRamp, .ramp = 500ms}, 1.0F);
  estop();
  robot->run(750);
  for (int i = 0; i < 200; ++i) {
    robot->tick();
    ASSERT_EQ(currentA(), 0.0F) << "safe torque off, although the load pulls it down";
  }
  EXPECT_LT(rpm(), -10.0F);
}

TEST_F(FallbackTest, ARampAfterATimeoutEndsWithTheNextTarget) {
  start({.on_timeout = FallbackAction::kRamp, .ramp = 1s});
  robot->run(350);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kActive);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kRamp);
  robot->hold(kLeft, kVelocity120, 500);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kTarget);
  EXPECT_NEAR(rpm(), 120.0F, 3.0F);
}

TEST_F(FallbackTest, ARampWithinASoftStartLeadsToRest) {
  start({.on_timeout = FallbackAction::kRamp, .ramp = 1s});
  robot->order(Operation::kDisable);
  robot->run(2);
  robot->order(Operation::kEnable);
  // It still turns, and is asked to turn the other way: not yet half way there, that ends.
  robot->hold(kLeft, {.mode = ControlMode::kVelocity, .value = -120.0}, 60);
  robot->run(50);
  ASSERT_EQ(robot->motor(kLeft).acting, Acting::kRamp);
  const float begun_rpm = std::fabs(rpm());
  ASSERT_LT(begun_rpm, 60.0F);
  for (int i = 0; i < 500; ++i) {
    robot->tick();
    ASSERT_LT(std::fabs(rpm()), begun_rpm + 10.0F);
  }
}

TEST_F(FallbackTest, AMotorThatIsLostOnItsRampIsWithoutTorque) {
  start({.on_estop = FallbackAction::kRamp, .ramp = 1s});
  estop();
  robot->run(100);
  robot->freezeSimulation(true);
  robot->run(60);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kOffline);
  EXPECT_EQ(currentA(), 0.0F);
  robot->freezeSimulation(false);
  robot->run(100);
  EXPECT_EQ(currentA(), 0.0F) << "and the ramp does not come back";
}

TEST_F(FallbackTest, ABrakeAfterATimeoutLasts) {
  start({.on_timeout = FallbackAction::kBrake, .brake_max = 1s}, 1.0F);
  robot->run(5000);
  EXPECT_LT(std::fabs(rpm()), 1.0F);
}

TEST_F(FallbackTest, ADriveThatCannotDampBrakesWhenItsHoldIsOver) {
  constexpr FallbackConfig kConfig{};
  DriveFrames frames;
  frames.brake = frames.hold = Provision::kFrame;
  EXPECT_EQ(boundOf(FallbackAction::kHold, false, kConfig, frames).then, FrameKind::kBrake);
  frames.brake = Provision::kUnsupported;
  EXPECT_EQ(boundOf(FallbackAction::kHold, false, kConfig, frames).then, FrameKind::kHold);
  frames.damp = Provision::kFrame;
  EXPECT_EQ(boundOf(FallbackAction::kHold, false, kConfig, frames).then, FrameKind::kDamp);
  EXPECT_FALSE(boundOf(FallbackAction::kBrake, false, kConfig, frames).most) << "of a group, or a time-out";
}

TEST_F(FallbackTest, ANewTargetEndsIt) {
  start({.on_timeout = FallbackAction::kBrake});
  robot->run(500);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kActive);
  robot->hold(kLeft, kVelocity120, 1000);
  EXPECT_NEAR(rpm(), 120.0F, 3.0F);
}

TEST_F(FallbackTest, CoastByACommandIsCoastWhateverTheFallback) {
  start({.on_timeout = FallbackAction::kBrake});
  for (int i = 0; i < 500; ++i) {
    robot->hold(kLeft, {.mode = ControlMode::kCoast}, 1);
    ASSERT_EQ(currentA(), 0.0F);
  }
  robot->run(100);
  EXPECT_EQ(currentA(), 0.0F);
}

TEST_F(FallbackTest, AfterADisableItActsUntilTheMotorStandsStill) {
  start({.on_disable = FallbackAction::kBrake});
  robot->order(Operation::kDisable);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kReady);
  EXPECT_LT(currentA(), 0.0F);
  robot->run(1500);
  EXPECT_LT(std::fabs(rpm()), 1.0F);
  EXPECT_EQ(currentA(), 0.0F);
}

TEST_F(FallbackTest, AnEstopBrakesAndHoldsALoadUntilItIsDisabledOnceMore) {
  start({.on_estop = FallbackAction::kBrake}, 1.0F);
  estop();
  robot->tick();
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kReady);
  EXPECT_LT(currentA(), 0.0F);
  robot->run(3000);
  EXPECT_LT(std::fabs(rpm()), 1.0F);
  EXPECT_GT(currentA(), 0.5F);  // it carries the load
  EXPECT_EQ(robot->order(Operation::kClear).motors[kLeft], Refusal::kNone);
  robot->run(100);
  EXPECT_GT(currentA(), 0.5F);  // and does not drop it in between
  robot->order(Operation::kDisable);
  EXPECT_EQ(currentA(), 0.0F);
}

TEST_F(FallbackTest, ADisableThatIsRepeatedForWantOfAnAnswerLetsNothingGo) {
  start({.on_estop = FallbackAction::kBrake}, 1.0F);
  robot->order(Operation::kEstop);
  robot->run(3000);
  EXPECT_GT(currentA(), 0.5F);  // it carries the load
  Order order;
  order.operation = Operation::kDisable;
  order.motors.set(kLeft);
  for (const auto asked : {Asked::kAgain, Asked::kUnasked}) {
    order.asked = asked;
    robot->carryOut(order);
    robot->run(10);
    EXPECT_GT(currentA(), 0.5F);
  }
  order.asked = Asked::kAnew;
  robot->carryOut(order);
  EXPECT_EQ(currentA(), 0.0F);
}

TEST_F(FallbackTest, ARepeatedDisableStopsWhatWasEnabledSince) {
  start({});
  Order order;
  order.operation = Operation::kDisable;
  order.motors.set(kLeft);
  order.asked = Asked::kAgain;
  robot->carryOut(order);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kReady);
}

TEST_F(FallbackTest, ACoastFromBeforeItWasEnabledLetsGoOfNothing) {
  start({.on_timeout = FallbackAction::kHold, .on_estop = FallbackAction::kHold}, 2.0F);
  const auto before = robot->now();
  robot->order(Operation::kEstop);
  robot->run(3000);
  robot->order(Operation::kClear);
  enableFor(20);
  ASSERT_EQ(robot->motor(kLeft).status, MotorStatus::kActive);
  ASSERT_EQ(robot->motor(kLeft).acting, Acting::kHold);
  Command late;
  late.received = late.said = before;
  late.deadline = robot->now() + 1s;
  late.count = 1;
  late.setpoints[0] = {static_cast<std::uint16_t>(kLeft), {.mode = ControlMode::kCoast}};
  ASSERT_TRUE(robot->exchange().commands.push(late));
  robot->run(10);
  EXPECT_EQ(robot->motor(kLeft).acting, Acting::kHold);
}

TEST_F(FallbackTest, AMotorThatIsHeldIsNotLetGoWhileItIsEnabled) {
  start({.on_estop = FallbackAction::kHold}, 2.0F);
  robot->order(Operation::kEstop);
  robot->run(1000);
  robot->order(Operation::kClear);
  robot->beginEnabling(MotorSet{}.set(kLeft));
  bool was_enabling = false;
  for (int i = 0; i < 100; ++i) {
    robot->tick();
    was_enabling |= robot->motor(kLeft).status == MotorStatus::kEnabling;
    ASSERT_GT(std::fabs(currentA()), 1.0F) << i;
  }
  EXPECT_TRUE(was_enabling);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kActive);
}

TEST_F(FallbackTest, WithoutFeedbackThereIsNone) {
  start({.on_timeout = FallbackAction::kBrake, .on_estop = FallbackAction::kBrake});
  estop();
  robot->run(10);
  EXPECT_NE(currentA(), 0.0F);
  robot->freezeSimulation(true);
  robot->run(25);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kOffline);
  EXPECT_EQ(currentA(), 0.0F);
  robot->freezeSimulation(false);
  robot->run(500);
  EXPECT_EQ(currentA(), 0.0F);
}

TEST_F(FallbackTest, ABrakeInAnEstopIsWatchedAsAnyOtherLoop) {
  start({.on_estop = FallbackAction::kBrake}, 1.0F,
        {.temperature_derate_c = 70.0F, .temperature_trip_c = 90.0F});
  estop();
  robot->run(3000);
  EXPECT_GT(currentA(), 0.5F);
  robot->simBus().setTemperature(kLeft, 95.0);
  robot->run(2);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kFault);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kOverheated);
  EXPECT_EQ(currentA(), 0.0F);
}

TEST_F(FallbackTest, AnEncoderThatIsReversedDoesNotMakeABrakeInAnEstopRunAway) {
  start({.on_estop = FallbackAction::kBrake}, 0.0F, {.runaway_rpm = 50.0F});
  estop();
  robot->simBus().setEncoderFault(kLeft, {.reversed = true});
  robot->run(3000);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kFault);
  EXPECT_EQ(currentA(), 0.0F);
}

TEST_F(FallbackTest, ALostReferenceBeginsItInPlaceOfTheAngle) {
  start({.on_timeout = FallbackAction::kBrake});
  const double far_deg = angleDeg() + 3600.0;
  robot->hold(kLeft, {.mode = ControlMode::kTotalAngle, .value = far_deg}, 200);
  robot->command(kLeft, {.mode = ControlMode::kTotalAngle, .value = far_deg}, std::chrono::milliseconds{500});
  robot->simBus().silence(kLeft, true);
  robot->run(15);  // more than can be counted over, less than the feedback timeout
  robot->simBus().silence(kLeft, false);
  robot->run(3);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kActive);
  EXPECT_FALSE(robot->motor(kLeft).feedback.zeroed);
  robot->run(400);
  EXPECT_LT(std::fabs(rpm()), 3.0F);
}

TEST_F(FallbackTest, TheEndOfTheProcessWaitsForItButNotForEver) {
  start({.on_disable = FallbackAction::kBrake});
  robot->scheduler().beginStop();
  robot->run(10);
  EXPECT_LT(currentA(), 0.0F);
  EXPECT_FALSE(robot->scheduler().stopped());
  for (int i = 0; i < 1100 && !robot->scheduler().stopped(); ++i) robot->tick();
  EXPECT_TRUE(robot->scheduler().stopped());
  EXPECT_EQ(currentA(), 0.0F);
  EXPECT_LT(std::fabs(rpm()), 1.0F);
}

TEST_F(FallbackTest, AHoldAtTheEndOfTheProcessLetsGoAfterASecond) {
  start({.on_disable = FallbackAction::kHold}, 1.0F);
  robot->scheduler().beginStop();
  robot->run(990);
  EXPECT_GT(currentA(), 0.5F);
  robot->run(100);
  EXPECT_TRUE(robot->scheduler().stopped());
  EXPECT_EQ(currentA(), 0.0F);
}

}  // namespace
}  // namespace rc10::test::axis_fallback_test
