#include "app/angle.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace rc10::test::angle_test {
namespace {

TEST(Angle, WrapsIntoOneTurn) {
  EXPECT_DOUBLE_EQ(wrapDegrees(0.0), 0.0);
  EXPECT_DOUBLE_EQ(wrapDegrees(360.0), 0.0);
  EXPECT_DOUBLE_EQ(wrapDegrees(-10.0), 350.0);
  EXPECT_DOUBLE_EQ(wrapDegrees(725.0), 5.0);
  EXPECT_FLOAT_EQ(wrapDegrees(-0.5F), 359.5F);
}

TEST(Angle, ATinyNegativeAngleDoesNotBecomeAFullTurn) {
  EXPECT_LT(wrapDegrees(-1e-30F), 360.0F);
  EXPECT_LT(wrapDegrees(-1e-300), 360.0);
  EXPECT_GE(wrapDegrees(-1e-300), 0.0);
}

TEST(Angle, StaysInRangeForEveryFiniteNumber) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200'000; ++i) {
    const auto mantissa = static_cast<double>(random() % 2'000'001) / 1e6 - 1.0;
    const double angle = std::ldexp(mantissa, static_cast<int>(random() % 400) - 200);
    const double wrapped = wrapDegrees(angle);
    ASSERT_GE(wrapped, 0.0) << angle;
    ASSERT_LT(wrapped, 360.0) << angle;
    const double way = shortestAngle(angle, -angle);
    ASSERT_GE(way, -180.0) << angle;
    ASSERT_LT(way, 180.0) << angle;
  }
}

TEST(Angle, TakesTheShortWayAcrossZero) {
  EXPECT_DOUBLE_EQ(shortestAngle(350.0, 10.0), 20.0);
  EXPECT_DOUBLE_EQ(shortestAngle(10.0, 350.0), -20.0);
  EXPECT_DOUBLE_EQ(shortestAngle(-170.0, 170.0), -20.0);
  EXPECT_DOUBLE_EQ(shortestAngle(0.0, 180.0), -180.0);
  EXPECT_DOUBLE_EQ(shortestAngle(5.0, 725.0), 0.0);
}

TEST(Angle, WrapsIntoHalfATurnEitherWayWithoutRounding) {
  EXPECT_EQ(wrapHalfTurn(190.0), -170.0);
  EXPECT_EQ(wrapHalfTurn(-190.0), 170.0);
  EXPECT_EQ(wrapHalfTurn(180.0), 180.0);
  EXPECT_EQ(wrapHalfTurn(-180.0), -180.0);
  EXPECT_EQ(wrapHalfTurn(0x1p-40), 0x1p-40);
  EXPECT_EQ(wrapHalfTurn(360.0 * 0x1p30 + 90.0), 90.0);
  EXPECT_TRUE(std::isnan(wrapHalfTurn(std::numeric_limits<double>::infinity())));
}

TEST(Angle, NotANumberStaysNotANumber) {
  EXPECT_TRUE(std::isnan(wrapDegrees(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace rc10::test::angle_test
