#include "drives/damiao/damiao_speed.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace rc10::test::damiao_speed_test {
namespace {

using namespace std::chrono_literals;

constexpr double kVMax = 10.0;
constexpr double kFastest = 15.0;

/// A drive at 1 kHz whose field wraps at +-10 rad/s.
class DamiaoSpeedTest : public ::testing::Test {
 protected:
  double sample(double rad_s, Duration later = 1ms, bool follows = true, Duration jitter = 0ms) {
    now_ += later;
    rad_ += rad_s * std::chrono::duration<double>(later).count();
    constexpr double kStep = 2.0 * kVMax / 4095.0;
    const auto code = static_cast<unsigned>(std::lround((rad_s + kVMax) / kStep)) & 0xFFFU;
    return speed_.take(static_cast<double>(code) * kStep - kVMax, rad_, follows, now_ + jitter);
  }

  DamiaoSpeed speed_{kVMax, kFastest};
  MonotonicTime now_{1000s};
  double rad_ = 0.0;
};

TEST_F(DamiaoSpeedTest, GoesOnOverTheEndOfItsFieldInBothDirections) {
  for (const double sign : {1.0, -1.0}) {
    speed_ = DamiaoSpeed{kVMax, kFastest};
    for (double rad_s = 0.0; rad_s < 14.0; rad_s += 0.05)
      ASSERT_NEAR(sample(sign * rad_s), sign * rad_s, 0.01);
    for (double rad_s = 14.0; rad_s > -3.0; rad_s -= 0.05)
      ASSERT_NEAR(sample(sign * rad_s), sign * rad_s, 0.01);
  }
}

TEST_F(DamiaoSpeedTest, FindsTheWrapOfAShaftThatIsTooFastAlready) {
  (void)sample(12.0, 1s);
  for (int i = 0; i < 25; ++i) (void)sample(12.0);
  EXPECT_NEAR(sample(12.0), 12.0, 0.01);
}

TEST_F(DamiaoSpeedTest, StampsThatComeInBurstsDoNotCount) {
  (void)sample(0.0, 1s);
  for (int i = 0; i < 200; ++i)
    ASSERT_NEAR(sample(9.0, 1ms, true, i % 2 == 0 ? 0us : Duration{-900us}), 9.0, 0.01) << i;
}

TEST_F(DamiaoSpeedTest, APositionThatCountsFromElsewhereIsNoSpeed) {
  for (int i = 0; i < 20; ++i) (void)sample(1.0);
  rad_ += 25.0;
  speed_.restart();
  for (int i = 0; i < 20; ++i) ASSERT_NEAR(sample(1.0), 1.0, 0.01);
}

TEST_F(DamiaoSpeedTest, SlowFeedbackIsUnderstoodToo) {
  for (const auto gap : {5ms, 10ms, 20ms, 50ms}) {
    speed_ = DamiaoSpeed{kVMax, kFastest};
    (void)sample(0.0, gap);
    for (double rad_s = 0.0; rad_s < 14.0; rad_s += 1.0) ASSERT_NEAR(sample(rad_s, gap), rad_s, 0.01);
    for (int i = 0; i < 10; ++i) ASSERT_NEAR(sample(12.0, gap), 12.0, 0.01);
  }
}

TEST_F(DamiaoSpeedTest, AReversalBetweenTwoSamplesIsNoWrap) {
  for (const auto gap : {4ms, 10ms, 25ms}) {
    speed_ = DamiaoSpeed{kVMax, kFastest};
    for (int i = 0; i < 10; ++i) (void)sample(9.0, gap);
    rad_ += 9.0 * std::chrono::duration<double>(gap).count();  // evenly, from 9 to -9
    ASSERT_NEAR(sample(-9.0, gap), -9.0, 0.01);
  }
}

TEST_F(DamiaoSpeedTest, AFieldThatSaysMoreThanTheDriveReachesNeverWraps) {
  speed_ = DamiaoSpeed{kVMax, kVMax};
  for (const double rad_s : {9.9, -9.9, 9.9}) ASSERT_NEAR(sample(rad_s), rad_s, 0.01);
}

TEST_F(DamiaoSpeedTest, AShortSlipOrAHardStopIsNoWrap) {
  for (int i = 0; i < 100; ++i) {
    if (i == 50) rad_ += 0.1;
    ASSERT_NEAR(sample(3.0), 3.0, 0.01) << i;
  }
  // From one end of the field to the other within a window.
  for (double rad_s = 3.0; rad_s < 9.9; rad_s += 1.0) ASSERT_NEAR(sample(rad_s), rad_s, 0.01);
  for (double rad_s = 9.9; rad_s > -9.9; rad_s -= 1.0) ASSERT_NEAR(sample(rad_s), rad_s, 0.01);
  for (int i = 0; i < 100; ++i) ASSERT_NEAR(sample(-9.9), -9.9, 0.01);
}

TEST_F(DamiaoSpeedTest, ALeapOfThePositionIsNoSpeed) {
  for (int i = 0; i < 20; ++i) (void)sample(1.0);
  rad_ += 5.0;
  for (int i = 0; i < 20; ++i) ASSERT_NEAR(sample(1.0, 1ms, i != 0), 1.0, 0.01);
}

}  // namespace
}  // namespace rc10::test::damiao_speed_test
