#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "app/low_pass.hpp"
#include "app/moving_average.hpp"
#include "app/two_pole_filter.hpp"

namespace rc10::test::frequency_response_test {
namespace {

constexpr float kDt = 0.001F;
constexpr auto kDtSeconds = static_cast<double>(kDt);
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = std::numbers::pi;
using Complex = std::complex<double>;

/// Gain and phase at a frequency, by correlation over whole periods after the transient.
template <typename Step>
Complex measured(Step&& step, double frequency_hz) {
  constexpr int kSettle = 4000;
  constexpr int kSamples = 4000;  // whole periods for multiples of 0.25 Hz
  Complex sum;
  for (int i = 0; i < kSettle + kSamples; ++i) {
    const double phase = 2.0 * kPi * frequency_hz * i * 0.001;
    const double out = step(std::cos(phase));
    if (i >= kSettle) sum += out * std::polar(1.0, -phase);
  }
  return 2.0 * sum / static_cast<double>(kSamples);
}

Complex delay(double frequency_hz) { return std::polar(1.0, -2.0 * kPi * frequency_hz * 0.001); }

/// j tan(pi f dt) / tan(pi f0 dt): what the bilinear transform makes of j f / f0.
Complex bilinear(double frequency_hz, double reference_hz) {
  return {0.0, std::tan(kPi * frequency_hz * 0.001) / std::tan(kPi * reference_hz * 0.001)};
}

constexpr double kFrequencies[] = {0.25, 1.0, 5.0, 12.0, 20.0, 30.0, 47.0, 80.0, 150.0, 333.0, 450.0};

TEST(LowPass, HasTheResponseOfItsDifferenceEquation) {
  const double x = 2.0 * kPi * 20.0 * 0.001;
  for (const double f : kFrequencies) {
    LowPass filter(20.0F);
    const Complex h =
        measured([&](double u) { return static_cast<double>(filter.step(static_cast<float>(u), kDt)); }, f);
    const double k = x / (1.0 + x);
    EXPECT_NEAR(std::abs(h - k / (1.0 - (1.0 - k) * delay(f))), 0.0, 1e-5) << f;
  }
}

TEST(LowPass, IsThreeDecibelsDownAtItsCutOff) {
  LowPass filter(5.0F);
  const Complex h =
      measured([&](double u) { return static_cast<double>(filter.step(static_cast<float>(u), kDt)); }, 5.0);
  EXPECT_NEAR(std::abs(h), std::sqrt(0.5), 0.01);
}

TEST(ButterworthLowPass, HasTheResponseOfTheBilinearTransform) {
  for (const double cutoff_hz : {5.0, 30.0, 200.0}) {
    for (const double f : kFrequencies) {
      ButterworthLowPass filter(cutoff_hz);
      const Complex h = measured([&](double u) { return filter.step(u, kDt); }, f);
      const Complex s = bilinear(f, cutoff_hz);
      EXPECT_NEAR(std::abs(h - 1.0 / (s * s + std::numbers::sqrt2 * s + 1.0)), 0.0, 1e-6)
          << cutoff_hz << ' ' << f;
    }
  }
}

TEST(ButterworthLowPass, IsThreeDecibelsDownAtItsCutOffHoweverNearHalfTheRate) {
  for (const double cutoff_hz : {1.0, 10.0, 100.0, 300.0, 440.0}) {
    ButterworthLowPass filter(cutoff_hz);
    const Complex h = measured([&](double u) { return filter.step(u, kDt); }, cutoff_hz);
    EXPECT_NEAR(std::abs(h), std::sqrt(0.5), 1e-5) << cutoff_hz;
  }
}

TEST(ButterworthLowPass, FollowsASineThroughSamplesThatComeUnevenly) {
  ButterworthLowPass even(20.0);
  ButterworthLowPass uneven(20.0);
  double t = 0.0;
  double even_t = 0.0;
  for (int i = 0; i < 3000; ++i) {
    // One of three samples is lost, as on a loaded bus.
    const float dt_s = i % 2 == 0 ? kDt : 2.0F * kDt;
    t += static_cast<double>(dt_s);
    (void)uneven.step(std::sin(2.0 * kPi * 5.0 * t), dt_s);
    while (even_t < t - 0.5 * kDtSeconds) {
      even_t += kDtSeconds;
      (void)even.step(std::sin(2.0 * kPi * 5.0 * even_t), kDt);
    }
    if (i > 500) {
      ASSERT_NEAR(uneven.value(), even.value(), 0.005);
    }
  }
}

TEST(ButterworthLowPass, BeginsSettledOnItsFirstInput) {
  ButterworthLowPass filter(5.0);
  for (int i = 0; i < 100; ++i) EXPECT_NEAR(filter.step(42.0, kDt), 42.0, 1e-9);
  filter.reset();
  EXPECT_EQ(filter.step(-3.0, kDt), -3.0);
  filter.reset(8.0);
  EXPECT_NEAR(filter.step(8.0, kDt), 8.0, 1e-12);
}

TEST(ButterworthLowPass, WithoutACutOffIsNoFilter) {
  for (const double cutoff_hz : {0.0, -1.0, kNan}) {
    ButterworthLowPass filter(cutoff_hz);
    EXPECT_EQ(filter.step(1.0, kDt), 1.0);
    EXPECT_EQ(filter.step(-7.0, kDt), -7.0);
  }
}

TEST(Notch, HasTheResponseOfTheBilinearTransform) {
  for (const double f : kFrequencies) {
    Notch filter({.centre_hz = 47.0, .width_hz = 10.0});
    const Complex h = measured([&](double u) { return filter.step(u, kDt); }, f);
    const Complex s = bilinear(f, 47.0);
    const double k = 2.0 * std::tan(kPi * 0.010) / std::sin(2.0 * kPi * 0.047);
    EXPECT_NEAR(std::abs(h - (s * s + 1.0) / (s * s + k * s + 1.0)), 0.0, 1e-6) << f;
  }
}

TEST(Notch, TakesItsCentreOutAndIsThreeDecibelsDownAtEdgesOneWidthApart) {
  const auto gain = [](double f) {
    Notch filter({.centre_hz = 100.0, .width_hz = 20.0});
    return std::abs(measured([&](double u) { return filter.step(u, kDt); }, f));
  };
  EXPECT_NEAR(gain(100.0), 0.0, 1e-6);
  EXPECT_NEAR(gain(1.0), 1.0, 1e-3);
  EXPECT_NEAR(gain(450.0), 1.0, 1e-2);
  const auto edge = [&](double inside, double outside) {
    for (int i = 0; i < 12; ++i) {
      const double middle = std::round(2.0 * (inside + outside)) / 4.0;  // whole periods
      (gain(middle) < std::sqrt(0.5) ? inside : outside) = middle;
    }
    return 0.5 * (inside + outside);
  };
  EXPECT_NEAR(edge(100.0, 140.0) - edge(100.0, 60.0), 20.0, 0.5);
}

TEST(Notch, WithoutACentreOrWidthOrBeyondTheRateIsNoFilter) {
  for (const Notch::Config& config : {Notch::Config{}, Notch::Config{0.0, 5.0}, Notch::Config{50.0, 0.0},
                                      Notch::Config{kNan, kNan}, Notch::Config{480.0, 10.0}}) {
    Notch filter(config);
    EXPECT_EQ(filter.step(1.0, kDt), 1.0);
    EXPECT_EQ(filter.step(-7.0, kDt), -7.0);
  }
}

TEST(MovingAverage, HasTheResponseOfTheMean) {
  for (const double f : kFrequencies) {
    MovingAverage<8> filter;
    Complex expected;
    for (int i = 0; i < 8; ++i) expected += std::pow(delay(f), i) / 8.0;
    EXPECT_NEAR(std::abs(measured([&](double u) { return filter.step(u); }, f) - expected), 0.0, 1e-9) << f;
  }
}

template <typename Filter>
void expectSafe(Filter filter) {
  (void)filter.step(1.0, kDt);
  const double value = filter.step(3.0, kDt);
  for (const double bad : {kNan, kInfinity, -kInfinity}) EXPECT_EQ(filter.step(bad, kDt), value);
  for (const float dt_s : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_EQ(filter.step(100.0, dt_s), value);
  }
  for (int i = 0; i < 1000; ++i) {
    const double huge = i % 2 == 0 ? 1e308 : -1e308;
    ASSERT_TRUE(std::isfinite(filter.step(huge, i % 3 == 0 ? 1e30F : 1e-30F)));
  }
  filter.reset(kNan);
  ASSERT_TRUE(std::isfinite(filter.step(0.0, kDt)));
}

TEST(Filters, InputThatMakesNoSenseKeepsTheLastOutput) {
  expectSafe(ButterworthLowPass(30.0));
  expectSafe(Notch({.centre_hz = 50.0, .width_hz = 5.0}));
  LowPass first_order(30.0F);
  const float value = first_order.step(3.0F, kDt);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(first_order.step(bad, kDt), value);
    EXPECT_EQ(first_order.step(1.0F, -bad), value);
  }
  EXPECT_TRUE(std::isfinite(first_order.step(3e38F, 3e38F)));
}

}  // namespace
}  // namespace rc10::test::frequency_response_test
