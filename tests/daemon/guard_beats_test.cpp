#include "daemon/guard_beats.hpp"

#include <gtest/gtest.h>

namespace rc10::test::guard_beats_test {
namespace {

using namespace std::chrono_literals;
using News = GuardBeats::News;

class GuardBeatsTest : public testing::Test {
 protected:
  News after(Duration pause, std::uint32_t beats) { return guard.look(beats, now += pause); }
  /// The first news within this many looks, 50 ms apart.
  News within(int looks, std::uint32_t beats) {
    auto news = News::kNone;
    for (int i = 0; i < looks && news == News::kNone; ++i) news = after(50ms, beats);
    return news;
  }

  MonotonicTime now{1h};
  GuardBeats guard;
};

TEST_F(GuardBeatsTest, AGuardThatBeatsIsNoNews) {
  for (std::uint32_t beats = 1; beats < 100; ++beats) EXPECT_EQ(after(50ms, beats), News::kNone);
}

TEST_F(GuardBeatsTest, OneThatStandsStillIsToldOnceAndWhenItGoesOn) {
  EXPECT_EQ(after(50ms, 7), News::kNone);
  EXPECT_EQ(within(19, 7), News::kNone);
  EXPECT_EQ(after(50ms, 7), News::kStandsStill);
  EXPECT_EQ(within(100, 7), News::kNone);
  EXPECT_EQ(after(50ms, 8), News::kGoesOn);
  EXPECT_EQ(within(19, 8), News::kNone);
}

TEST_F(GuardBeatsTest, APauseOfTheComputerIsNoneOfTheGuard) {
  EXPECT_EQ(after(50ms, 7), News::kNone);
  EXPECT_EQ(after(10s, 7), News::kNone);
  EXPECT_EQ(after(50ms, 8), News::kNone);
}

TEST_F(GuardBeatsTest, AGuardWithoutBeatsIsNotJudged) { EXPECT_EQ(within(1000, 0), News::kNone); }

}  // namespace
}  // namespace rc10::test::guard_beats_test
