#include <cmath>
#include <initializer_list>
#include <limits>

#include <gtest/gtest.h>

#include "app/limits.hpp"
#include "app/low_pass.hpp"
#include "app/tracking_differentiator.hpp"

namespace rc10::test::filters_test {
namespace {

TEST(LowPass, LetsEverythingThroughWithoutABandwidth) {
  LowPass filter;
  EXPECT_FLOAT_EQ(filter.step(3.0F, 0.001F), 3.0F);
  EXPECT_FLOAT_EQ(filter.step(-7.0F, 0.001F), -7.0F);
}

TEST(LowPass, ReachesTwoThirdsOfAStepAfterItsTimeConstant) {
  LowPass filter(1.0F);  // time constant 1 / (2 pi) s
  float value = 0.0F;
  for (int i = 0; i < 159; ++i) value = filter.step(1.0F, 0.001F);
  EXPECT_NEAR(value, 0.632F, 0.005F);
}

TEST(LowPass, NeverOvershootsHoweverLargeTheStep) {
  LowPass filter(1000.0F);
  for (int i = 0; i < 10; ++i) {
    EXPECT_LE(filter.step(1.0F, 10.0F), 1.0F);
    EXPECT_GE(filter.value(), 0.0F);
  }
}

TEST(TrackingDifferentiator, FollowsAtOnceWithoutABandwidth) {
  TrackingDifferentiator tracker;
  EXPECT_FLOAT_EQ(tracker.step(12.0F, 0.001F), 12.0F);
}

TEST(TrackingDifferentiator, ArrivesWithoutOvershootAfterSixTimeConstants) {
  TrackingDifferentiator tracker(20.0F);
  float before = 0.0F;
  for (int i = 0; i < 290; ++i) {  // 5.8 / 20 s
    const float value = tracker.step(100.0F, 0.001F);
    EXPECT_GE(value, before);
    EXPECT_LE(value, 100.0F);
    before = value;
  }
  EXPECT_GT(before, 97.9F);
}

TEST(TrackingDifferentiator, ArrivesHoweverFarOut) {
  for (const float far : {1e6F, 1e8F, 3e9F, -1e12F}) {
    for (const float bandwidth : {0.5F, 20.0F}) {
      TrackingDifferentiator tracker(bandwidth);
      tracker.reset(far);
      const float target = far * 1.0001F;
      for (int i = 0; i < 100'000; ++i) (void)tracker.step(target, 0.001F);
      EXPECT_EQ(tracker.step(target, 0.001F), target);
    }
  }
}

TEST(TrackingDifferentiator, IsTheSameAtEveryRate) {
  for (const float dt_s : {0.0001F, 0.001F, 0.01F, 0.05F}) {
    TrackingDifferentiator tracker(10.0F);
    float value = 0.0F;
    const int steps = static_cast<int>(std::lround(0.2F / dt_s));
    for (int i = 0; i < steps; ++i) value = tracker.step(1.0F, dt_s);
    EXPECT_NEAR(value, 1.0F - 3.0F * std::exp(-2.0F), 1e-3F) << dt_s;  // r t = 2
  }
}

TEST(TrackingDifferentiator, StaysStableForAnyBandwidthAndStep) {
  for (const float bandwidth : {1.0F, 1e3F, 1e6F, 1e20F}) {
    TrackingDifferentiator tracker(bandwidth);
    for (int i = 0; i < 1000; ++i) {
      const float value = tracker.step(i % 2 == 0 ? 1.0F : -1.0F, 0.1F);
      ASSERT_TRUE(std::isfinite(value)) << bandwidth;
      ASSERT_LE(std::abs(value), 1.01F) << bandwidth;
    }
  }
}

TEST(OutputRange, IsTheNarrowerOfTwoLimits) {
  const OutputRange range = OutputRange::symmetric(10.0F).within(4.0F);
  EXPECT_FLOAT_EQ(range.low, -4.0F);
  EXPECT_FLOAT_EQ(range.high, 4.0F);
  EXPECT_FLOAT_EQ(OutputRange::symmetric(10.0F).within(0.0F).high, 10.0F);
}

TEST(OutputRange, AllowsNothingForALimitThatMakesNoSense) {
  EXPECT_FLOAT_EQ(OutputRange::symmetric(-1.0F).high, 0.0F);
  EXPECT_FLOAT_EQ(OutputRange::symmetric(std::numeric_limits<float>::quiet_NaN()).high, 0.0F);
}

}  // namespace
}  // namespace rc10::test::filters_test
