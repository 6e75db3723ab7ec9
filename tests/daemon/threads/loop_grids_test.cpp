#include "daemon/threads/loop_grids.hpp"

#include <gtest/gtest.h>

namespace rc10::test::loop_grids_test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kAhead = 1'764'244'800s + 123'456'789ns;

TEST(LoopGrids, TicksLieAtThreeTenthsAndDrainsBeforeThem) {
  const auto [ticks, drains] = loopGrids(RobotConfig{}, kAhead);
  EXPECT_EQ(ticks.period, 1ms);
  EXPECT_EQ(ticks.offset, 300us);
  EXPECT_EQ(drains.period, 1ms);
  EXPECT_EQ(drains.offset, 200us);
}

TEST(LoopGrids, PhaseAndLeadAreThoseOfTheConfiguration) {
  RobotConfig config;
  config.rate_hz = 500;
  config.phase_of_period = 0.75;
  config.rx_lead = 150us;
  const auto [ticks, drains] = loopGrids(config, kAhead);
  EXPECT_EQ(ticks.period, 2ms);
  EXPECT_EQ(ticks.offset, 1500us);
  EXPECT_EQ(drains.offset, 1350us);
}

TEST(LoopGrids, OnTheWallClockTicksLieInItsPeriods) {
  RobotConfig config;
  config.phase_clock = PhaseClock::kRealtime;
  const auto [ticks, drains] = loopGrids(config, kAhead);
  EXPECT_EQ(ticks.phaseOn(kAhead), 300us);
  EXPECT_EQ(drains.phaseOn(kAhead), 200us);
  EXPECT_NE(ticks.offset, 300us);
}

}  // namespace
}  // namespace rc10::test::loop_grids_test
