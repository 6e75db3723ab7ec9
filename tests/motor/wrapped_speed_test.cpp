#include "motor/wrapped_speed.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace rc10::test::wrapped_speed_test {
namespace {

using namespace std::chrono_literals;

constexpr double kVMax = 10.0;
constexpr double kFastest = 15.0;

/// A drive at 1 kHz whose field wraps at +-10 rad/s.
class WrappedSpeedTest : public ::testing::Test {
 protected:
  double sample(double rad_s, Duration later = 1ms, bool follows = true, Duration jitter = 0ms) {
    now_ += later;
    rad_ += rad_s * std::chrono::duration<double>(later).count();
    constexpr double kStep = 2.0 * kVMax / 4095.0;
    const auto code = static_cast<unsigned>(std::lround((rad_s + kVMax) / kStep)) & 0xFFFU;
    return speed_.take(static_cast<double>(code) * kStep - kVMax, rad_, follows, now_ + jitter);
  }

  WrappedSpeed speed_{kVMax, kFastest};
  MonotonicTime now_{1000s};
  double rad_ = 0.0;
};

TEST_F(WrappedSpeedTest, GoesOnOverTheEndOfItsFieldInBothDirections) {
  for (const double sign : {1.0, -1.0}) {
    speed_ = WrappedSpeed{kVMax, kFastest};
    for (double rad_s = 0.0; rad_s < 14.0; rad_s += 0.05)
      ASSERT_NEAR(sample(sign * rad_s), sign * rad_s, 0.01);
    for (double rad_s = 14.0; rad_s > -3.0; rad_s -= 0.05)
      ASSERT_NEAR(sample(sign * rad_s), sign * rad_s, 0.01);
  }
}

TEST_F(WrappedSpeedTest, FindsTheWrapOfAShaftThatIsTooFastAlready) {
  (void)sample(12.0, 1s);
  for (int i = 0; i < 25; ++i) (void)sample(12.0);
  EXPECT_NEAR(sample(12.0), 12.0, 0.01);
}

TEST_F(WrappedSpeedTest, StampsThatComeInBurstsDoNotCount) {
  (void)sample(0.0, 1s);
  for (int i = 0; i < 200; ++i)
    ASSERT_NEAR(sample(9.0, 1ms, true, i % 2 == 0 ? 0us : Duration{-900us}), 9.0, 0.01) << i;
}

TEST_F(WrappedSpeedTest, APositionThatCountsFromElsewhereIsNoSpeed) {
  for (int i = 0; i < 20; ++i) (void)sample(1.0);
  rad_ += 25.0;
  speed_.restart();
  for (int i = 0; i < 20; ++i) ASSERT_NEAR(sample(1.0), 1.0, 0.01);
}

TEST_F(WrappedSpeedTest, SlowFeedbackIsUnderstoodToo) {
  for (const auto gap : {5ms, 10ms, 20ms, 50ms}) {
    speed_ = WrappedSpeed{kVMax, kFastest};
    (void)sample(0.0, gap);
    for (double rad_s = 0.0; rad_s < 14.0; rad_s += 1.0) ASSERT_NEAR(sample(rad_s, gap), rad_s, 0.01);
    for (int i = 0; i < 10; ++i) ASSERT_NEAR(sample(12.0, gap), 12.0, 0.01);
  }
}

TEST_F(WrappedSpeedTest, AReversalBetweenTwoSamplesIsNoWrap) {
  for (const auto gap : {4ms, 10ms, 25ms}) {
    speed_ = WrappedSpeed{kVMax, kFastest};
    for (int i = 0; i < 10; ++i) (void)sample(9.0, gap);
    rad_ += 9.0 * std::chrono::duration<double>(gap).count();  // evenly, from 9 to -9
    ASSERT_NEAR(sample(-9.0, gap), -9.0, 0.01);
  }
}

TEST_F(WrappedSpeedTest, AFieldThatSaysMoreThanTheDriveReachesNeverWraps) {
  speed_ = WrappedSpeed{kVMax, kVMax};
  for (const double rad_s : {9.9, -9.9, 9.9}) ASSERT_NEAR(sample(rad_s), rad_s, 0.01);
}

TEST_F(WrappedSpeedTest, GoesOnOverSeveralWrapsOfANarrowField) {
  for (const double sign : {1.0, -1.0}) {
    speed_ = WrappedSpeed{kVMax, 5.0 * kVMax};
    for (double rad_s = 0.0; rad_s < 45.0; rad_s += 0.1)
      ASSERT_NEAR(sample(sign * rad_s), sign * rad_s, 0.03);
    for (double rad_s = 45.0; rad_s > -25.0; rad_s -= 0.1)
      ASSERT_NEAR(sample(sign * rad_s), sign * rad_s, 0.03);
  }
}

TEST_F(WrappedSpeedTest, AFieldThatIsCutOffStaysAsItIsTold) {
  for (double rad_s = 0.0; rad_s < 14.0; rad_s += 0.02) {
    now_ += 1ms;
    rad_ += rad_s * 1e-3;
    ASSERT_NEAR(speed_.take(std::min(rad_s, kVMax), rad_, true, now_), std::min(rad_s, kVMax), 1e-9);
  }
}

TEST_F(WrappedSpeedTest, AShortSlipOrAHardStopIsNoWrap) {
  for (int i = 0; i < 100; ++i) {
    if (i == 50) rad_ += 0.1;
    ASSERT_NEAR(sample(3.0), 3.0, 0.01) << i;
  }
  // From one end of the field to the other within a window.
  for (double rad_s = 3.0; rad_s < 9.9; rad_s += 1.0) ASSERT_NEAR(sample(rad_s), rad_s, 0.01);
  for (double rad_s = 9.9; rad_s > -9.9; rad_s -= 1.0) ASSERT_NEAR(sample(rad_s), rad_s, 0.01);
  for (int i = 0; i < 100; ++i) ASSERT_NEAR(sample(-9.9), -9.9, 0.01);
}

TEST_F(WrappedSpeedTest, ALeapOfThePositionIsNoSpeed) {
  for (int i = 0; i < 20; ++i) (void)sample(1.0);
  rad_ += 5.0;
  for (int i = 0; i < 20; ++i) ASSERT_NEAR(sample(1.0, 1ms, i != 0), 1.0, 0.01);
}

}  // namespace
}  // namespace rc10::test::wrapped_speed_test
