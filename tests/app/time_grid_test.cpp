#include "app/time_grid.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rc10::test::time_grid_test
