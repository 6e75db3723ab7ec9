#include "app/planar_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "app/angle.hpp"
#include "app/mecanum_kinematics.hpp"

namespace rc10::test::planar_odometry_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kDt = 0.001F;

TEST(PlanarOdometry, DrivesStraightWhereItLooks) {
  PlanarOdometry odometry({.x_m = 1.0, .y_m = 2.0, .heading_deg = 90.0});
  (void)odometry.step({.vx_m_s = 2.0, .vy_m_s = 1.0}, 0.5F);
  EXPECT_NEAR(odometry.pose().x_m, 0.5, 1e-12);
  EXPECT_NEAR(odometry.pose().y_m, 3.0, 1e-12);
  EXPECT_NEAR(odometry.pose().heading_deg, 90.0, 1e-12);
}

TEST(PlanarOdometry, AnArcIsExactInOneStepHoweverFarItTurns) {
  // A circle of radius 1 m, from (0, 0) heading along x: the middle is at (0, 1).
  for (const double turn_deg : {1e-9, 1e-3, 1.0, 90.0, 179.0, 270.0, 1000.0}) {
    PlanarOdometry odometry;
    (void)odometry.step({.vx_m_s = toRadians(turn_deg), .wz_deg_s = turn_deg}, 1.0F);
    EXPECT_NEAR(odometry.pose().x_m, std::sin(toRadians(turn_deg)), 1e-12) << turn_deg;
    EXPECT_NEAR(odometry.pose().y_m, 1.0 - std::cos(toRadians(turn_deg)), 1e-12) << turn_deg;
    EXPECT_NEAR(odometry.pose().heading_deg, wrapDegrees(turn_deg), 1e-9) << turn_deg;
  }
}

TEST(PlanarOdometry, ManySmallStepsAndOneLargeStepEndAtTheSamePlace) {
  const Twist2D twist{.vx_m_s = 1.2, .vy_m_s = -0.7, .wz_deg_s = 130.0};
  PlanarOdometry small({.heading_deg = 30.0});
  PlanarOdometry large({.heading_deg = 30.0});
  for (int i = 0; i < 1024; ++i) (void)small.step(twist, 1.0F / 1024.0F);
  (void)large.step(twist, 1.0F);
  EXPECT_NEAR(small.pose().x_m, large.pose().x_m, 1e-11);
  EXPECT_NEAR(small.pose().y_m, large.pose().y_m, 1e-11);
  EXPECT_NEAR(small.pose().heading_deg, large.pose().heading_deg, 1e-9);
}

TEST(PlanarOdometry, AMecanumRobotReturnsFromASquareByTheAnglesOfItsWheels) {
  const MecanumKinematics kinematics(
      {.wheel_radius_m = 0.076, .half_track_m = 0.25, .half_wheelbase_m = 0.2});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(0.5, 1.5);
  PlanarOdometry odometry;
  MecanumWheels angle_deg{};
  double farthest_m = 0.0;
  for (const Twist2D& side :
       {Twist2D{.vx_m_s = 1.0}, Twist2D{.vy_m_s = 1.0}, Twist2D{.vx_m_s = -1.0}, Twist2D{.vy_m_s = -1.0}}) {
    const MecanumWheels rpm = kinematics.inverse(side);
    double left_s = 1.0;
    while (left_s > 1e-9) {
      // Uneven steps, as samples come.
      const auto dt_s = static_cast<float>(std::min(0.001 * jitter(random), left_s));
      MecanumWheels mean{};
      for (const auto wheel : MecanumWheels::kAll) {
        const double before_deg = angle_deg.*wheel;
        angle_deg.*wheel += rpm.*wheel * 6.0 * static_cast<double>(dt_s);
        mean.*wheel = meanRpm(before_deg, angle_deg.*wheel, dt_s);
      }
      const Pose2D& pose = odometry.step(kinematics.forward(mean), dt_s);
      farthest_m = std::max(farthest_m, std::hypot(pose.x_m, pose.y_m));
      left_s -= static_cast<double>(dt_s);
    }
  }
  EXPECT_NEAR(farthest_m, std::numbers::sqrt2, 1e-6);
  EXPECT_NEAR(odometry.pose().x_m, 0.0, 1e-6);
  EXPECT_NEAR(odometry.pose().y_m, 0.0, 1e-6);
  EXPECT_NEAR(shortestAngle(0.0, odometry.pose().heading_deg), 0.0, 1e-9);
}

TEST(PlanarOdometry, TakesTheHeadingOfAnImuAndTheVelocityOfTheWheels) {
  PlanarOdometry odometry({.heading_deg = 350.0});
  // The wheels slip: they say that the robot does not turn.
  (void)odometry.step({.vx_m_s = 1.0}, 10.0, 1.0F);
  EXPECT_NEAR(odometry.pose().heading_deg, 10.0, 1e-12);
  EXPECT_NEAR(odometry.pose().y_m, 0.0, 1e-12);  // an arc from -10 to +10 degrees
  EXPECT_NEAR(odometry.pose().x_m, std::sin(toRadians(10.0)) / toRadians(10.0), 1e-12);
  (void)odometry.step({.vx_m_s = 1.0, .wz_deg_s = 10.0}, kNan, 1.0F);
  EXPECT_NEAR(odometry.pose().heading_deg, 20.0, 1e-12);
}

TEST(PlanarOdometry, HeadingStaysWithinATurn) {
  PlanarOdometry odometry;
  for (int i = 0; i < 10'000; ++i) {
    (void)odometry.step({.wz_deg_s = -700.0}, 0.01F);
    ASSERT_GE(odometry.pose().heading_deg, 0.0);
    ASSERT_LT(odometry.pose().heading_deg, 360.0);
  }
}

TEST(PlanarOdometry, InputThatMakesNoSenseLeavesThePoseAlone) {
  const Pose2D pose{.x_m = 1.0, .y_m = 2.0, .heading_deg = 3.0};
  PlanarOdometry odometry(pose);
  for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(odometry.step({.vx_m_s = bad}, kDt), pose);
    EXPECT_EQ(odometry.step({.wz_deg_s = bad}, kDt), pose);
    odometry.reset({.x_m = bad});
    EXPECT_EQ(odometry.pose(), pose);
  }
  for (const float dt_s : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_EQ(odometry.step({.vx_m_s = 1.0}, dt_s), pose);
    EXPECT_EQ(odometry.step({.vx_m_s = 1.0}, 50.0, dt_s), pose);
  }
  EXPECT_EQ(odometry.step({.vx_m_s = 1e300}, 1e30F), pose);
}

}  // namespace
}  // namespace rc10::test::planar_odometry_test
