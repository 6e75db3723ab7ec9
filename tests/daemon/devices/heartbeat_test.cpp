#include "daemon/devices/heartbeat.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/fake_gpio.hpp"

namespace rc10::test::heartbeat_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class HeartbeatTest : public ::testing::Test {
 protected:
  /// One millisecond, with or without a tick in it.
  bool step(bool ticks = true) {
    now += 1ms;
    if (ticks) ++tick;
    return heartbeat.step(now, tick);
  }
  void run(int milliseconds, bool ticks = true) {
    for (int i = 0; i < milliseconds; ++i) EXPECT_TRUE(step(ticks));
  }

  FakePulse::State output;
  Heartbeat heartbeat{std::make_unique<FakePulse>(output), 20ms};
  MonotonicTime now{100s};
  std::uint64_t tick = 0;
};

TEST_F(HeartbeatTest, IsASquareWaveWhileTheSchedulerTicks) {
  run(100);
  ASSERT_EQ(output.levels.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(output.levels[i], i % 2 == 0);
}

TEST_F(HeartbeatTest, DoesNotBeginBeforeTheFirstTick) {
  run(100, false);
  EXPECT_THAT(output.levels, IsEmpty());
  run(1);
  run(20);
  EXPECT_GE(output.levels.size(), 2U);
}

TEST_F(HeartbeatTest, StopsAtOnceWhenTheTicksStopAndGoesOnWithThem) {
  run(100);
  const auto before = output.levels.size();
  run(1000, false);
  EXPECT_LE(output.levels.size(), before + 1);  // the half wave in which the last tick was
  const auto stopped = output.levels.size();
  run(40);
  EXPECT_GE(output.levels.size(), stopped + 3);
}

TEST_F(HeartbeatTest, DoesNotMakeUpForTheTimeInWhichItWasNotAsked) {
  run(50);
  const auto before = output.levels.size();
  now += 10s;  // the whole computer stood still
  run(20);
  EXPECT_LE(output.levels.size(), before + 3);
}

TEST_F(HeartbeatTest, SaysWhenTheOutputRefuses) {
  output.refuses = true;
  EXPECT_FALSE(step());
  EXPECT_TRUE(step());  // not due
}

TEST_F(HeartbeatTest, EndsLow) {
  run(1);
  heartbeat.end();
  EXPECT_THAT(output.levels, ElementsAre(true, false));
}

}  // namespace
}  // namespace rc10::test::heartbeat_test
