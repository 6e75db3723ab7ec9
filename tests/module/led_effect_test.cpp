#include "module/led_effect.hpp"

#include <vector>

#include <gmock/gmock.h>

namespace rc10::test::led_effect_test {
namespace {

using namespace std::chrono_literals;
using ::testing::Each;
using ::testing::ElementsAre;

constexpr Rgb kRed{1.0F, 0.0F, 0.0F};
constexpr Rgb kBlue{0.0F, 0.0F, 1.0F};

std::vector<Rgb> painted(LedPattern pattern, Duration at, std::size_t pixels = 4) {
  std::vector<Rgb> picture(pixels);
  paint({.pattern = pattern, .colour = kRed, .second = kBlue, .period = 1s}, MonotonicTime{100s + at},
        picture);
  return picture;
}

TEST(LedEffect, ColoursAreNamedOrWrittenInHex) {
  EXPECT_EQ(colourOf("red"), kRed);
  EXPECT_EQ(colourOf("#0000fF"), kBlue);
  EXPECT_EQ(colourOf("#FF0000"), kRed);
  EXPECT_EQ(colourOf("black"), Rgb{});
  EXPECT_EQ(colourOf("purplish"), Rgb{});
}

TEST(LedEffect, SteadyIsAlwaysTheSame) {
  for (const auto at : {0ms, 333ms, 999ms}) EXPECT_THAT(painted(LedPattern::kSteady, at), Each(kRed));
}

TEST(LedEffect, BlinkHasEachColourForHalfThePeriod) {
  EXPECT_THAT(painted(LedPattern::kBlink, 0ms), Each(kRed));
  EXPECT_THAT(painted(LedPattern::kBlink, 499ms), Each(kRed));
  EXPECT_THAT(painted(LedPattern::kBlink, 500ms), Each(kBlue));
  EXPECT_THAT(painted(LedPattern::kBlink, 999ms), Each(kBlue));
  EXPECT_THAT(painted(LedPattern::kBlink, 1s), Each(kRed));
}

TEST(LedEffect, BreathingGoesFromTheSecondColourToTheFirstAndBackWithoutAJump) {
  EXPECT_THAT(painted(LedPattern::kBreathe, 0ms), Each(kBlue));
  EXPECT_NEAR(painted(LedPattern::kBreathe, 500ms)[0].red, 1.0F, 1e-3F);
  float last = 0.0F;
  for (int ms = 0; ms <= 1000; ms += 10) {
    const auto pixel = painted(LedPattern::kBreathe, std::chrono::milliseconds{ms})[0];
    EXPECT_NEAR(pixel.red, last, 0.05F);
    EXPECT_NEAR(pixel.red + pixel.blue, 1.0F, 1e-5F);
    last = pixel.red;
  }
}

TEST(LedEffect, AQuarterOfTheStripRunsRound) {
  EXPECT_THAT(painted(LedPattern::kRun, 0ms), ElementsAre(kRed, kBlue, kBlue, kBlue));
  EXPECT_THAT(painted(LedPattern::kRun, 800ms), ElementsAre(kBlue, kBlue, kBlue, kRed));
  EXPECT_THAT(painted(LedPattern::kRun, 900ms, 8),
              ElementsAre(kRed, kBlue, kBlue, kBlue, kBlue, kBlue, kBlue, kRed));
  EXPECT_THAT(painted(LedPattern::kRun, 999ms, 1), ElementsAre(kRed));
}

}  // namespace
}  // namespace rc10::test::led_effect_test
