#include "app/swerve_kinematics.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "app/angle.hpp"

namespace rc10::test::swerve_kinematics_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadiusM = 0.05;
constexpr double kRpm = 60.0 / (2.0 * std::numbers::pi * kRadiusM);
const SwerveModules kStraight{};

SwerveKinematics swerve(double rest_below_m_s = 1e-3) {
  return SwerveKinematics({.wheel_radius_m = kRadiusM,
                           .half_track_m = 0.3,
                           .half_wheelbase_m = 0.4,
                           .rest_below_m_s = rest_below_m_s});
}

TEST(Swerve, DrivesSidewaysWithAllWheelsToTheLeft) {
  const SwerveModules modules = swerve().inverse({.vy_m_s = 2.0}, kStraight);
  for (const auto module : SwerveModules::kAll) {
    EXPECT_NEAR((modules.*module).speed_rpm, 2.0 * kRpm, 1e-9);
    EXPECT_NEAR((modules.*module).angle_deg, 90.0, 1e-9);
  }
}

TEST(Swerve, TurnsOnTheSpotWithEachWheelAcrossItsLever) {
  const SwerveModules modules = swerve().inverse({.wz_deg_s = 180.0}, kStraight);
  // The front right wheel stands at (0.4, -0.3): it moves along (0.3, 0.4).
  EXPECT_NEAR(modules.front_right.angle_deg, toDegrees(std::atan2(0.4, 0.3)), 1e-9);
  EXPECT_NEAR(modules.front_left.angle_deg, toDegrees(std::atan2(0.4, -0.3)), 1e-9);
  EXPECT_NEAR(modules.rear_left.angle_deg, 360.0 + toDegrees(std::atan2(-0.4, -0.3)), 1e-9);
  EXPECT_NEAR(modules.rear_right.angle_deg, 360.0 + toDegrees(std::atan2(-0.4, 0.3)), 1e-9);
  for (const auto module : SwerveModules::kAll) {
    EXPECT_NEAR((modules.*module).speed_rpm, std::numbers::pi * 0.5 * kRpm, 1e-9);
  }
}

TEST(Swerve, ForwardUndoesInverse) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> linear(-4.0, 4.0);
  std::uniform_real_distribution<double> angular(-500.0, 500.0);
  const SwerveKinematics kinematics = swerve(0.0);
  for (int i = 0; i < 1000; ++i) {
    const Twist2D twist{linear(random), linear(random), angular(random)};
    const Twist2D driven = kinematics.forward(kinematics.inverse(twist, kStraight));
    EXPECT_NEAR(driven.vx_m_s, twist.vx_m_s, 1e-9);
    EXPECT_NEAR(driven.vy_m_s, twist.vy_m_s, 1e-9);
    EXPECT_NEAR(driven.wz_deg_s, twist.wz_deg_s, 1e-7);
  }
}

TEST(Swerve, ForwardIsTheMotionOfLeastSquaresWhenModulesContradictEachOther) {
  const SwerveKinematics kinematics = swerve(0.0);
  const SwerveModules measured{{100.0, 10.0}, {140.0, -20.0}, {90.0, 30.0}, {-60.0, 170.0}};
  const auto misfit = [&](const Twist2D& twist) {
    const SwerveModules fitted = kinematics.inverse(twist, kStraight);
    double sum = 0.0;
    for (const auto module : SwerveModules::kAll) {
      const SwerveModule& a = fitted.*module;
      const SwerveModule& b = measured.*module;
      sum += std::pow(a.speed_rpm * std::cos(toRadians(a.angle_deg)) -
                          b.speed_rpm * std::cos(toRadians(b.angle_deg)),
                      2.0) +
             std::pow(a.speed_rpm * std::sin(toRadians(a.angle_deg)) -
                          b.speed_rpm * std::sin(toRadians(b.angle_deg)),
                      2.0);
    }
    return sum;
  };
  const Twist2D best = kinematics.forward(measured);
  for (const double step : {-1e-3, 1e-3}) {
    for (const auto axis : {&Twist2D::vx_m_s, &Twist2D::vy_m_s, &Twist2D::wz_deg_s}) {
      Twist2D other = best;
      other.*axis += step;
      EXPECT_GT(misfit(other), misfit(best));
    }
  }
}

TEST(Swerve, WheelsKeepTheirAnglesAtRest) {
  const SwerveModules measured{{0.0, 10.0}, {0.0, 100.0}, {0.0, -90.0}, {0.0, 725.0}};
  for (const Twist2D& twist : {Twist2D{}, Twist2D{.vx_m_s = 1e-4}}) {
    const SwerveModules modules = swerve().inverse(twist, measured);
    EXPECT_EQ(modules.front_left.angle_deg, 10.0);
    EXPECT_EQ(modules.front_right.angle_deg, 100.0);
    EXPECT_EQ(modules.rear_left.angle_deg, 270.0);
    EXPECT_EQ(modules.rear_right.angle_deg, 5.0);
    EXPECT_EQ(fastest(modules), 0.0);
  }
}

TEST(Swerve, AModuleTurnsAtMostNinetyDegreesAndRollsBackwardsInstead) {
  const SwerveModule module = steered({.speed_rpm = 100.0, .angle_deg = 170.0}, 0.0);
  EXPECT_NEAR(module.angle_deg, 350.0, 1e-9);
  EXPECT_NEAR(module.speed_rpm, -100.0 * std::cos(toRadians(10.0)), 1e-9);
  for (double wanted_deg = -400.0; wanted_deg < 400.0; wanted_deg += 0.7) {
    for (double measured_deg = -800.0; measured_deg < 800.0; measured_deg += 77.7) {
      const SwerveModule to = steered({.speed_rpm = 100.0, .angle_deg = wanted_deg}, measured_deg);
      ASSERT_LE(std::abs(shortestAngle(measured_deg, to.angle_deg)), 90.0 + 1e-9);
      // A wheel that rolls in the wanted direction is never negative.
      const double along = to.speed_rpm * std::cos(toRadians(to.angle_deg - wanted_deg));
      ASSERT_GE(along, -1e-9);
      ASSERT_LE(along, 100.0 + 1e-9);
    }
  }
}

TEST(Swerve, AModuleRollsByTheCosineOfWhatItHasYetToTurn) {
  EXPECT_NEAR(steered({.speed_rpm = 100.0, .angle_deg = 60.0}, 0.0).speed_rpm, 50.0, 1e-9);
  EXPECT_NEAR(steered({.speed_rpm = 100.0, .angle_deg = 90.0}, 0.0).speed_rpm, 0.0, 1e-9);
  EXPECT_NEAR(steered({.speed_rpm = 100.0, .angle_deg = 42.0}, 42.0).speed_rpm, 100.0, 1e-9);
}

TEST(Swerve, AChassisThatTurnsItsModulesLimitsThemByOneFactor) {
  const SwerveKinematics kinematics = swerve();
  const SwerveModules wanted =
      limited(kinematics.inverse({.vx_m_s = 3.0, .vy_m_s = 1.0, .wz_deg_s = 200.0}, kStraight), 300.0);
  EXPECT_NEAR(fastest(wanted), 300.0, 1e-9);
  const Twist2D driven = kinematics.forward(wanted);
  EXPECT_NEAR(driven.vy_m_s / driven.vx_m_s, 1.0 / 3.0, 1e-9);
  EXPECT_NEAR(driven.wz_deg_s / driven.vx_m_s, 200.0 / 3.0, 1e-6);
  EXPECT_LE(fastest(steered(wanted, kStraight)), 300.0 + 1e-9);
}

TEST(Swerve, InputThatIsNotFiniteStopsTheWheelsAndKeepsTheirAngles) {
  const SwerveModules measured{{0.0, 10.0}, {0.0, 20.0}, {0.0, kNan}, {0.0, 40.0}};
  for (const double bad : {kNan, kInfinity, -kInfinity, 1e308}) {
    const SwerveModules modules = swerve().inverse({.vx_m_s = bad}, measured);
    EXPECT_EQ(fastest(modules), 0.0);
    EXPECT_EQ(modules.front_right.angle_deg, 20.0);
    EXPECT_EQ(modules.rear_left.angle_deg, 0.0);
    EXPECT_EQ(fastest(limited(modules, 100.0)), 0.0);
  }
  for (const double bad : {kNan, kInfinity}) {
    EXPECT_EQ(swerve().forward({{bad, 0.0}, {}, {}, {}}), Twist2D{});
    EXPECT_EQ(swerve().forward({{1.0, bad}, {}, {}, {}}), Twist2D{});
    EXPECT_EQ(steered({.speed_rpm = bad, .angle_deg = 5.0}, 30.0).speed_rpm, 0.0);
    EXPECT_EQ(steered({.speed_rpm = bad, .angle_deg = 5.0}, 30.0).angle_deg, 30.0);
    EXPECT_EQ(steered({.speed_rpm = 1.0, .angle_deg = 5.0}, bad).speed_rpm, 0.0);
  }
}

}  // namespace
}  // namespace rc10::test::swerve_kinematics_test
