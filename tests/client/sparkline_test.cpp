#include "client/sparkline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rc10::client::test::sparkline_test {
namespace {

TEST(Sparkline, RisesFromItsLowestToItsHighestValue) {
  Sparkline line(8);
  for (int i = 0; i < 8; ++i) line.add(10.0 * i);
  EXPECT_EQ(line.text(false), "_.:-=+*#");
  EXPECT_EQ(line.text(true), "\u2581\u2582\u2583\u2584\u2585\u2586\u2587\u2588");
  EXPECT_EQ(line.lowest(), 0.0);
  EXPECT_EQ(line.highest(), 70.0);
  EXPECT_EQ(line.newest(), 70.0);
}

TEST(Sparkline, ForgetsWhatIsTooOldToShow) {
  Sparkline line(2);
  for (const double value : {1000.0, 1.0, 2.0}) line.add(value);
  EXPECT_EQ(line.text(false), "_#");
}

TEST(Sparkline, WhatStandsStillIsALineInTheMiddle) {
  Sparkline line(3);
  for (int i = 0; i < 3; ++i) line.add(-4.0);
  EXPECT_EQ(line.text(false), "===");
}

TEST(Sparkline, WhatIsNotReportedIsAGap) {
  Sparkline line(3);
  line.add(1.0);
  line.add(std::numeric_limits<double>::quiet_NaN());
  line.add(std::numeric_limits<double>::infinity());
  EXPECT_EQ(line.text(false), "=  ");
  EXPECT_TRUE(std::isnan(line.newest()));
  EXPECT_TRUE(std::isnan(Sparkline(3).lowest()));
}

}  // namespace
}  // namespace rc10::client::test::sparkline_test
