#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "app/median_filter.hpp"
#include "app/moving_average.hpp"

namespace rc10::test::window_filters_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(MovingAverage, IsTheMeanOfWhatThereIsUntilItIsFull) {
  MovingAverage<3> filter;
  EXPECT_EQ(filter.step(6.0), 6.0);
  EXPECT_EQ(filter.step(0.0), 3.0);
  EXPECT_EQ(filter.step(3.0), 3.0);
  EXPECT_EQ(filter.step(-3.0), 0.0);
}

TEST(MovingAverage, KeepsNothingOfALargeSampleThatHasLeftIt) {
  MovingAverage<4> filter;
  (void)filter.step(1e17);
  for (int i = 0; i < 8; ++i) (void)filter.step(1.0);
  EXPECT_EQ(filter.value(), 1.0);
}

TEST(MedianFilter, IsTheMedianOfItsWindow) {
  std::mt19937 random(17);
  std::deque<double> window;
  MedianFilter<7> filter;
  for (int i = 0; i < 5000; ++i) {
    const double input = static_cast<double>(random() % 20);  // with many equal ones
    window.push_back(input);
    if (window.size() > 7) window.pop_front();
    std::vector<double> sorted(window.begin(), window.end());
    std::ranges::sort(sorted);
    const double expected = 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
    ASSERT_EQ(filter.step(input), expected) << i;
  }
}

TEST(MedianFilter, ASingleWrongSampleLeavesNoTrace) {
  MedianFilter<3> filter;
  for (int i = 0; i < 5; ++i) (void)filter.step(10.0);
  EXPECT_EQ(filter.step(1e300), 10.0);
  EXPECT_EQ(filter.step(10.0), 10.0);
  EXPECT_EQ(filter.step(10.0), 10.0);
}

TEST(WindowFilters, LeaveOutWhatIsNotFinite) {
  MovingAverage<4> average;
  MedianFilter<3> median;
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_EQ(average.step(bad), 0.0);
    EXPECT_EQ(median.step(bad), 0.0);
  }
  (void)average.step(5.0);
  (void)median.step(5.0);
  EXPECT_EQ(average.step(kNan), 5.0);
  EXPECT_EQ(median.step(kNan), 5.0);
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(std::isfinite(average.step(1e308)));
    EXPECT_TRUE(std::isfinite(median.step(1e308)));
  }
  average.reset();
  median.reset();
  EXPECT_EQ(average.step(2.0), 2.0);
  EXPECT_EQ(median.step(2.0), 2.0);
}

}  // namespace
}  // namespace rc10::test::window_filters_test
