#include "motor/guarding/fallback.hpp"

#include <gtest/gtest.h>

namespace rc10::test::fallback_test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kInstant{1};

class FallbackTest : public ::testing::Test {
 protected:
  void begin(FallbackAction action, Fallback::Until until = Fallback::Until::kEnded,
             const FallbackBound& bound = {}) {
    fallback.begin(action, until, bound, {.from_rpm = 100.0, .over = 1s}, start);
  }
  /// `unheard`: age of the sample.
  FrameKind after(Duration time, bool stands_still = false, double angle_deg = 0.0, Duration unheard = {}) {
    fallback.step({stands_still, angle_deg, start + time - unheard}, start + time);
    return fallback.kind();
  }

  const MonotonicTime start{100s};
  Fallback fallback;
};

TEST_F(FallbackTest, ItActsFromItsBeginToItsEnd) {
  EXPECT_FALSE(fallback.acts());
  EXPECT_FALSE(fallback.resistsFor(0s, start));
  begin(FallbackAction::kBrake);
  EXPECT_TRUE(fallback.acts());
  EXPECT_FALSE(fallback.resistsFor(1s, start + 1s - kInstant));
  EXPECT_TRUE(fallback.resistsFor(1s, start + 1s));
  fallback.end();
  EXPECT_FALSE(fallback.acts());
  EXPECT_FALSE(fallback.resistsFor(1s, start + 1s));
  begin(FallbackAction::kRamp);
  EXPECT_FALSE(fallback.resistsFor(0s, start + 1s)) << "it leads";
  fallback.giveWay(FrameKind::kDamp);
  EXPECT_FALSE(fallback.resistsFor(0s, start + 1s)) << "it ends with the ramp";
}

TEST_F(FallbackTest, EachActionHasItsFrames) {
  EXPECT_EQ(frameKindOf(FallbackAction::kCoast), FrameKind::kRest);
  EXPECT_EQ(frameKindOf(FallbackAction::kDamp), FrameKind::kDamp);
  EXPECT_EQ(frameKindOf(FallbackAction::kBrake), FrameKind::kBrake);
  EXPECT_EQ(frameKindOf(FallbackAction::kHold), FrameKind::kHold);
  EXPECT_EQ(frameKindOf(FallbackAction::kRamp), FrameKind::kCommand);
}

TEST_F(FallbackTest, ABrakeThatADriveLacksDoesNotResist) {
  EXPECT_EQ(resistanceOf({.brake_resists = true}), FrameKind::kRest);
  EXPECT_EQ(resistanceOf({.brake = Provision::kFrame}), FrameKind::kRest) << "a loop may push";
  EXPECT_EQ(resistanceOf({.brake = Provision::kFrame, .brake_resists = true}), FrameKind::kBrake);
  EXPECT_EQ(resistanceOf({.damp = Provision::kFrame, .brake = Provision::kFrame, .brake_resists = true}),
            FrameKind::kDamp);
}

TEST_F(FallbackTest, ARampFallsEvenlyAndHasTimeToComeToRest) {
  begin(FallbackAction::kRamp);
  EXPECT_EQ(fallback.rampRpm(start), 100.0);
  EXPECT_NEAR(fallback.rampRpm(start + 250ms), 75.0, 1e-4);
  EXPECT_GT(fallback.rampRpm(start + 1s - kInstant), 0.0);
  EXPECT_EQ(fallback.rampRpm(start + 1s), 0.0);
  EXPECT_EQ(fallback.rampRpm(start + 2s), 0.0);
  EXPECT_EQ(after(1200ms - kInstant), FrameKind::kCommand);
  EXPECT_EQ(after(1200ms), FrameKind::kRest);
}

TEST_F(FallbackTest, OneThatIsNoRampDoesNotEndWithTheTimeOfARamp) {
  begin(FallbackAction::kBrake);
  EXPECT_EQ(after(2s), FrameKind::kBrake);
}

TEST_F(FallbackTest, AtItsBoundItBecomesWhatComesThen) {
  begin(FallbackAction::kHold, Fallback::Until::kEnded, {.most = 10s, .then = FrameKind::kDamp});
  EXPECT_EQ(after(10s - kInstant), FrameKind::kHold);
  EXPECT_EQ(after(10s), FrameKind::kDamp);
  EXPECT_EQ(after(20s), FrameKind::kDamp);
}

TEST_F(FallbackTest, OneThatHasEndedBecomesNothingAtItsBound) {
  begin(FallbackAction::kHold, Fallback::Until::kEnded, {.most = 10s});
  fallback.end();
  EXPECT_EQ(after(11s), FrameKind::kRest);
}

TEST_F(FallbackTest, WithoutABoundItActsForEver) {
  begin(FallbackAction::kHold, Fallback::Until::kEnded, {.most = 10s});
  begin(FallbackAction::kDamp);
  EXPECT_EQ(after(std::chrono::hours{24}, true), FrameKind::kDamp);
}

TEST_F(FallbackTest, StandstillEndsItOnlyAfterATimeWithoutMovement) {
  begin(FallbackAction::kDamp, Fallback::Until::kStandstill);
  EXPECT_EQ(after(299ms, true), FrameKind::kDamp);
  EXPECT_EQ(after(300ms, false), FrameKind::kDamp) << "back from an overshoot";
  EXPECT_EQ(after(600ms - kInstant, true), FrameKind::kDamp);
  EXPECT_EQ(after(600ms, true), FrameKind::kRest);
}

TEST_F(FallbackTest, ATimeInWhichNothingIsHeardIsNoStandstill) {
  begin(FallbackAction::kDamp, Fallback::Until::kStandstill);
  EXPECT_EQ(after(250ms, true), FrameKind::kDamp);
  EXPECT_EQ(after(340ms, true, 0.4, 41ms), FrameKind::kDamp) << "a load that sinks slowly, after a pause";
  EXPECT_EQ(after(2s, true, 0.4, 1701ms), FrameKind::kDamp);
  EXPECT_EQ(after(2s, true, 0.4, 1700ms), FrameKind::kRest);
}

TEST_F(FallbackTest, StandstillNeverEndsAHold) {
  begin(FallbackAction::kHold, Fallback::Until::kStandstill, {.most = 10s});
  EXPECT_EQ(after(10s - kInstant, true), FrameKind::kHold);
  EXPECT_EQ(after(10s, true), FrameKind::kDamp) << "its load stood still because it was held";
  EXPECT_EQ(after(10300ms - kInstant, true), FrameKind::kDamp);
  EXPECT_EQ(after(10300ms, true), FrameKind::kRest) << "nothing moves";
}

TEST_F(FallbackTest, ALoadThatSinksAfterItsHoldIsDampedUntilItLies) {
  begin(FallbackAction::kHold, Fallback::Until::kStandstill, {.most = 10s});
  EXPECT_EQ(after(9s, true), FrameKind::kHold);
  EXPECT_EQ(after(10s, true), FrameKind::kDamp);
  for (Duration sinking = 10100ms; sinking < 20s; sinking += 100ms)
    ASSERT_EQ(after(sinking, false), FrameKind::kDamp);
  EXPECT_EQ(after(20199ms, true), FrameKind::kDamp);
  EXPECT_EQ(after(20200ms, true), FrameKind::kRest);
}

TEST_F(FallbackTest, ALoadThatSinksMoreSlowlyThanStandstillIsDampedUntilItLies) {
  begin(FallbackAction::kDamp, Fallback::Until::kStandstill);
  double angle_deg = 90.0;
  for (Duration sinking = 100ms; sinking <= 5s; sinking += 100ms) {
    ASSERT_EQ(after(sinking, true, angle_deg), FrameKind::kDamp) << angle_deg;
    angle_deg -= 0.3;
  }
  EXPECT_EQ(after(5200ms, true, angle_deg), FrameKind::kDamp);
  EXPECT_EQ(after(5500ms, true, angle_deg), FrameKind::kRest) << "it lies";
}

TEST_F(FallbackTest, NoiseOfAnEncoderIsNoMovement) {
  begin(FallbackAction::kDamp, Fallback::Until::kStandstill);
  for (Duration time = 10ms; time < 300ms; time += 10ms)
    ASSERT_EQ(after(time, true, time % 20ms == 0ms ? 90.2 : 89.8), FrameKind::kDamp);
  EXPECT_EQ(after(300ms, true, 90.2), FrameKind::kRest);
}

TEST_F(FallbackTest, TheBrakeOfADriveThatCannotDampDoesNotLetGoOfWhatWasHeld) {
  begin(FallbackAction::kHold, Fallback::Until::kStandstill, {.most = 10s, .then = FrameKind::kBrake});
  EXPECT_EQ(after(10s, true), FrameKind::kBrake);
  EXPECT_EQ(after(1h, true), FrameKind::kBrake) << "its load stands still because it brakes";
  begin(FallbackAction::kBrake, Fallback::Until::kStandstill);
  EXPECT_EQ(after(300ms, true), FrameKind::kRest) << "one that was asked for";
}

TEST_F(FallbackTest, WhatDampsEndsAtStandstillOnceItsMotorIsDisabled) {
  begin(FallbackAction::kDamp);
  EXPECT_EQ(after(1h, true), FrameKind::kDamp);
  fallback.disabled();
  EXPECT_EQ(after(2h, true), FrameKind::kRest);
  begin(FallbackAction::kHold, Fallback::Until::kEnded, {.most = 10s});
  fallback.disabled();
  EXPECT_EQ(after(9s, true), FrameKind::kHold);
  EXPECT_EQ(after(10s, true), FrameKind::kDamp) << "its load sinks";
  EXPECT_EQ(after(11s, true), FrameKind::kRest);
  begin(FallbackAction::kBrake);
  fallback.disabled();
  EXPECT_EQ(after(1h, true), FrameKind::kBrake);
  begin(FallbackAction::kDamp, Fallback::Until::kEnded, {.most = {}, .estop = true});
  fallback.disabled();
  EXPECT_EQ(after(1h, true), FrameKind::kDamp) << "it replaces what held a load";
}

TEST_F(FallbackTest, AHoldIsBoundAndABrakeIsInAnEstopOfTheRobot) {
  const FallbackConfig config{.hold_max = 3s, .brake_max = 4s};
  const DriveFrames frames;
  for (const bool estop : {false, true}) {
    EXPECT_EQ(boundOf(FallbackAction::kHold, estop, config, frames).most, Duration{3s});
    for (const auto action : {FallbackAction::kCoast, FallbackAction::kDamp, FallbackAction::kRamp})
      EXPECT_EQ(boundOf(action, estop, config, frames).most, std::nullopt);
  }
  EXPECT_EQ(boundOf(FallbackAction::kBrake, true, config, frames).most, Duration{4s});
  EXPECT_EQ(boundOf(FallbackAction::kBrake, false, config, frames).most, std::nullopt);
}

TEST_F(FallbackTest, NoBoundLetsALoadFall) {
  const auto then = [](Provision damp, Provision brake) {
    return boundOf(FallbackAction::kHold, true, {}, {.damp = damp, .brake = brake}).then;
  };
  EXPECT_EQ(then(Provision::kFrame, Provision::kFrame), FrameKind::kDamp);
  EXPECT_EQ(then(Provision::kNothing, Provision::kFrame), FrameKind::kDamp);
  EXPECT_EQ(then(Provision::kUnsupported, Provision::kFrame), FrameKind::kBrake);
  EXPECT_EQ(then(Provision::kUnsupported, Provision::kNothing), FrameKind::kBrake);
  EXPECT_EQ(then(Provision::kUnsupported, Provision::kUnsupported), FrameKind::kHold);
}

}  // namespace
}  // namespace rc10::test::fallback_test
