#include "motor/guarding/reduced_motion.hpp"

#include <gtest/gtest.h>

namespace rc10::test::reduced_motion_test {
namespace {

using namespace std::chrono_literals;

class ReducedMotionTest : public ::testing::Test {
 protected:
  void step(bool reduced, bool moves, float velocity_rpm, int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      feedback.velocity_rpm = velocity_rpm;
      ++feedback.samples;
      tick.now += 1ms;
      (void)motion.step(reduced, moves, feedback, tick);
    }
  }

  ReducedMotion motion{
      {.velocity_rpm = 20.0F, .effort_share = 0.5F, .within = 1s, .tolerance_rpm = 5.0F, .full_rpm = 480.0F}};
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

TEST_F(ReducedMotionTest, AContactThatOpensAnewWhileItStillLiftsBrakesWithAllToo) {
  step(true, true, 0.0F, 10);
  step(false, true, 200.0F, 100);
  EXPECT_LT(motion.effortShare(), 0.6F);
  step(true, true, 200.0F);
  EXPECT_EQ(motion.effortShare(), 1.0F);
}

}  // namespace
}  // namespace rc10::test::reduced_motion_test
