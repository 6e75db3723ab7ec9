#include "daemon/supervision/simulation_watch.hpp"

#include <gtest/gtest.h>

namespace rc10::test::simulation_watch_test {
namespace {

using namespace std::chrono_literals;

constexpr MonotonicTime kStart{10s};

TEST(SimulationWatchTest, RealBusesAreNeverLate) {
  SimulationWatch watch;
  for (int tick = 0; tick < 5; ++tick) {
    watch.look(0, kStart + tick * 1ms);
    EXPECT_FALSE(watch.late());
  }
}

TEST(SimulationWatchTest, IsLateInATickWithoutAStep) {
  SimulationWatch watch;
  watch.look(1, kStart);
  EXPECT_FALSE(watch.late());
  watch.look(1, kStart + 1ms);
  EXPECT_TRUE(watch.late());
  watch.look(2, kStart + 2ms);
  EXPECT_FALSE(watch.late());
}

TEST(SimulationWatchTest, IsNoLongerLateOnceItHasEnded) {
  SimulationWatch watch;
  watch.look(1, kStart);
  watch.look(1, kStart + 999ms);
  EXPECT_TRUE(watch.late());
  watch.look(1, kStart + 1s);
  EXPECT_FALSE(watch.late());
}

}  // namespace
}  // namespace rc10::test::simulation_watch_test
