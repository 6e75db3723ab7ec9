#include "client/motion/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>

namespace rc10::client::test::excitation_test {
namespace {

using testing::HasSubstr;
using Kind = ExcitationKind;
constexpr double kLeadS = Excitation::kLeadS;

Excitation made(const ExcitationSettings& settings) {
  const auto excitation = Excitation::of(settings);
  EXPECT_TRUE(excitation) << excitation.error().message;
  return *excitation;
}

std::string refusal(const ExcitationSettings& settings) {
  const auto excitation = Excitation::of(settings);
  return excitation ? "" : excitation.error().message;
}

/// Largest magnitude beside the base, between the samples of a client too.
double peakOf(const Excitation& excitation) {
  double peak = 0.0;
  for (double t = kLeadS; t < excitation.timeS(); t += 1e-4)
    peak = std::max(peak, std::abs(excitation.valueAt(t, 0.0) - excitation.settings().base));
  return peak;
}

TEST(Excitation, EachKindHasItsWord) {
  for (const auto kind : {Kind::kStep, Kind::kRamp, Kind::kSweep, Kind::kMultisine})
    EXPECT_EQ(excitationOf(toString(kind)), kind);
  EXPECT_FALSE(excitationOf("chirp"));
}

TEST(Excitation, AStepStandsAtItsBaseAndThenAtItsHeight) {
  const auto step = made({.kind = Kind::kStep, .base = 10.0, .amplitude = -60.0, .time_s = 1.0});
  EXPECT_EQ(step.valueAt(0.5 * kLeadS, 0.0), 10.0);
  EXPECT_EQ(step.valueAt(kLeadS - 1e-6, 0.0), 10.0);
  EXPECT_EQ(step.valueAt(kLeadS, 0.0), -50.0);
  EXPECT_EQ(step.valueAt(100.0, 0.0), -50.0);
  EXPECT_EQ(step.timeS(), kLeadS + 1.0);
  EXPECT_EQ(step.lowest(), -50.0);
  EXPECT_EQ(step.highest(), 10.0);
}

TEST(Excitation, TheBaseIsApproachedFromWhereTheMotorIsWithoutAJump) {
  const auto step = made({.base = 10.0, .amplitude = 60.0, .time_s = 1.0});
  EXPECT_EQ(step.valueAt(0.0, -30.0), -30.0);
  EXPECT_EQ(step.valueAt(-1.0, -30.0), -30.0);
  EXPECT_DOUBLE_EQ(step.valueAt(0.25 * kLeadS, -30.0), -10.0);
  EXPECT_NEAR(step.valueAt(1e-3, -30.0), -30.0, 1e-3);
}

TEST(Excitation, ARampRisesAtItsRateAndStays) {
  const auto ramp = made({.kind = Kind::kRamp, .amplitude = -60.0, .time_s = 2.0, .rate_per_s = 100.0});
  EXPECT_DOUBLE_EQ(ramp.valueAt(kLeadS + 0.3, 0.0), -30.0);
  EXPECT_EQ(ramp.valueAt(kLeadS + 1.0, 0.0), -60.0);
}

TEST(Excitation, ASweepEndsWithoutAJumpAndRestsForAPeriodOfItsLowestFrequency) {
  const auto sweep = made({.kind = Kind::kSweep, .base = 10.0, .amplitude = 20.0, .time_s = 4.3});
  EXPECT_DOUBLE_EQ(sweep.timeS(), kLeadS + 6.0);
  for (double t = kLeadS; t < sweep.timeS(); t += 1e-4)
    ASSERT_LT(std::abs(sweep.valueAt(t + 1e-4, 0.0) - sweep.valueAt(t, 0.0)), 0.3) << t;
  for (double t = kLeadS + 4.3 + 0.025; t < sweep.timeS(); t += 1e-3) ASSERT_EQ(sweep.valueAt(t, 0.0), 10.0);
}

TEST(Excitation, ALogarithmicSweepHasTheGeometricMeanInItsMiddleAndALinearOneTheMean) {
  // Counted by turns of the sine: zero crossings upwards up to the middle, of those up to the end.
  const auto turns = [](bool linear, double part) {
    const auto sweep = made({.kind = Kind::kSweep,
                             .amplitude = 1.0,
                             .time_s = 20.0,
                             .from_hz = 1.0,
                             .to_hz = 16.0,
                             .linear = linear});
    int crossings = 0;
    for (double t = 0.0; t < part * 20.0; t += 1e-4)
      crossings +=
          sweep.valueAt(kLeadS + t, 0.0) < 0.0 && sweep.valueAt(kLeadS + t + 1e-4, 0.0) >= 0.0 ? 1 : 0;
    return crossings;
  };
  // f(t) = 16^(t / 20): 20 / ln 16 * (16^part - 1) turns. Linear: t + 15 t^2 / 40.
  EXPECT_NEAR(turns(false, 0.5), 20.0 / std::log(16.0) * 3.0, 1.0);
  EXPECT_NEAR(turns(false, 1.0), 20.0 / std::log(16.0) * 15.0, 1.0);
  EXPECT_NEAR(turns(true, 0.5), 10.0 + 37.5, 1.0);
  EXPECT_NEAR(turns(true, 1.0), 20.0 + 150.0, 1.0);
}

TEST(Excitation, SinesStayWithinTheirAmplitude) {
  for (const auto kind : {Kind::kSweep, Kind::kMultisine}) {
    const auto sines = made({.kind = kind, .base = 60.0, .amplitude = 20.0, .time_s = 10.0});
    EXPECT_NEAR(peakOf(sines), 20.0, 0.3) << toString(kind);
    EXPECT_EQ(sines.lowest(), 40.0);
    EXPECT_EQ(sines.highest(), 80.0);
  }
}

TEST(Excitation, AMultisineRepeatsItselfWithTheLowestFrequency) {
  const auto sines = made({.kind = Kind::kMultisine, .amplitude = 1.0, .time_s = 10.0, .from_hz = 2.0});
  for (double t = 0.0; t < 0.5; t += 0.013)
    EXPECT_NEAR(sines.valueAt(kLeadS + t, 0.0), sines.valueAt(kLeadS + t + 0.5, 0.0), 1e-9);
}

TEST(Excitation, SchroederPhasesKeepThePeakOfAMultisineLow) {
  // Twenty lines in phase would have a crest factor of sqrt(2 * 20) = 6.3.
  const auto sines =
      made({.kind = Kind::kMultisine, .amplitude = 1.0, .time_s = 4.0, .from_hz = 1.0, .to_hz = 20.0});
  double squares = 0.0;
  for (int i = 0; i < 4000; ++i) squares += std::pow(sines.valueAt(kLeadS + i * 1e-3, 0.0), 2.0);
  EXPECT_LT(1.0 / std::sqrt(squares / 4000.0), 2.0);
}

TEST(Excitation, WhatCannotBeRunIsRefusedWithItsRange) {
  EXPECT_THAT(refusal({.amplitude = 0.0}), HasSubstr("moves nothing"));
  EXPECT_THAT(refusal({.amplitude = std::numeric_limits<double>::quiet_NaN()}), HasSubstr("moves nothing"));
  EXPECT_THAT(refusal({.base = std::numeric_limits<double>::infinity(), .amplitude = 1.0}),
              HasSubstr("base"));
  EXPECT_THAT(refusal({.amplitude = 1.0, .time_s = 0.0}), HasSubstr("0.05 to 120 s"));
  EXPECT_THAT(refusal({.kind = Kind::kRamp, .amplitude = 1.0}), HasSubstr("needs a rate"));
  EXPECT_THAT(refusal({.kind = Kind::kRamp, .amplitude = 60.0, .time_s = 1.0, .rate_per_s = 10.0}),
              HasSubstr("takes 6.00 s"));
  EXPECT_THAT(refusal({.kind = Kind::kSweep, .amplitude = 1.0, .time_s = 10.0, .to_hz = 51.0}),
              HasSubstr("0.05 to 50 Hz"));
  EXPECT_THAT(refusal({.kind = Kind::kSweep, .amplitude = 1.0, .time_s = 3.0}), HasSubstr("4.0 s or more"));
  EXPECT_THAT(
      refusal({.kind = Kind::kMultisine, .amplitude = 1.0, .time_s = 8.0, .from_hz = 1.0, .to_hz = 1.5}),
      HasSubstr("multiples"));
}

}  // namespace
}  // namespace rc10::client::test::excitation_test
