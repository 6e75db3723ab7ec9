#include "daemon/threads/overload_watch.hpp"

#include <gtest/gtest.h>

namespace rc10::test::overload_watch_test {
namespace {

using namespace std::chrono_literals;

class OverloadWatchTest : public ::testing::Test {
 protected:
  /// Ticks that overrun with this much CPU time each, until it is an overload. At most 1,000.
  int ticksUntilOverload(Duration each) {
    for (int tick = 1; tick <= 1000; ++tick) {
      if (watch.overran(cpu_time += each)) return tick;
    }
    return 0;
  }

  OverloadWatch watch{1ms, 100ms};
  Duration cpu_time = 7s;
};

TEST_F(OverloadWatchTest, TicksThatUseMoreThanTheirPeriodAreAnOverloadAfterTheLimit) {
  EXPECT_EQ(ticksUntilOverload(2ms), 51) << "of the first one the start is not known";
}

TEST_F(OverloadWatchTest, AThreadThatOthersKeepFromTheCpuIsNotOverloaded) {
  EXPECT_EQ(ticksUntilOverload(50us), 0);
  EXPECT_EQ(ticksUntilOverload(1ms), 0) << "a full period is no more than it";
}

TEST_F(OverloadWatchTest, OneTickThatFitsEndsTheCount) {
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(watch.overran(cpu_time += 2ms));
  watch.inTime();
  EXPECT_EQ(ticksUntilOverload(2ms), 51);
}

TEST_F(OverloadWatchTest, OneThatWasOnlyPreemptedEndsItToo) {
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(watch.overran(cpu_time += 2ms));
  EXPECT_FALSE(watch.overran(cpu_time += 100us));
  EXPECT_EQ(ticksUntilOverload(2ms), 50);
}

}  // namespace
}  // namespace rc10::test::overload_watch_test
