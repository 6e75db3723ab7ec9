#include "client/motion/step_response.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace rc10::client::test::step_response_test {
namespace {

/// A response to the step at time 0, sampled each millisecond.
StepResponse judged(const std::function<double(double)>& response, double start, double target,
                    double length_s) {
  std::vector<double> times;
  std::vector<double> values;
  for (double t = -0.2; t < length_s; t += 1e-3) {
    times.push_back(t);
    values.push_back(t < 0.0 ? start : response(t));
  }
  return judgeStep(times, values, start, target);
}

TEST(StepResponse, AFirstOrderSystemHasTheNumbersOfItsTimeConstant) {
  const double tau_s = 0.1;
  const auto step =
      judged([&](double t) { return 20.0 + 60.0 * (1.0 - std::exp(-t / tau_s)); }, 20.0, 80.0, 2.0);
  EXPECT_NEAR(step.rise_s, tau_s * std::log(9.0), 1e-4);
  EXPECT_NEAR(step.settling_s, tau_s * std::log(50.0), 1e-4);
  EXPECT_EQ(step.overshoot_percent, 0.0);
  EXPECT_NEAR(step.steady_error, 0.0, 1e-4);
}

TEST(StepResponse, ASecondOrderSystemOvershootsAsItsDampingSays) {
  const double damping = 0.5;
  const double omega = 20.0;
  const double damped = omega * std::sqrt(1.0 - damping * damping);
  const auto response = [&](double t) {
    return -60.0 * (1.0 - std::exp(-damping * omega * t) *
                              (std::cos(damped * t) + damping * omega / damped * std::sin(damped * t)));
  };
  const auto step = judged(response, 0.0, -60.0, 2.0);
  EXPECT_NEAR(step.overshoot_percent, 100.0 * std::exp(-std::numbers::pi * damping / std::sqrt(0.75)), 0.05);
  EXPECT_NEAR(step.peak_s, std::numbers::pi / damped, 1e-3);
  EXPECT_NEAR(step.peak, -60.0 * 1.16303, 0.05);
  EXPECT_NEAR(step.rise_s * omega, 1.639, 0.02);  // Franklin, Powell: 1.64 for a damping of 0.5
}

TEST(StepResponse, ADelayMovesTheSettlingAndNotTheRise) {
  const auto late =
      judged([](double t) { return t < 0.05 ? 0.0 : 1.0 - std::exp(-(t - 0.05) / 0.1); }, 0.0, 1.0, 2.0);
  EXPECT_NEAR(late.rise_s, 0.1 * std::log(9.0), 1e-3);
  EXPECT_NEAR(late.settling_s, 0.05 + 0.1 * std::log(50.0), 1e-3);
}

TEST(StepResponse, WhatStopsShortHasAnErrorAndNeverSettles) {
  const auto step = judged([](double t) { return 50.0 * (1.0 - std::exp(-t / 0.05)); }, 0.0, 60.0, 1.0);
  EXPECT_TRUE(std::isnan(step.settling_s));
  EXPECT_TRUE(std::isnan(step.rise_s));
  EXPECT_NEAR(step.steady_error, 10.0, 0.01);
}

TEST(StepResponse, ToPassThroughTheBandAtTheEndIsNotToSettle) {
  EXPECT_TRUE(std::isnan(judged([](double t) { return t; }, 0.0, 1.0, 1.005).settling_s));
}

TEST(StepResponse, WithoutAStepThereAreNoNumbers) {
  EXPECT_TRUE(std::isnan(judged([](double) { return 1.0; }, 1.0, 1.0, 1.0).overshoot_percent));
  EXPECT_TRUE(std::isnan(judgeStep({}, {}, 0.0, 1.0).overshoot_percent));
}

TEST(FollowingError, HasTheRootMeanSquareAndTheLargestMagnitude) {
  const std::vector<double> target{0.0, 3.0, 0.0, 5.0};
  const std::vector<double> response{0.0, 0.0, 4.0, std::numeric_limits<double>::quiet_NaN()};
  const auto error = followingError(target, response);
  EXPECT_DOUBLE_EQ(error.rms, std::sqrt(25.0 / 3.0));
  EXPECT_EQ(error.max, 4.0);
  EXPECT_TRUE(std::isnan(followingError({}, {}).rms));
}

}  // namespace
}  // namespace rc10::client::test::step_response_test
