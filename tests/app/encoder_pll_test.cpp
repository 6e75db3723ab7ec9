#include "app/encoder_pll.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "app/angle.hpp"

namespace rc10::test::encoder_pll_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kDt = 0.001F;
constexpr auto kDtSeconds = static_cast<double>(kDt);
constexpr double kCountDeg = 360.0 / 8192.0;

double quantised(double angle_deg) { return kCountDeg * std::floor(angle_deg / kCountDeg); }

TEST(EncoderPll, KnowsASteadyVelocityFarBetterThanOneCountPerSample) {
  EncoderPll pll({.bandwidth_rad_s = 60.0});
  constexpr double kRpm = 7.3;  // slower than one count in a sample
  double worst = 0.0;
  double sum = 0.0;
  for (int i = 0; i < 4000; ++i) {
    (void)pll.step(quantised(kRpm * 6.0 * i * kDtSeconds), kDt);
    if (i < 1000) continue;
    worst = std::max(worst, std::abs(pll.state().velocity_rpm - kRpm));
    sum += pll.state().velocity_rpm;
  }
  EXPECT_LT(worst, 0.05 * kCountDeg / (6.0 * kDtSeconds));  // a difference is wrong by up to a whole count
  EXPECT_NEAR(sum / 3000.0, kRpm, 0.01);
  EXPECT_NEAR(pll.state().angle_deg, kRpm * 6.0 * 3.999, kCountDeg);
}

TEST(EncoderPll, LagsASteadyAccelerationByTwiceItOverTheBandwidth) {
  EncoderPll pll({.bandwidth_rad_s = 100.0});
  constexpr double kRpmPerS = 500.0;
  double t = 0.0;
  for (int i = 0; i < 2000; ++i) {
    t = i * kDtSeconds;
    (void)pll.step(3.0 * kRpmPerS * t * t, kDt);  // 6 a t^2 / 2
  }
  EXPECT_NEAR(pll.state().velocity_rpm, kRpmPerS * t - 2.0 * kRpmPerS / 100.0, 0.5);
}

TEST(EncoderPll, FollowsAVibrationLikeTwoLowPasses) {
  for (const double w_rad_s : {10.0, 60.0, 200.0}) {
    EncoderPll pll({.bandwidth_rad_s = 60.0});
    double largest = 0.0;
    for (int i = 0; i < 8000; ++i) {
      const double t = i * 1e-4;
      (void)pll.step(6.0 * std::sin(w_rad_s * t) / w_rad_s, 1e-4F);  // velocity: cos, 1 rpm
      if (i > 4000) largest = std::max(largest, std::abs(pll.state().velocity_rpm));
    }
    const double ratio = w_rad_s / 60.0;
    EXPECT_NEAR(largest, 1.0 / (1.0 + ratio * ratio), 0.01) << w_rad_s;
  }
}

TEST(EncoderPll, IsStableForAnyBandwidthAndAnyStep) {
  std::mt19937 random(5);
  for (const double bandwidth : {1.0, 1e3, 1e6, 1e300}) {
    EncoderPll pll({.bandwidth_rad_s = bandwidth});
    double angle_deg = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const float dt_s = 1e-4F * static_cast<float>(1 + random() % 1000);
      angle_deg += 600.0 * static_cast<double>(dt_s);  // 100 rpm
      (void)pll.step(angle_deg, dt_s);
    }
    EXPECT_NEAR(pll.state().velocity_rpm, 100.0, 1e-6) << bandwidth;
  }
}

TEST(EncoderPll, WithoutABandwidthIsTheDifferenceOfTheSamples) {
  for (const double none : {0.0, -1.0, kNan}) {
    EncoderPll pll({.bandwidth_rad_s = none});
    (void)pll.step(10.0, kDt);
    EXPECT_NEAR(pll.step(10.06, kDt).velocity_rpm, 10.0, 1e-5);
  }
}

TEST(EncoderPll, AnAngleWithinATurnHasNoSpikeAtTheWrap) {
  EncoderPll pll({.bandwidth_rad_s = 100.0, .circular_period_deg = 360.0});
  for (int i = 0; i < 5000; ++i) {
    (void)pll.step(wrapDegrees(100.0 - 0.6 * i), kDt);  // -100 rpm
    ASSERT_GE(pll.state().angle_deg, 0.0);
    ASSERT_LT(pll.state().angle_deg, 360.0);
    if (i > 200) {
      ASSERT_NEAR(pll.state().velocity_rpm, -100.0, 0.01);
    }
  }
}

TEST(EncoderPll, TheFirstSampleOnlySetsTheAngle) {
  EncoderPll pll({.bandwidth_rad_s = 100.0});
  EXPECT_EQ(pll.step(1e6, kDt).velocity_rpm, 0.0);
  EXPECT_EQ(pll.state().angle_deg, 1e6);
  pll.reset();
  EXPECT_EQ(pll.step(-5.0, kDt).velocity_rpm, 0.0);
}

TEST(EncoderPll, InputThatMakesNoSenseChangesNothing) {
  EncoderPll pll({.bandwidth_rad_s = 100.0});
  for (int i = 0; i < 100; ++i) (void)pll.step(0.6 * i, kDt);
  const double velocity_rpm = pll.state().velocity_rpm;
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_EQ(pll.step(bad, kDt).velocity_rpm, velocity_rpm);
  }
  for (const float dt_s : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_EQ(pll.step(1e3, dt_s).velocity_rpm, velocity_rpm);
  }
  for (int i = 0; i < 100; ++i) {
    (void)pll.step(i % 2 == 0 ? 1e308 : -1e308, i % 3 == 0 ? 1e-38F : 1e38F);
    ASSERT_TRUE(std::isfinite(pll.state().velocity_rpm));
    ASSERT_TRUE(std::isfinite(pll.state().angle_deg));
  }
}

}  // namespace
}  // namespace rc10::test::encoder_pll_test
