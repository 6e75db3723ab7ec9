#include "app/time_grid.hpp"

#include <gtest/gtest.h>

#include <array>

namespace rc10::test::time_grid_test {
namespace {

using namespace std::chrono_literals;

constexpr MonotonicTime at(Duration time) { return MonotonicTime{time}; }

TEST(TimeGrid, IsAMultipleOfThePeriod) {
  for (Duration now = 5s; now < 5s + 3ms; now += 7us) {
    const auto next = TimeGrid{1ms}.next(at(now)).time_since_epoch();
    ASSERT_EQ(next % 1ms, 0ns);
    ASSERT_GE(next - now, 500us) << "no time left to get there";
    ASSERT_LE(next - now, 1500us) << "a tick was left out";
  }
}

TEST(TimeGrid, LeavesOutAPointThatIsTooClose) {
  EXPECT_EQ(TimeGrid{1ms}.next(at(5s)), at(5s + 1ms));
  EXPECT_EQ(TimeGrid{1ms}.next(at(5s + 499us)), at(5s + 1ms));
  EXPECT_EQ(TimeGrid{1ms}.next(at(5s + 501us)), at(5s + 2ms));
}

TEST(TimeGrid, WorksForOtherPeriods) {
  EXPECT_EQ(TimeGrid{2ms + 500us}.next(at(5s + 1ms)), at(5s + 2500us));
  EXPECT_EQ(TimeGrid{1ms + 250us}.next(at(5s + 1ms)), at(5s + 2500us));
}

TEST(TimeGrid, LiesAtItsOffsetInEachPeriod) {
  EXPECT_EQ((TimeGrid{1ms, 300us}.next(at(5s))), at(5s + 1300us));
  EXPECT_EQ((TimeGrid{1ms, 300us}.next(at(5s + 801us))), at(5s + 2300us));
  EXPECT_EQ((TimeGrid{1ms, 300us}.shifted(-400us).next(at(5s))), at(5s + 900us))
      << "also before the multiple";
}

TEST(TimeGrid, LiesInThePeriodsOfAnotherClock) {
  for (const Duration ahead : std::array<Duration, 3>{1'764'244'800s + 123'456'789ns, 0ns, -7s - 400us}) {
    const auto grid = TimeGrid::onClock(1ms, 300us, ahead);
    EXPECT_GE(grid.offset, 0ns);
    EXPECT_LT(grid.offset, 1ms);
    EXPECT_EQ(grid.phaseOn(ahead), 300us);
    EXPECT_EQ(((grid.next(at(5s)).time_since_epoch() + ahead) % 1ms + 1ms) % 1ms, 300us);
  }
}

TEST(TimeGrid, TellsItsPlaceOnAClockThatWasStepped) {
  const auto grid = TimeGrid::onClock(1ms, 300us, 100s + 50us);
  EXPECT_EQ(grid.phaseOn(100s + 250us), 500us);
  EXPECT_EQ(grid.phaseOn(99s + 700us), 950us);
  EXPECT_EQ(grid.phaseOn(101s + 50us), 300us) << "a leap second moves nothing";
}

}  // namespace
}  // namespace rc10::test::time_grid_test
