#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "app/feedforward.hpp"
#include "app/impedance.hpp"

namespace rc10::test::controllers_test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kNanDouble = std::numeric_limits<double>::quiet_NaN();

TEST(Feedforward, AddsWhatVelocityAndAccelerationNeed) {
  const Feedforward feedforward({.per_rpm = 0.01F, .per_rpm_s = 0.002F});
  EXPECT_FLOAT_EQ(feedforward.output({.velocity_rpm = 100.0F, .acceleration_rpm_s = -300.0F}), 1.0F - 0.6F);
}

TEST(Feedforward, FrictionHasNoStepAtRest) {
  const Feedforward feedforward({.friction = 0.5F, .friction_rpm = 2.0F});
  EXPECT_EQ(feedforward.output({.velocity_rpm = 0.0F}), 0.0F);
  EXPECT_NEAR(feedforward.output({.velocity_rpm = 0.02F}), 0.005F, 1e-5F);
  EXPECT_NEAR(feedforward.output({.velocity_rpm = 2.0F}), 0.5F * std::tanh(1.0F), 1e-6F);
  EXPECT_NEAR(feedforward.output({.velocity_rpm = -100.0F}), -0.5F, 1e-6F);
}

TEST(Feedforward, FrictionWithoutAWidthIsTheSignAndNothingAtRest) {
  for (const float width : {0.0F, -1.0F, kNan}) {
    const Feedforward feedforward({.friction = 0.5F, .friction_rpm = width});
    EXPECT_EQ(feedforward.output({.velocity_rpm = 1e-6F}), 0.5F);
    EXPECT_EQ(feedforward.output({.velocity_rpm = -1e-6F}), -0.5F);
    EXPECT_EQ(feedforward.output({.velocity_rpm = 0.0F}), 0.0F);
  }
}

TEST(Feedforward, GravityPullsMostWhereTheArmIsLevel) {
  const Feedforward feedforward({.gravity = 4.0F, .gravity_deg = 30.0F});
  EXPECT_NEAR(feedforward.output({.angle_deg = 30.0}), 4.0F, 1e-5F);
  EXPECT_NEAR(feedforward.output({.angle_deg = 90.0}), 2.0F, 1e-5F);
  EXPECT_NEAR(feedforward.output({.angle_deg = 120.0}), 0.0F, 1e-5F);
  EXPECT_NEAR(feedforward.output({.angle_deg = 210.0 + 3600.0}), -4.0F, 1e-5F);
}

TEST(Feedforward, AnArmThatFallsWithoutItStaysWhereItIs) {
  // 2 kg at 0.3 m: 5.886 N m level. The arm as a pendulum, held by the feedforward alone.
  const Feedforward feedforward({.gravity = 2.0F * 9.81F * 0.3F});
  double angle_deg = 40.0;
  double velocity_rad_s = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double pull_nm = -2.0 * 9.81 * 0.3 * std::cos(angle_deg * std::acos(-1.0) / 180.0);
    const auto hold_nm = static_cast<double>(feedforward.output({.angle_deg = angle_deg}));
    velocity_rad_s += (pull_nm + hold_nm) / (2.0 * 0.3 * 0.3) * 0.001;
    angle_deg += velocity_rad_s * 180.0 / std::acos(-1.0) * 0.001;
  }
  EXPECT_NEAR(angle_deg, 40.0, 1e-3);
}

TEST(Feedforward, InputThatIsNotFiniteGivesNothing) {
  const Feedforward feedforward({.per_rpm = 1.0F, .per_rpm_s = 1.0F, .friction = 1.0F, .gravity = 1.0F});
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_EQ(feedforward.output({.angle_deg = static_cast<double>(bad)}), 0.0F);
    EXPECT_EQ(feedforward.output({.velocity_rpm = bad}), 0.0F);
    EXPECT_EQ(feedforward.output({.acceleration_rpm_s = bad}), 0.0F);
  }
  EXPECT_EQ(feedforward.output({.velocity_rpm = 3e38F, .acceleration_rpm_s = 3e38F}), 0.0F);
}

TEST(Impedance, IsASpringInRadiansAndADamper) {
  const Impedance spring({.stiffness_nm_per_rad = 10.0F});
  EXPECT_NEAR(spring.torque({.angle_deg = 180.0}, {.angle_deg = 90.0}), 10.0F * std::acos(0.0F), 1e-5F);
  const Impedance damper({.damping_nms_per_rad = 2.0F});
  EXPECT_NEAR(damper.torque({.velocity_rpm = 0.0F}, {.velocity_rpm = 30.0F}), -2.0F * std::acos(-1.0F),
              1e-5F);
  EXPECT_FLOAT_EQ(spring.torque({.torque_nm = 3.0F}, {}), 3.0F);
}

TEST(Impedance, ACircularSpringPullsTheShortestWay) {
  const Impedance spring({.stiffness_nm_per_rad = 1.0F, .circular = true});
  EXPECT_GT(spring.torque({.angle_deg = 10.0}, {.angle_deg = 350.0}), 0.0F);
  EXPECT_LT(spring.torque({.angle_deg = 350.0}, {.angle_deg = 10.0}), 0.0F);
  const Impedance straight({.stiffness_nm_per_rad = 1.0F});
  EXPECT_LT(straight.torque({.angle_deg = 10.0}, {.angle_deg = 350.0}), 0.0F);
}

TEST(Impedance, StaysWithinTheNarrowerLimit) {
  const Impedance spring({.stiffness_nm_per_rad = 100.0F, .torque_limit_nm = 5.0F});
  EXPECT_FLOAT_EQ(spring.torque({.angle_deg = 90.0}, {}), 5.0F);
  EXPECT_FLOAT_EQ(spring.torque({.angle_deg = -90.0}, {}, OutputRange::symmetric(2.0F)), -2.0F);
}

TEST(Impedance, AMassOnItComesToRestAtTheTarget) {
  // J = 0.1 kg m2, k = 10, d = 2 sqrt(k J): critically damped, w = 10 rad/s.
  const Impedance spring({.stiffness_nm_per_rad = 10.0F, .damping_nms_per_rad = 2.0F});
  double angle_deg = 0.0;
  double velocity_rpm = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const auto torque = static_cast<double>(spring.torque(
        {.angle_deg = 90.0}, {.angle_deg = angle_deg, .velocity_rpm = static_cast<float>(velocity_rpm)}));
    velocity_rpm += torque / 0.1 * 0.001 * 30.0 / std::acos(-1.0);
    angle_deg += 6.0 * velocity_rpm * 0.001;
    ASSERT_LE(angle_deg, 90.0 + 1e-3);
  }
  EXPECT_NEAR(angle_deg, 90.0, 1e-2);
}

TEST(Impedance, ANegativeSpringOrDamperIsNone) {
  for (const float bad : {-1.0F, kNan}) {
    const Impedance none({.stiffness_nm_per_rad = bad, .damping_nms_per_rad = bad});
    EXPECT_EQ(none.torque({.angle_deg = 90.0, .velocity_rpm = 10.0F}, {}), 0.0F);
  }
}

TEST(Impedance, InputThatIsNotFiniteGivesNoTorque) {
  const Impedance spring({.stiffness_nm_per_rad = 10.0F, .damping_nms_per_rad = 1.0F, .circular = true});
  EXPECT_EQ(spring.torque({.angle_deg = kNanDouble}, {}), 0.0F);
  EXPECT_EQ(spring.torque({}, {.angle_deg = kNanDouble}), 0.0F);
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_EQ(spring.torque({.velocity_rpm = bad}, {}), 0.0F);
    EXPECT_EQ(spring.torque({}, {.velocity_rpm = bad}), 0.0F);
    EXPECT_EQ(spring.torque({.torque_nm = bad}, {}), 0.0F);
  }
  EXPECT_TRUE(std::isfinite(Impedance({.stiffness_nm_per_rad = 1e38F}).torque({.angle_deg = 1e300}, {})));
}

}  // namespace
}  // namespace rc10::test::controllers_test
