#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "motor/guarding/guard_bench.hpp"

namespace rc10::test::motor_guard_test {
namespace {

using namespace guard_bench;

TEST_F(MotorGuardTest, FindsNothingWrongWithAMotorThatTurns) {
  for (int i = 0; i < 1000; ++i) {
    const auto verdict = step(kLimitCurrent);
    ASSERT_EQ(verdict.fault, FaultCode::kNone);
    ASSERT_EQ(verdict.derating, 1.0F);
    ASSERT_EQ(verdict.limits, 0U);
  }
}

TEST_F(MotorGuardTest, TripsOnTheThirdSampleThatIsTooFast) {
  feedback.velocity_rpm = -701.0F;
  EXPECT_EQ(step().fault, FaultCode::kNone);
  EXPECT_EQ(step().fault, FaultCode::kNone);
  EXPECT_EQ(step().fault, FaultCode::kOverspeed);
}

TEST_F(MotorGuardTest, OneSampleCountsOnceHoweverManyTicksSeeIt) {
  feedback.velocity_rpm = 701.0F;
  (void)step();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(tickOnly().fault, FaultCode::kNone);
}

TEST_F(MotorGuardTest, AStrangeSampleAmongGoodOnesIsNoSpeed) {
  for (int i = 0; i < 30; ++i) {
    feedback.velocity_rpm = i % 3 == 0 ? 100.0F : 5000.0F;
    EXPECT_EQ(step().fault, FaultCode::kNone);
  }
}

TEST_F(MotorGuardTest, TakesCurrentAwayFromAHotMotorAndTripsAtTheEnd) {
  feedback.temperature_c = 80.0F;
  EXPECT_EQ(step().derating, 1.0F);
  feedback.temperature_c = 95.0F;
  EXPECT_FLOAT_EQ(step().derating, 0.25F);
  EXPECT_EQ(step().limits, kLimitTemperature);
  EXPECT_EQ(step().fault, FaultCode::kNone);
  feedback.temperature_c = 100.0F;
  EXPECT_EQ(step().derating, 0.0F);
  EXPECT_EQ(step().fault, FaultCode::kOverheated);
}

TEST_F(MotorGuardTest, TorqueComesBackSlowlyOnceItIsThreeDegreesCooler) {
  feedback.temperature_c = 95.0F;
  ASSERT_FLOAT_EQ(step().derating, 0.25F);
  feedback.temperature_c = 93.0F;
  for (int i = 0; i < 1000; ++i) ASSERT_FLOAT_EQ(step().derating, 0.25F) << "two degrees are noise";
  feedback.temperature_c = 70.0F;
  float before = 0.25F;
  for (int i = 0; i < 3749; ++i) {
    const float now_derating = step().derating;
    ASSERT_GT(now_derating, before) << i;
    ASSERT_NEAR(now_derating - before, 0.2e-3F, 1e-6F) << i;
    before = now_derating;
  }
  EXPECT_NEAR(before, 1.0F, 1e-3F) << "the whole in at most five seconds";
  (void)step();
  (void)step();
  EXPECT_EQ(step().derating, 1.0F);
  EXPECT_EQ(step().limits, 0U);
}

TEST_F(MotorGuardTest, ItIsAsWarmWhenItIsEnabledAgainAsTheTimeBetweenSays) {
  feedback.temperature_c = 95.0F;
  (void)step();
  guard.reset();
  feedback.temperature_c = 70.0F;
  EXPECT_NEAR(step().derating, 0.25F, 0.001F) << "no way round the slope";
  guard.reset();
  now += 2s;
  EXPECT_NEAR(step().derating, 0.65F, 0.001F);
}

// A winding around the threshold: told in whole degrees, with noise, heated by the square of the
// current that it is allowed, under a load that would take it to 110 C.
TEST_F(MotorGuardTest, AroundItsThresholdAHotMotorIsInNoLimitCycle) {
  double winding_c = 70.0;
  float before = 1.0F;
  int rises = 0;
  std::uint32_t random = 1;
  for (int i = 0; i < 1'200'000; ++i) {
    random = random * 1664525U + 1013904223U;
    const double noise_c = static_cast<double>(random >> 8U) / 16777216.0 - 0.5;
    feedback.temperature_c = static_cast<float>(std::floor(winding_c + noise_c));
    const float factor = step().derating;
    winding_c += 0.001 / 60.0 * (85.0 * static_cast<double>(factor * factor) + 25.0 - winding_c);
    if (i > 600'000) {
      ASSERT_GT(factor, 0.6F);
      ASSERT_LT(factor, 1.0F);
      rises += factor > before ? 1 : 0;
    }
    before = factor;
  }
  EXPECT_EQ(rises, 0) << "it has settled";
}

TEST_F(MotorGuardTest, ATemperatureThatIsNotReportedIsNoTemperature) {
  feedback.temperature_c = kNotReported;
  EXPECT_EQ(step().derating, 1.0F);
  EXPECT_EQ(step().fault, FaultCode::kNone);
}

TEST_F(MotorGuardTest, AStallIsPushingWithoutTurningForSomeTime) {
  feedback.velocity_rpm = 3.0F;
  for (int i = 0; i < 200; ++i) ASSERT_EQ(step(kLimitCurrent).fault, FaultCode::kNone) << i;
  EXPECT_EQ(step(kLimitCurrent).fault, FaultCode::kStalled);
  EXPECT_EQ(step(kLimitCurrent).limits, kLimitStall);
}

TEST_F(MotorGuardTest, StandingStillWithoutPushingIsNoStall) {
  feedback.velocity_rpm = 0.0F;
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(step().fault, FaultCode::kNone);
}

TEST_F(MotorGuardTest, EveryStartFromRestCountsAnew) {
  feedback.velocity_rpm = 0.0F;
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 150; ++j) ASSERT_EQ(step(kLimitCurrent).fault, FaultCode::kNone);
    guard.reset();
  }
}

TEST_F(MotorGuardTest, AStallMayBeAFlagOnly) {
  guard = MotorGuard{{.stall_time = 200ms, .stall_rpm = 10.0F, .stall_trips = false}};
  feedback.velocity_rpm = 0.0F;
  for (int i = 0; i < 300; ++i) ASSERT_EQ(step(kLimitCurrent).fault, FaultCode::kNone);
  EXPECT_EQ(step(kLimitCurrent).limits, kLimitStall);
}

TEST_F(MotorGuardTest, WatchesNothingThatIsNotConfigured) {
  guard = MotorGuard{GuardConfig{}};
  feedback = seen(1e6F, 1000.0F);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(step(kLimitCurrent).fault, FaultCode::kNone);
}

TEST_F(MotorGuardTest, WatchesEachLimitThatIsConfiguredByItself) {
  EXPECT_FALSE(GuardConfig{}.any());
  for (const GuardConfig& config :
       {GuardConfig{.overspeed_rpm = 1.0F}, GuardConfig{.temperature_trip_c = 1.0F},
        GuardConfig{.stall_time = 1ms}, GuardConfig{.following_error_deg = 1.0},
        GuardConfig{.encoder_jumps = true}, GuardConfig{.frozen_a = 1.0F}, GuardConfig{.runaway_rpm = 1.0F}})
    EXPECT_TRUE(config.any());
}

// Each condition is met all the time, and one threshold is set, which nothing reaches.
TEST_F(MotorGuardTest, BesideOneLimitTheOthersAreNotWatched) {
  constexpr float kFar = 1e9F;
  for (const GuardConfig& config :
       {GuardConfig{.overspeed_rpm = kFar}, GuardConfig{.temperature_trip_c = kFar},
        GuardConfig{.stall_time = 100s, .stall_rpm = 10.0F}, GuardConfig{.following_error_deg = 1e9},
        GuardConfig{.encoder_jumps = true}, GuardConfig{.frozen_a = kFar},
        GuardConfig{.runaway_rpm = kFar}}) {
    guard = MotorGuard{config};
    feedback.temperature_c = 500.0F;
    feedback.current_a = 0.0F;
    feedback.total_angle_deg = 0.0;
    target = {.mode = ControlMode::kTotalAngle, .value = 1e6};
    effort_a = 50.0F;
    for (const float rpm : {0.0F, -1.0F, -5000.0F}) {
      feedback.velocity_rpm = rpm;
      for (int i = 0; i < 300; ++i) ASSERT_EQ(step(kLimitCurrent).fault, FaultCode::kNone) << i;
    }
  }
}

TEST_F(MotorGuardTest, AtItsThresholdNothingIsWrong) {
  feedback.velocity_rpm = -700.0F;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(step().fault, FaultCode::kNone);
  feedback.velocity_rpm = 10.0F;
  for (int i = 0; i < 300; ++i) EXPECT_EQ(step(kLimitCurrent).fault, FaultCode::kNone) << "it turns";
  feedback.temperature_c = 99.9F;
  EXPECT_EQ(step().fault, FaultCode::kNone);
}

TEST_F(MotorGuardTest, BeyondItsTripAMotorHasNoCurrentAtAll) {
  feedback.temperature_c = 150.0F;
  EXPECT_EQ(step().derating, 0.0F);
  EXPECT_TRUE(guard.tooHot(feedback));
  feedback.temperature_c = 100.0F;
  EXPECT_TRUE(guard.tooHot(feedback));
  feedback.temperature_c = 99.0F;
  EXPECT_FALSE(guard.tooHot(feedback));
  EXPECT_FALSE(MotorGuard{GuardConfig{}}.tooHot(seen(0.0F, 500.0F)));
}

TEST_F(MotorGuardTest, WithoutASlopeAMotorHasAllItsCurrentUntilItTrips) {
  for (const float from_c : {100.0F, 110.0F}) {
    guard = MotorGuard{{.temperature_derate_c = from_c, .temperature_trip_c = 100.0F}};
    feedback.temperature_c = 99.0F;
    EXPECT_EQ(step().derating, 1.0F);
    feedback.temperature_c = 111.0F;
    EXPECT_EQ(step().derating, 1.0F);
    EXPECT_EQ(step().fault, FaultCode::kOverheated);
  }
}

TEST_F(MotorGuardTest, FastSamplesOfBeforeDoNotCount) {
  feedback.velocity_rpm = 701.0F;
  (void)step();
  (void)step();
  guard.reset();
  EXPECT_EQ(step().fault, FaultCode::kNone);
}

TEST_F(MotionGuardTest, FarFromTheTargetForLongEnoughIsAFault) {
  target = {.mode = ControlMode::kTotalAngle, .value = 16.0};
  EXPECT_EQ(run(100), FaultCode::kNone);
  EXPECT_EQ(run(1), FaultCode::kFollowingError);
}

// The state in which it stood still is not seen: the motor may have been elsewhere.
TEST_F(MotionGuardTest, APauseOfTheProcessIsNoTimeFarFromTheTarget) {
  target = {.mode = ControlMode::kTotalAngle, .value = 16.0};
  EXPECT_EQ(run(10), FaultCode::kNone);
  now += 500ms;
  EXPECT_EQ(run(1), FaultCode::kNone);
  EXPECT_EQ(run(100), FaultCode::kFollowingError);
}

TEST_F(MotionGuardTest, APauseOfTheProcessIsNoTimeWithFrozenReadings) {
  effort_a = 5.0F;
  EXPECT_EQ(run(3), FaultCode::kNone);
  now += 1s;
  EXPECT_EQ(tickOnly().fault, FaultCode::kNone);
  EXPECT_EQ(run(1), FaultCode::kNone);
  EXPECT_EQ(run(200), FaultCode::kFrozen);
}

TEST_F(MotionGuardTest, NearTheTargetNowAndThenIsNone) {
  target = {.mode = ControlMode::kTotalAngle, .value = 16.0};
  for (int i = 0; i < 10; ++i) {
    feedback.total_angle_deg = 0.0;
    EXPECT_EQ(run(90), FaultCode::kNone);
    feedback.total_angle_deg = 2.0;
    EXPECT_EQ(run(1), FaultCode::kNone);
  }
}

TEST_F(MotionGuardTest, AJumpOfTheEncoderIsAFaultAtOnceButNotOneFromBefore) {
  feedback.jumps = 3;  // before it was ACTIVE
  EXPECT_EQ(run(10), FaultCode::kNone);
  feedback.jumps = 4;
  EXPECT_EQ(run(1), FaultCode::kEncoderJump);
}

TEST_F(MotionGuardTest, ReadingsThatStandStillThoughCurrentIsCommandedAreAFault) {
  effort_a = 5.0F;
  EXPECT_EQ(run(200), FaultCode::kNone);
  EXPECT_EQ(run(2), FaultCode::kFrozen);
}

// At its no-load speed, 10 turns away: speed and current change no more, and the field of the angle has
// ended.
TEST_F(MotionGuardTest, AShaftThatTurnsOnBeyondTheFieldOfItsAngleIsNotFrozen) {
  effort_a = 5.0F;
  feedback.angle_at_end = true;
  feedback.velocity_rpm = 500.0F;
  EXPECT_EQ(run(1000), FaultCode::kNone);
  feedback.velocity_rpm = 0.0F;
  EXPECT_EQ(run(203), FaultCode::kFrozen) << "one that stands still there may be";
}

TEST_F(MotionGuardTest, ABlockedMotorWhoseCurrentIsAsCommandedIsNotFrozen) {
  effort_a = 5.0F;
  feedback.current_a = 4.8F;
  EXPECT_EQ(run(1000), FaultCode::kNone);
}

TEST_F(MotionGuardTest, ACurrentAfterAnAngleThatWasHeldIsNotFrozen) {
  EXPECT_EQ(run(1), FaultCode::kNone);
  unit = CommandUnit::kNative;
  EXPECT_EQ(run(1000), FaultCode::kNone);
  unit = CommandUnit::kAmpere;
  effort_a = 5.0F;
  EXPECT_EQ(run(199), FaultCode::kNone) << "the current has its time from now on";
  EXPECT_EQ(run(3), FaultCode::kFrozen);
}

TEST_F(MotionGuardTest, ReadingsThatChangeByOneBitAreNotFrozen) {
  effort_a = 5.0F;
  feedback.temperature_c = 40.0F;
  const std::array<std::function<void(float)>, 4> readings{
      [this](float by) { feedback.total_angle_deg += static_cast<double>(by); },
      [this](float by) { feedback.velocity_rpm += by; }, [this](float by) { feedback.current_a += by; },
      [this](float by) { feedback.temperature_c += by; }};
  for (const auto& change : readings) {
    for (const float by : {0.01F, 0.01F, -0.01F, -0.01F}) {
      EXPECT_EQ(run(150), FaultCode::kNone);
      change(by);
    }
  }
}

TEST_F(MotionGuardTest, GainingSpeedAgainstAllTheTorqueIsARunaway) {
  effort_a = 20.0F;
  feedback.velocity_rpm = -10.0F;
  EXPECT_EQ(run(10, kLimitCurrent), FaultCode::kNone);
  feedback.velocity_rpm = -58.0F;
  feedback.current_a = 20.0F;
  EXPECT_EQ(run(10, kLimitCurrent), FaultCode::kNone);
  feedback.velocity_rpm = -59.0F;
  EXPECT_EQ(run(1, kLimitCurrent), FaultCode::kRunaway);
}

TEST_F(MotionGuardTest, TheTargetOfADrivesOwnLoopIsNoTorque) {
  unit = CommandUnit::kNative;
  effort_a = 199.0F;  // deg
  feedback.current_a = -10.0F;
  for (int rpm = 0; rpm > -100; --rpm) {
    feedback.velocity_rpm = static_cast<float>(rpm);
    EXPECT_EQ(run(1, kLimitCurrent), FaultCode::kNone) << "its current drives it there";
  }
  feedback.current_a = kNotReported;
  EXPECT_EQ(run(100, kLimitCurrent), FaultCode::kNone);
}

TEST_F(MotionGuardTest, InADrivesOwnLoopItsCurrentTellsOfARunaway) {
  unit = CommandUnit::kNative;
  effort_a = -30.0F;
  feedback.current_a = 20.0F;
  EXPECT_EQ(atLimit(-10.0F, 10), FaultCode::kNone);
  EXPECT_EQ(atLimit(-59.0F, 1), FaultCode::kRunaway);
}

TEST_F(MotionGuardTest, ALoadThatIsLetDownAsAskedIsNoRunaway) {
  unit = CommandUnit::kNative;
  feedback.current_a = 20.0F;
  for (const auto asked : {Target{.mode = ControlMode::kVelocity, .value = -100.0},
                           Target{.mode = ControlMode::kTotalAngle, .value = -500.0}}) {
    guard.reset();
    target = asked;
    EXPECT_EQ(atLimit(-1.0F, 10), FaultCode::kNone);
    EXPECT_EQ(atLimit(-99.0F, 10), FaultCode::kNone);
    target.value = -target.value;
    EXPECT_EQ(run(1, kLimitCurrent), FaultCode::kNone) << "from here on it is opposed";
    EXPECT_EQ(atLimit(-148.0F, 1), FaultCode::kRunaway);
  }
  guard.reset();
  target = {.mode = ControlMode::kVelocity, .value = -30.0};
  EXPECT_EQ(atLimit(-31.0F, 10), FaultCode::kNone);
  EXPECT_EQ(atLimit(-80.0F, 1), FaultCode::kRunaway) << "faster than asked";
}

TEST_F(MotionGuardTest, ASpringThatLetsALoadDownIsNoRunaway) {
  effort_a = 20.0F;
  target = {.mode = ControlMode::kImpedance, .value = -90.0, .stiffness_nm_per_rad = 1.0F};
  EXPECT_EQ(atLimit(-1.0F, 10), FaultCode::kNone);
  EXPECT_EQ(atLimit(-70.0F, 10), FaultCode::kNone);
  target.stiffness_nm_per_rad = 0.0F;  // asks for no place
  EXPECT_EQ(atLimit(-1.0F, 10), FaultCode::kNone);
  EXPECT_EQ(atLimit(-70.0F, 1), FaultCode::kRunaway);
}

TEST_F(MotionGuardTest, ATargetAsksForNoMoreThanTheVelocityLimit) {
  for (const auto asked : {Target{.mode = ControlMode::kVelocity, .value = -1e6},
                           Target{.mode = ControlMode::kTotalAngle, .value = -1e6}}) {
    guard = MotorGuard{{.runaway_rpm = 48.0F, .velocity_limit_rpm = 60.0F}};
    effort_a = 20.0F;
    target = asked;
    EXPECT_EQ(atLimit(-60.0F, 10), FaultCode::kNone);
    EXPECT_EQ(atLimit(-61.0F, 10), FaultCode::kNone);
    EXPECT_EQ(atLimit(-110.0F, 1), FaultCode::kRunaway);
  }
}

TEST_F(MotionGuardTest, AtItsThresholdNothingIsWrong) {
  target = {.mode = ControlMode::kTotalAngle, .value = -15.0};
  effort_a = -1.0F;
  EXPECT_EQ(run(500), FaultCode::kNone);
  target.value = -15.1;
  EXPECT_EQ(run(101), FaultCode::kFollowingError);
}

TEST_F(MotionGuardTest, AnAngleOfAnyTurnIsFollowedTheShortestWay) {
  feedback.total_angle_deg = 355.0;
  feedback.angle_deg = 355.0F;
  target = {.mode = ControlMode::kAngle, .value = 5.0};
  EXPECT_EQ(run(500), FaultCode::kNone);
  target.value = 11.0;
  EXPECT_EQ(run(101), FaultCode::kFollowingError);
}

TEST_F(MotionGuardTest, ATargetThatIsNoAngleHasNoFollowingError) {
  feedback.angle_deg = 0.0F;
  for (const auto mode :
       {ControlMode::kVelocity, ControlMode::kCurrent, ControlMode::kImpedance, ControlMode::kVoltage}) {
    target = {.mode = mode, .value = 90.0};
    EXPECT_EQ(run(300), FaultCode::kNone);
  }
}

TEST_F(MotionGuardTest, TimesOfBeforeDoNotCount) {
  target = {.mode = ControlMode::kTotalAngle, .value = 16.0};
  effort_a = 5.0F;
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(run(90), FaultCode::kNone);
    guard.reset();
  }
  target = {};
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(run(190), FaultCode::kNone);
    guard.reset();
  }
}

TEST_F(MotionGuardTest, ATemperatureThatIsNotReportedChangesNothing) {
  effort_a = 5.0F;
  feedback.temperature_c = kNotReported;
  EXPECT_EQ(run(202), FaultCode::kFrozen);
  guard.reset();
  for (int i = 0; i < 500; ++i) {
    feedback.temperature_c = i % 2 == 0 ? kNotReported : 40.0F;
    EXPECT_EQ(run(1), FaultCode::kNone);
  }
}

TEST_F(MotionGuardTest, OnlyAllTheTorqueThereIsShowsARunaway) {
  effort_a = 20.0F;
  for (const std::uint32_t limits : {0U, static_cast<std::uint32_t>(kLimitAngle)}) {
    feedback.velocity_rpm = -10.0F;
    EXPECT_EQ(run(10, limits), FaultCode::kNone);
    feedback.velocity_rpm = -500.0F;
    feedback.current_a = 20.0F;
    EXPECT_EQ(run(10, limits), FaultCode::kNone);
  }
}

TEST_F(MotionGuardTest, ARunawayCountsFromTheSlowestSpeedAgainstItsTorque) {
  effort_a = 20.0F;
  feedback.current_a = 20.0F;
  feedback.velocity_rpm = 0.0F;
  EXPECT_EQ(run(3, kLimitCurrent), FaultCode::kNone);
  feedback.velocity_rpm = -50.0F;
  EXPECT_EQ(run(3, kLimitCurrent), FaultCode::kNone) << "at standstill nothing was against it";
  feedback.velocity_rpm = -5.0F;
  EXPECT_EQ(run(3, kLimitCurrent), FaultCode::kNone);
  feedback.velocity_rpm = -53.5F;
  EXPECT_EQ(run(1, kLimitCurrent), FaultCode::kRunaway);
  guard.reset();
  feedback.velocity_rpm = -80.0F;
  EXPECT_EQ(run(3, kLimitCurrent), FaultCode::kNone) << "what was before does not count";
}

TEST_F(MotionGuardTest, AVoltageIsAnEffort) {
  unit = CommandUnit::kVolt;
  effort_a = 20.0F;
  feedback.current_a = -10.0F;  // along the motion
  feedback.velocity_rpm = -10.0F;
  EXPECT_EQ(run(3, kLimitCurrent), FaultCode::kNone);
  feedback.velocity_rpm = -59.0F;
  EXPECT_EQ(run(1, kLimitCurrent), FaultCode::kRunaway);
}

TEST_F(MotionGuardTest, BrakingFromFullSpeedIsNone) {
  effort_a = -20.0F;
  feedback.current_a = -20.0F;
  for (int rpm = 480; rpm > 0; --rpm) {
    feedback.velocity_rpm = static_cast<float>(rpm);
    ASSERT_EQ(run(1, kLimitCurrent), FaultCode::kNone) << rpm;
  }
}

}  // namespace
}  // namespace rc10::test::motor_guard_test
