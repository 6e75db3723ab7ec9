#include "daemon/threads/periodic_timer.hpp"

#include <gtest/gtest.h>

#include "daemon/exchange/clock.hpp"

namespace rc10::test::periodic_timer_test {
namespace {

using namespace std::chrono_literals;

constexpr MonotonicTime at(Duration time) { return MonotonicTime{time}; }

TEST(NextOnGrid, IsAMultipleOfThePeriod) {
  for (Duration now = 5s; now < 5s + 3ms; now += 7us) {
    const auto next = nextOnGrid(at(now), 1ms).time_since_epoch();
    ASSERT_EQ(next % 1ms, 0ns);
    ASSERT_GE(next - now, 500us) << "no time left to get there";
    ASSERT_LE(next - now, 1500us) << "a tick was left out";
  }
}

TEST(NextOnGrid, LeavesOutAPointThatIsTooClose) {
  EXPECT_EQ(nextOnGrid(at(5s), 1ms), at(5s + 1ms));
  EXPECT_EQ(nextOnGrid(at(5s + 499us), 1ms), at(5s + 1ms));
  EXPECT_EQ(nextOnGrid(at(5s + 501us), 1ms), at(5s + 2ms));
}

TEST(NextOnGrid, WorksForOtherPeriods) {
  EXPECT_EQ(nextOnGrid(at(5s + 1ms), 2ms + 500us), at(5s + 2500us));
  EXPECT_EQ(nextOnGrid(at(5s + 1ms), 1ms + 250us), at(5s + 2500us));
}

TEST(PeriodicTimer, CountsTheExpirationsThatWereMissed) {
  auto timer = PeriodicTimer::create().value();
  timer.start(monotonicNow() - 10ms, 1ms);  // the first lies in the past: nothing to wait for
  EXPECT_GE(timer.wait(), 11U);
}

TEST(PeriodicTimer, DoesNotExpireBeforeItsTime) {
  auto timer = PeriodicTimer::create().value();
  const auto first = monotonicNow() + 2ms;
  timer.start(first, 1h);
  EXPECT_EQ(timer.wait(), 1U);
  EXPECT_GE(monotonicNow(), first);
}

TEST(PeriodicTimer, StaysOnItsGridHoweverLateItIsRead) {
  auto timer = PeriodicTimer::create().value();
  const auto first = nextOnGrid(monotonicNow(), 1ms);
  timer.start(first, 1ms);
  std::uint64_t expirations = 0;
  while (expirations < 20) {
    expirations += timer.wait();
    // Counted expirations have passed: no expiration comes early, none twice.
    ASSERT_GE(monotonicNow(), first + 1ms * static_cast<std::int64_t>(expirations - 1));
  }
}

}  // namespace
}  // namespace rc10::test::periodic_timer_test
