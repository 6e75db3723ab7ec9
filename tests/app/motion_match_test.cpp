#include "app/motion_match.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include <gtest/gtest.h>

namespace rc10::test::motion_match_test {
namespace {

using Sign = MotionMatch::Sign;

/// A shaft on a vehicle that turns as well, seen by its motor and by a sensor that is late.
class MotionMatchTest : public ::testing::Test {
 protected:
  void run(double seconds) {
    const auto ticks = static_cast<int>(std::lround(seconds / static_cast<double>(dt_s)));
    for (int i = 0; i < ticks; ++i) {
      now_s += static_cast<double>(dt_s);
      const double motor = std::sin(30.0 * now_s) * motor_size;
      past.push_front(sign * motor + std::sin(vehicle_rad_s * now_s) * vehicle_size);
      if (past.size() > 200) past.pop_back();
      if (i % every == 0) sensor = past[std::min(lag, past.size() - 1)];
      match.step(motor, sensor, dt_s);
    }
  }

  MotionMatch match{{.enough = 0.1}};
  std::deque<double> past;
  float dt_s = 0.001F;
  double now_s = 0.0;
  double motor_size = 10.0;
  double vehicle_size = 0.0;
  double vehicle_rad_s = 7.0;
  double sign = 1.0;
  double sensor = 0.0;
  std::size_t lag = 0;
  int every = 1;
};

TEST_F(MotionMatchTest, TellsTheLagInWholeTicks) {
  for (const std::size_t ticks : {0U, 1U, 7U, 20U, 39U}) {
    match = MotionMatch{{.enough = 0.1}};
    lag = ticks;
    run(1.0);
    ASSERT_TRUE(match.lagSeconds().has_value()) << ticks;
    EXPECT_NEAR(*match.lagSeconds(), 0.001 * static_cast<double>(ticks), 1e-6);
    EXPECT_NEAR(match.motorThen(), sensor, 1e-9);
    EXPECT_EQ(match.sign(), Sign::kAgrees);
  }
}

TEST_F(MotionMatchTest, AfterAGapTheMotorsSpeedOfBeforeItIsNotThatOfThen) {
  lag = 7;
  run(1.0);
  ASSERT_TRUE(match.lagSeconds().has_value());
  match.step(0.0, std::numeric_limits<double>::quiet_NaN(), dt_s);
  for (int i = 0; i < 7; ++i) {
    match.step(0.0, 0.0, dt_s);
    EXPECT_TRUE(std::isnan(match.motorThen())) << i;
  }
  match.step(0.0, 0.0, dt_s);
  EXPECT_EQ(match.motorThen(), 0.0);
}

TEST_F(MotionMatchTest, ASlowSensorsLagIsThatOfANewValue) {
  every = 10;
  lag = 12;
  run(2.0);
  ASSERT_TRUE(match.lagSeconds().has_value());
  EXPECT_NEAR(*match.lagSeconds(), 0.012, 1e-6);
}

TEST_F(MotionMatchTest, HoldsInTicksOfOtherPeriods) {
  for (const float period_s : {0.0005F, 0.002F, 0.005F}) {
    match = MotionMatch{{.enough = 0.1}};
    dt_s = period_s;
    lag = 4;
    run(2.0);
    ASSERT_TRUE(match.lagSeconds().has_value()) << period_s;
    EXPECT_NEAR(*match.lagSeconds(), 4.0 * static_cast<double>(period_s), 1e-6);
  }
}

TEST_F(MotionMatchTest, AReversedSensorIsOpposedAndHasNoLag) {
  sign = -1.0;
  lag = 7;
  run(0.3);
  EXPECT_EQ(match.sign(), Sign::kOpposed);
  EXPECT_FALSE(match.lagSeconds().has_value());
}

TEST_F(MotionMatchTest, AnEvenAccelerationTellsTheSignButNoLag) {
  for (int i = 0; i < 1000; ++i) match.step(0.02 * i, 0.02 * i, dt_s);
  EXPECT_EQ(match.sign(), Sign::kAgrees);
  EXPECT_FALSE(match.lagSeconds().has_value());
}

TEST_F(MotionMatchTest, MotionOfTheVehicleTeachesNothing) {
  vehicle_size = 30.0;
  vehicle_rad_s = 23.0;
  run(5.0);
  EXPECT_EQ(match.sign(), Sign::kUnknown);
  EXPECT_FALSE(match.lagSeconds().has_value());
}

TEST_F(MotionMatchTest, NothingIsJudgedBeforeEnoughHasMoved) {
  motor_size = 0.05;
  run(5.0);
  EXPECT_EQ(match.sign(), Sign::kUnknown);
}

TEST_F(MotionMatchTest, AGapIsNotMeasuredAcross) {
  lag = 5;
  run(1.0);
  for (int i = 0; i < 100; ++i) match.step(10.0, std::numeric_limits<double>::quiet_NaN(), dt_s);
  EXPECT_FALSE(match.fresh());
  lag = 20;
  past.clear();
  run(0.05);
  EXPECT_NEAR(*match.lagSeconds(), 0.005, 1e-6) << "not enough ticks since the gap";
  run(8.0);
  EXPECT_NEAR(*match.lagSeconds(), 0.020, 1e-6);
}

TEST_F(MotionMatchTest, ASensorThatWasAwayLongEnoughToBeMountedAnewIsFoundAnew) {
  const auto away = [this](int ticks) {
    for (int i = 0; i < ticks; ++i) match.step(10.0, std::numeric_limits<double>::quiet_NaN(), dt_s);
    past.clear();
  };
  run(1.0);
  away(1900);
  EXPECT_EQ(match.sign(), Sign::kAgrees);
  run(0.01);
  away(2001);
  EXPECT_EQ(match.sign(), Sign::kUnknown);
  sign = -1.0;
  run(1.0);
  EXPECT_EQ(match.sign(), Sign::kOpposed);
  away(5000);
  EXPECT_EQ(match.sign(), Sign::kOpposed) << "a loose plug mends no sign";
}

TEST_F(MotionMatchTest, AnAngleThatWrapsIsNoJump) {
  match = MotionMatch{{.enough = 0.1, .circular_period = 360.0}};
  for (int i = 0; i < 2000; ++i) {
    const double angle = 0.5 * i + 20.0 * std::sin(0.02 * i);
    match.step(angle, std::remainder(angle, 360.0), dt_s);
  }
  ASSERT_TRUE(match.lagSeconds().has_value());
  EXPECT_EQ(*match.lagSeconds(), 0.0);
}

TEST_F(MotionMatchTest, ResetForgetsBoth) {
  run(1.0);
  match.reset();
  EXPECT_EQ(match.sign(), Sign::kUnknown);
  EXPECT_FALSE(match.lagSeconds().has_value());
}

}  // namespace
}  // namespace rc10::test::motion_match_test
