#include "motor/sample_spacing.hpp"

#include <initializer_list>
#include <random>

#include <gtest/gtest.h>

namespace rc10::test::sample_spacing_test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

TEST(SampleSpacing, IsZeroOnlyWhenNoSampleArrived) {
  SampleSpacing spacing(milliseconds{1});
  EXPECT_FLOAT_EQ(spacing.take(), 0.0F);
  spacing.add(milliseconds{1});
  EXPECT_FLOAT_EQ(spacing.take(), 0.001F);
  EXPECT_FLOAT_EQ(spacing.take(), 0.0F);
}

TEST(SampleSpacing, TwoSamplesInOneTickCountForBoth) {
  SampleSpacing spacing(milliseconds{1});
  spacing.add(milliseconds{1});
  spacing.add(milliseconds{1});
  EXPECT_NEAR(spacing.take(), 0.002F, 1e-6F);
}

TEST(SampleSpacing, LostFramesCountWithTheirTime) {
  SampleSpacing spacing(milliseconds{1});
  spacing.add(milliseconds{3});
  EXPECT_NEAR(spacing.take(), 0.003F, 1e-6F);
}

TEST(SampleSpacing, JitterOfTheStampsIsSmoothedAway) {
  SampleSpacing spacing(milliseconds{1});
  std::mt19937 random(3);
  int late_us = 0;
  for (int i = 0; i < 10'000; ++i) {
    const int next_us = static_cast<int>(random() % 400);
    spacing.add(microseconds{1000 + next_us - late_us});
    late_us = next_us;
    const float dt_s = spacing.take();
    ASSERT_GT(dt_s, 0.00094F);
    ASSERT_LT(dt_s, 0.00106F);
  }
}

TEST(SampleSpacing, FollowsADriveOnAnotherRate) {
  for (const int period_us : {700, 1400, 2000, 3300}) {
    SampleSpacing spacing(milliseconds{1});
    for (int i = 0; i < 300; ++i) {
      spacing.add(microseconds{period_us});
      (void)spacing.take();
    }
    spacing.add(microseconds{period_us});
    EXPECT_NEAR(spacing.take(), static_cast<float>(period_us) * 1e-6F, 1e-5F) << period_us;
  }
}

TEST(SampleSpacing, StaysBetweenATenthAndFivePeriods) {
  SampleSpacing spacing(milliseconds{1});
  for (const Duration strange :
       {Duration{-1'000'000'000}, Duration{0}, Duration{1}, Duration{3'600'000'000'000}}) {
    for (int i = 0; i < 300; ++i) {
      spacing.add(strange);
      const float dt_s = spacing.take();
      ASSERT_GE(dt_s, 0.000099F);
      ASSERT_LE(dt_s, 0.005001F);
    }
  }
}

}  // namespace
}  // namespace rc10::test::sample_spacing_test
