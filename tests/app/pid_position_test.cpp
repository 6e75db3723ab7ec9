#include "app/pid_position.hpp"

#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace rc10::test::pid_position_test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kDt = 0.001F;

TEST(PidPosition, ProportionalShareIsGainTimesError) {
  PID_Position pid({.kp = 2.0F});
  EXPECT_FLOAT_EQ(pid.step(10.0F, 4.0F, kDt), 12.0F);
}

TEST(PidPosition, IntegralGrowsPerSecondWhateverTheRate) {
  for (const float dt_s : {0.0005F, 0.001F, 0.01F}) {
    PID_Position pid({.ki = 3.0F});
    float output = 0.0F;
    for (int i = 0; i < static_cast<int>(std::lround(1.0F / dt_s)); ++i) output = pid.step(2.0F, 0.0F, dt_s);
    EXPECT_NEAR(output, 6.0F, 0.02F) << dt_s;
  }
}

TEST(PidPosition, IntegralIsActiveWithoutASeparationThreshold) {
  for (const float threshold : {0.0F, kInfinity}) {
    PID_Position pid({.ki = 1.0F, .integral_separation = threshold});
    for (int i = 0; i < 100; ++i) (void)pid.step(1000.0F, 0.0F, kDt);
    EXPECT_GT(pid.state().integral, 90.0F);
  }
}

TEST(PidPosition, IntegralStandsStillBeyondTheSeparationThreshold) {
  PID_Position pid({.ki = 1.0F, .integral_separation = 5.0F});
  for (int i = 0; i < 100; ++i) (void)pid.step(4.0F, 0.0F, kDt);
  const float integral = pid.state().integral;
  EXPECT_GT(integral, 0.3F);
  for (int i = 0; i < 100; ++i) (void)pid.step(50.0F, 0.0F, kDt);
  EXPECT_FLOAT_EQ(pid.state().integral, integral);
}

TEST(PidPosition, IntegralStaysWithinItsOwnLimit) {
  PID_Position pid({.ki = 100.0F, .integral_limit = 2.5F});
  for (int i = 0; i < 1000; ++i) (void)pid.step(-10.0F, 0.0F, kDt);
  EXPECT_FLOAT_EQ(pid.state().output, -2.5F);
}

TEST(PidPosition, AStepOfTheTargetCausesNoDerivativeKick) {
  PID_Position pid({.kd = 1.0F});
  (void)pid.step(0.0F, 5.0F, kDt);
  EXPECT_FLOAT_EQ(pid.step(1000.0F, 5.0F, kDt), 0.0F);
}

TEST(PidPosition, DerivativeOpposesTheMotionOfTheMeasurement) {
  PID_Position pid({.kd = 0.5F});
  (void)pid.step(0.0F, 5.0F, kDt);
  EXPECT_NEAR(pid.step(0.0F, 5.02F, kDt), -10.0F, 0.01F);  // 20 per second
}

TEST(PidPosition, DerivativeFilterSpreadsOneNoisySample) {
  PID_Position pid({.kd = 1.0F, .derivative_filter_hz = 20.0F});
  (void)pid.step(0.0F, 0.0F, kDt);
  const float first = pid.step(0.0F, 0.1F, kDt);
  EXPECT_GT(first, -20.0F);  // unfiltered: -100
  EXPECT_LT(first, 0.0F);
}

TEST(PidPosition, ErrorsInsideTheDeadbandCountAsZero) {
  PID_Position pid({.kp = 1.0F, .ki = 10.0F, .deadband = 2.0F});
  for (int i = 0; i < 100; ++i) EXPECT_FLOAT_EQ(pid.step(1.9F, 0.0F, kDt), 0.0F);
  EXPECT_GT(pid.step(2.1F, 0.0F, kDt), 2.0F);
}

TEST(PidPosition, CircularErrorTakesTheShortWayForAnyAngles) {
  const auto output = [](float target, float measured) {
    PID_Position pid({.kp = 1.0F, .circular_period = 360.0F});
    return pid.step(target, measured, kDt);
  };
  EXPECT_NEAR(output(10.0F, 350.0F), 20.0F, 1e-4F);
  EXPECT_NEAR(output(350.0F, 10.0F), -20.0F, 1e-4F);
  EXPECT_NEAR(output(-170.0F, 170.0F), 20.0F, 1e-4F);
  EXPECT_NEAR(output(725.0F, 0.0F), 5.0F, 1e-4F);
}

TEST(PidPosition, CircularDerivativeHasNoSpikeAtTheWrap) {
  PID_Position pid({.kd = 1.0F, .circular_period = 360.0F});
  (void)pid.step(0.0F, 359.9F, kDt);
  EXPECT_NEAR(pid.step(0.0F, 0.1F, kDt), -200.0F, 0.5F);  // 0.2 deg in 1 ms
}

TEST(PidPosition, OutputObeysTheNarrowerOfOwnLimitAndLimitInForce) {
  PID_Position pid({.kp = 100.0F, .output_limit = 8.0F});
  EXPECT_FLOAT_EQ(pid.step(10.0F, 0.0F, kDt), 8.0F);
  EXPECT_FLOAT_EQ(pid.step(10.0F, 0.0F, kDt, 3.0F), 3.0F);
  EXPECT_FLOAT_EQ(pid.step(-10.0F, 0.0F, kDt, 20.0F), -8.0F);
}

TEST(PidPosition, LeavesSaturationAtOnceWhenTheErrorReverses) {
  PID_Position pid({.kp = 1.0F, .ki = 50.0F});
  for (int i = 0; i < 5000; ++i) EXPECT_LE(pid.step(100.0F, 0.0F, kDt, 10.0F), 10.0F);
  EXPECT_LT(pid.step(-5.0F, 0.0F, kDt, 10.0F), 6.0F);
}

TEST(PidPosition, ForgetsWhatALoweredLimitNoLongerAllows) {
  PID_Position pid({.ki = 100.0F});
  for (int i = 0; i < 200; ++i) (void)pid.step(1.0F, 0.0F, kDt, 20.0F);
  EXPECT_FLOAT_EQ(pid.state().output, 20.0F);
  (void)pid.step(1.0F, 0.0F, kDt, 2.0F);
  // Back at the old limit, the output rises from 2 by integration, not at once.
  EXPECT_LT(pid.step(1.0F, 0.0F, kDt, 20.0F), 2.3F);
}

TEST(PidPosition, StartsFromTheOutputInForceAndThenActsOnTheFullError) {
  PID_Position pid({.kp = 1.0F, .ki = 1.0F});
  pid.start(7.0F, 20.0F, 120.0F);
  const float first = pid.step(120.0F, 20.0F, kDt);
  EXPECT_GT(first, 7.0F);
  EXPECT_LT(first, 7.0F + 10.0F);  // a tenth of the proportional share per millisecond
  for (int i = 0; i < 100; ++i) (void)pid.step(120.0F, 20.0F, kDt);
  EXPECT_GT(pid.state().output, 100.0F);
}

TEST(PidPosition, NothingIsLeftOfAStartAfterAThirdOfASecond) {
  PID_Position pid({.kp = 1.0F});
  pid.start(7.0F, 20.0F, 380.0F);
  for (int i = 0; i < 333; ++i) (void)pid.step(380.0F, 20.0F, kDt);
  EXPECT_EQ(pid.state().glide, 0.0F);
  EXPECT_EQ(pid.state().output_offset, 0.0F);
}

TEST(PidPosition, StartWithoutAnIntegralDoesNotKeepAnOffset) {
  PID_Position pid({.kp = 1.0F});
  pid.start(5.0F, 0.0F, 0.0F);
  EXPECT_NEAR(pid.step(0.0F, 0.0F, kDt), 4.5F, 0.1F);
  for (int i = 0; i < 200; ++i) (void)pid.step(0.0F, 0.0F, kDt);
  EXPECT_NEAR(pid.state().output, 0.0F, 1e-4F);
}

TEST(PidPosition, TimeThatDoesNotAdvanceKeepsTheLastOutput) {
  PID_Position pid({.kp = 1.0F, .ki = 10.0F, .kd = 1.0F});
  const float output = pid.step(10.0F, 0.0F, kDt);
  for (const float dt_s : {0.0F, -1.0F, kNan}) EXPECT_FLOAT_EQ(pid.step(500.0F, 3.0F, dt_s), output);
}

TEST(PidPosition, AHugeStepCountsAsTheLongestOne) {
  PID_Position pid({.ki = 1.0F});
  EXPECT_FLOAT_EQ(pid.step(1.0F, 0.0F, 1000.0F), kMaxStepSeconds);
}

TEST(PidPosition, InputThatIsNotFiniteGivesZeroAndForgetsEverything) {
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    PID_Position pid({.kp = 1.0F, .ki = 100.0F});
    for (int i = 0; i < 100; ++i) (void)pid.step(10.0F, 0.0F, kDt);
    EXPECT_FLOAT_EQ(pid.step(bad, 0.0F, kDt), 0.0F);
    EXPECT_FLOAT_EQ(pid.state().integral, 0.0F);
    EXPECT_FLOAT_EQ(pid.step(1.0F, bad, kDt), 0.0F);
    EXPECT_NEAR(pid.step(1.0F, 0.0F, kDt), 1.1F, 1e-4F);
  }
}

TEST(PidPosition, AnyFiniteInputGivesAFiniteOutput) {
  std::mt19937 random(7);
  const auto any = [&random] {
    return std::ldexp(static_cast<float>(random() % 2001) / 1000.0F - 1.0F,
                      static_cast<int>(random() % 256) - 128);
  };
  for (const float period : {0.0F, 360.0F}) {
    PID_Position pid(
        {.kp = 1e10F, .ki = 1e10F, .kd = 1e10F, .circular_period = period, .derivative_filter_hz = 30.0F});
    for (int i = 0; i < 100'000; ++i) ASSERT_TRUE(std::isfinite(pid.step(any(), any(), any())));
  }
}

/// A controller with an integral of 4, at an error of 2 that stands.
PID_Position tuned(const PID_Position::Config& config) {
  PID_Position pid(config);
  pid.start(4.0F, 0.0F, 0.0F);
  for (int i = 0; i < 500; ++i) (void)pid.step(0.0F, 0.0F, kDt);
  (void)pid.step(2.0F, 0.0F, kDt);
  return pid;
}

TEST(PidPosition, AnotherIntegralGainDoesNotStepTheOutput) {
  PID_Position pid = tuned({.kp = 1.0F, .ki = 0.5F});
  const float before = pid.state().output;
  pid.retune({.kp = 1.0F, .ki = 50.0F});
  EXPECT_NEAR(pid.step(2.0F, 0.0F, kDt), before, 50.0F * 2.0F * kDt * 1.01F)
      << "what the new gain adds in one step";
}

TEST(PidPosition, AnotherProportionalGainActsWithoutABumpAndThenFully) {
  PID_Position pid = tuned({.kp = 1.0F, .ki = 1e-6F});
  const float before = pid.state().output;
  pid.retune({.kp = 5.0F, .ki = 1e-6F});
  EXPECT_NEAR(pid.step(2.0F, 0.0F, kDt), before, 0.1F * 8.0F);
  for (int i = 0; i < 200; ++i) (void)pid.step(2.0F, 0.0F, kDt);
  EXPECT_NEAR(pid.state().output, 4.0F + 10.0F, 1e-2F);
}

TEST(PidPosition, WithoutAnIntegralGainTheIntegralGoesToo) {
  PID_Position pid = tuned({.kp = 1.0F, .ki = 0.5F});
  const float before = pid.state().output;
  pid.retune({.kp = 1.0F});
  EXPECT_NEAR(pid.step(2.0F, 0.0F, kDt), before, 0.1F * 4.0F + 0.01F) << "not at once";
  for (int i = 0; i < 200; ++i) (void)pid.step(2.0F, 0.0F, kDt);
  EXPECT_NEAR(pid.state().output, 2.0F, 1e-2F);
}

TEST(PidPosition, ANarrowerLimitActsAtOnceAndOneOfTheIntegralWithoutABump) {
  PID_Position limited = tuned({.kp = 1.0F, .ki = 0.5F});
  limited.retune({.kp = 1.0F, .ki = 0.5F, .output_limit = 3.0F});
  EXPECT_FLOAT_EQ(limited.step(2.0F, 0.0F, kDt), 3.0F);
  PID_Position pid = tuned({.kp = 1.0F, .ki = 1e-6F});
  const float before = pid.state().output;
  pid.retune({.kp = 1.0F, .ki = 1e-6F, .integral_limit = 1.0F});
  EXPECT_FLOAT_EQ(pid.state().integral, 1.0F);
  EXPECT_NEAR(pid.step(2.0F, 0.0F, kDt), before, 0.1F * 3.0F);
  for (int i = 0; i < 200; ++i) (void)pid.step(2.0F, 0.0F, kDt);
  EXPECT_NEAR(pid.state().output, 3.0F, 1e-2F);
}

TEST(PidPosition, AnotherDeadbandOrDerivativeDoesNotStepTheOutput) {
  PID_Position pid = tuned({.kp = 1.0F, .ki = 1e-6F});
  const float before = pid.state().output;
  pid.retune({.kp = 1.0F, .ki = 1e-6F, .deadband = 3.0F});
  EXPECT_NEAR(pid.step(2.0F, 0.0F, kDt), before, 0.1F * 2.0F);
  for (int i = 0; i < 200; ++i) (void)pid.step(2.0F, 0.0F, kDt);
  EXPECT_NEAR(pid.state().output, 4.0F, 1e-2F);
  PID_Position moving({.ki = 1e-6F});
  for (int i = 0; i < 100; ++i) (void)moving.step(0.0F, static_cast<float>(i) * 0.01F, kDt);
  moving.retune({.ki = 1e-6F, .kd = 1.0F});
  EXPECT_NEAR(moving.step(0.0F, 1.0F, kDt), 0.0F, 0.1F * 10.0F) << "10 / s";
}

TEST(PidPosition, LessGainAtTheLimitLetsGoOfItAsSoonAsTheErrorAllows) {
  PID_Position pid({.kp = 400.0F, .output_limit = 5.0F});
  EXPECT_FLOAT_EQ(pid.step(2.0F, 0.0F, kDt), 5.0F);
  pid.retune({.kp = 0.4F, .output_limit = 5.0F});
  EXPECT_NEAR(pid.step(2.0F, 0.0F, kDt), 5.0F, 0.1F * 5.0F) << "no bump";
  for (int i = 0; i < 30; ++i) (void)pid.step(2.0F, 0.0F, kDt);
  EXPECT_NEAR(pid.state().output, 0.8F, 0.3F);
  for (int i = 0; i < 5; ++i) (void)pid.step(-2.0F, 0.0F, kDt);
  EXPECT_LT(pid.state().output, 0.0F) << "the other way at once";
}

TEST(PidPosition, MoreGainAtTheLimitStaysThere) {
  PID_Position pid({.kp = 4.0F, .output_limit = 5.0F});
  (void)pid.step(2.0F, 0.0F, kDt);
  pid.retune({.kp = 40.0F, .output_limit = 5.0F});
  EXPECT_FLOAT_EQ(pid.step(2.0F, 0.0F, kDt), 5.0F);
  EXPECT_FLOAT_EQ(pid.step(-2.0F, 0.0F, kDt), -5.0F) << "nothing is carried over";
}

TEST(PidPosition, OtherGainsBeforeTheFirstStepAreThoseOfTheConfiguration) {
  PID_Position pid({.kp = 1.0F});
  pid.retune({.kp = 3.0F});
  EXPECT_FLOAT_EQ(pid.step(2.0F, 0.0F, kDt), 6.0F);
}

}  // namespace
}  // namespace rc10::test::pid_position_test
