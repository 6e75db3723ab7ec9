#include <cmath>

#include <gtest/gtest.h>

#include "app/differential_kinematics.hpp"
#include "app/encoder_pll.hpp"
#include "app/feedforward.hpp"
#include "app/homogeneous_transform.hpp"
#include "app/impedance.hpp"
#include "app/kalman_filter.hpp"
#include "app/mecanum_kinematics.hpp"
#include "app/median_filter.hpp"
#include "app/moving_average.hpp"
#include "app/omni_kinematics.hpp"
#include "app/planar_odometry.hpp"
#include "app/s_curve_profile.hpp"
#include "app/slew_limiter.hpp"
#include "app/swerve_kinematics.hpp"
#include "app/trapezoid_profile.hpp"
#include "app/two_pole_filter.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::algorithms_allocation_test {
namespace {

constexpr float kDt = 0.001F;

TEST(Algorithms, AllocateNothing) {
  const AllocGuard guard;
  TrapezoidProfile trapezoid({.velocity = 100.0, .acceleration = 400.0});
  SCurveProfile s_curve({.velocity = 100.0, .acceleration = 400.0, .jerk = 4000.0});
  SlewLimiter slew(1.0);
  ButterworthLowPass low_pass(30.0);
  Notch notch({.centre_hz = 50.0, .width_hz = 5.0});
  MovingAverage<16> average;
  MedianFilter<15> median;
  EncoderPll pll({.bandwidth_rad_s = 100.0});
  KalmanFilter<6, 3> kalman;
  const MecanumKinematics mecanum({.wheel_radius_m = 0.1, .half_track_m = 0.2, .half_wheelbase_m = 0.2});
  const Omni3Kinematics omni3({.wheel_radius_m = 0.1, .centre_distance_m = 0.2});
  const Omni4Kinematics omni4({.wheel_radius_m = 0.1, .half_track_m = 0.2, .half_wheelbase_m = 0.2});
  const DifferentialKinematics differential({.wheel_radius_m = 0.1, .half_track_m = 0.2});
  const SwerveKinematics swerve({.wheel_radius_m = 0.1, .half_track_m = 0.2, .half_wheelbase_m = 0.2});
  const Feedforward feedforward({.per_rpm = 1.0F, .gravity = 2.0F});
  const Impedance impedance({.stiffness_nm_per_rad = 1.0F});
  PlanarOdometry odometry;
  SwerveModules modules;
  HomogeneousTransform2D flat;
  HomogeneousTransform3D spatial;
  double sum = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double x = 0.01 * (i % 100) - 0.5;
    const Twist2D twist{x, -x, 90.0 * x};
    sum += trapezoid.step(10.0 * x, kDt).position + s_curve.step(10.0 * x, kDt).position + slew.step(x, kDt);
    sum += low_pass.step(x, kDt) + notch.step(x, kDt) + average.step(x) + median.step(x);
    sum += pll.step(x, kDt).velocity_rpm;
    (void)kalman.predict(Eigen::Matrix<double, 6, 6>::Identity(), Eigen::Matrix<double, 6, 6>::Identity());
    (void)kalman.update(Eigen::Vector3d::Constant(x), Eigen::Matrix<double, 3, 6>::Identity(),
                        Eigen::Matrix3d::Identity());
    (void)odometry.step(mecanum.forward(limited(mecanum.inverse(twist), 10.0)), kDt);
    (void)odometry.step(omni3.forward(limited(omni3.inverse(twist), 10.0)), kDt);
    (void)odometry.step(omni4.forward(limited(omni4.inverse(twist), 10.0)), kDt);
    (void)odometry.step(differential.forward(limited(differential.inverse(twist), 10.0)), kDt);
    modules = steered(limited(swerve.inverse(twist, modules), 10.0), modules);
    (void)odometry.step(swerve.forward(modules), kDt);
    sum += static_cast<double>(feedforward.output({.angle_deg = x}) + impedance.torque({.angle_deg = x}, {}));
    flat = flat * HomogeneousTransform2D(odometry.pose()).inverse();
    spatial = spatial * HomogeneousTransform3D(Eigen::Vector3d(x, x, x), EulerZyx{x, x, x}).inverse();
    sum += flat.apply(Eigen::Vector2d(x, x)).x() + spatial.apply(spatial.pose()).z_m;
  }
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_TRUE(std::isfinite(sum + kalman.state()(0)));
}

}  // namespace
}  // namespace rc10::test::algorithms_allocation_test
