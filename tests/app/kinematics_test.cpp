#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "app/differential_kinematics.hpp"
#include "app/mecanum_kinematics.hpp"
#include "app/omni_kinematics.hpp"
#include "app/wheel_speeds.hpp"

namespace rc10::test::kinematics_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadiusM = 0.076;
/// Speed of a wheel whose tread moves at 1 m/s.
constexpr double kRpm = 60.0 / (2.0 * std::numbers::pi * kRadiusM);

MecanumKinematics mecanum() {
  return MecanumKinematics({.wheel_radius_m = kRadiusM, .half_track_m = 0.25, .half_wheelbase_m = 0.2});
}
Omni3Kinematics omni3(Omni3Kinematics::MiddleWheel middle = Omni3Kinematics::MiddleWheel::kRear) {
  return Omni3Kinematics({.wheel_radius_m = kRadiusM, .centre_distance_m = 0.3, .middle_wheel = middle});
}
Omni4Kinematics omni4() {
  return Omni4Kinematics({.wheel_radius_m = kRadiusM, .half_track_m = 0.25, .half_wheelbase_m = 0.2});
}
DifferentialKinematics differential() {
  return DifferentialKinematics({.wheel_radius_m = kRadiusM, .half_track_m = 0.25});
}

class RandomTwists {
 public:
  Twist2D operator()() { return {linear_(random_), linear_(random_), angular_(random_)}; }

 private:
  std::mt19937 random_{11};
  std::uniform_real_distribution<double> linear_{-5.0, 5.0};
  std::uniform_real_distribution<double> angular_{-720.0, 720.0};
};

void expectNear(const Twist2D& twist, const Twist2D& expected, double tolerance = 1e-9) {
  EXPECT_NEAR(twist.vx_m_s, expected.vx_m_s, tolerance);
  EXPECT_NEAR(twist.vy_m_s, expected.vy_m_s, tolerance);
  EXPECT_NEAR(twist.wz_deg_s, expected.wz_deg_s, tolerance * 100.0);
}

template <typename Kinematics>
void expectIdentity(const Kinematics& kinematics) {
  RandomTwists twists;
  for (int i = 0; i < 1000; ++i) {
    const Twist2D twist = twists();
    expectNear(kinematics.forward(kinematics.inverse(twist)), twist);
  }
}

TEST(Mecanum, DrivesForwardWithAllWheelsAlike) {
  const MecanumWheels wheels = mecanum().inverse({.vx_m_s = 1.0});
  for (const auto wheel : MecanumWheels::kAll) EXPECT_NEAR(wheels.*wheel, kRpm, 1e-9);
}

TEST(Mecanum, DrivesLeftWithTheFrontLeftAndRearRightWheelsBackwards) {
  const MecanumWheels wheels = mecanum().inverse({.vy_m_s = 1.0});
  EXPECT_NEAR(wheels.front_left_rpm, -kRpm, 1e-9);
  EXPECT_NEAR(wheels.front_right_rpm, kRpm, 1e-9);
  EXPECT_NEAR(wheels.rear_left_rpm, kRpm, 1e-9);
  EXPECT_NEAR(wheels.rear_right_rpm, -kRpm, 1e-9);
}

TEST(Mecanum, TurnsCounterClockwiseWithTheLeftWheelsBackwardsByTheSumOfTheHalfDistances) {
  const MecanumWheels wheels = mecanum().inverse({.wz_deg_s = 180.0});
  const double rpm = std::numbers::pi * (0.25 + 0.2) * kRpm;
  EXPECT_NEAR(wheels.front_left_rpm, -rpm, 1e-9);
  EXPECT_NEAR(wheels.front_right_rpm, rpm, 1e-9);
  EXPECT_NEAR(wheels.rear_left_rpm, -rpm, 1e-9);
  EXPECT_NEAR(wheels.rear_right_rpm, rpm, 1e-9);
}

TEST(Omni3, DrivesForwardWithoutItsMiddleWheel) {
  const Omni3Wheels wheels = omni3().inverse({.vx_m_s = 1.0});
  EXPECT_NEAR(wheels.middle_rpm, 0.0, 1e-9);
  EXPECT_NEAR(wheels.right_rpm, kRpm * std::sqrt(0.75), 1e-9);
  EXPECT_NEAR(wheels.left_rpm, -kRpm * std::sqrt(0.75), 1e-9);
}

TEST(Omni3, AMiddleWheelAtTheRearTurnsBackwardsOnTheWayToTheLeftAndOneInFrontForwards) {
  const Omni3Wheels rear = omni3().inverse({.vy_m_s = 1.0});
  EXPECT_NEAR(rear.middle_rpm, -kRpm, 1e-9);
  EXPECT_NEAR(rear.left_rpm, 0.5 * kRpm, 1e-9);
  EXPECT_NEAR(rear.right_rpm, 0.5 * kRpm, 1e-9);
  const Omni3Wheels front = omni3(Omni3Kinematics::MiddleWheel::kFront).inverse({.vy_m_s = 1.0});
  EXPECT_NEAR(front.middle_rpm, kRpm, 1e-9);
  EXPECT_NEAR(front.left_rpm, -0.5 * kRpm, 1e-9);
}

/// Reading of each wheel, from its place and rolling direction alone.
double rolled(const Twist2D& twist, double x_m, double y_m, double direction_deg) {
  const double w_rad_s = toRadians(twist.wz_deg_s);
  const double vx = twist.vx_m_s - w_rad_s * y_m;
  const double vy = twist.vy_m_s + w_rad_s * x_m;
  return kRpm * (vx * std::cos(toRadians(direction_deg)) + vy * std::sin(toRadians(direction_deg)));
}

TEST(Omni, EveryWheelRollsByWhatItsPlaceMovesInItsDirection) {
  RandomTwists twists;
  for (int i = 0; i < 200; ++i) {
    const Twist2D twist = twists();
    const Omni4Wheels four = omni4().inverse(twist);
    EXPECT_NEAR(four.front_left_rpm, rolled(twist, 0.2, 0.25, 135.0), 1e-9);
    EXPECT_NEAR(four.front_right_rpm, rolled(twist, 0.2, -0.25, 45.0), 1e-9);
    EXPECT_NEAR(four.rear_left_rpm, rolled(twist, -0.2, 0.25, 225.0), 1e-9);
    EXPECT_NEAR(four.rear_right_rpm, rolled(twist, -0.2, -0.25, 315.0), 1e-9);
    for (const auto middle : {Omni3Kinematics::MiddleWheel::kFront, Omni3Kinematics::MiddleWheel::kRear}) {
      const Omni3Wheels three = omni3(middle).inverse(twist);
      const bool rear = middle == Omni3Kinematics::MiddleWheel::kRear;
      const auto at = [&twist](double place_deg) {
        return rolled(twist, 0.3 * std::cos(toRadians(place_deg)), 0.3 * std::sin(toRadians(place_deg)),
                      place_deg + 90.0);
      };
      EXPECT_NEAR(three.left_rpm, at(rear ? 60.0 : 120.0), 1e-9);
      EXPECT_NEAR(three.right_rpm, at(rear ? -60.0 : -120.0), 1e-9);
      EXPECT_NEAR(three.middle_rpm, at(rear ? 180.0 : 0.0), 1e-9);
    }
  }
}

TEST(Differential, TurnsOnTheSpotWithOppositeSidesAndCannotDriveSideways) {
  const DifferentialWheels turn = differential().inverse({.vy_m_s = 3.0, .wz_deg_s = 180.0});
  EXPECT_NEAR(turn.right_rpm, std::numbers::pi * 0.25 * kRpm, 1e-9);
  EXPECT_NEAR(turn.left_rpm, -turn.right_rpm, 1e-9);
  EXPECT_EQ(differential().forward({.left_rpm = 10.0, .right_rpm = 30.0}).vy_m_s, 0.0);
}

TEST(Kinematics, ForwardUndoesInverse) {
  expectIdentity(mecanum());
  expectIdentity(omni3());
  expectIdentity(omni3(Omni3Kinematics::MiddleWheel::kFront));
  expectIdentity(omni4());
  RandomTwists twists;
  for (int i = 0; i < 1000; ++i) {
    Twist2D twist = twists();
    twist.vy_m_s = 0.0;
    expectNear(differential().forward(differential().inverse(twist)), twist);
  }
}

/// The sum of the squared differences between the wheels and those a motion would have.
template <typename Kinematics, typename Wheels>
double misfit(const Kinematics& kinematics, const Wheels& wheels, const Twist2D& twist) {
  const Wheels fitted = kinematics.inverse(twist);
  double sum = 0.0;
  for (const auto wheel : Wheels::kAll) sum += std::pow(fitted.*wheel - wheels.*wheel, 2.0);
  return sum;
}

template <typename Kinematics, typename Wheels>
void expectLeastSquares(const Kinematics& kinematics, const Wheels& wheels) {
  const Twist2D best = kinematics.forward(wheels);
  const double least = misfit(kinematics, wheels, best);
  for (const double step : {-1e-3, 1e-3}) {
    for (const auto axis : {&Twist2D::vx_m_s, &Twist2D::vy_m_s, &Twist2D::wz_deg_s}) {
      Twist2D other = best;
      other.*axis += step;
      EXPECT_GT(misfit(kinematics, wheels, other), least);
    }
  }
}

TEST(Kinematics, FourWheelsThatContradictEachOtherGiveTheMotionOfLeastSquares) {
  expectLeastSquares(mecanum(), MecanumWheels{100.0, 130.0, 90.0, -40.0});
  expectLeastSquares(omni4(), Omni4Wheels{100.0, 130.0, 90.0, -40.0});
}

TEST(Limited, AllWheelsSlowDownByOneFactorSoThatTheDirectionStays) {
  const Twist2D twist{.vx_m_s = 3.0, .vy_m_s = -1.0, .wz_deg_s = 90.0};
  const MecanumWheels slow = limited(mecanum().inverse(twist), 200.0);
  EXPECT_NEAR(fastest(slow), 200.0, 1e-9);
  const Twist2D driven = mecanum().forward(slow);
  EXPECT_NEAR(driven.vy_m_s / driven.vx_m_s, -1.0 / 3.0, 1e-12);
  EXPECT_NEAR(driven.wz_deg_s / driven.vx_m_s, 30.0, 1e-9);
  EXPECT_LT(driven.vx_m_s, 3.0);
}

TEST(Limited, WheelsWithinTheLimitStayAsTheyAre) {
  const DifferentialWheels wheels = limited(DifferentialWheels{-90.0, 100.0}, 100.0);
  EXPECT_EQ(wheels.left_rpm, -90.0);
  EXPECT_EQ(wheels.right_rpm, 100.0);
}

TEST(Limited, ALimitThatMakesNoSenseAllowsNothing) {
  for (const double limit : {0.0, -5.0, kNan}) {
    EXPECT_EQ(fastest(limited(DifferentialWheels{-90.0, 100.0}, limit)), 0.0);
  }
  EXPECT_EQ(fastest(limited(DifferentialWheels{kNan, 100.0}, 50.0)), 0.0);
  EXPECT_EQ(fastest(limited(DifferentialWheels{-90.0, 100.0}, kInfinity)), 100.0);
}

template <typename Kinematics>
void expectRest(const Kinematics& kinematics, const Twist2D& twist) {
  EXPECT_EQ(fastest(kinematics.inverse(twist)), 0.0);
}

TEST(Kinematics, InputThatIsNotFiniteOrTooLargeIsRest) {
  for (const double bad : {kNan, kInfinity, -kInfinity, 1e308}) {
    for (const Twist2D& twist : {Twist2D{bad, 0.0, 0.0}, Twist2D{1.0, bad, 0.0}, Twist2D{1.0, 1.0, bad}}) {
      if (std::isfinite(bad) && twist.wz_deg_s == bad) continue;  // in rad/s and with short levers it fits
      expectRest(mecanum(), twist);
      expectRest(omni3(), twist);
      expectRest(omni4(), twist);
      if (!std::isfinite(bad)) expectRest(differential(), twist);
    }
    if (std::isfinite(bad)) continue;
    EXPECT_EQ(mecanum().forward({bad, 1.0, 1.0, 1.0}), Twist2D{});
    EXPECT_EQ(omni3().forward({bad, 1.0, 1.0}), Twist2D{});
    EXPECT_EQ(omni4().forward({1.0, bad, 1.0, 1.0}), Twist2D{});
    EXPECT_EQ(differential().forward({1.0, bad}), Twist2D{});
  }
}

TEST(Kinematics, AWheelWithoutARadiusNeverMoves) {
  for (const double radius_m : {0.0, -1.0, kNan, kInfinity, 1e-320}) {
    const MecanumKinematics none({.wheel_radius_m = radius_m, .half_track_m = 0.25, .half_wheelbase_m = 0.2});
    expectRest(none, {.vx_m_s = 1.0, .wz_deg_s = 10.0});
    EXPECT_EQ(none.forward({100.0, 100.0, 100.0, 100.0}), Twist2D{});
  }
}

TEST(Kinematics, WithoutALeverTheTurnIsUnknownAndZero) {
  const DifferentialKinematics narrow({.wheel_radius_m = kRadiusM, .half_track_m = 0.0});
  EXPECT_EQ(narrow.forward({.left_rpm = -10.0, .right_rpm = 10.0}), Twist2D{});
}

TEST(MeanRpm, IsTheTurnOfTheWheelOverTheTime) {
  EXPECT_NEAR(meanRpm(100.0, 136.0, 0.1F), 60.0, 1e-5);  // a tenth of a turn in a tenth of a second
  for (const float dt_s : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_EQ(meanRpm(0.0, 1.0, dt_s), 0.0);
  }
}

TEST(Twist, IsTurnedBetweenTheFramesOfWorldAndRobot) {
  // The robot looks to the left (y of the world): the world's x is to its right.
  expectNear(worldToBody({.vx_m_s = 1.0, .wz_deg_s = 5.0}, 90.0), {.vy_m_s = -1.0, .wz_deg_s = 5.0});
  expectNear(bodyToWorld({.vx_m_s = 1.0, .wz_deg_s = 5.0}, 90.0), {.vy_m_s = 1.0, .wz_deg_s = 5.0});
  EXPECT_EQ(worldToBody({.vx_m_s = 1.0}, kNan), Twist2D{});
}

}  // namespace
}  // namespace rc10::test::kinematics_test
