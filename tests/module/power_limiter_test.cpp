#include "module/power_limiter.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "module/module_base.hpp"

namespace rc10::test::power_limiter_test {
namespace {

TEST(PowerLimiter, SlowsDownUntilThePowerFitsAndRecovers) {
  PowerLimiter limiter{100.0};
  double factor = 1.0;
  // A driving motor takes power in proportion to the square of how fast it is told to be.
  for (int i = 0; i < 2000; ++i) factor = limiter.step(250.0 * factor * factor, {}, 0.001F);
  EXPECT_NEAR(250.0 * factor * factor, 100.0, 1.0);
  for (int i = 0; i < 2000; ++i) factor = limiter.step(10.0, {}, 0.001F);
  EXPECT_EQ(factor, 1.0);
  for (int i = 0; i < 10'000; ++i) factor = limiter.step(1e9, {}, 0.001F);
  EXPECT_EQ(factor, PowerLimiter::kLeast);
  EXPECT_EQ(limiter.step(kNoSignal, {}, 0.001F), PowerLimiter::kLeast) << "what is not known changes nothing";
}

// Bounds that docs/modules.md states.
TEST(PowerLimiter, AStartFromRestDoesNotPeak) {
  struct Start {
    double slew_m_s2, peak;
    int above_ms;
  };
  // 20 kg, told a velocity that rises at its slew rate; the motors push in proportion to what is missing.
  for (const auto& [slew_m_s2, peak, longest_ms] :
       {Start{2.0, 1.05, 5}, Start{8.0, 1.2, 10}, Start{30.0, 1.7, 25}, Start{100.0, 1.7, 25}}) {
    PowerLimiter limiter{60.0};
    double told_m_s = 0.0;
    double speed_m_s = 0.0;
    double push_n = 0.0;
    double peak_w = 0.0;
    int above_ms = 0;
    constexpr double kWanted_m_s = 3.0;
    for (int i = 0; i < 4000; ++i) {
      const double power_w = push_n * speed_m_s;
      peak_w = std::max(peak_w, power_w);
      if (power_w > 1.02 * 60.0) ++above_ms;
      const double factor = limiter.step(
          power_w, {.told = told_m_s / kWanted_m_s, .measured = speed_m_s / kWanted_m_s}, 0.001F);
      told_m_s += std::clamp(factor * kWanted_m_s - told_m_s, -slew_m_s2 * 0.001, slew_m_s2 * 0.001);
      const double asked_n = std::clamp(2000.0 * (told_m_s - speed_m_s), -200.0, 200.0);
      push_n += (asked_n - push_n) * 0.4;  // the current loop, and the age of the feedback
      speed_m_s += (push_n - 3.0 * speed_m_s) / 20.0 * 0.001;
    }
    EXPECT_LE(peak_w, peak * 60.0) << slew_m_s2;
    EXPECT_LE(above_ms, longest_ms) << slew_m_s2;
    EXPECT_GT(speed_m_s, 2.9) << "and it arrives";
  }
}

TEST(PowerLimiter, WithoutALimitEverythingIsAllowed) {
  PowerLimiter limiter{0.0};
  EXPECT_EQ(limiter.step(1e9, {}, 0.001F), 1.0);
}

}  // namespace
}  // namespace rc10::test::power_limiter_test
