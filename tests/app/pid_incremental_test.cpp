#include "app/pid_incremental.hpp"

#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace rc10::test::pid_incremental_test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kDt = 0.001F;

/// A controller that has been running at zero error, as after start().
PID_Incremental running(const PID_Incremental::Config& config) {
  PID_Incremental pid(config);
  pid.start(0.0F, 0.0F, 0.0F);
  (void)pid.step(0.0F, 0.0F, kDt);
  return pid;
}

TEST(PidIncremental, AChangeOfTheErrorMovesTheOutputByGainTimesChange) {
  PID_Incremental pid = running({.kp = 2.0F});
  EXPECT_FLOAT_EQ(pid.step(10.0F, 0.0F, kDt), 20.0F);
  EXPECT_FLOAT_EQ(pid.step(10.0F, 4.0F, kDt), 12.0F);
}

TEST(PidIncremental, IntegratesPerSecondWhateverTheRate) {
  for (const float dt_s : {0.0005F, 0.001F, 0.01F}) {
    PID_Incremental pid({.ki = 3.0F});
    pid.start(0.0F, 0.0F, 0.0F);
    for (int i = 0; i < static_cast<int>(std::lround(1.0F / dt_s)); ++i) (void)pid.step(2.0F, 0.0F, dt_s);
    EXPECT_NEAR(pid.state().output, 6.0F, 0.02F) << dt_s;
  }
}

TEST(PidIncremental, DerivativeActsOnTheChangeOfTheMeasuredRate) {
  PID_Incremental pid = running({.kd = 0.1F});
  EXPECT_NEAR(pid.step(0.0F, 0.01F, kDt), -1.0F, 1e-3F);    // rate 0 -> 10 per second
  EXPECT_NEAR(pid.step(0.0F, 0.02F, kDt), -1.0F, 1e-3F);    // rate unchanged
  EXPECT_NEAR(pid.step(500.0F, 0.03F, kDt), -1.0F, 1e-3F);  // the target causes no kick
}

TEST(PidIncremental, ErrorsInsideTheDeadbandDoNotMoveTheOutput) {
  PID_Incremental pid = running({.kp = 1.0F, .ki = 10.0F, .deadband = 5.0F});
  for (int i = 0; i < 100; ++i) EXPECT_FLOAT_EQ(pid.step(4.9F, 0.0F, kDt), 0.0F);
}

TEST(PidIncremental, LeavesSaturationAtOnceWhenTheErrorFalls) {
  PID_Incremental pid = running({.kp = 1.0F, .ki = 50.0F});
  for (int i = 0; i < 5000; ++i) EXPECT_LE(pid.step(100.0F, 0.0F, kDt, 10.0F), 10.0F);
  EXPECT_LT(pid.step(99.0F, 5.0F, kDt, 10.0F), 9.0F);
}

TEST(PidIncremental, ForgetsWhatALoweredLimitNoLongerAllows) {
  PID_Incremental pid = running({.ki = 100.0F});
  for (int i = 0; i < 300; ++i) (void)pid.step(1.0F, 0.0F, kDt, 20.0F);
  EXPECT_FLOAT_EQ(pid.state().output, 20.0F);
  EXPECT_FLOAT_EQ(pid.step(1.0F, 0.0F, kDt, 2.0F), 2.0F);
  EXPECT_LT(pid.step(1.0F, 0.0F, kDt, 20.0F), 2.2F);
}

TEST(PidIncremental, OutputObeysItsOwnLimit) {
  PID_Incremental pid = running({.kp = 10.0F, .output_limit = 4.0F});
  EXPECT_FLOAT_EQ(pid.step(10.0F, 0.0F, kDt), 4.0F);
}

TEST(PidIncremental, StartsFromTheOutputInForceWithoutABump) {
  PID_Incremental pid({.kp = 1.0F, .ki = 1.0F});
  pid.start(7.0F, 20.0F, 120.0F);
  const float first = pid.step(120.0F, 20.0F, kDt);
  EXPECT_GT(first, 7.0F);
  EXPECT_LT(first, 17.0F);  // a tenth of the proportional share per millisecond
  for (int i = 0; i < 100; ++i) (void)pid.step(120.0F, 20.0F, kDt);
  EXPECT_NEAR(pid.state().output, 7.0F + 100.0F, 15.0F);
}

TEST(PidIncremental, WithoutStartTheFirstStepBeginsAtZero) {
  PID_Incremental pid({.kp = 1.0F});
  EXPECT_LT(pid.step(100.0F, 0.0F, kDt), 10.0F);
  for (int i = 0; i < 100; ++i) (void)pid.step(100.0F, 0.0F, kDt);
  EXPECT_NEAR(pid.state().output, 100.0F, 0.1F);
}

TEST(PidIncremental, TheTrackingDifferentiatorBringsTheTargetSmoothly) {
  PID_Incremental pid({.kp = 1.0F, .tracking_rad_s = 50.0F});
  pid.start(0.0F, 0.0F, 100.0F);
  float before = 0.0F;
  for (int i = 0; i < 120; ++i) {
    const float output = pid.step(100.0F, 0.0F, kDt);
    EXPECT_GE(output, before);
    EXPECT_LT(output - before, 2.5F);  // slope of the tracker: bandwidth / e * step
    before = output;
  }
  EXPECT_GT(before, 97.0F);
}

TEST(PidIncremental, TheTrackingDifferentiatorIsStableForAnyStep) {
  for (const float dt_s : {1e-6F, 0.001F, 0.05F, 10.0F}) {
    PID_Incremental pid({.kp = 1.0F, .tracking_rad_s = 1000.0F});
    pid.start(0.0F, 0.0F, 0.0F);
    for (int i = 0; i < 1000; ++i) ASSERT_LE(std::abs(pid.step(1.0F, 0.0F, dt_s)), 1.01F) << dt_s;
  }
}

TEST(PidIncremental, TimeThatDoesNotAdvanceKeepsTheLastOutput) {
  PID_Incremental pid = running({.kp = 1.0F, .ki = 10.0F, .kd = 1.0F});
  const float output = pid.step(10.0F, 0.0F, kDt);
  for (const float dt_s : {0.0F, -1.0F, kNan}) EXPECT_FLOAT_EQ(pid.step(500.0F, 3.0F, dt_s), output);
}

TEST(PidIncremental, AHugeStepCountsAsTheLongestOne) {
  PID_Incremental pid = running({.ki = 1.0F});
  EXPECT_NEAR(pid.step(1.0F, 0.0F, 1000.0F), kMaxStepSeconds, 1e-5F);
}

TEST(PidIncremental, InputThatIsNotFiniteGivesZeroAndForgetsEverything) {
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    PID_Incremental pid = running({.kp = 1.0F, .ki = 100.0F});
    for (int i = 0; i < 100; ++i) (void)pid.step(10.0F, 0.0F, kDt);
    EXPECT_FLOAT_EQ(pid.step(bad, 0.0F, kDt), 0.0F);
    EXPECT_FLOAT_EQ(pid.state().output, 0.0F);
    EXPECT_FLOAT_EQ(pid.step(1.0F, bad, kDt), 0.0F);
    EXPECT_LT(pid.step(1.0F, 0.0F, kDt), 0.3F);
  }
}

TEST(PidIncremental, AnyFiniteInputGivesAFiniteOutput) {
  std::mt19937 random(7);
  const auto any = [&random] {
    return std::ldexp(static_cast<float>(random() % 2001) / 1000.0F - 1.0F,
                      static_cast<int>(random() % 256) - 128);
  };
  for (const float tracking : {0.0F, 100.0F}) {
    PID_Incremental pid({.kp = 1e10F, .ki = 1e10F, .kd = 1e10F, .tracking_rad_s = tracking});
    for (int i = 0; i < 100'000; ++i) ASSERT_TRUE(std::isfinite(pid.step(any(), any(), any())));
  }
}

TEST(PidIncremental, OtherGainsDoNotStepTheOutput) {
  PID_Incremental pid = running({.kp = 2.0F, .ki = 1.0F});
  for (int i = 0; i < 100; ++i) (void)pid.step(10.0F, 0.0F, kDt);
  const float before = pid.state().output;
  pid.retune({.kp = 20.0F, .ki = 50.0F, .kd = 1.0F, .derivative_filter_hz = 20.0F});
  EXPECT_NEAR(pid.step(10.0F, 0.0F, kDt), before + 50.0F * 10.0F * kDt, 1e-3F);
  EXPECT_NEAR(pid.step(9.0F, 0.0F, kDt), before + 0.5F + 0.45F - 20.0F, 1e-2F) << "and act on what changes";
}

TEST(PidIncremental, AnotherDeadbandDoesNotStepTheOutput) {
  PID_Incremental pid = running({.kp = 2.0F});
  const float before = pid.step(3.0F, 0.0F, kDt);
  pid.retune({.kp = 2.0F, .deadband = 5.0F});
  EXPECT_FLOAT_EQ(pid.step(3.0F, 0.0F, kDt), before);
  pid.retune({.kp = 2.0F});
  EXPECT_FLOAT_EQ(pid.step(3.0F, 0.0F, kDt), before);
}

TEST(PidIncremental, TheTrackingDifferentiatorComesAndGoesWithoutABump) {
  PID_Incremental pid = running({.kp = 2.0F});
  const float before = pid.step(10.0F, 0.0F, kDt);
  pid.retune({.kp = 2.0F, .tracking_rad_s = 20.0F});
  EXPECT_NEAR(pid.step(10.0F, 0.0F, kDt), before, 1e-4F);
  const float on_its_way = pid.step(110.0F, 0.0F, kDt);
  pid.retune({.kp = 2.0F});
  EXPECT_NEAR(pid.step(110.0F, 0.0F, kDt), on_its_way, 0.1F * 200.0F);
  for (int i = 0; i < 200; ++i) (void)pid.step(110.0F, 0.0F, kDt);
  EXPECT_NEAR(pid.state().output, 220.0F, 0.1F);
}

/// Mean output at a limit of 10 while a large error stays and the measurement is noisy by `noise` each way.
float meanAtLimit(PID_Incremental::Config config, float error, float noise) {
  PID_Incremental pid(config);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  double sum = 0.0;
  constexpr int kSteps = 5000;
  for (int i = 0; i < 2 * kSteps; ++i) {
    const float output = pid.step(error, noise * unit(random), kDt, 10.0F);
    if (i >= kSteps) sum += static_cast<double>(output);
  }
  return static_cast<float>(sum / kSteps);
}

TEST(PidIncremental, NoiseTakesNothingFromTheEffortAtTheLimit) {
  const PID_Incremental::Config gains{.kp = 0.05F, .ki = 0.3F};
  const PID_Incremental::Config damped{.kp = 0.05F, .ki = 0.3F, .kd = 2e-5F, .derivative_filter_hz = 100.0F};
  for (const float noise : {1.0F, 5.0F, 15.0F}) {
    EXPECT_GT(meanAtLimit(gains, 300.0F, noise), 9.99F) << noise;
    EXPECT_LT(meanAtLimit(gains, -300.0F, noise), -9.99F) << noise;
    EXPECT_GT(meanAtLimit(damped, 300.0F, noise), 9.99F) << noise;
  }
}

TEST(PidIncremental, ALeapOfTheMeasurementHardlyWindsItUp) {
  PID_Incremental pid({.kp = 1.0F});
  for (int i = 0; i < 5000; ++i) (void)pid.step(100.0F, 0.0F, kDt, 10.0F);
  (void)pid.step(100.0F, -1000.0F, kDt, 10.0F);
  EXPECT_NEAR(pid.step(100.0F, -990.0F, kDt, 10.0F), 2.0F, 0.01F) << "by a fifth of the limit at most";
}

}  // namespace
}  // namespace rc10::test::pid_incremental_test
