#include "motor/guarding/target_shaper.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "motor/guarding/shaper_bench.hpp"

namespace rc10::test {
namespace {

TEST_F(TargetShaperTest, WithoutLimitsEveryTargetPassesAsItIs) {
  for (int mode = 0; mode < kControlModeCount; ++mode) {
    const auto shaped = step(static_cast<ControlMode>(mode), 12345.0);
    EXPECT_EQ(static_cast<int>(shaped.target.mode), mode);
    EXPECT_EQ(shaped.target.value, 12345.0);
    EXPECT_EQ(shaped.limits, 0U);
  }
}

// Each way by itself: too fast, and too sudden.
TEST_F(TargetShaperTest, AFeedForwardThatIsLimitedSaysSo) {
  const Target moving{.mode = ControlMode::kTotalAngle, .velocity_ff_rpm = 20.0F};
  configure({.velocity_slew_rpm_per_s = 1000.0F});
  EXPECT_EQ(step(moving).limits, kLimitSlew);
  configure({.angle_slew_deg_per_s = 60.0F});  // 10 rpm
  feedback.total_angle_deg = 0.0;
  const auto fast = step(moving);
  EXPECT_EQ(fast.target.velocity_ff_rpm, 10.0F);
  EXPECT_EQ(fast.limits, kLimitSlew);
}

TEST_F(TargetShaperTest, AVelocityTargetRisesFromTheMeasuredSpeedAtItsRate) {
  configure({.velocity_slew_rpm_per_s = 1000.0F});
  feedback.velocity_rpm = 50.0F;
  const auto first = step(ControlMode::kVelocity, 100.0);
  EXPECT_NEAR(first.target.value, 51.0, 1e-6);
  EXPECT_EQ(first.limits, kLimitSlew);
  EXPECT_EQ(valueAfter(49, ControlMode::kVelocity, 100.0), 100.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 100.0).limits, 0U);
}

TEST_F(TargetShaperTest, ACurrentTargetStartsFromTheCurrentInForce) {
  configure({.effort_slew_per_s = 100.0F});
  EXPECT_NEAR(step(ControlMode::kCurrent, -5.0, 2.0F).target.value, 1.9, 1e-6);
}

TEST_F(TargetShaperTest, ACurrentStartsFromTheMeasuredOneWhereTheLastCommandWasASpeed) {
  configure({.effort_slew_per_s = 100.0F});
  feedback.current_a = 1.5F;
  const auto shaped = step({.mode = ControlMode::kCurrent, .value = 5.0}, {3000.0F, CommandUnit::kNative});
  EXPECT_NEAR(shaped.target.value, 1.6, 1e-6);
}

TEST_F(TargetShaperTest, AVoltageStartsFromNothingWhereTheLastCommandWasACurrent) {
  configure({.effort_slew_per_s = 100.0F});
  EXPECT_NEAR(step(ControlMode::kVoltage, 5.0, 20.0F).target.value, 0.1, 1e-6);
}

TEST_F(TargetShaperTest, ADutyStartsFromNothingAndRisesByItsShareOfTheFullEffort) {
  configure({.effort_slew_per_s = 100.0F, .effort_full_scale = 50.0F});
  EXPECT_NEAR(step(ControlMode::kDuty, 0.5, 20.0F).target.value, 0.002, 1e-9);
}

TEST_F(TargetShaperTest, ATorqueFeedForwardRisesAtTheRateOfTheCurrent) {
  configure({.effort_slew_per_s = 100.0F, .effort_per_nm = 2.0F});
  for (const auto mode :
       {ControlMode::kVelocity, ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kImpedance}) {
    shaper.reset();
    const Target target{.mode = mode, .torque_ff_nm = 3.0F};
    EXPECT_NEAR(static_cast<double>(step(target).target.torque_ff_nm), 0.05, 1e-6);
    EXPECT_NEAR(static_cast<double>(step(target).target.torque_ff_nm), 0.10, 1e-6);
    EXPECT_EQ(step(target).limits, kLimitSlew);
  }
}

TEST_F(TargetShaperTest, TheSmallestFeedForwardRisesAtItsRateToo) {
  configure({.effort_slew_per_s = 100.0F, .velocity_slew_rpm_per_s = 50.0F, .effort_per_nm = 2.0F});
  EXPECT_NEAR(step({.mode = ControlMode::kTotalAngle, .torque_ff_nm = 0.1F}).target.torque_ff_nm, 0.05F,
              1e-6F);
  shaper.reset();
  EXPECT_NEAR(step({.mode = ControlMode::kTotalAngle, .velocity_ff_rpm = 0.1F}).target.velocity_ff_rpm, 0.05F,
              1e-6F);
}

TEST_F(TargetShaperTest, AVelocityFeedForwardIsNoFasterThanTheAngleMayMoveAndDoesNotJump) {
  configure({.velocity_slew_rpm_per_s = 1000.0F, .angle_slew_deg_per_s = 60.0F});
  const Target target{.mode = ControlMode::kTotalAngle, .velocity_ff_rpm = 500.0F};
  EXPECT_NEAR(static_cast<double>(step(target).target.velocity_ff_rpm), 1.0, 1e-6);
  for (int i = 0; i < 50; ++i) (void)step(target);
  EXPECT_NEAR(static_cast<double>(step(target).target.velocity_ff_rpm), 10.0, 1e-6);
}

TEST_F(TargetShaperTest, AFeedForwardThatIsNoLongerAskedForFadesAtItsRate) {
  configure({.effort_slew_per_s = 100.0F, .velocity_slew_rpm_per_s = 1000.0F, .effort_per_nm = 2.0F});
  const Target pushed{.mode = ControlMode::kTotalAngle, .velocity_ff_rpm = 5.0F, .torque_ff_nm = 0.1F};
  for (int i = 0; i < 5; ++i) (void)step(pushed);
  const Target left{.mode = ControlMode::kTotalAngle};
  const auto fading = step(left);
  EXPECT_NEAR(static_cast<double>(fading.target.velocity_ff_rpm), 4.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(fading.target.torque_ff_nm), 0.05, 1e-6);
  EXPECT_EQ(fading.limits, kLimitSlew);
  for (int i = 0; i < 4; ++i) (void)step(left);
  const auto faded = step(left);
  EXPECT_EQ(faded.target.velocity_ff_rpm, 0.0F);
  EXPECT_EQ(faded.target.torque_ff_nm, 0.0F);
  EXPECT_EQ(faded.limits, 0U);
}

TEST_F(TargetShaperTest, NoFeedForwardPushesOutwardsAtASoftLimit) {
  auto config = soft;
  for (const float effort_per_nm : {0.0F, 2.0F}) {
    config.effort_per_nm = effort_per_nm;
    configure(config);
    at(91.0);
    for (const auto mode :
         {ControlMode::kVelocity, ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kImpedance}) {
      const auto out = step({.mode = mode, .value = 90.0, .velocity_ff_rpm = 50.0F, .torque_ff_nm = 3.0F});
      EXPECT_EQ(out.target.torque_ff_nm, 0.0F);
      EXPECT_EQ(out.limits & kLimitAngle, kLimitAngle);
      if (mode != ControlMode::kVelocity) {
        EXPECT_EQ(out.target.velocity_ff_rpm, 0.0F);
      }
      EXPECT_EQ(step({.mode = mode, .value = 90.0, .torque_ff_nm = -3.0F}).target.torque_ff_nm, -3.0F);
    }
  }
}

TEST_F(TargetShaperTest, ATorqueBesideASoftSpringBrakesBeforeASoftLimit) {
  auto config = soft;
  config.effort_per_nm = 2.0F;
  configure(config);
  at(80.0);  // 20 rpm are allowed
  feedback.velocity_rpm = 25.0F;
  const auto out = step({.mode = ControlMode::kImpedance, .value = 80.0, .torque_ff_nm = 3.0F});
  EXPECT_NEAR(static_cast<double>(out.target.torque_ff_nm), -0.5, 1e-6);
}

// As a client asks for one that only pulls, without damping.
TEST_F(TargetShaperTest, ASpringThatIsTooFastForASoftLimitIsBrakedAndOneThatIsSlowIsNot) {
  auto config = soft;
  config.effort_per_nm = 2.0F;
  configure(config);
  at(80.0);  // 20 rpm are allowed
  const Target spring{.mode = ControlMode::kImpedance, .value = 85.0, .stiffness_nm_per_rad = 10.0F};
  EXPECT_EQ(step(spring).target.torque_ff_nm, 0.0F);
  feedback.velocity_rpm = -100.0F;
  EXPECT_EQ(step(spring).target.torque_ff_nm, 0.0F) << "far from the other limit";
  feedback.velocity_rpm = 25.0F;
  const auto out = step(spring);
  EXPECT_NEAR(static_cast<double>(out.target.torque_ff_nm), -0.5, 1e-6);
  EXPECT_EQ(out.limits, kLimitAngle);
}

TEST_F(TargetShaperTest, ATorqueFeedForwardHoldsALoadUnderACeilingAndDrivesNothingBeyondIt) {
  configure({.effort_per_nm = 2.0F, .effort_full_scale = 20.0F});
  const Target held{.mode = ControlMode::kVelocity, .value = 60.0, .torque_ff_nm = 8.0F};
  (void)step(held);
  shaper.setCeiling(20.0);
  EXPECT_EQ(step(held).target.torque_ff_nm, 8.0F) << "a load that is held is not dropped";
  feedback.velocity_rpm = -30.0F;
  EXPECT_EQ(step(held).target.torque_ff_nm, 8.0F) << "nor while it sinks";
  feedback.velocity_rpm = 20.0F;
  const auto fast = step(held);
  EXPECT_EQ(fast.target.torque_ff_nm, 0.0F);
  EXPECT_NE(fast.limits & kLimitVelocity, 0U);
  feedback.velocity_rpm = 0.0F;
  EXPECT_NEAR(static_cast<double>(step(held).target.torque_ff_nm), 0.02, 1e-6) << "and comes back slowly";
}

TEST_F(TargetShaperTest, WhereTheEffortOfASpeedIsUnknownTheLoopOfTheDriveBrakes) {
  auto config = soft;
  config.approach_effort_per_rpm = 0.0F;
  config.has_velocity_loop = true;
  configure(config);
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.value, 3.0) << "far from the limit it acts";
  at(80.0);  // 20 rpm are allowed
  feedback.velocity_rpm = 25.0F;
  const auto fast = step(ControlMode::kCurrent, 3.0);
  EXPECT_EQ(fast.target.mode, ControlMode::kVelocity);
  EXPECT_EQ(fast.target.value, 20.0);
  EXPECT_EQ(fast.limits, kLimitAngle);
  feedback.velocity_rpm = 17.0F;
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.mode, ControlMode::kVelocity) << "clearly slower";
  feedback.velocity_rpm = 15.0F;
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.mode, ControlMode::kCurrent);
  at(85.0);
  feedback.velocity_rpm = 0.0F;
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.value, 1.5);
  at(95.0);
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.value, 0.0);
  EXPECT_EQ(step(ControlMode::kCurrent, -3.0).target.value, -3.0) << "back is always allowed";
  for (const double way : {1.0, -1.0}) {
    configure(config);
    at(way * 95.0);
    feedback.velocity_rpm = static_cast<float>(way * 0.05);
    const auto creeping = step(ControlMode::kCurrent, way * 3.0);
    EXPECT_EQ(creeping.target.mode, ControlMode::kVelocity) << "beyond the limit no speed is too small";
    EXPECT_EQ(creeping.target.value, 0.0);
  }
}

TEST_F(TargetShaperTest, UnderACeilingASpeedLoopIsLedNoFartherThoughTheShaftLags) {
  configure({.approach_rpm_per_deg = 2.0F, .lead_is_speed = true});
  shaper.setCeiling(20.0);
  EXPECT_NEAR(valueAfter(1000, ControlMode::kTotalAngle, 720.0), 5.0, 1e-9);
  configure({.approach_rpm_per_deg = 2.0F});
  shaper.setCeiling(20.0);
  EXPECT_NEAR(valueAfter(1000, ControlMode::kTotalAngle, 720.0), 120.0, 0.5) << "a spring holds a load by it";
}

TEST_F(TargetShaperTest, AWayThatHasJustBegunWhenACeilingComesGainsNoSpeed) {
  configure({.approach_rpm_per_deg = 2.0F});
  EXPECT_EQ(step(ControlMode::kTotalAngle, 720.0).target.value, 720.0);
  shaper.setCeiling(20.0);
  EXPECT_NEAR(step(ControlMode::kTotalAngle, 720.0).target.value, 0.5, 1e-9);
}

TEST_F(TargetShaperTest, ATargetThatRunsOnWhenACeilingComesLeadsLessFarAndOneThatStandsKeepsItsLoad) {
  configure({.approach_rpm_per_deg = 2.0F});
  EXPECT_EQ(step(ControlMode::kTotalAngle, 3.0).target.value, 3.0);
  shaper.setCeiling(20.0);
  EXPECT_NEAR(step(ControlMode::kTotalAngle, 4.0).target.value, 0.5, 1e-9);
  configure({.approach_rpm_per_deg = 2.0F});
  EXPECT_EQ(step(ControlMode::kTotalAngle, 3.0).target.value, 3.0);
  shaper.setCeiling(20.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, 3.0).target.value, 3.0);
}

TEST_F(TargetShaperTest, AnAngleTargetStartsWhereTheMotorIsAndArrivesExactly) {
  configure({.angle_slew_deg_per_s = 100.0F});
  at(30.0);
  EXPECT_NEAR(step(ControlMode::kTotalAngle, 60.0).target.value, 30.1, 1e-6);
  EXPECT_EQ(valueAfter(300, ControlMode::kTotalAngle, 60.0), 60.0);
}

TEST_F(TargetShaperTest, ASlewedAngleGoesTheShortestWay) {
  configure({.angle_slew_deg_per_s = 100.0F});
  at(350.0);
  const auto shaped = step(ControlMode::kAngle, 10.0);
  EXPECT_EQ(shaped.target.mode, ControlMode::kTotalAngle);
  EXPECT_NEAR(shaped.target.value, 350.1, 1e-6);
  EXPECT_NEAR(valueAfter(250, ControlMode::kAngle, 10.0), 370.0, 1e-9);
}

TEST_F(TargetShaperTest, AResetForgetsWhereTheTargetWas) {
  configure({.velocity_slew_rpm_per_s = 1000.0F});
  (void)valueAfter(100, ControlMode::kVelocity, 100.0);
  shaper.reset();
  EXPECT_NEAR(step(ControlMode::kVelocity, 100.0).target.value, 1.0, 1e-6);
}

TEST_F(TargetShaperTest, NoAngleTargetLeadsBeyondASoftLimit) {
  configure(soft);
  const auto shaped = step(ControlMode::kTotalAngle, 720.0);
  EXPECT_EQ(shaped.target.value, 90.0);
  EXPECT_EQ(shaped.limits, kLimitAngle);
  EXPECT_EQ(step(ControlMode::kTotalAngle, -45.0).limits, 0U);
}

// Its stop lies there, or gravity has let it sag: no leap to the limit.
TEST_F(TargetShaperTest, AShaftBeyondASoftLimitIsLedBackByItsTargetsAndNeverFartherOut) {
  configure(soft);
  at(-100.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, -100.0).target.value, -100.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, -99.5).target.value, -99.5);
  const auto out = step(ControlMode::kTotalAngle, -120.0);
  EXPECT_EQ(out.target.value, -100.0);
  EXPECT_EQ(out.limits, kLimitAngle);
  at(-95.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, -120.0).target.value, -100.0) << "held where it was led";
  EXPECT_EQ(step(ControlMode::kTotalAngle, -95.0).target.value, -95.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, -100.0).target.value, -95.0) << "not where it was before";
  at(-80.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, -100.0).target.value, -90.0) << "from now on the limit holds";
  at(-93.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, -100.0).target.value, -90.0) << "if it is pushed out again, too";
}

TEST_F(TargetShaperTest, AnAngleThatIsAllowedAnotherWayRoundIsReachedThatWay) {
  configure({.angle_min_deg = -300.0, .angle_max_deg = 100.0, .approach_rpm_per_deg = 2.0F});
  at(80.0);
  // 200 deg: the shortest way is up, through the limit; -160 deg is the same angle.
  const auto shaped = step(ControlMode::kAngle, 200.0);
  EXPECT_EQ(shaped.target.mode, ControlMode::kTotalAngle);
  EXPECT_NEAR(shaped.target.value, -160.0, 1e-9);
  EXPECT_EQ(shaped.limits, 0U);
}

TEST_F(TargetShaperTest, AVelocityTargetSlowsDownTowardsASoftLimitAndEndsThere) {
  configure(soft);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).target.value, 180.0);
  at(80.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).target.value, 20.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).limits, kLimitAngle);
  at(95.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).target.value, 0.0);
  EXPECT_EQ(step(ControlMode::kVelocity, -500.0).target.value, -370.0);  // back is allowed
}

TEST_F(TargetShaperTest, NoCurrentPushesOutwardsAtTheLimitAndEveryOneInwards) {
  configure(soft);
  at(91.0);
  const auto out = step(ControlMode::kCurrent, 3.0);
  EXPECT_EQ(out.target.mode, ControlMode::kCurrent);
  EXPECT_EQ(out.target.value, 0.0);
  EXPECT_EQ(out.limits, kLimitAngle);
  feedback.velocity_rpm = 10.0F;
  EXPECT_NEAR(step(ControlMode::kCurrent, 3.0).target.value, -2.0, 1e-6);  // it brakes
  EXPECT_EQ(step(ControlMode::kCurrent, -3.0).target.value, -3.0);
}

TEST_F(TargetShaperTest, ACurrentFadesAsTheSpeedNearsWhatIsAllowed) {
  configure(soft);
  at(80.0);  // 20 rpm are allowed
  feedback.velocity_rpm = 5.0F;
  EXPECT_EQ(step(ControlMode::kCurrent, 3.0).target.value, 3.0);
  feedback.velocity_rpm = 10.0F;
  EXPECT_NEAR(step(ControlMode::kCurrent, 3.0).target.value, 2.0, 1e-6);
  feedback.velocity_rpm = 25.0F;
  EXPECT_NEAR(step(ControlMode::kCurrent, 3.0).target.value, -1.0, 1e-6);
}

TEST_F(TargetShaperTest, ACurrentThatASoftLimitTookAwayComesBackAtItsRate) {
  auto config = soft;
  config.effort_slew_per_s = 100.0F;
  configure(config);
  at(80.0);  // 20 rpm are allowed
  EXPECT_EQ(valueAfter(40, ControlMode::kCurrent, 3.0), 3.0);
  feedback.velocity_rpm = 15.0F;
  EXPECT_NEAR(step(ControlMode::kCurrent, 3.0).target.value, 1.0, 1e-6) << "less acts at once";
  feedback.velocity_rpm = 25.0F;
  EXPECT_NEAR(step(ControlMode::kCurrent, 3.0).target.value, -1.0, 1e-6) << "and so does a brake";
  feedback.velocity_rpm = 0.0F;
  EXPECT_NEAR(step(ControlMode::kCurrent, 3.0).target.value, 0.1, 1e-6) << "more comes as it may rise";
  EXPECT_NEAR(step(ControlMode::kCurrent, 3.0).target.value, 0.2, 1e-6);
}

TEST_F(TargetShaperTest, ACurrentThatACeilingTookAwayComesBackAtItsRate) {
  configure({.effort_slew_per_s = 100.0F, .approach_effort_per_rpm = 0.2F});
  EXPECT_EQ(valueAfter(40, ControlMode::kCurrent, 3.0), 3.0);
  feedback.velocity_rpm = 18.0F;
  shaper.setCeiling(20.0);
  EXPECT_NEAR(step(ControlMode::kCurrent, 3.0).target.value, 0.4, 1e-6);
  shaper.setCeiling(std::numeric_limits<double>::infinity());
  EXPECT_NEAR(step(ControlMode::kCurrent, 3.0).target.value, 0.5, 1e-6);
}

TEST_F(TargetShaperTest, AnEffortThatItsLimitCutOffChangesFromThatLimit) {
  configure({.effort_slew_per_s = 1000.0F});
  const auto limited = [&](double asked_a) {
    return step({.mode = ControlMode::kCurrent, .value = asked_a}, {2.0F, CommandUnit::kAmpere, true})
        .target.value;
  };
  EXPECT_EQ(valueAfter(20, ControlMode::kCurrent, 10.0), 10.0);
  EXPECT_NEAR(limited(10.0), 3.0, 1e-6) << "its motor says again that it is too much";
  EXPECT_NEAR(limited(-10.0), 1.0, 1e-6);
}

TEST_F(TargetShaperTest, AVoltageMayKeepUpTheAllowedSpeed) {
  auto config = soft;
  config.effort_per_rpm = 0.1F;
  configure(config);
  at(80.0);
  feedback.velocity_rpm = 20.0F;
  EXPECT_NEAR(step(ControlMode::kVoltage, 24.0).target.value, 2.0, 1e-6);
}

TEST_F(TargetShaperTest, SoftLimitsWaitForAReference) {
  configure(soft);
  feedback.zeroed = false;
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).target.value, 500.0);
  EXPECT_EQ(step(ControlMode::kVelocity, 500.0).limits, 0U);
}

TEST_F(TargetShaperTest, AFirstStepIsAllowedUpToItsLimit) {
  configure({.max_first_step_deg = 10.0});
  at(350.0);
  EXPECT_TRUE(shaper.firstStepAllowed({.mode = ControlMode::kAngle, .value = 0.0}, {}, feedback));
  EXPECT_FALSE(shaper.firstStepAllowed({.mode = ControlMode::kAngle, .value = 1.0}, {}, feedback));
  EXPECT_FALSE(shaper.firstStepAllowed({.mode = ControlMode::kTotalAngle, .value = 0.0}, {}, feedback));
  EXPECT_TRUE(shaper.firstStepAllowed({.mode = ControlMode::kVelocity, .value = 500.0}, {}, feedback));
}

// ---- Soft start

TEST_F(TargetShaperTest, ASoftStartGoesFromWhatIsMeasuredToWhatIsAsked) {
  configure({.soft_start_s = 0.1F});
  shaper.restart();
  feedback.velocity_rpm = 40.0F;
  EXPECT_NEAR(step(ControlMode::kVelocity, 140.0).target.value, 41.0, 1e-3);
  EXPECT_EQ(step(ControlMode::kVelocity, 140.0).limits, kLimitSlew);
  EXPECT_NEAR(valueAfter(48, ControlMode::kVelocity, 140.0), 90.0, 1e-3);
  EXPECT_NEAR(valueAfter(50, ControlMode::kVelocity, 140.0), 140.0, 1e-3);
  EXPECT_EQ(step(ControlMode::kVelocity, -140.0).target.value, -140.0) << "from then on at once";
  EXPECT_EQ(step(ControlMode::kVelocity, -140.0).limits, 0U);
}

TEST_F(TargetShaperTest, ASoftStartOfAnAngleTakesTheShortestWay) {
  configure({.soft_start_s = 0.1F});
  shaper.restart();
  at(350.0);
  for (int i = 0; i < 50; ++i) (void)step(ControlMode::kAngle, 30.0);
  const double half_way = step(ControlMode::kAngle, 30.0).target.value;
  EXPECT_NEAR(std::remainder(half_way - 10.0, 360.0), 0.4, 0.1);
}

TEST_F(TargetShaperTest, ASoftStartBeginsWithTheEffortThatHolds) {
  configure({.soft_start_s = 0.1F});
  shaper.restart();
  EXPECT_NEAR(step(ControlMode::kCurrent, 2.0, 2.0F).target.value, 2.0, 1e-6) << "it is not reduced";
}

TEST_F(TargetShaperTest, ASoftStartHoldsForFeedForwardAndSpring) {
  configure({.soft_start_s = 0.1F});
  shaper.restart();
  const auto first = step({.mode = ControlMode::kImpedance,
                           .value = 100.0,
                           .velocity_ff_rpm = 50.0F,
                           .torque_ff_nm = 2.0F,
                           .stiffness_nm_per_rad = 10.0F,
                           .damping_nms_per_rad = 1.0F});
  EXPECT_NEAR(first.target.value, 1.0, 1e-3);
  EXPECT_NEAR(first.target.velocity_ff_rpm, 0.5F, 1e-3F);
  EXPECT_NEAR(first.target.torque_ff_nm, 0.02F, 1e-3F);
  EXPECT_EQ(first.target.stiffness_nm_per_rad, 10.0F);
}

TEST_F(TargetShaperTest, ATargetThatChangesWithinASoftStartLeadsNowhereElse) {
  configure({.soft_start_s = 0.1F});
  shaper.restart();
  feedback.velocity_rpm = -100.0F;
  EXPECT_NEAR(valueAfter(50, ControlMode::kVelocity, 100.0), 0.0, 1e-3);
  // A shaft that is told to stand still is not sent back to where the soft start began.
  for (int i = 0; i < 100; ++i) EXPECT_NEAR(step(ControlMode::kVelocity, 0.0).target.value, 0.0, 1e-3);
}

TEST_F(TargetShaperTest, EnablingAnewStartsFromWhatIsMeasuredThen) {
  configure({.soft_start_s = 0.1F});
  shaper.restart();
  feedback.velocity_rpm = -80.0F;
  (void)valueAfter(200, ControlMode::kVelocity, 0.0);
  feedback.velocity_rpm = 0.0F;
  shaper.restart();  // and its mode stays: a ramp is in force on both sides
  EXPECT_NEAR(step(ControlMode::kVelocity, 0.0).target.value, 0.0, 1e-3);
}

TEST_F(TargetShaperTest, ASoftStartLeadsToTheLimitAndNotToATargetBeyondIt) {
  configure(
      {.effort_per_nm = 2.0F, .effort_limit = 10.0F, .velocity_limit_rpm = 200.0F, .soft_start_s = 0.1F});
  const auto first = [this](const Target& target) {
    shaper.restart();
    return step(target).target;
  };
  EXPECT_NEAR(first({.mode = ControlMode::kVelocity, .value = -1e9}).value, -2.0, 1e-3);
  EXPECT_NEAR(first({.mode = ControlMode::kCurrent, .value = 1e9, .torque_ff_nm = 1e30F}).value, 0.1, 1e-3);
  EXPECT_NEAR(first({.mode = ControlMode::kCurrent, .value = 12.0, .torque_ff_nm = -4.0F}).value, 0.04, 1e-3);
  EXPECT_NEAR(first({.mode = ControlMode::kDuty, .value = 50.0}).value, 0.01, 1e-3);
  const auto spring =
      first({.mode = ControlMode::kTotalAngle, .velocity_ff_rpm = 1e30F, .torque_ff_nm = -1e30F});
  EXPECT_NEAR(spring.velocity_ff_rpm, 2.0F, 1e-3F);
  EXPECT_NEAR(spring.torque_ff_nm, -0.05F, 1e-3F);
}

TEST_F(TargetShaperTest, ARampKeepsItsTimeWhateverTheSlewLimit) {
  configure({.velocity_slew_rpm_per_s = 100.0F});
  feedback.velocity_rpm = 90.0F;
  for (int i = 1; i <= 30; ++i) {
    Target ramp{.mode = ControlMode::kVelocity, .value = 90.0 - 3.0 * i};
    const double asked_rpm = ramp.value;
    (void)shaper.slowDown(ramp, feedback, {}, kTickS);
    ASSERT_NEAR(ramp.value, asked_rpm, 1e-9);
  }
  EXPECT_NEAR(step(ControlMode::kVelocity, 50.0).target.value, 0.1, 1e-6)
      << "and a target goes on from there";
}

TEST_F(TargetShaperTest, ABrakeDoesNotStartSoftly) {
  configure({.soft_start_s = 0.1F});
  shaper.restart();
  const auto first = step(ControlMode::kBrake, 0.0);
  EXPECT_EQ(first.target.mode, ControlMode::kBrake);
}

/// Speeds that a shaft may be pushed to, with tolerance.
class SpeedBoundsTest : public TargetShaperTest {
 protected:
  static constexpr double kStandstillRpm = 10.0;
  void expectBounds(std::optional<double> from_rpm, float low_rpm, float high_rpm) {
    const OutputRange bounds = shaper.speedBounds(feedback, from_rpm, kStandstillRpm);
    EXPECT_NEAR(bounds.low, low_rpm, 1e-3F);
    EXPECT_NEAR(bounds.high, high_rpm, 1e-3F);
  }
};

TEST_F(SpeedBoundsTest, WithoutLimitsThereAreNone) {
  (void)step(ControlMode::kVelocity, 20.0);
  const OutputRange bounds = shaper.speedBounds(feedback, std::nullopt, kStandstillRpm);
  EXPECT_EQ(bounds.low, -std::numeric_limits<float>::infinity());
  EXPECT_EQ(bounds.high, std::numeric_limits<float>::infinity());
}

TEST_F(SpeedBoundsTest, AStopFromASpeedLiesBetweenItAndStandstill) {
  expectBounds(80.0, -20.0F, 110.0F);
  expectBounds(-80.0, -110.0F, 20.0F);
  expectBounds(0.0, -20.0F, 20.0F);
}

TEST_F(SpeedBoundsTest, AHandThatTouchesACarriedLoadHasItsTolerance) {
  const auto most_rpm = [&](double standstill_rpm) {
    return shaper.speedBounds(feedback, 0.0, standstill_rpm).high;
  };
  EXPECT_NEAR(most_rpm(15.0), 20.0F, 1e-3F);
  EXPECT_NEAR(most_rpm(60.0), 30.0F, 1e-3F) << "half a standstill at least";
  EXPECT_NEAR(most_rpm(4.0), 8.0F, 1e-3F) << "two at most";
}

TEST_F(TargetShaperTest, AnAngleUnderACeilingSaysThatItIsLimitedBothWays) {
  shaper.setCeiling(40.0);
  at(0.0);
  (void)step(ControlMode::kTotalAngle, 0.0);
  EXPECT_EQ(step(ControlMode::kTotalAngle, 500.0).limits, kLimitVelocity);
  EXPECT_EQ(step(ControlMode::kTotalAngle, -500.0).limits, kLimitVelocity);
}

TEST_F(SpeedBoundsTest, TheCeilingOfReducedModeBoundsBothWays) {
  shaper.setCeiling(40.0);
  expectBounds(std::nullopt, -50.0F, 50.0F);
  expectBounds(8.0, -5.0F, 14.0F);
}

TEST_F(SpeedBoundsTest, OnTheWayToASoftLimitASpeedIsThatOfItsTarget) {
  configure(soft);
  at(50.0);
  (void)step(ControlMode::kVelocity, 20.0);
  expectBounds(std::nullopt, -20.0F, 42.5F);
  at(85.0);
  (void)step(ControlMode::kVelocity, 20.0);
  expectBounds(std::nullopt, -20.0F, 31.25F);  // 2 rpm/deg * 5 deg
  at(95.0);
  (void)step(ControlMode::kVelocity, 20.0);
  expectBounds(std::nullopt, -20.0F, 20.0F);
}

TEST_F(SpeedBoundsTest, APlaceIsApproachedAtTheGainOfItsLoop) {
  configure(soft);
  at(80.0);
  (void)step(ControlMode::kTotalAngle, 85.0);
  expectBounds(std::nullopt, -1.125F * 170.0F * 4.0F - 20.0F, 1.125F * 10.0F * 4.0F + 20.0F);
  feedback.zeroed = false;
  const OutputRange bounds = shaper.speedBounds(feedback, std::nullopt, kStandstillRpm);
  EXPECT_EQ(bounds.high, std::numeric_limits<float>::infinity()) << "its angle is not known";
}

TEST_F(TargetShaperTest, ADutyBeginsAtThatOfTheTurningShaft) {
  configure({.effort_slew_per_s = 60.0F, .effort_full_scale = 60.0F, .duty_per_rpm = 1.0F / 2000.0F});
  const Target asked{.mode = ControlMode::kDuty, .value = 0.9};
  feedback.velocity_rpm = 1000.0F;
  EXPECT_NEAR(step(asked).target.value, 0.501, 1e-6);
  shaper.reset();
  EXPECT_NEAR(step(asked, {.duty = 0.7F}).target.value, 0.701, 1e-6) << "as the drive reports it";
  shaper.reset();
  feedback.velocity_rpm = 1e9F;
  EXPECT_NEAR(step(asked).target.value, 0.999, 1e-6);
}

}  // namespace
}  // namespace rc10::test
