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

}  // namespace
}  // namespace host_clock_test
}  // namespace robot_client
}  // namespace rc10
