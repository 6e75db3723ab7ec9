#include "robot_client/session/host_clock.hpp"

#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace host_clock_test {
namespace {

using namespace std::chrono_literals;

TEST(HostClock, TheQuickestMessageGivesTheDistanceOfTheClocks) {
  HostClock clock;
  const MonotonicTime local{1000s};
  EXPECT_EQ(clock.observe(50s, local), local);
  // This one came 3 ms sooner after it was stamped, the next one 20 ms later.
  EXPECT_EQ(clock.observe(50s + 10ms, local + 7ms), local + 7ms);
  EXPECT_NEAR(std::chrono::duration<double>(clock.observe(50s + 20ms, local + 37ms) - (local + 17ms)).count(),
              0.0, 10e-6);
}

TEST(HostClock, BeginsAnewWhenTheHostHasStartedAgain) {
  HostClock clock;
  const MonotonicTime local{1000s};
  (void)clock.observe(5000s, local);
  EXPECT_EQ(clock.observe(1s, local + 60s), local + 60s);
}

TEST(HostClock, IsTakenAnewAfterTheHostHasSlept) {
  HostClock clock;
  MonotonicTime local{1000s};
  Duration host = 5000s;
  (void)clock.observe(host, local);
  local += 60s;  // one second of the host
  host += 1s;
  EXPECT_LT(clock.observe(host, local), local - 50s);
  for (int i = 0; i < 600; ++i) (void)clock.observe(host += 10ms, local += 10ms);
  EXPECT_EQ(clock.observe(host + 10ms, local + 10ms), local + 10ms);
}

TEST(HostClock, MessagesOfAQueueThatIsReadInBurstsAreAsOldAsTheyAre) {
  HostClock clock;
  MonotonicTime local{1000s};
  Duration host = 5000s;
  (void)clock.observe(host, local);
  // The program stands for two seconds, again and again, and its queue drops the newest.
  for (int turn = 0; turn < 10; ++turn) {
    for (int i = 0; i < 100; ++i) EXPECT_LT(clock.observe(host + i * 5ms, local + 2s), local + 501ms);
    local += 2s;
    host += 2s;
  }
}

TEST(HostClock, MessagesOfAQueueThatIsNeverEmptyAreAsOldAsTheyAre) {
  HostClock clock;
  MonotonicTime local{1000s};
  Duration host = 5000s;
  (void)clock.observe(host, local);
  // A callback of 12 ms for each of 200 states a second: each waits for 1.2 s.
  local += 1200ms;
  for (int i = 0; i < 1000; ++i) EXPECT_LT(clock.observe(host += 12ms, local += 12ms, false), local - 1100ms);
}

}  // namespace
}  // namespace host_clock_test
}  // namespace robot_client
}  // namespace rc10
