#include "motor/saturated_speed.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace rc10::test::saturated_speed_test {
namespace {

using namespace std::chrono_literals;

constexpr double kEnd = 10.0;

/// A drive at 1 kHz whose field is cut off at +-10 rad/s.
class SaturatedSpeedTest : public ::testing::Test {
 protected:
  double sample(double rad_s, bool follows = true, Duration jitter = 0ms) {
    now_ += 1ms;
    rad_ += rad_s * 1e-3;
    speed_.add(rad_, follows, now_ + jitter);
    return speed_.of(std::clamp(rad_s, -kEnd, kEnd));
  }

  SaturatedSpeed speed_{kEnd};
  MonotonicTime now_{1000s};
  double rad_ = 0.0;
};

TEST_F(SaturatedSpeedTest, WithinItsFieldASpeedIsThatWhichIsTold) {
  for (int i = 0; i < 100; ++i) ASSERT_EQ(sample(9.9), 9.9);
  rad_ += 1.0;
  ASSERT_EQ(sample(9.9), 9.9);
}

TEST_F(SaturatedSpeedTest, AtTheEndTheWaySaysHowFastItIs) {
  for (const double rad_s : {14.0, -25.0}) {
    for (int i = 0; i < 50; ++i) (void)sample(rad_s);
    EXPECT_NEAR(sample(rad_s), rad_s, 0.01);
  }
}

TEST_F(SaturatedSpeedTest, AWayThatIsShorterOrTheOtherOneIsNotBelieved) {
  for (const double way_rad_s : {5.0, -30.0}) {
    for (int i = 0; i < 50; ++i) (void)sample(way_rad_s);
    EXPECT_EQ(speed_.of(kEnd), kEnd);
  }
}

TEST_F(SaturatedSpeedTest, StampsThatComeInBurstsAreNoSpeed) {
  for (int i = 0; i < 200; ++i) {
    const double rad_s = sample(14.0, true, i % 2 == 0 ? 0us : Duration{-900us});
    if (i > 30) {
      ASSERT_NEAR(rad_s, 14.0, 1.5) << i;
    }
  }
}

TEST_F(SaturatedSpeedTest, ALeapOfThePositionIsNoWay) {
  for (int i = 0; i < 50; ++i) (void)sample(0.0);
  rad_ += 50.0;
  EXPECT_EQ((void(sample(0.0, false)), speed_.of(kEnd)), kEnd);
  for (int i = 0; i < 50; ++i) (void)sample(0.0);
  EXPECT_EQ(speed_.of(kEnd), kEnd);
}

}  // namespace
}  // namespace rc10::test::saturated_speed_test
