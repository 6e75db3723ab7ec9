#include "motor/guarding/reduced_motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "motor/guarding/motor_guard.hpp"

namespace rc10::test::reduced_motion_test {
namespace {

using namespace std::chrono_literals;

class ReducedMotionTest : public ::testing::Test {
 protected:
  using Motion = ReducedMotion::Motion;

  /// The first of these ticks that finds it too fast; 0: none does.
  int step(bool reduced, bool moves, float velocity_rpm, int ticks = 1) {
    return step(reduced, moves ? Motion::kLed : Motion::kNone, velocity_rpm, ticks);
  }
  int step(bool reduced, Motion motion_now, float velocity_rpm, int ticks = 1) {
    int found = 0;
    for (int i = 1; i <= ticks; ++i) {
      feedback.velocity_rpm = velocity_rpm;
      ++feedback.samples;
      tick.now += 1ms;
      if (motion.step(reduced, motion_now, feedback, tick) && found == 0) found = i;
    }
    return found;
  }
  static constexpr ReducedConfig config() {
    return {
        .velocity_rpm = 20.0F, .effort_share = 0.5F, .within = 1s, .tolerance_rpm = 5.0F, .full_rpm = 480.0F};
  }

  ReducedMotion motion{config()};
  MotorFeedback feedback;
  Tick tick{.now = MonotonicTime{10s}, .dt_s = 0.001F};
};

TEST_F(ReducedMotionTest, AShaftThatSomethingHasSpunUpIsBrakedWithAllItsMotorHas) {
  step(true, false, 0.0F, 10);
  ASSERT_EQ(motion.effortShare(), 0.5F);
  step(true, false, -180.0F);
  step(true, true, -180.0F);
  EXPECT_EQ(motion.effortShare(), 1.0F);
  step(true, true, 10.0F);
  EXPECT_EQ(motion.effortShare(), 0.5F);
}

TEST_F(ReducedMotionTest, AShaftThatIsStillFastAfterTheTimeHasReducedEffort) {
  step(true, true, 180.0F, 990);
  EXPECT_EQ(motion.effortShare(), 1.0F);
  step(true, true, 180.0F, 20);
  EXPECT_EQ(motion.effortShare(), 0.5F);
}

TEST_F(ReducedMotionTest, AnActionThatOnlyResistsHasReducedEffortAfterTheTimeAndIsNeverTooFast) {
  EXPECT_EQ(step(true, Motion::kResisted, 180.0F, 990), 0);
  EXPECT_EQ(motion.effortShare(), 1.0F);
  EXPECT_EQ(step(true, Motion::kResisted, 180.0F, 2000), 0);
  EXPECT_EQ(motion.effortShare(), 0.5F);
}

TEST_F(ReducedMotionTest, ATargetAfterAResistanceThatLastedHasTheWholeTime) {
  step(true, Motion::kResisted, 180.0F, 3000);
  EXPECT_EQ(step(true, Motion::kLed, 180.0F, 990), 0);
  EXPECT_EQ(motion.effortShare(), 1.0F);
  EXPECT_NE(step(true, Motion::kLed, 180.0F, 20), 0);
}

TEST_F(ReducedMotionTest, AClientThatLapsesNowAndThenDoesNotBeginTheTimeAnew) {
  int too_fast_at_ms = 0;
  for (int at_ms = 0; at_ms < 1200 && too_fast_at_ms == 0; at_ms += 67) {
    const int found = step(true, Motion::kLed, 180.0F, 50);
    if (found > 0) too_fast_at_ms = at_ms + found;
    EXPECT_EQ(step(true, Motion::kResisted, 180.0F, 17), 0);
  }
  EXPECT_GE(too_fast_at_ms, 1000);
  EXPECT_EQ(motion.ceilingRpm(), 20.0);
}

TEST_F(ReducedMotionTest, ALapseHidesNoSampleOfADriveThatReportsSlowly) {
  step(true, Motion::kLed, 180.0F, 1000);
  int fast = 0;
  for (int at_ms = 0; at_ms < 400 && fast == 0; ++at_ms) {
    tick.now += 1ms;
    if (at_ms % 20 == 0) ++feedback.samples;
    if (motion.step(true, at_ms % 50 < 40 ? Motion::kLed : Motion::kResisted, feedback, tick)) fast = at_ms;
  }
  EXPECT_EQ(fast, 60) << "the third sample while it is led: at 0, 20, 60 ms";
}

TEST_F(ReducedMotionTest, ATargetAfterAShortLapseInWhichALoadSpunTheShaftUpHasTheWholeTime) {
  step(true, Motion::kLed, 15.0F, 2000);
  step(true, Motion::kResisted, 15.0F, 50);
  step(true, Motion::kResisted, 90.0F, 300);
  EXPECT_EQ(step(true, Motion::kLed, 90.0F, 990), 0);
  EXPECT_EQ(motion.effortShare(), 1.0F);
  EXPECT_NE(step(true, Motion::kLed, 90.0F, 20), 0);
}

TEST_F(ReducedMotionTest, AContactThatOpensAnewWhileItStillLiftsBrakesWithAllToo) {
  step(true, true, 0.0F, 10);
  step(false, true, 200.0F, 100);
  EXPECT_LT(motion.effortShare(), 0.6F);
  step(true, true, 200.0F);
  EXPECT_EQ(motion.effortShare(), 1.0F);
}

TEST_F(ReducedMotionTest, TheCeilingFallsFromTheMeasuredSpeedWithinHalfTheTime) {
  step(true, true, -180.0F);
  EXPECT_NEAR(motion.ceilingRpm(), 180.0 - 0.32, 1e-4);
  step(true, true, -180.0F, 249);
  EXPECT_NEAR(motion.ceilingRpm(), 100.0, 1e-3);
  step(true, true, -180.0F, 300);
  EXPECT_EQ(motion.ceilingRpm(), 20.0);
}

TEST_F(ReducedMotionTest, TheCeilingFallsAtTheRateOfTheMotorWhereItHasOne) {
  auto slow = config();
  slow.slew_rpm_per_s = 100.0F;
  motion = ReducedMotion{slow};
  step(true, true, 180.0F);
  EXPECT_NEAR(motion.ceilingRpm(), 179.9, 1e-4);
}

TEST_F(ReducedMotionTest, AShaftThatWasSpunUpBeyondItsLimitComesDownInTimeAllTheSame) {
  auto slow = config();
  slow.slew_rpm_per_s = 460.0F;
  motion = ReducedMotion{slow};
  step(true, true, -1020.0F);
  EXPECT_NEAR(motion.ceilingRpm(), 1020.0 - 2.0, 1e-3);
  slow.slew_rpm_per_s = 4000.0F;
  motion = ReducedMotion{slow};
  step(true, true, -1020.0F);
  EXPECT_NEAR(motion.ceilingRpm(), 1020.0 - 4.0, 1e-3) << "its own rate is quicker";
}

TEST_F(ReducedMotionTest, AShaftThatIsSlowHasTheReducedSpeedAtOnce) {
  for (const float rpm : {0.0F, 12.0F, 20.0F}) {
    motion = ReducedMotion{config()};
    step(true, true, rpm);
    EXPECT_EQ(motion.ceilingRpm(), 20.0);
    EXPECT_EQ(motion.effortShare(), 0.5F);
  }
}

TEST_F(ReducedMotionTest, ASpeedWithinTheToleranceIsNotBrakedWithAll) {
  step(true, true, 25.0F);
  EXPECT_EQ(motion.effortShare(), 0.5F);
  motion = ReducedMotion{config()};
  step(true, true, 25.1F);
  EXPECT_EQ(motion.effortShare(), 1.0F);
  step(true, true, 25.0F);
  EXPECT_EQ(motion.effortShare(), 0.5F) << "it is down";
  step(true, true, 30.0F);
  EXPECT_EQ(motion.effortShare(), 0.5F) << "and has no reason to be faster again";
}

TEST_F(ReducedMotionTest, TheThirdFastSampleAfterTheTimeIsTooFast) {
  EXPECT_EQ(step(true, true, 26.0F, 1000), 0);
  EXPECT_EQ(step(true, true, 26.0F, 10), kFastSamples);
}

TEST_F(ReducedMotionTest, AfterTheTimeEffortIsReducedToTheTick) {
  step(true, true, 180.0F, 1000);
  EXPECT_EQ(motion.effortShare(), 1.0F);
  step(true, true, 180.0F);
  EXPECT_EQ(motion.effortShare(), 0.5F);
}

TEST_F(ReducedMotionTest, ASpeedAtTheToleranceAndAFewSamplesAboveItAreNotTooFast) {
  EXPECT_EQ(step(true, true, 25.0F, 2000), 0);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(step(true, true, -26.0F, kFastSamples - 1), 0);
    EXPECT_EQ(step(true, true, 0.0F), 0);
  }
  EXPECT_EQ(step(true, true, -26.0F, kFastSamples), kFastSamples);
}

TEST_F(ReducedMotionTest, ASampleCountsOnce) {
  step(true, true, 10.0F, 1100);
  EXPECT_EQ(step(true, true, 30.0F, kFastSamples - 1), 0);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(motion.step(true, Motion::kLed, feedback, tick));
  step(true, false, 30.0F);
  step(true, true, 30.0F, 998);
  tick.now += 1s;
  for (int i = 0; i < 10; ++i)
    EXPECT_FALSE(motion.step(true, Motion::kLed, feedback, tick)) << "none came in the time";
}

TEST_F(ReducedMotionTest, AMotorThatBeginsToMoveHasItsTimeAnew) {
  EXPECT_EQ(step(true, false, 100.0F, 5000), 0) << "one that only turns is not driven";
  EXPECT_EQ(step(true, true, 100.0F, 1000), 0);
  EXPECT_EQ(step(true, true, 100.0F, 3), 3);
  EXPECT_EQ(step(false, true, 100.0F, 5000), 0);
  EXPECT_EQ(step(true, true, 100.0F, 1000), 0);
}

TEST_F(ReducedMotionTest, SpeedAndEffortComeBackWithinASecond) {
  step(true, true, 0.0F, 10);
  step(false, true, 0.0F);
  EXPECT_NEAR(motion.ceilingRpm(), 20.46, 1e-3);
  EXPECT_NEAR(motion.effortShare(), 0.5005F, 1e-5F);
  step(false, true, 0.0F, 997);
  EXPECT_TRUE(std::isfinite(motion.ceilingRpm()));
  EXPECT_LT(motion.effortShare(), 1.0F);
  step(false, true, 0.0F, 3);
  EXPECT_FALSE(std::isfinite(motion.ceilingRpm()));
  EXPECT_EQ(motion.effortShare(), 1.0F);
}

TEST_F(ReducedMotionTest, EffortAloneIsReducedAtOnceAndBoundsNoSpeed) {
  motion = ReducedMotion{{.effort_share = 0.5F, .within = 1s}};
  EXPECT_EQ(step(true, true, 500.0F, 3000), 0);
  EXPECT_EQ(motion.effortShare(), 0.5F);
  EXPECT_FALSE(std::isfinite(motion.ceilingRpm()));
  step(false, true, 500.0F, 500);
  EXPECT_NEAR(motion.effortShare(), 0.75F, 1e-3F);
  EXPECT_FALSE(std::isfinite(motion.ceilingRpm()));
}

TEST_F(ReducedMotionTest, SpeedAloneIsReducedWithAllTheEffort) {
  auto speed = config();
  speed.effort_share = 1.0F;
  motion = ReducedMotion{speed};
  EXPECT_EQ(step(true, true, 30.0F, 2000), 1003);
  EXPECT_EQ(motion.effortShare(), 1.0F);
  EXPECT_EQ(motion.ceilingRpm(), 20.0);
}

TEST_F(ReducedMotionTest, WithoutAnyReductionTheContactChangesNothing) {
  motion = ReducedMotion{{.full_rpm = 480.0F}};
  EXPECT_EQ(step(true, true, 500.0F, 3000), 0);
  EXPECT_EQ(motion.effortShare(), 1.0F);
  EXPECT_FALSE(std::isfinite(motion.ceilingRpm()));
}

}  // namespace
}  // namespace rc10::test::reduced_motion_test
