#include "client/motion/frequency_response.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "client/motion/excitation.hpp"

namespace rc10::client::test::frequency_response_test {
namespace {

using Complex = std::complex<double>;
using Model = std::function<Complex(double frequency_hz)>;
constexpr double kSampleS = 1e-3;
constexpr double kPi = std::numbers::pi;

std::vector<double> excited(ExcitationKind kind, double from_hz, double to_hz) {
  const auto excitation =
      Excitation::of({.kind = kind, .amplitude = 20.0, .time_s = 40.0, .from_hz = from_hz, .to_hz = to_hz});
  std::vector<double> input;
  for (double t = 0.0; t < excitation->timeS(); t += kSampleS) input.push_back(excitation->valueAt(t, 0.0));
  return input;
}

/// x' = (u - x) / tau, exactly for an input that is held for a sample.
std::vector<double> firstOrder(const std::vector<double>& input, double tau_s) {
  std::vector<double> output;
  double x = 0.0;
  for (const double u : input) {
    output.push_back(x);
    x += (u - x) * -std::expm1(-kSampleS / tau_s);
  }
  return output;
}
Complex firstOrderAt(double frequency_hz, double tau_s) {
  // A held sample is late by half of one.
  const double omega = 2.0 * kPi * frequency_hz;
  return std::polar(1.0, -omega * kSampleS / 2.0) / Complex(1.0, omega * tau_s);
}

void expectNear(const FrequencyResponse& found, const Model& model, double part) {
  ASSERT_GT(found.size(), 10U);
  for (const auto& point : found) {
    EXPECT_LT(std::abs(point.response - model(point.frequency_hz)),
              part * std::abs(model(point.frequency_hz)))
        << point.frequency_hz << " Hz";
  }
}

FrequencyResponse sampled(const Model& model, double from_hz, double to_hz) {
  FrequencyResponse response;
  for (double f = from_hz; f < to_hz; f *= 1.02) response.push_back({f, model(f), 1.0});
  return response;
}

TEST(FrequencyResponse, AFirstOrderSystemIsFoundBySweepAndMultisine) {
  for (const auto kind : {ExcitationKind::kSweep, ExcitationKind::kMultisine}) {
    const auto input = excited(kind, 0.5, 20.0);
    const double lines = kind == ExcitationKind::kMultisine ? 0.5 : 0.0;
    const auto found = estimateResponse(input, firstOrder(input, 0.03), kSampleS, {0.5, 20.0, lines});
    expectNear(
        found, [](double f) { return firstOrderAt(f, 0.03); }, 0.03);
    EXPECT_NEAR(bandwidthHz(found), 1.0 / (2.0 * kPi * 0.03), 0.1);
    EXPECT_TRUE(std::all_of(found.begin(), found.end(), [](const auto& p) { return p.coherence > 0.98; }));
  }
}

TEST(FrequencyResponse, TheHighestFrequenciesOfASweepAreAsExactAsTheOthersHoweverLongItLasts) {
  for (const double time_s : {4.0, 4.5, 5.3, 10.0, 17.9}) {
    for (const bool linear : {false, true}) {
      const auto sweep = Excitation::of({.kind = ExcitationKind::kSweep,
                                         .amplitude = 20.0,
                                         .time_s = time_s,
                                         .from_hz = 1.0,
                                         .to_hz = 20.0,
                                         .linear = linear});
      std::vector<double> input;
      for (double t = Excitation::kLeadS; t < sweep->timeS(); t += kSampleS)
        input.push_back(sweep->valueAt(t, 0.0));
      const auto found = estimateResponse(input, firstOrder(input, 0.03), kSampleS, {1.0, 20.0, 0.0});
      ASSERT_NEAR(found.back().frequency_hz, 20.0, 0.5);
      for (const auto& point : found) {
        if (point.frequency_hz < 15.0) continue;
        const Complex true_response = firstOrderAt(point.frequency_hz, 0.03);
        EXPECT_LT(std::abs(point.response - true_response), 0.05 * std::abs(true_response))
            << point.frequency_hz << " Hz, " << time_s << " s";
      }
    }
  }
}

TEST(FrequencyResponse, ADelayTurnsThePhaseAndKeepsTheGain) {
  const auto input = excited(ExcitationKind::kMultisine, 1.0, 20.0);
  std::vector<double> output(input.size());
  for (std::size_t i = 50; i < input.size(); ++i) output[i] = input[i - 50];
  const auto found = estimateResponse(input, output, kSampleS, {1.0, 20.0, 1.0});
  const auto phases = phasesDeg(found);
  ASSERT_EQ(found.size(), 20U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(phases[i], -360.0 * found[i].frequency_hz * 0.05, 1.0);  // to a whole turn at 20 Hz
    EXPECT_NEAR(found[i].gainDb(), 0.0, 0.2);
  }
  EXPECT_TRUE(std::isnan(bandwidthHz(found)));
}

TEST(FrequencyResponse, NoiseLowersTheCoherenceAndNotTheGain) {
  const auto input = excited(ExcitationKind::kMultisine, 1.0, 20.0);
  auto output = input;
  std::mt19937 random{1};
  std::normal_distribution<double> noise{0.0, 20.0};
  for (auto& value : output) value += noise(random);
  const auto found = estimateResponse(input, output, kSampleS, {1.0, 20.0, 1.0});
  for (const auto& point : found) {
    EXPECT_LT(point.coherence, 0.999);
    EXPECT_GT(point.coherence, 0.8);
    EXPECT_NEAR(point.gainDb(), 0.0, 1.0);
  }
  std::vector<double> alone(input.size());
  for (auto& value : alone) value = noise(random);
  for (const auto& point : estimateResponse(input, alone, kSampleS, {1.0, 20.0, 1.0}))
    EXPECT_LT(point.coherence, 0.3);
}

TEST(FrequencyResponse, AShaftThatStandsHasNoResponse) {
  const auto input = excited(ExcitationKind::kMultisine, 1.0, 20.0);
  const std::vector<double> output(input.size(), 2842.74625);
  EXPECT_TRUE(estimateResponse(input, output, kSampleS, {1.0, 20.0, 1.0}).empty());
}

TEST(FrequencyResponse, TooFewSamplesForAMeanGiveNone) {
  const std::vector<double> few(2900, 1.0);
  EXPECT_TRUE(estimateResponse(few, few, kSampleS, {1.0, 20.0, 0.0}).empty());
}

TEST(FrequencyResponse, TheBandwidthLiesBetweenTwoPoints) {
  const auto second = [](double f) { return 1.0 / Complex(1.0 - f * f / 25.0, 2.0 * 0.7 * f / 5.0); };
  EXPECT_NEAR(bandwidthHz(sampled(second, 0.5, 20.0)), 5.0 * 1.0098, 0.01);  // for a damping of 0.7
  EXPECT_TRUE(std::isnan(bandwidthHz(sampled(second, 8.0, 20.0))));
  EXPECT_TRUE(std::isnan(bandwidthHz({})));
}

TEST(StabilityMargins, AreThoseOfAnIntegratorWithADelay) {
  // L = K e^(-s T) / s: crosses 1 at K rad/s with a phase of -90 - K T, and -180 degrees at pi / (2 T) rad/s.
  const double gain = 20.0;
  const double delay_s = 0.02;
  const auto closed = [&](double f) {
    const double omega = 2.0 * kPi * f;
    const Complex open = std::polar(gain / omega, -kPi / 2.0 - omega * delay_s);
    return open / (1.0 + open);
  };
  const auto margins = stabilityMargins(sampled(closed, 0.5, 25.0));
  EXPECT_NEAR(margins.phase_at_hz, gain / (2.0 * kPi), 0.01);
  EXPECT_NEAR(margins.phase_deg, 90.0 - gain * delay_s * 180.0 / kPi, 0.1);
  EXPECT_NEAR(margins.gain_at_hz, 1.0 / (4.0 * delay_s), 0.02);
  EXPECT_NEAR(margins.gain_db, 20.0 * std::log10(kPi / (2.0 * delay_s) / gain), 0.05);
}

TEST(StabilityMargins, AFirstOrderLoopHasNoGainMargin) {
  const auto margins =
      stabilityMargins(sampled([](double f) { return 1.0 / Complex(1.0, f / 5.0); }, 0.5, 20.0));
  EXPECT_NEAR(margins.phase_deg, 90.0, 0.1);  // L = 5 / (j f)
  EXPECT_NEAR(margins.phase_at_hz, 5.0, 0.01);
  EXPECT_TRUE(std::isnan(margins.gain_db));
}

TEST(StabilityMargins, PointsOfNoiseCross0dBNowhere) {
  auto response = sampled([](double f) { return 1.0 / Complex(1.0, f / 5.0); }, 0.5, 20.0);
  for (auto& point : response) point.coherence = 0.2;
  EXPECT_TRUE(std::isnan(stabilityMargins(response).phase_deg));
  EXPECT_TRUE(std::isnan(bandwidthHz(response)));
}

}  // namespace
}  // namespace rc10::client::test::frequency_response_test
