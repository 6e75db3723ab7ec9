// The fragments of docs/algorithms.md, compiled and run; tests/docs compares them with the page.
#include <vector>

#include <gtest/gtest.h>

#include "app/encoder_pll.hpp"
#include "app/feedforward.hpp"
#include "app/homogeneous_transform.hpp"
#include "app/impedance.hpp"
#include "app/kalman_filter.hpp"
#include "app/mecanum_kinematics.hpp"
#include "app/pid_incremental.hpp"
#include "app/pid_position.hpp"
#include "app/planar_odometry.hpp"
#include "app/s_curve_profile.hpp"
#include "app/slew_limiter.hpp"
#include "app/swerve_kinematics.hpp"
#include "app/two_pole_filter.hpp"

namespace rc10::test::algorithms_examples_test {
namespace {

TEST(AlgorithmsExamples, ACascadeOfPidsTakesTheShortestWay) {
  const float limit_a = 10.0F;
  PID_Position angle({.kp = 4.0F, .output_limit = 200.0F, .circular_period = 360.0F});  // deg to rpm
  PID_Incremental speed({.kp = 0.2F, .ki = 1.6F});                                      // rpm to A
  const float target_rpm = angle.step(10.0F, 350.0F, 0.001F);  // 20 degrees to go: the shortest way
  const float current_a = speed.step(target_rpm, 55.0F, 0.001F, limit_a);
  speed.retune({.kp = 0.3F, .ki = 2.4F});
  EXPECT_NEAR(target_rpm, 80.0F, 1e-3F);
  EXPECT_GT(current_a, 0.0F);
  EXPECT_EQ(speed.config().kp, 0.3F);
}

TEST(AlgorithmsExamples, AFeedforwardAddsSpeedFrictionAndGravity) {
  const Feedforward feedforward({.per_rpm = 0.01F, .friction = 0.3F, .gravity = 4.0F, .gravity_deg = 90.0F});
  const float current_a = feedforward.output({.angle_deg = 90.0, .velocity_rpm = 20.0F});
  EXPECT_NEAR(current_a, 4.5F, 1e-4F);
}

TEST(AlgorithmsExamples, ASpringPullsTowardsItsAngleAndDamps) {
  const Impedance spring({.stiffness_nm_per_rad = 20.0F, .damping_nms_per_rad = 0.5F});
  const float torque_nm = spring.torque({.angle_deg = 30.0}, {.angle_deg = 25.0, .velocity_rpm = 2.0F});
  EXPECT_NEAR(torque_nm, 1.6406F, 1e-3F);
}

TEST(AlgorithmsExamples, AnSCurveEndsAtItsTargetInTheTimeOfItsLimits) {
  std::vector<double> reference;
  SCurveProfile lift({.velocity = 360.0, .acceleration = 1800.0, .jerk = 18'000.0});  // degrees
  lift.reset(10.0);
  while (!lift.restsAt(720.0)) {
    const ProfileState& now = lift.step(720.0, 0.001F);
    reference.push_back(now.position);
  }
  EXPECT_EQ(reference.back(), 720.0);
  EXPECT_NEAR(static_cast<double>(reference.size()), 1000.0 * (710.0 / 360.0 + 0.2 + 0.1), 2.0);
}

TEST(AlgorithmsExamples, ASlewLimiterRisesByItsRate) {
  SlewLimiter throttle({.away_per_s = 3.0, .towards_per_s = 6.0});  // brakes harder than it accelerates
  const double speed_m_s = throttle.step(2.0, 0.01F);
  EXPECT_NEAR(speed_m_s, 0.03, 1e-6);
}

TEST(AlgorithmsExamples, FiltersPassTheirFirstValue) {
  ButterworthLowPass smooth(40.0);
  Notch resonance({.centre_hz = 85.0, .width_hz = 15.0});
  const double clean = resonance.step(smooth.step(12.5, 0.001F), 0.001F);
  EXPECT_EQ(clean, 12.5);
}

TEST(AlgorithmsExamples, AnEncoderPllTurnsAcrossTheEndOfItsRange) {
  EncoderPll pll({.bandwidth_rad_s = 100.0, .circular_period_deg = 360.0});
  (void)pll.step(359.9, 0.001F);  // the first sample only sets the angle
  const double velocity_rpm = pll.step(0.1, 0.001F).velocity_rpm;
  EXPECT_GT(velocity_rpm, 0.0);
}

TEST(AlgorithmsExamples, AKalmanFilterTakesAMeasurementWithinItsGate) {
  KalmanFilter<2, 1> height(Eigen::Vector2d(0.5, 0.0), Eigen::Matrix2d::Identity());  // m, m/s
  const Eigen::Matrix2d drift{{1.0, 0.01}, {0.0, 1.0}};
  (void)height.predict(drift, 1e-4 * Eigen::Matrix2d::Identity());
  const bool taken = height.update(Eigen::Matrix<double, 1, 1>(0.52), Eigen::RowVector2d(1.0, 0.0),
                                   Eigen::Matrix<double, 1, 1>(1e-3), 6.6);
  EXPECT_TRUE(taken);
  EXPECT_NEAR(height.state()(0), 0.52, 1e-3);
}

TEST(AlgorithmsExamples, AMecanumChassisComesAsFarAsItsWheelsRoll) {
  PlanarOdometry odometry;
  const MecanumKinematics chassis({.wheel_radius_m = 0.076, .half_track_m = 0.25, .half_wheelbase_m = 0.2});
  const Twist2D wanted = worldToBody({.vx_m_s = 1.0, .wz_deg_s = 90.0}, odometry.pose().heading_deg);
  const MecanumWheels wheels = limited(chassis.inverse(wanted), 400.0);
  const Pose2D& pose = odometry.step(chassis.forward(wheels), 0.001F);
  EXPECT_NEAR(pose.x_m, 0.001, 1e-6);
}

TEST(AlgorithmsExamples, ASwerveModuleRollsBackwardsInsteadOfTurning) {
  const SwerveModules measured{};
  const SwerveKinematics swerve({.wheel_radius_m = 0.05, .half_track_m = 0.3, .half_wheelbase_m = 0.3});
  SwerveModules modules = swerve.inverse({.vx_m_s = -1.0}, measured);
  modules = steered(limited(modules, 300.0), measured);
  EXPECT_LT(modules.front_left.speed_rpm, -100.0);  // backwards, without turning
  EXPECT_EQ(modules.front_left.angle_deg, 0.0);
}

TEST(AlgorithmsExamples, TransformsLeadFromTheCameraToTheField) {
  const PlanarOdometry odometry({.x_m = 2.0, .y_m = 1.0, .heading_deg = 90.0});
  const HomogeneousTransform2D world_to_base(odometry.pose());
  const HomogeneousTransform2D base_to_camera(0.3, 0.0, 180.0);
  const Eigen::Vector2d ball_m = (world_to_base * base_to_camera).apply(Eigen::Vector2d(1.5, 0.0));
  EXPECT_NEAR(ball_m.x(), 2.0, 1e-12);
  EXPECT_NEAR(ball_m.y(), 1.0 + 0.3 - 1.5, 1e-12);
}

}  // namespace
}  // namespace rc10::test::algorithms_examples_test
