#include "motor/cascade.hpp"

#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

namespace rc10::test::cascade_test {
namespace {

constexpr float kDt = 0.001F;
constexpr float kLimit = 10.0F;

CascadeConfig plainConfig() {
  return {.velocity = PID_Position::Config{.kp = 0.1F}, .angle = {.kp = 2.0F}, .velocity_limit_rpm = 100.0F};
}

/// The effort after the start-up glide has faded, with a shaft that stands still.
float settled(Cascade& cascade, const Target& target, const Cascade::Measured& measured, float limit = kLimit,
              float effort_ff = 0.0F) {
  float effort = 0.0F;
  for (int i = 0; i < 300; ++i) effort = cascade.step(target, measured, kDt, limit, effort, effort_ff);
  return effort;
}

TEST(Cascade, VelocityErrorBecomesEffort) {
  Cascade cascade(plainConfig());
  EXPECT_NEAR(settled(cascade, {.mode = ControlMode::kVelocity, .value = 50.0}, {}), 5.0F, 1e-3F);
  EXPECT_FALSE(cascade.velocityLimited());
  EXPECT_FALSE(cascade.effortLimited());
}

TEST(Cascade, AngleErrorBecomesVelocityTheShortWayRound) {
  Cascade cascade(plainConfig());
  const Cascade::Measured measured{.angle_deg = 350.0F, .total_angle_deg = 350.0};
  // 20 deg * 2 rpm/deg * 0.1 A/rpm
  EXPECT_NEAR(settled(cascade, {.mode = ControlMode::kAngle, .value = 10.0}, measured), 4.0F, 1e-3F);
  EXPECT_NEAR(settled(cascade, {.mode = ControlMode::kTotalAngle, .value = 340.0}, measured), -2.0F, 1e-3F);
}

TEST(Cascade, SmallErrorsAreSeenAfterABillionTurns) {
  Cascade cascade(plainConfig());
  const Cascade::Measured measured{.total_angle_deg = 360e9};
  EXPECT_NEAR(settled(cascade, {.mode = ControlMode::kTotalAngle, .value = 360e9 + 1.0}, measured), 0.2F,
              1e-3F);
}

TEST(Cascade, VelocityTargetsObeyTheLimitInEveryMode) {
  Cascade cascade(plainConfig());
  EXPECT_NEAR(settled(cascade, {.mode = ControlMode::kVelocity, .value = 1e9}, {}, 100.0F), 10.0F, 1e-3F);
  EXPECT_TRUE(cascade.velocityLimited());
  EXPECT_NEAR(settled(cascade, {.mode = ControlMode::kTotalAngle, .value = -1e9}, {}, 100.0F), -10.0F, 1e-3F);
  EXPECT_TRUE(cascade.velocityLimited());
}

TEST(Cascade, FeedForwardVelocityIsAddedInsideTheLimit) {
  Cascade cascade(plainConfig());
  const Target moving{.mode = ControlMode::kTotalAngle, .value = 0.0, .velocity_ff_rpm = 30.0F};
  EXPECT_NEAR(settled(cascade, moving, {}), 3.0F, 1e-3F);
  const Target racing{.mode = ControlMode::kTotalAngle, .value = 0.0, .velocity_ff_rpm = 300.0F};
  EXPECT_NEAR(settled(cascade, racing, {}, 100.0F), 10.0F, 1e-3F);
  EXPECT_TRUE(cascade.velocityLimited());
}

TEST(Cascade, FeedForwardEffortIsAddedInsideTheLimit) {
  Cascade cascade(plainConfig());
  const Target still{.mode = ControlMode::kVelocity};
  EXPECT_NEAR(settled(cascade, still, {}, kLimit, 4.0F), 4.0F, 1e-3F);
  EXPECT_NEAR(settled(cascade, still, {}, kLimit, 40.0F), kLimit, 1e-3F);
  EXPECT_TRUE(cascade.effortLimited());
}

TEST(Cascade, FeedForwardEffortDoesNotWindUpTheLoop) {
  Cascade cascade({.velocity = PID_Position::Config{.ki = 10.0F}, .angle = {}, .velocity_limit_rpm = 0.0F});
  const Target up{.mode = ControlMode::kVelocity, .value = 10.0};
  EXPECT_NEAR(settled(cascade, up, {}, kLimit, 8.0F), kLimit, 1e-3F);
  // The integral holds the 2 A of room that were left, so the output falls at once with the feed-forward.
  EXPECT_NEAR(cascade.step(up, {}, kDt, kLimit, kLimit, 0.0F), 2.1F, 0.05F);
}

TEST(Cascade, AChangeOfModeContinuesFromTheEffortInForce) {
  for (const auto mode : {ControlMode::kVelocity, ControlMode::kAngle, ControlMode::kTotalAngle}) {
    Cascade cascade({.velocity = PID_Position::Config{.kp = 0.1F, .ki = 1.0F}, .angle = {.kp = 1.0F}});
    const Cascade::Measured measured{.angle_deg = 90.0F, .total_angle_deg = 450.0, .velocity_rpm = 40.0F};
    const Target target{.mode = mode, .value = mode == ControlMode::kVelocity ? 40.0 : 130.0};
    // At most a tenth of the proportional share appears in the first millisecond.
    EXPECT_NEAR(cascade.step(target, measured, kDt, 20.0F, 6.5F), 6.5F, 4.0F) << toString(mode);
  }
}

TEST(Cascade, FeedForwardEffortIsPartOfTheEffortInForce) {
  Cascade cascade({.velocity = PID_Position::Config{.kp = 0.1F, .ki = 1.0F}, .angle = {}});
  EXPECT_NEAR(cascade.step({.mode = ControlMode::kVelocity}, {}, kDt, 20.0F, 6.5F, 4.0F), 6.5F, 0.01F);
}

TEST(Cascade, FeedForwardVelocityDoesNotWindUpTheAngleLoop) {
  Cascade cascade(
      {.velocity = PID_Position::Config{.kp = 0.1F}, .angle = {.ki = 100.0F}, .velocity_limit_rpm = 100.0F});
  Target target{.mode = ControlMode::kTotalAngle, .value = 10.0, .velocity_ff_rpm = 80.0F};
  EXPECT_NEAR(settled(cascade, target, {}, 50.0F), 10.0F, 1e-3F);
  target.velocity_ff_rpm = 0.0F;  // the integral holds the 20 rpm of room that were left
  EXPECT_NEAR(cascade.step(target, {}, kDt, 50.0F, 10.0F), 2.1F, 0.05F);
}

TEST(Cascade, TheDerivativeOfTheAngleOpposesTheMotionAlsoAcrossTheWrap) {
  for (const auto mode : {ControlMode::kAngle, ControlMode::kTotalAngle}) {
    Cascade cascade({.velocity = PID_Position::Config{.kp = 0.1F}, .angle = {.kd = 0.5F}});
    double total_deg = 350.0;
    float effort = 0.0F;
    for (int i = 0; i < 200; ++i) {  // 100 deg/s, through 360 after 100 steps
      total_deg += 0.1;
      const Cascade::Measured measured{
          .angle_deg = static_cast<float>(total_deg < 360.0 ? total_deg : total_deg - 360.0),
          .total_angle_deg = total_deg};
      effort = cascade.step({.mode = mode, .value = 0.0}, measured, kDt, 100.0F, effort);
      if (i <= 90) continue;  // start-up glide
      ASSERT_NEAR(effort, -5.0F, 0.05F) << toString(mode) << i;
    }
  }
}

TEST(Cascade, TheAngleLoopForgetsBetweenTwoUses) {
  Cascade cascade({.velocity = PID_Position::Config{.kp = 0.1F}, .angle = {.ki = 100.0F}});
  EXPECT_GT(settled(cascade, {.mode = ControlMode::kTotalAngle, .value = 10.0}, {}, 50.0F), 20.0F);
  (void)settled(cascade, {.mode = ControlMode::kVelocity}, {});
  EXPECT_NEAR(settled(cascade, {.mode = ControlMode::kTotalAngle}, {}), 0.0F, 1e-3F);
}

TEST(Cascade, StartsAnewAfterReset) {
  Cascade cascade({.velocity = PID_Position::Config{.ki = 10.0F}, .angle = {}, .velocity_limit_rpm = 0.0F});
  const Target up{.mode = ControlMode::kVelocity, .value = 10.0};
  (void)settled(cascade, up, {});
  cascade.reset();
  EXPECT_NEAR(cascade.step(up, {}, kDt, kLimit, 0.0F), 0.0F, 0.1F);
  EXPECT_FALSE(cascade.effortLimited());
}

TEST(Cascade, OtherModesAndNumbersThatAreNotFiniteGiveZero) {
  Cascade cascade(plainConfig());
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Target good{.mode = ControlMode::kVelocity, .value = 50.0};
  EXPECT_FLOAT_EQ(cascade.step({.mode = ControlMode::kCurrent, .value = 5.0}, {}, kDt, kLimit, 3.0F), 0.0F);
  EXPECT_FLOAT_EQ(cascade.step({.mode = ControlMode::kVelocity, .value = kNan}, {}, kDt, kLimit, 3.0F), 0.0F);
  EXPECT_FLOAT_EQ(cascade.step(good, {.total_angle_deg = kNan}, kDt, kLimit, 3.0F), 0.0F);
  EXPECT_FLOAT_EQ(cascade.step(good, {}, kDt, std::numeric_limits<float>::quiet_NaN(), 3.0F), 0.0F);
  EXPECT_TRUE(
      std::isfinite(cascade.step({.mode = ControlMode::kVelocity, .value = 1e300}, {}, kDt, kLimit, 0.0F)));
}

TEST(Cascade, WorksWithTheIncrementalFormAsWell) {
  Cascade cascade(
      {.velocity = PID_Incremental::Config{.kp = 0.1F}, .angle = {.kp = 2.0F}, .velocity_limit_rpm = 0.0F});
  EXPECT_NEAR(settled(cascade, {.mode = ControlMode::kVelocity, .value = 50.0}, {}), 5.0F, 1e-2F);
}

TEST(Cascade, OtherGainsActWithoutABumpInBothLoopsAndBothForms) {
  const std::initializer_list<std::pair<CascadeConfig, CascadeConfig>> changes{
      {{.velocity = PID_Position::Config{.kp = 0.1F}, .angle = {.kp = 2.0F}},
       {.velocity = PID_Position::Config{.kp = 0.2F}, .angle = {.kp = 3.0F}}},
      {{.velocity = PID_Incremental::Config{.kp = 0.1F}, .angle = {.kp = 2.0F}},
       {.velocity = PID_Incremental::Config{.kp = 0.2F}, .angle = {.kp = 3.0F}}}};
  const Target target{.mode = ControlMode::kTotalAngle, .value = 10.0};
  for (const auto& [before, after] : changes) {
    Cascade cascade(before);
    EXPECT_NEAR(settled(cascade, target, {}), 2.0F, 0.02F);
    cascade.retune(after);
    EXPECT_EQ(cascade.config().angle.kp, 3.0F);
    EXPECT_NEAR(cascade.step(target, {}, kDt, kLimit, 2.0F), 2.0F, 0.1F * 4.0F);
  }
}

TEST(Cascade, AnotherTypeOfLoopIsNotTaken) {
  Cascade cascade(plainConfig());
  cascade.retune({.velocity = PID_Incremental::Config{.kp = 5.0F}, .angle = {.kp = 5.0F}});
  EXPECT_EQ(cascade.config().angle.kp, 2.0F);
  EXPECT_NEAR(settled(cascade, {.mode = ControlMode::kVelocity, .value = 50.0}, {}), 5.0F, 1e-3F);
}

TEST(Cascade, OtherGainsDoNotPassTheLimits) {
  Cascade cascade(plainConfig());
  auto config = plainConfig();
  config.angle.output_limit = 1e6F;
  std::get<PID_Position::Config>(config.velocity).kp = 1e6F;
  cascade.retune(config);
  EXPECT_LE(settled(cascade, {.mode = ControlMode::kTotalAngle, .value = 1e6}, {}), kLimit);
  EXPECT_TRUE(cascade.velocityLimited());
}

const std::initializer_list<CascadeConfig> kWindingUp{
    {.velocity = PID_Position::Config{.kp = 0.1F, .ki = 5.0F, .kd = 0.001F}, .angle = {}},
    {.velocity = PID_Incremental::Config{.kp = 0.1F, .ki = 5.0F, .kd = 0.001F}, .angle = {}}};

// A shaft that a hand held back is let go: the loop has wound up to all its effort.
TEST(Cascade, AnEffortThatDrivesEverFasterBeyondTheSpeedBoundIsHalvedInEachStep) {
  for (const auto& config : kWindingUp) {
    for (const float way : {1.0F, -1.0F}) {
      const Target target{.mode = ControlMode::kVelocity, .value = static_cast<double>(way) * 10.0};
      Cascade cascade(config);
      float effort = settled(cascade, target, {});
      ASSERT_FLOAT_EQ(effort, way * kLimit);
      const auto stepAt = [&](float rpm) {
        effort = cascade.step(target, {.velocity_rpm = way * rpm}, kDt, kLimit, effort);
        return way * effort;
      };
      cascade.boundSpeeds({way > 0.0F ? -5.0F : -13.0F, way > 0.0F ? 13.0F : 5.0F});
      (void)stepAt(12.0F);  // of its leap
      EXPECT_GT(stepAt(12.0F), 2.0F) << "within the bound";
      effort = way * 8.0F;
      // With -4 rpm * 0.1 A/rpm, and an integral that has only begun.
      EXPECT_NEAR(stepAt(14.0F), 4.0F - 0.4F, 0.05F);
      EXPECT_NEAR(stepAt(14.1F), 1.8F - 0.41F, 0.05F);
      EXPECT_NEAR(stepAt(14.2F), 0.695F - 0.42F, 0.05F);
      const float balances = way * effort;
      EXPECT_NEAR(stepAt(14.2F), balances, 0.3F) << "it does not drive it on";
      for (int i = 0; i < 20; ++i) (void)stepAt(14.3F + 0.01F * static_cast<float>(i));
      EXPECT_LT(stepAt(15.0F), 0.0F) << "the error brakes";
    }
  }
}

TEST(Cascade, AnAngleLoopThatHasWoundUpAsksForNoSpeedBeyondTheBound) {
  CascadeConfig config = plainConfig();
  config.angle.ki = 100.0F;
  Cascade cascade(config);
  const Target target{.mode = ControlMode::kTotalAngle, .value = 10.0};
  EXPECT_NEAR(settled(cascade, target, {}), 10.0F, 1e-3F) << "all of 100 rpm";
  float effort = 0.0F;
  cascade.boundSpeeds(OutputRange::symmetric(15.0F));
  for (int i = 0; i < 300; ++i) effort = cascade.step(target, {}, kDt, kLimit, effort);
  EXPECT_NEAR(effort, 1.5F, 1e-3F);
  EXPECT_TRUE(cascade.velocityLimited());
}

TEST(Cascade, WhatHasBuiltUpAgainstABlockedShaftDoesNotActInAStop) {
  constexpr float kLeastRpm = 2.0F;
  const Target standstill{.mode = ControlMode::kVelocity};
  for (const auto& config : kWindingUp) {
    for (const float way : {1.0F, -1.0F}) {
      const auto effortInAStop = [&](float asked_rpm, float measured_rpm, float effort_ff = 0.0F) {
        Cascade cascade(config);
        const Cascade::Measured measured{.velocity_rpm = way * measured_rpm};
        const Target target{.mode = ControlMode::kVelocity, .value = static_cast<double>(way * asked_rpm)};
        float wound = settled(cascade, target, measured);
        wound = cascade.step(target, measured, kDt, kLimit, wound, way * effort_ff);
        const bool dropped = cascade.dropWindup(wound, measured.velocity_rpm, kLeastRpm);
        return way * cascade.step(standstill, measured, kDt, kLimit, dropped ? 0.0F : wound);
      };
      EXPECT_NEAR(effortInAStop(20.0F, 0.0F), 0.0F, 0.01F);
      EXPECT_NEAR(effortInAStop(20.0F, 9.0F), -0.9F, 0.1F) << "the error alone";
      EXPECT_NEAR(effortInAStop(20.0F, -5.0F), 0.5F, 0.1F) << "pulled back";
      EXPECT_GT(effortInAStop(20.0F, 11.0F), 7.0F) << "it turns: its load is carried";
      EXPECT_NEAR(effortInAStop(20.0F, 20.0F, 6.0F), 6.0F - 2.0F, 0.1F) << "what was fed forward as well";
      Cascade another_mode(config);
      (void)settled(another_mode, {.mode = ControlMode::kVelocity, .value = 20.0}, {});
      another_mode.reset();  // a current, say
      EXPECT_FALSE(another_mode.dropWindup(way, 0.0F, kLeastRpm));
      EXPECT_GT(effortInAStop(1.9F, 0.0F), 2.0F) << "the noise of what is held";
    }
  }
}

TEST(Cascade, AnAngleLoopThatHasBuiltUpAsksForNothingInAStop) {
  CascadeConfig config = plainConfig();
  config.angle.ki = 100.0F;
  Cascade cascade(config);
  const float wound = settled(cascade, {.mode = ControlMode::kTotalAngle, .value = 10.0}, {});
  ASSERT_TRUE(cascade.dropWindup(wound, 0.0F, 2.0F));
  EXPECT_NEAR(cascade.step({.mode = ControlMode::kTotalAngle}, {}, kDt, kLimit, 0.0F), 0.0F, 1e-3F);
}

// With a deadband nothing acts on the error of a load that is held.
TEST(Cascade, ALoadWithinTheDeadbandIsNoBlockedShaft) {
  CascadeConfig config{.velocity = PID_Position::Config{.kp = 0.1F, .ki = 5.0F}, .angle = {}};
  Cascade cascade(config);
  const Target target{.mode = ControlMode::kVelocity, .value = 5.0};
  const float wound = settled(cascade, target, {});
  std::get<PID_Position::Config>(config.velocity).deadband = 8.0F;
  cascade.retune(config);
  (void)cascade.step(target, {}, kDt, kLimit, wound);
  EXPECT_FALSE(cascade.dropWindup(wound, 0.0F, 2.0F));
}

}  // namespace
}  // namespace rc10::test::cascade_test
