#include "daemon/recording/sample_turns.hpp"

#include <gtest/gtest.h>

#include <array>

namespace rc10::test::sample_turns_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kThings = 7;

class SampleTurnsTest : public ::testing::Test {
 protected:
  /// Number due at this time.
  std::size_t advance(Duration time) {
    turns.advance(MonotonicTime{1h + time}, kThings);
    std::size_t due = 0;
    for (std::size_t i = 0; i < kThings; ++i) {
      if (!turns.due(i)) continue;
      ++counts[i];
      ++due;
    }
    return due;
  }

  SampleTurns turns{50ms};
  std::array<int, kThings> counts{};
};

TEST_F(SampleTurnsTest, TheFirstTickTakesAll) { EXPECT_EQ(advance(13ms), kThings); }

TEST_F(SampleTurnsTest, APauseAlmostAsLongAsTheIntervalLosesNoTurn) {
  (void)advance(1ms);
  EXPECT_EQ(advance(50ms), kThings);
}

TEST_F(SampleTurnsTest, EachHasOneTurnAnIntervalAndNoTickHasThemAll) {
  (void)advance(0ms);
  counts.fill(0);
  for (int ms = 1; ms <= 1000; ++ms) EXPECT_LE(advance(ms * 1ms), 1U);
  for (const int count : counts) EXPECT_EQ(count, 20);
}

TEST_F(SampleTurnsTest, ATickOfManyPeriodsTakesWhatTheOthersMissed) {
  (void)advance(0ms);
  counts.fill(0);
  for (int ms = 13; ms <= 1300; ms += 13) (void)advance(ms * 1ms);
  for (const int count : counts) EXPECT_EQ(count, 26);
}

TEST_F(SampleTurnsTest, AfterAStandstillAllAreDueOnce) {
  (void)advance(0ms);
  EXPECT_EQ(advance(3s + 20ms), kThings);
  EXPECT_EQ(advance(3s + 21ms), 0U);
}

TEST_F(SampleTurnsTest, TheSameTimeAgainTakesNothing) {
  (void)advance(5ms);
  EXPECT_EQ(advance(5ms), 0U);
}

}  // namespace
}  // namespace rc10::test::sample_turns_test
