// Cost of one step of each algorithm of src/app: see docs/algorithms.md.
//   app_bench [Google Benchmark's options]
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "app/differential_kinematics.hpp"
#include "app/encoder_pll.hpp"
#include "app/feedforward.hpp"
#include "app/homogeneous_transform.hpp"
#include "app/impedance.hpp"
#include "app/kalman_filter.hpp"
#include "app/low_pass.hpp"
#include "app/mecanum_kinematics.hpp"
#include "app/median_filter.hpp"
#include "app/moving_average.hpp"
#include "app/omni_kinematics.hpp"
#include "app/pid_incremental.hpp"
#include "app/pid_position.hpp"
#include "app/planar_odometry.hpp"
#include "app/s_curve_profile.hpp"
#include "app/slew_limiter.hpp"
#include "app/subnormals.hpp"
#include "app/swerve_kinematics.hpp"
#include "app/tracking_differentiator.hpp"
#include "app/trapezoid_profile.hpp"
#include "app/two_pole_filter.hpp"

namespace rc10::bench {
namespace {

constexpr float kDt = 0.001F;

/// Input that is different in each step, so that nothing is computed once and kept.
class Wave {
 public:
  Wave() {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = std::sin(0.1 * static_cast<double>(i));
  }
  double operator()() noexcept { return values_[next_++ % values_.size()]; }

 private:
  std::array<double, 256> values_{};
  std::size_t next_ = 0;
};

template <typename Step>
void add(const char* name, Step step) {
  benchmark::RegisterBenchmark(name, [step](benchmark::State& state) mutable {
    Wave wave;
    for (auto _ : state) {
      auto result = step(wave());
      benchmark::DoNotOptimize(result);
    }
  });
}

float narrow(double value) noexcept { return static_cast<float>(value); }

void addControllers() {
  add("pid_position", [pid = PID_Position({.kp = 1.0F, .ki = 2.0F, .kd = 0.1F})](double x) mutable {
    return pid.step(1.0F, narrow(x), kDt, 10.0F);
  });
  add("pid_incremental", [pid = PID_Incremental({.kp = 1.0F, .ki = 2.0F})](double x) mutable {
    return pid.step(1.0F, narrow(x), kDt, 10.0F);
  });
  add("feedforward", [law = Feedforward({.per_rpm = 0.1F, .friction = 0.2F, .gravity = 3.0F})](double x) {
    return law.output({.angle_deg = 90.0 * x, .velocity_rpm = narrow(x)});
  });
  add("impedance", [law = Impedance({.stiffness_nm_per_rad = 5.0F, .damping_nms_per_rad = 0.1F})](double x) {
    return law.torque({.angle_deg = 90.0}, {.angle_deg = 90.0 * x, .velocity_rpm = narrow(x)});
  });
}

/// A generator on its way to and fro: a new target every second.
template <typename Profile>
auto toAndFro(Profile profile) {
  return [profile, steps = 0](double) mutable {
    const double target = (steps++ / 1000) % 2 == 0 ? 20.0 : -20.0;
    return profile.step(target, kDt).position;
  };
}

void addProfiles() {
  add("trapezoid_profile", toAndFro(TrapezoidProfile({.velocity = 100.0, .acceleration = 400.0})));
  add("s_curve_profile", toAndFro(SCurveProfile({.velocity = 100.0, .acceleration = 800.0, .jerk = 8000.0})));
  add("s_curve_profile/target_that_moves_in_each_step",
      [profile = SCurveProfile({.velocity = 100.0, .acceleration = 800.0, .jerk = 8000.0})](
          double x) mutable { return profile.step(x, kDt).position; });
  add("tracking_differentiator",
      [tracker = TrackingDifferentiator(20.0F)](double x) mutable { return tracker.step(narrow(x), kDt); });
  add("slew_limiter", [limiter = SlewLimiter(5.0)](double x) mutable { return limiter.step(x, kDt); });
  add("twist_slew_limiter",
      [limiter = TwistSlewLimiter({.linear_m_s2 = 3.0, .angular_deg_s2 = 90.0})](double x) mutable {
        return limiter.step({x, -x, 90.0 * x}, kDt).vx_m_s;
      });
}

void addFilters() {
  add("low_pass", [filter = LowPass(30.0F)](double x) mutable { return filter.step(narrow(x), kDt); });
  add("butterworth_low_pass",
      [filter = ButterworthLowPass(30.0)](double x) mutable { return filter.step(x, kDt); });
  add("notch", [filter = Notch({.centre_hz = 50.0, .width_hz = 5.0})](double x) mutable {
    return filter.step(x, kDt);
  });
  add("moving_average/16", [filter = MovingAverage<16>()](double x) mutable { return filter.step(x); });
  add("median_filter/5", [filter = MedianFilter<5>()](double x) mutable { return filter.step(x); });
  add("median_filter/31", [filter = MedianFilter<31>()](double x) mutable { return filter.step(x); });
  add("encoder_pll", [pll = EncoderPll({.bandwidth_rad_s = 100.0})](double x) mutable {
    return pll.step(360.0 * x, kDt).velocity_rpm;
  });
  add("kalman_filter/2x1", [filter = KalmanFilter<2, 1>()](double x) mutable {
    (void)filter.predict(Eigen::Matrix2d{{1.0, 0.001}, {0.0, 1.0}}, Eigen::Matrix2d::Identity() * 1e-3);
    return filter.update(Eigen::Matrix<double, 1, 1>::Constant(x), Eigen::RowVector2d(1.0, 0.0),
                         Eigen::Matrix<double, 1, 1>::Constant(0.01));
  });
  add("kalman_filter/6x3", [filter = KalmanFilter<6, 3>()](double x) mutable {
    Eigen::Matrix<double, 6, 6> transition = Eigen::Matrix<double, 6, 6>::Identity();
    transition.topRightCorner<3, 3>().diagonal().setConstant(0.001);
    Eigen::Matrix<double, 3, 6> observation = Eigen::Matrix<double, 3, 6>::Zero();
    observation.leftCols<3>().setIdentity();
    (void)filter.predict(transition, Eigen::Matrix<double, 6, 6>::Identity() * 1e-3);
    return filter.update(Eigen::Vector3d::Constant(x), observation, Eigen::Matrix3d::Identity() * 0.01);
  });
}

/// A step of a chassis: wheels for a twist, limited, and back again into the pose.
template <typename Kinematics>
void addChassis(const char* name, const Kinematics& kinematics) {
  add(name, [kinematics, odometry = PlanarOdometry()](double x) mutable {
    const auto wheels = limited(kinematics.inverse({x, -x, 90.0 * x}), 300.0);
    return odometry.step(kinematics.forward(wheels), kDt).x_m;
  });
}

void addKinematics() {
  addChassis("mecanum_with_odometry",
             MecanumKinematics({.wheel_radius_m = 0.076, .half_track_m = 0.25, .half_wheelbase_m = 0.2}));
  addChassis("omni3_with_odometry", Omni3Kinematics({.wheel_radius_m = 0.076, .centre_distance_m = 0.25}));
  addChassis("omni4_with_odometry",
             Omni4Kinematics({.wheel_radius_m = 0.076, .half_track_m = 0.25, .half_wheelbase_m = 0.2}));
  addChassis("differential_with_odometry",
             DifferentialKinematics({.wheel_radius_m = 0.076, .half_track_m = 0.25}));
  add("swerve_with_odometry",
      [kinematics = SwerveKinematics({.wheel_radius_m = 0.05, .half_track_m = 0.25, .half_wheelbase_m = 0.2}),
       odometry = PlanarOdometry(), measured = SwerveModules()](double x) mutable {
        const SwerveModules wanted = limited(kinematics.inverse({x, -x, 90.0 * x}, measured), 300.0);
        measured = steered(wanted, measured);
        return odometry.step(kinematics.forward(measured), kDt).x_m;
      });
}

void addTransforms() {
  add("homogeneous_transform_2d/compose_and_apply", [arm = HomogeneousTransform2D(1.0, 2.0, 30.0)](double x) {
    return (arm * HomogeneousTransform2D(x, 0.0, 90.0 * x)).apply(Eigen::Vector2d(1.0, x)).x();
  });
  add("homogeneous_transform_3d/compose_and_apply",
      [arm = HomogeneousTransform3D(Eigen::Vector3d(1.0, 2.0, 3.0), EulerZyx{10.0, 20.0, 30.0})](double x) {
        const HomogeneousTransform3D hand(Eigen::Vector3d(x, 0.0, 0.0), EulerZyx{.pitch_deg = 90.0 * x});
        return (arm * hand).apply(Eigen::Vector3d(1.0, x, 0.0)).x();
      });
}

}  // namespace
}  // namespace rc10::bench

int main(int argc, char** argv) {
  using namespace rc10::bench;
  rc10::flushSubnormals();  // as the scheduler's thread
  addControllers();
  addProfiles();
  addFilters();
  addKinematics();
  addTransforms();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
