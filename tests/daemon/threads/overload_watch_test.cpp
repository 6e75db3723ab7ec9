#include "daemon/threads/overload_watch.hpp"

#include <gtest/gtest.h>

namespace rc10::test::overload_watch_test {
namespace {

using namespace std::chrono_literals;

class OverloadWatchTest : public ::testing::Test {
 protected:
  /// A tick without a pause after it.
  bool overran(Duration used) { return watch.overran(cpu_time += used); }
  /// Ticks with this much CPU time each until it is an overload. At most 1,000.
  int ticksUntilOverload(Duration each) {
    for (int tick = 1; tick <= 1000; ++tick) {
      if (overran(each)) return tick;
    }
    return 0;
  }

  OverloadWatch watch{1ms, 90, 100ms};
  Duration cpu_time = 7s;
};

TEST_F(OverloadWatchTest, TicksThatUseMoreThanTheirPeriodAreAnOverloadAfterTheLimit) {
  EXPECT_EQ(ticksUntilOverload(2ms), 51) << "of the first one the start is not known";
}

TEST_F(OverloadWatchTest, TicksThatNearlyFillTheirPeriodAreOneToo) {
  EXPECT_EQ(ticksUntilOverload(950us), 107);
}

TEST_F(OverloadWatchTest, LongAndShortTicksThatFillTheirPeriodsTogetherAreOne) {
  int ticks = 0;
  while (ticks < 1000 && !overran(ticks % 2 == 0 ? 1100us : 850us)) ++ticks;
  EXPECT_EQ(ticks, 104);
}

TEST_F(OverloadWatchTest, AThreadThatOthersKeepFromTheCpuIsNotOverloaded) {
  EXPECT_EQ(ticksUntilOverload(50us), 0);
  EXPECT_EQ(ticksUntilOverload(890us), 0) << "room enough, though none of them had a pause";
}

TEST_F(OverloadWatchTest, OnePauseEndsTheCount) {
  EXPECT_TRUE(watch.pauses(100us));
  EXPECT_FALSE(watch.pauses(99us));
  EXPECT_FALSE(watch.pauses(-1ms));
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(overran(2ms));
  watch.inTime();
  EXPECT_EQ(ticksUntilOverload(2ms), 51);
}

TEST_F(OverloadWatchTest, TicksWithLittleWorkEndItToo) {
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(overran(2ms));
  for (int i = 0; i < 70; ++i) EXPECT_FALSE(overran(10us));
  EXPECT_EQ(ticksUntilOverload(2ms), 50);
}

TEST(OverloadPercentTest, FollowsTheShareThatTheKernelLeaves) {
  EXPECT_EQ(overloadPercent(95), 90);
  EXPECT_EQ(overloadPercent(50), 45);
  EXPECT_EQ(overloadPercent(3), 5);
  EXPECT_EQ(overloadPercent(100), 97) << "nothing is throttled";
}

}  // namespace
}  // namespace rc10::test::overload_watch_test
