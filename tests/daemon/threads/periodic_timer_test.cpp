#include "daemon/threads/periodic_timer.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/time_grid.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/threads/timer_kind.hpp"

namespace rc10::test::periodic_timer_test {
namespace {

using namespace std::chrono_literals;

class PeriodicTimerTest : public testing::TestWithParam<TimerKind> {};

TEST_P(PeriodicTimerTest, CountsTheExpirationsThatWereMissed) {
  auto timer = PeriodicTimer::create(GetParam()).value();
  timer.start(monotonicNow() - 10ms, 1ms);  // the first lies in the past: nothing to wait for
  EXPECT_GE(timer.wait(), 11U);
}

TEST_P(PeriodicTimerTest, DoesNotExpireBeforeItsTime) {
  auto timer = PeriodicTimer::create(GetParam()).value();
  const auto first = monotonicNow() + 2ms;
  timer.start(first, 1h);
  EXPECT_EQ(timer.wait(), 1U);
  EXPECT_GE(timer.woken(), first);
  EXPECT_LE(timer.woken(), monotonicNow());
}

TEST_P(PeriodicTimerTest, StaysOnItsGridHoweverLateItIsRead) {
  auto timer = PeriodicTimer::create(GetParam()).value();
  const auto first = TimeGrid{1ms}.next(monotonicNow());
  timer.start(first, 1ms);
  std::uint64_t expirations = 0;
  while (expirations < 20) {
    expirations += timer.wait();
    // Counted expirations have passed: no expiration comes early, none twice.
    ASSERT_GE(monotonicNow(), first + 1ms * static_cast<std::int64_t>(expirations - 1));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, PeriodicTimerTest,
                         testing::Values(TimerKind::kTimerfd, TimerKind::kNanosleep), [](const auto& kind) {
                           return kind.param == TimerKind::kTimerfd ? "Timerfd" : "Nanosleep";
                         });

TEST(PeriodicTimer, GoesOnByNanosleepWhenItsDescriptorCannotBeRead) {
  const UniqueFd unreadable{::open("/dev/null", O_WRONLY | O_CLOEXEC)};
  const int next = ::dup(unreadable.get());
  ::close(next);
  auto timer = PeriodicTimer::create(TimerKind::kTimerfd).value();
  const auto first = monotonicNow() + 2ms;
  timer.start(first, 1h);
  ASSERT_EQ(::dup2(unreadable.get(), next), next) << "in the place of its descriptor";
  EXPECT_EQ(timer.wait(), 0U);
  EXPECT_EQ(timer.wait(), 1U);
  EXPECT_GE(monotonicNow(), first);
}

TEST(TimerKind, AutoSleepsOnPreemptRtOnly) {
  EXPECT_EQ(timerKind(TimerPolicy::kAuto, true), TimerKind::kNanosleep);
  EXPECT_EQ(timerKind(TimerPolicy::kAuto, false), TimerKind::kTimerfd);
  for (const bool preempt_rt : {false, true}) {
    EXPECT_EQ(timerKind(TimerPolicy::kTimerfd, preempt_rt), TimerKind::kTimerfd);
    EXPECT_EQ(timerKind(TimerPolicy::kNanosleep, preempt_rt), TimerKind::kNanosleep);
  }
}

}  // namespace
}  // namespace rc10::test::periodic_timer_test
