#include "daemon/threads/overload_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rc10::test::overload_watch_test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPeriod = 1ms;

/// A thread that ticks on a grid, as SchedLoop does.
class OverloadWatchTest : public ::testing::Test {
 protected:
  using Cost = std::function<Duration(int tick, std::uint64_t periods)>;

  /// Time until the overload; 0: none within a minute. `others`: time that other programs take in the
  /// middle of each tick.
  Duration timeUntilOverload(const Cost& cost, Duration others = {}) {
    const Duration begin = now;
    Duration due = now + kPeriod;
    for (int tick = 0; now - begin < 60s; ++tick) {
      now = std::max(now, due);
      const auto periods = static_cast<std::uint64_t>((now - due) / kPeriod + 1);
      due += kPeriod * static_cast<std::int64_t>(periods);
      const Duration used = cost(tick, periods);
      cpu_time += used;
      now += used + others;
      if (!watch.ended(periods, due - now)) continue;
      ++readings;
      if (watch.overran(cpu_time)) return now - begin;
    }
    return {};
  }
  Duration timeUntilOverload(Duration first, Duration second, Duration others = {}) {
    return timeUntilOverload([=](int tick, std::uint64_t) { return tick % 2 == 0 ? first : second; }, others);
  }

  OverloadWatch watch{kPeriod, 93, 100ms};
  Duration cpu_time = 7s;
  Duration now = 100s;
  int readings = 0;
};

TEST_F(OverloadWatchTest, TicksThatUseMoreThanTheirPeriodAreAnOverloadAfterTheLimit) {
  EXPECT_EQ(timeUntilOverload(2ms, 2ms), 1ms + 102ms) << "of the first one the start is not known";
}

TEST_F(OverloadWatchTest, TicksThatNearlyFillTheirPeriodAreOneToo) {
  const auto took = timeUntilOverload(931us, 931us);
  EXPECT_GT(took, 100ms);
  EXPECT_LT(took, 112ms);
  EXPECT_EQ(timeUntilOverload(930us, 930us), Duration::zero());
}

// A pause after the short tick hides nothing.
TEST_F(OverloadWatchTest, LongAndShortTicksThatFillTheirPeriodsTogetherAreOne) {
  struct Pair {
    Duration first;
    Duration second;
  };
  for (const auto& [first, second] :
       {Pair{1250us, 650us}, {2200us, 700us}, {4200us, 600us}, {18'200us, 700us}, {24'200us, 700us}}) {
    watch = OverloadWatch{kPeriod, 93, 100ms};
    const auto took = timeUntilOverload(first, second);
    EXPECT_GT(took, 100ms) << first.count();
    EXPECT_LT(took, 160ms) << first.count();
  }
}

TEST_F(OverloadWatchTest, OneShortTickAmongLongOnesChangesNothing) {
  const auto took =
      timeUntilOverload([](int tick, std::uint64_t) { return tick % 100 == 99 ? 850us : 1000us; });
  EXPECT_GT(took, 100ms);
  EXPECT_LT(took, 120ms);
}

TEST_F(OverloadWatchTest, ALongTickNowAndThenIsNone) {
  EXPECT_EQ(timeUntilOverload([](int tick, std::uint64_t) { return tick % 900 == 0 ? 50ms : 100us; }),
            Duration::zero());
  EXPECT_GT(readings, 60) << "it was looked at";
}

TEST_F(OverloadWatchTest, AThreadThatOthersKeepFromTheCpuIsNotOverloaded) {
  EXPECT_EQ(timeUntilOverload(50us, 50us, 2ms), Duration::zero());
  EXPECT_EQ(timeUntilOverload(880us, 880us, 100us), Duration::zero()) << "no tick had a pause";
}

// Frames of the missed periods wait for the tick that comes at last.
TEST_F(OverloadWatchTest, TicksThatCatchUpAreNone) {
  const auto catching_up = [](int, std::uint64_t periods) {
    return 200us + 80us * static_cast<std::int64_t>(periods);
  };
  EXPECT_EQ(timeUntilOverload(catching_up, 9'100us), Duration::zero());
  EXPECT_GT(readings, 100);
}

TEST_F(OverloadWatchTest, AnOverloadThatGoesOnIsToldAfterEachLimit) {
  EXPECT_EQ(timeUntilOverload(2ms, 2ms), 103ms);
  EXPECT_EQ(timeUntilOverload(2ms, 2ms), 1ms + 102ms);
}

TEST_F(OverloadWatchTest, CpuTimeIsReadOnlyAfterTicksWithoutAPause) {
  EXPECT_EQ(timeUntilOverload(500us, 500us), Duration::zero());
  EXPECT_EQ(readings, 0);
  EXPECT_FALSE(watch.ended(1, 70us));
  EXPECT_TRUE(watch.ended(1, 69us));
  EXPECT_TRUE(watch.ended(1, -1ms));
}

TEST(OverloadPercentTest, FollowsTheShareThatTheKernelLeaves) {
  EXPECT_EQ(overloadPercent(95), 93);
  EXPECT_EQ(overloadPercent(50), 48);
  EXPECT_EQ(overloadPercent(3), 1) << "always below it";
  EXPECT_EQ(overloadPercent(1), 1);
  EXPECT_EQ(overloadPercent(100), 97) << "nothing is throttled";
}

}  // namespace
}  // namespace rc10::test::overload_watch_test
