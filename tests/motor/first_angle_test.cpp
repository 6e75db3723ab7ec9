#include "motor/first_angle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/angle.hpp"
#include "app/units.hpp"
#include "motor/angle_reference.hpp"

namespace rc10::first_angle_test {
namespace {

constexpr Travel kArm{-90.0, 200.0};

TEST(FirstAngle, WithoutBothLimitsIsWithinHalfATurn) {
  EXPECT_DOUBLE_EQ(firstAngle(190.0, {}).value(), -170.0);
  EXPECT_DOUBLE_EQ(firstAngle(190.0, {.min_deg = 0.0}).value(), -170.0);
  EXPECT_DOUBLE_EQ(firstAngle(-190.0, {.max_deg = 0.0}).value(), 170.0);
}

TEST(FirstAngle, WithoutBothLimitsIsOnTheTurnNearestToWhereItWas) {
  EXPECT_DOUBLE_EQ(firstAngle(5.0, {}, 725.0).value(), 725.0);
  EXPECT_DOUBLE_EQ(firstAngle(-170.0, {.min_deg = 0.0}, 545.0).value(), 550.0);
  EXPECT_DOUBLE_EQ(firstAngle(5.0, kArm, 725.0).value(), 5.0) << "its travel says which";
}

TEST(FirstAngle, IsRightOverTheWholeTravelAndHalfTheGapBeyond) {
  for (const Travel travel : {kArm, Travel{100.0, 440.0}, Travel{-3000.0, -2990.0}, Travel{0.0, 359.0}}) {
    const double gap_deg = kDegPerTurn - (travel.max_deg - travel.min_deg);
    const double beyond_deg = std::max(gap_deg / 2 - 1.01, -1.0);
    for (double deg = travel.min_deg - beyond_deg; deg <= travel.max_deg + beyond_deg; deg += 0.25) {
      const auto first = firstAngle(shortestAngle(0.0, deg), travel);
      ASSERT_TRUE(first) << deg;
      EXPECT_NEAR(*first, deg, 1e-9);
    }
  }
}

TEST(FirstAngle, IsNotGuessedInTheMiddleOfTheGapNorWhereTheTravelIsATurn) {
  EXPECT_FALSE(firstAngle(235.0, kArm));
  EXPECT_FALSE(firstAngle(-125.5, kArm));
  for (double deg = -180.0; deg < 180.0; deg += 1.0) {
    EXPECT_FALSE(firstAngle(deg, {-180.0, 180.0}));
    EXPECT_FALSE(firstAngle(deg, {-1e6, 1e6}));
  }
}

TEST(FirstAngle, IsDoubtedWithinADegreeOfTheMiddleOfTheGap) {
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(firstAngle(55.0 + sign * 179.0, kArm)) << sign;
    EXPECT_FALSE(firstAngle(55.0 + sign * 179.01, kArm)) << sign;
  }
}

TEST(FirstAngle, OfAShaftThatIsTurnedByHandBecomesClear) {
  AngleReference reference({.absolute = true, .zero_deg = 10.0, .travel = kArm});
  reference.update(245.0);
  EXPECT_TRUE(reference.turnUnclear());
  EXPECT_FALSE(reference.known());
  reference.update(220.0, false);
  EXPECT_TRUE(reference.turnUnclear()) << "something follows the angle: it must not jump";
  reference.update(200.0);
  EXPECT_FALSE(reference.turnUnclear());
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 190.0);
}

TEST(FirstAngle, ThatIsUnclearIsSetByRequest) {
  AngleReference reference({.absolute = true, .travel = {-720.0, 720.0}});
  reference.update(10.0);
  EXPECT_TRUE(reference.turnUnclear());
  EXPECT_TRUE(reference.setZero(370.0));
  reference.update(11.0);
  EXPECT_TRUE(reference.known());
  EXPECT_DOUBLE_EQ(reference.totalAngleDeg(), 371.0);
}

}  // namespace
}  // namespace rc10::first_angle_test
