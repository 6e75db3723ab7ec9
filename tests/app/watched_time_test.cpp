#include "app/watched_time.hpp"

#include <gtest/gtest.h>

namespace rc10::test::watched_time_test {
namespace {

constexpr Tick kOrdinary{.index = 0, .now = {}, .dt_s = 0.001F};
constexpr Tick kAfterAPause{.index = 1, .now = MonotonicTime{std::chrono::seconds{900}}, .dt_s = 0.005F};

TEST(WatchedTimeTest, CountsTheTicksSinceItBegan) {
  WatchedTime time;
  for (int i = 0; i < 1000; ++i) time.step(kOrdinary);
  EXPECT_NEAR(time.seconds(), 1.0, 1e-6);
  EXPECT_GE(time.seconds(), 1.0) << "a timer of 1 s is not a tick late";
  time.restart();
  EXPECT_EQ(time.seconds(), 0.0);
}

TEST(WatchedTimeTest, CountsAPauseAsFivePeriods) {
  WatchedTime time;
  time.step(kOrdinary);
  time.step(kAfterAPause);
  EXPECT_NEAR(time.seconds(), 0.006, 1e-6);
}

TEST(WatchedTimeTest, IsLongerThanAnyWhereItNeverBegan) {
  auto time = WatchedTime::never();
  EXPECT_GT(time.seconds(), 1e9);
  time.restart();
  EXPECT_EQ(time.seconds(), 0.0);
}

}  // namespace
}  // namespace rc10::test::watched_time_test
