// Bounds of targets in both directions, and in each unit.

#include <limits>

#include <gtest/gtest.h>

#include "app/angle.hpp"
#include "motor/guarding/shaper_bench.hpp"

namespace rc10::test {
namespace {

TEST_F(TargetShaperTest, AVoltageGoesOnFromTheVoltageInForce) {
  configure({.effort_slew_per_s = 100.0F});
  const auto shaped = step({.mode = ControlMode::kVoltage, .value = 5.0}, {3.0F, CommandUnit::kVolt});
  EXPECT_NEAR(shaped.target.value, 3.1, 1e-6);
}

TEST_F(TargetShaperTest, AShaftBeyondALimitDoesNotLeapThereByAnAngleOfATurnEither) {
  configure(soft);
  at(91.5);
  EXPECT_NEAR(step(ControlMode::kAngle, 170.0).target.value, 91.5, 1e-9);
  EXPECT_NEAR(step(ControlMode::kAngle, 91.0).target.value, 91.0, 1e-9) << "on its way back";
  EXPECT_NEAR(step(ControlMode::kAngle, 20.0).target.value, 20.0, 1e-9);
}

TEST_F(TargetShaperTest, AReadingThatIsMissingStartsFromNothing) {
  configure({.effort_slew_per_s = 100.0F, .velocity_slew_rpm_per_s = 1000.0F});
  feedback.velocity_rpm = feedback.current_a = kNotReported;
  EXPECT_NEAR(step(ControlMode::kVelocity, 100.0).target.value, 1.0, 1e-6);
  const auto current = step({.mode = ControlMode::kCurrent, .value = 5.0}, {3.0F, CommandUnit::kNative});
  EXPECT_NEAR(current.target.value, 0.1, 1e-6);
}

TEST_F(TargetShaperTest, AModeThatFollowsAnotherBeginsAnew) {
  configure({.effort_slew_per_s = 100.0F, .velocity_slew_rpm_per_s = 1000.0F, .effort_per_nm = 1.0F});
  const Target pushed{.mode = ControlMode::kVelocity, .value = 50.0, .torque_ff_nm = 0.2F};
  for (int i = 0; i < 100; ++i) (void)step(pushed);
  feedback.velocity_rpm = 20.0F;
  (void)step(ControlMode::kCurrent, 0.0);
  const auto again = step(pushed);
  EXPECT_NEAR(again.target.value, 21.0, 1e-6);
  EXPECT_NEAR(again.target.torque_ff_nm, 0.1F, 1e-6F);
}

TEST_F(TargetShaperTest, AnEffortThatItsLimitCutOffChangesFromThereInEachUnitAndDirection) {
  const auto limited = [&](ControlMode mode, double before, double asked, TargetShaper::InForce told) {
    configure({.effort_slew_per_s = 1000.0F});
    for (int i = 0; i < 20; ++i) (void)step({.mode = mode, .value = before}, {0.0F, told.unit});
    return step({.mode = mode, .value = asked}, told).target.value;
  };
  using enum ControlMode;
  EXPECT_NEAR(limited(kCurrent, -10.0, -10.0, {-2.0F, CommandUnit::kAmpere, true}), -3.0, 1e-6);
  EXPECT_NEAR(limited(kVoltage, 10.0, 10.0, {2.0F, CommandUnit::kVolt, true}), 3.0, 1e-6);
  EXPECT_NEAR(limited(kCurrent, 10.0, 10.0, {-2.0F, CommandUnit::kAmpere, true}), 1.0, 1e-6)
      << "a limit that brakes has left nothing";
  EXPECT_NEAR(limited(kCurrent, -10.0, -10.0, {2.0F, CommandUnit::kAmpere, true}), -1.0, 1e-6);
  EXPECT_NEAR(limited(kCurrent, 3.0, 10.0, {7.0F, CommandUnit::kAmpere, true}), 4.0, 1e-6)
      << "never more than was asked for";
  EXPECT_NEAR(limited(kVoltage, 3.0, 10.0, {1.0F, CommandUnit::kAmpere, true}), 4.0, 1e-6) << "another unit";
  EXPECT_NEAR(limited(kCurrent, 3.0, 10.0, {1.0F, CommandUnit::kVolt, true}), 4.0, 1e-6);
  EXPECT_NEAR(limited(kCurrent, 3.0, 10.0, {1.0F, CommandUnit::kAmpere, false}), 4.0, 1e-6) << "not limited";
}

TEST_F(TargetShaperTest, ATorqueBesideACurrentIsPartOfIt) {
  configure({.effort_per_nm = 2.0F});
  const auto sum = step({.mode = ControlMode::kCurrent, .value = 1.0, .torque_ff_nm = 0.5F});
  EXPECT_NEAR(sum.target.value, 2.0, 1e-6);
  EXPECT_EQ(sum.target.torque_ff_nm, 0.0F);
}

TEST_F(TargetShaperTest, ADutyIsBoundedAsTheEffortThatItStandsFor) {
  auto config = soft;
  config.effort_full_scale = 20.0F;
  configure(config);
  at(80.0);  // 20 rpm, so 4 A of 20
  EXPECT_NEAR(step(ControlMode::kDuty, 1.0).target.value, 0.2, 1e-6);
  at(-80.0);
  EXPECT_NEAR(step(ControlMode::kDuty, -1.0).target.value, -0.2, 1e-6);
}

TEST_F(TargetShaperTest, TheLowerSoftLimitHoldsAsTheUpperOne) {
  configure(soft);
  at(-80.0);
  EXPECT_EQ(step(ControlMode::kVelocity, -500.0).target.value, -20.0);
  EXPECT_EQ(step(ControlMode::kVelocity, -500.0).limits, kLimitAngle);
  EXPECT_EQ(step(ControlMode::kVelocity, -20.0).limits, 0U);
  at(-95.0);
  EXPECT_EQ(step(ControlMode::kVelocity, -500.0).target.value, 0.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).target.value, 370.0);
  EXPECT_EQ(step(ControlMode::kCurrent, -3.0).target.value, 0.0);
  EXPECT_EQ(step(ControlMode::kCurrent, -3.0).limits, kLimitAngle);
  feedback.velocity_rpm = -10.0F;
  EXPECT_NEAR(step(ControlMode::kCurrent, -3.0).target.value, 2.0, 1e-6);
  feedback.velocity_rpm = 0.0F;
  EXPECT_EQ(step(ControlMode::kTotalAngle, -120.0).target.value, -95.0);
  at(100.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, 120.0).target.value, 90.0) << "the shaft was inside meanwhile";
  configure(soft);
  EXPECT_EQ(step(ControlMode::kTotalAngle, 120.0).target.value, 100.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, 99.0).target.value, 99.0);
}

TEST_F(TargetShaperTest, ALimitOnOneSideLeavesTheOtherFree) {
  configure({.angle_min_deg = -90.0, .approach_rpm_per_deg = 2.0F});
  EXPECT_EQ(step(ControlMode::kTotalAngle, 1e6).target.value, 1e6);
  EXPECT_EQ(step(ControlMode::kTotalAngle, -100.0).target.value, -90.0);
  configure({.angle_max_deg = 90.0, .approach_rpm_per_deg = 2.0F});
  EXPECT_EQ(step(ControlMode::kTotalAngle, -1e6).target.value, -1e6);
  EXPECT_EQ(step(ControlMode::kTotalAngle, 100.0).target.value, 90.0);
}

TEST_F(TargetShaperTest, AnAngleThatNoWayRoundReachesEndsAtTheLimit) {
  configure(soft);
  at(80.0);
  EXPECT_EQ(step(ControlMode::kAngle, 200.0).target.value, 90.0);
  EXPECT_EQ(step(ControlMode::kAngle, 200.0).limits, kLimitAngle);
  configure({.angle_min_deg = -100.0, .angle_max_deg = 200.0, .approach_rpm_per_deg = 2.0F});
  at(-80.0);
  const auto round = step(ControlMode::kAngle, 200.0);
  EXPECT_NEAR(round.target.value, 200.0, 1e-9) << "its end is allowed";
  EXPECT_EQ(round.limits, 0U);
  configure({.angle_min_deg = -160.0, .angle_max_deg = 100.0, .approach_rpm_per_deg = 2.0F});
  at(80.0);
  EXPECT_NEAR(step(ControlMode::kAngle, 200.0).target.value, -160.0, 1e-9);
}

TEST_F(TargetShaperTest, AVelocityFeedForwardSlowsDownTowardsBothSoftLimits) {
  configure(soft);
  const auto ff = [&](double deg, float rpm) {
    at(deg);
    return step({.mode = ControlMode::kTotalAngle, .value = deg, .velocity_ff_rpm = rpm})
        .target.velocity_ff_rpm;
  };
  EXPECT_EQ(ff(80.0, 50.0F), 20.0F);
  EXPECT_EQ(ff(80.0, -50.0F), -50.0F);
  EXPECT_EQ(ff(-80.0, -50.0F), -20.0F);
  EXPECT_EQ(ff(-80.0, 50.0F), 50.0F);
}

TEST_F(TargetShaperTest, ATorqueFeedForwardPushesInwardsOnlyAtBothLimits) {
  auto config = soft;
  config.effort_per_nm = 2.0F;
  configure(config);
  const auto torque = [&](double deg, float nm, ControlMode mode = ControlMode::kVelocity) {
    at(deg);
    shaper.reset();
    return step({.mode = mode, .value = mode == ControlMode::kVelocity ? 0.0 : deg, .torque_ff_nm = nm})
        .target.torque_ff_nm;
  };
  EXPECT_EQ(torque(-91.0, -3.0F), 0.0F);
  EXPECT_EQ(torque(-91.0, 3.0F), 3.0F);
  EXPECT_NEAR(torque(80.0, 3.0F), 2.0F, 1e-6F) << "20 rpm, so 4 A";
  EXPECT_NEAR(torque(-80.0, -3.0F), -2.0F, 1e-6F);
  feedback.velocity_rpm = -25.0F;
  EXPECT_NEAR(torque(-80.0, -3.0F, ControlMode::kImpedance), 0.5F, 1e-6F) << "a soft spring is braked";
  EXPECT_EQ(torque(-80.0, -3.0F), 0.0F) << "a loop brakes by itself";
}

TEST_F(TargetShaperTest, ATorqueOfUnknownCurrentEndsAtTheAllowedSpeed) {
  configure(soft);
  at(80.0);
  const Target pushed{.mode = ControlMode::kVelocity, .torque_ff_nm = 3.0F};
  feedback.velocity_rpm = 19.0F;
  EXPECT_EQ(step(pushed).target.torque_ff_nm, 3.0F);
  feedback.velocity_rpm = 20.0F;
  const auto fast = step(pushed);
  EXPECT_EQ(fast.target.torque_ff_nm, 0.0F);
  EXPECT_EQ(fast.limits & kLimitAngle, kLimitAngle);
}

// ---- A ceiling

TEST_F(TargetShaperTest, UnderACeilingASpeedIsNoFasterInEitherDirection) {
  shaper.setCeiling(20.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).target.value, 20.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).limits, kLimitVelocity);
  EXPECT_EQ(step(ControlMode::kVelocity, -500.0).target.value, -20.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 20.0).limits, 0U);
}

TEST_F(TargetShaperTest, OfACeilingAndASoftLimitTheSlowerHolds) {
  configure(soft);
  at(80.0);
  shaper.setCeiling(10.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).target.value, 10.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).limits, kLimitVelocity);
  shaper.setCeiling(30.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).target.value, 20.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).limits, kLimitAngle);
  EXPECT_EQ(step(ControlMode::kVelocity, -500.0).target.value, -30.0);
  EXPECT_EQ(step(ControlMode::kVelocity, -500.0).limits, kLimitVelocity);
}

TEST_F(TargetShaperTest, UnderACeilingAVelocityFeedForwardIsNoFaster) {
  shaper.setCeiling(20.0);
  for (const float way : {1.0F, -1.0F}) {
    const Target moving{.mode = ControlMode::kTotalAngle, .velocity_ff_rpm = way * 50.0F};
    EXPECT_EQ(step(moving).target.velocity_ff_rpm, way * 20.0F);
    EXPECT_EQ(step(moving).limits & kLimitVelocity, kLimitVelocity);
  }
}

TEST_F(TargetShaperTest, WithoutALoopACeilingEndsAPushThatDrivesBeyondIt) {
  shaper.setCeiling(20.0);
  feedback.velocity_rpm = 19.0F;
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.value, 3.0);
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).limits, 0U);
  feedback.velocity_rpm = 20.0F;
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.value, 0.0);
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).limits, kLimitVelocity);
  EXPECT_EQ(step(ControlMode::kCurrent, -3.0).target.value, -3.0) << "that brakes";
  feedback.velocity_rpm = -25.0F;
  EXPECT_EQ(step(ControlMode::kCurrent, -3.0).target.value, 0.0);
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.value, 3.0);
}

TEST_F(TargetShaperTest, ATorqueFeedForwardFadesWithTheSpeedUnderACeiling) {
  configure({.effort_per_nm = 2.0F, .effort_full_scale = 20.0F});
  const Target held{.mode = ControlMode::kVelocity, .torque_ff_nm = 8.0F};
  (void)step(held);
  shaper.setCeiling(20.0);
  feedback.velocity_rpm = 10.0F;
  EXPECT_NEAR(step(held).target.torque_ff_nm, 5.0F, 1e-5F) << "half of the full 10 N·m";
  configure({.effort_full_scale = 20.0F});
  shaper.setCeiling(20.0);
  EXPECT_EQ(step(held).target.torque_ff_nm, 8.0F) << "of unknown current it is left to the loop";
}

TEST_F(TargetShaperTest, ADrivesLoopBrakesInBothDirectionsAndTheEffortComesBackFromWhatIsMeasured) {
  configure({.effort_slew_per_s = 100.0F, .has_velocity_loop = true});
  for (const double way : {1.0, -1.0}) {
    configure({.effort_slew_per_s = 100.0F, .has_velocity_loop = true});
    shaper.setCeiling(20.0);
    feedback.velocity_rpm = 0.0F;
    EXPECT_EQ(valueAfter(40, ControlMode::kCurrent, way * 3.0), way * 3.0);
    feedback.velocity_rpm = static_cast<float>(way * 21.0);
    feedback.current_a = static_cast<float>(way * -1.2);
    const auto fast = step(ControlMode::kCurrent, way * 3.0);
    EXPECT_EQ(fast.target.mode, ControlMode::kVelocity);
    EXPECT_EQ(fast.target.value, way * 20.0);
    EXPECT_EQ(fast.limits & kLimitVelocity, kLimitVelocity);
    feedback.velocity_rpm = static_cast<float>(way * 16.0);
    const auto slower = step(ControlMode::kCurrent, way * 3.0);
    EXPECT_EQ(slower.target.mode, ControlMode::kCurrent) << "at 80 % of it";
    EXPECT_NEAR(slower.target.value, way * -1.1, 1e-6);
  }
}

TEST_F(TargetShaperTest, OfUnknownEffortAPushFadesTowardsBothSoftLimits) {
  auto config = soft;
  config.approach_effort_per_rpm = 0.0F;
  config.has_velocity_loop = true;
  configure(config);
  at(-85.0);  // 10 rpm are allowed
  const auto fading = step(ControlMode::kCurrent, -3.0);
  EXPECT_EQ(fading.target.value, -1.5);
  EXPECT_EQ(fading.limits, kLimitAngle);
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.value, 3.0);
  EXPECT_EQ(step(ControlMode::kCurrent, 0.0).limits, 0U);
  at(-80.0);
  EXPECT_EQ(step(ControlMode::kCurrent, -3.0).target.value, -3.0) << "20 rpm are enough";
  feedback.velocity_rpm = -25.0F;
  const auto fast = step(ControlMode::kCurrent, -3.0);
  EXPECT_EQ(fast.target.mode, ControlMode::kVelocity);
  EXPECT_EQ(fast.target.value, -20.0);
  feedback.velocity_rpm = 25.0F;
  EXPECT_EQ(step(ControlMode::kCurrent, -3.0).target.mode, ControlMode::kCurrent) << "that way it is free";
}

TEST_F(TargetShaperTest, UnderACeilingAnAngleMovesNoFasterAndItsSpeedIsBounded) {
  configure({.approach_rpm_per_deg = 2.0F});
  shaper.setCeiling(20.0);  // 0.12 deg a tick; the loop asks for 4 rpm a degree, so 5 deg of lead
  for (const double way : {1.0, -1.0}) {
    at(0.0);
    shaper.reset();
    EXPECT_NEAR(step(ControlMode::kTotalAngle, way * 2.0).target.value, way * 0.12, 1e-6);
    EXPECT_NEAR(valueAfter(9, ControlMode::kTotalAngle, way * 2.0), way * 1.2, 1e-6);
    const auto moved = step({.mode = ControlMode::kTotalAngle,
                             .value = way * 2.0,
                             .velocity_ff_rpm = static_cast<float>(way * 30.0)});
    EXPECT_NEAR(moved.target.velocity_ff_rpm, way * (20.0 - 4.0 * 1.32), 1e-5);
    EXPECT_EQ(moved.limits & kLimitVelocity, kLimitVelocity);
  }
}

TEST_F(TargetShaperTest, ACeilingBeginsFromTheAngleThatIsInForce) {
  ASSERT_EQ(step(ControlMode::kAngle, 30.0).target.value, 30.0);
  shaper.setCeiling(20.0);
  EXPECT_EQ(step(ControlMode::kAngle, 30.0).target.value, 30.0);
  EXPECT_NEAR(step(ControlMode::kAngle, 40.0).target.value, 30.12, 1e-6);
}

TEST_F(TargetShaperTest, AShaftThatFollowsUnderACeilingIsLedNoFartherThanItsLoopNeeds) {
  configure({.approach_rpm_per_deg = 2.0F});
  shaper.setCeiling(20.0);
  (void)valueAfter(1000, ControlMode::kTotalAngle, 100.0);
  feedback.velocity_rpm = 10.5F;
  EXPECT_NEAR(step(ControlMode::kTotalAngle, 100.0).target.value, 5.0, 1e-9);
  (void)valueAfter(1000, ControlMode::kTotalAngle, 100.0);
  feedback.velocity_rpm = 9.5F;
  EXPECT_GT(valueAfter(10, ControlMode::kTotalAngle, 100.0), 6.0) << "one that lags keeps its spring";
  feedback.velocity_rpm = -15.0F;
  EXPECT_GT(valueAfter(10, ControlMode::kTotalAngle, 100.0), 7.0) << "nor one that is pushed back";
}

TEST_F(TargetShaperTest, ACeilingThatGoesLeavesEveryTargetAsItIs) {
  shaper.setCeiling(20.0);
  (void)step(ControlMode::kVelocity, 500.0);
  shaper.setCeiling(std::numeric_limits<double>::infinity());
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).target.value, 500.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).limits, 0U);
}

TEST_F(TargetShaperTest, ASpeedBeyondTheLimitOfTheMotorDoesNotWindUp) {
  configure({.velocity_slew_rpm_per_s = 1000.0F, .velocity_limit_rpm = 20.0F});
  EXPECT_NEAR(valueAfter(5000, ControlMode::kVelocity, 1e9), 20.0, 1e-6);
  EXPECT_EQ(step(ControlMode::kVelocity, 1e9).limits, kLimitVelocity);
  EXPECT_NEAR(step(ControlMode::kVelocity, 0.0).target.value, 19.0, 1e-6) << "at once";
  EXPECT_NEAR(valueAfter(5000, ControlMode::kVelocity, -1e9), -20.0, 1e-6);
}

TEST_F(TargetShaperTest, FromBeyondTheLimitOfTheMotorASoftStartIsSoftToo) {
  configure({.velocity_slew_rpm_per_s = 2000.0F, .velocity_limit_rpm = 480.0F, .soft_start_s = 0.2F});
  shaper.restart();
  feedback.velocity_rpm = -521.0F;
  EXPECT_NEAR(step(ControlMode::kVelocity, -192.0).target.value, -521.0 + 0.005 * 329.0, 1e-3);
}

TEST_F(TargetShaperTest, ASoftStartLeadsTheWayThatALimitLeaves) {
  configure({.angle_min_deg = -200.0, .angle_max_deg = 200.0, .soft_start_s = 0.2F});
  shaper.restart();
  at(-247.0);
  // Farther out is no way; the other way round it is 359 deg.
  EXPECT_NEAR(step(ControlMode::kAngle, 112.0).target.value, -247.0 + 0.005 * 359.0, 1e-3);
  EXPECT_NEAR(valueAfter(199, ControlMode::kAngle, 112.0), 112.0, 1e-6);
}

TEST_F(TargetShaperTest, AShaftThatCameBackFasterThanItsSlewIsNotLedOutAgain) {
  configure({.angle_slew_deg_per_s = 100.0F, .angle_min_deg = -90.0, .angle_max_deg = 90.0});
  for (const double side : {1.0, -1.0}) {
    shaper.reset();
    at(side * 120.0);
    EXPECT_NEAR(step(ControlMode::kTotalAngle, 0.0).target.value, side * 119.9, 1e-3);
    at(side * 80.0);
    EXPECT_NEAR(step(ControlMode::kTotalAngle, 0.0).target.value, side * 90.0, 1e-3);
  }
}

TEST_F(TargetShaperTest, ALoadThatPullsAShaftBackIntoItsTravelIsHeldAllTheWay) {
  configure({.angle_slew_deg_per_s = 10.0F, .angle_min_deg = -90.0, .angle_max_deg = 90.0});
  for (const double side : {1.0, -1.0}) {
    shaper.reset();
    for (int i = 1; i <= 100; ++i) {
      at(side * (110.0 - 0.05 * (i - 1)));
      EXPECT_NEAR(step(ControlMode::kTotalAngle, side * 80.0).target.value, side * (110.0 - 0.01 * i), 1e-3);
    }
    // Farther out is no way from there.
    EXPECT_NEAR(step(ControlMode::kTotalAngle, side * 119.0).target.value, side * 109.0, 1e-3);
  }
}

TEST_F(TargetShaperTest, WithoutASlewASpeedBeyondTheLimitIsTheMotorsToBound) {
  configure({.velocity_limit_rpm = 20.0F});
  const auto shaped = step(ControlMode::kVelocity, 100.0);
  EXPECT_EQ(shaped.target.value, 100.0);
  EXPECT_EQ(shaped.limits, 0U);
}

TEST_F(TargetShaperTest, FeedForwardsBeyondTheLimitOfTheMotorDoNotWindUp) {
  configure({.effort_slew_per_s = 100.0F,
             .velocity_slew_rpm_per_s = 1000.0F,
             .effort_per_nm = 2.0F,
             .effort_limit = 4.0F,
             .velocity_limit_rpm = 20.0F});
  const Target far{.mode = ControlMode::kTotalAngle, .velocity_ff_rpm = 1e9F, .torque_ff_nm = -1e9F};
  for (int i = 0; i < 5000; ++i) (void)step(far);
  const auto limited = step(far);
  EXPECT_NEAR(limited.target.velocity_ff_rpm, 20.0F, 1e-4F);
  EXPECT_NEAR(limited.target.torque_ff_nm, -2.0F, 1e-4F);
  EXPECT_NE(limited.limits & kLimitCurrent, 0U);
  const auto back = step({.mode = ControlMode::kTotalAngle}).target;
  EXPECT_NEAR(back.velocity_ff_rpm, 19.0F, 1e-4F);
  EXPECT_NEAR(back.torque_ff_nm, -1.95F, 1e-4F);
}

TEST_F(TargetShaperTest, AVelocityFeedForwardThatALimitTookComesBackAtItsSlew) {
  configure({.velocity_slew_rpm_per_s = 1000.0F,
             .angle_min_deg = -90.0,
             .angle_max_deg = 90.0,
             .approach_rpm_per_deg = 10.0F});
  const auto feedForward = [&](double deg) {
    return step({.mode = ControlMode::kTotalAngle, .value = deg, .velocity_ff_rpm = -300.0F})
        .target.velocity_ff_rpm;
  };
  for (int i = 0; i < 300; ++i) (void)feedForward(0.0);
  EXPECT_NEAR(feedForward(0.0), -300.0F, 1e-3F);
  EXPECT_EQ(feedForward(100.0), 0.0F);
  EXPECT_EQ(feedForward(100.0), 0.0F);
  EXPECT_NEAR(feedForward(80.0), -1.0F, 1e-3F);
  EXPECT_NEAR(feedForward(80.0), -2.0F, 1e-3F);
}

TEST_F(TargetShaperTest, ASoftStartBeyondALimitDoesNotGoTheOtherWayRound) {
  configure({.angle_min_deg = -120.0, .angle_max_deg = 120.0, .soft_start_s = 0.2F});
  shaper.restart();
  at(471.7);
  // 149 deg is in no turn of the travel: it stays where it is.
  for (int i = 0; i < 300; ++i) {
    at(471.7 - 0.05 * i);
    EXPECT_NEAR(step(ControlMode::kAngle, 149.0).target.value, 471.7, 1e-9);
  }
}

TEST_F(TargetShaperTest, AFirstStepIsAsFarAsTheWayThatALimitLeaves) {
  configure({.angle_min_deg = -120.0, .angle_max_deg = 120.0, .max_first_step_deg = 30.0});
  const auto allowed = [&](double from_deg, double to_deg) {
    at(from_deg);
    feedback.angle_deg = static_cast<float>(wrapDegrees(from_deg));
    return shaper.firstStepAllowed({.mode = ControlMode::kAngle, .value = to_deg}, {}, feedback);
  };
  EXPECT_TRUE(allowed(100.0, 115.0));
  EXPECT_TRUE(allowed(130.0, 115.0));
  // Farther out there is no way, and the other one is a turn.
  EXPECT_FALSE(allowed(471.7, 115.0));
  EXPECT_FALSE(allowed(-471.7, -115.0));
  EXPECT_TRUE(allowed(471.7, 100.0));
}

}  // namespace
}  // namespace rc10::test
