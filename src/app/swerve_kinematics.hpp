#pragma once

#include <array>

#include "app/planar_motion.hpp"
#include "app/wheel_speeds.hpp"

namespace rc10 {

/// One steered wheel. At 0 degrees it rolls forward, at 90 to the left.
struct SwerveModule {
  double speed_rpm = 0.0;
  double angle_deg = 0.0;  ///< [0, 360) where this project computes it.
};

[[nodiscard]] constexpr double& speedOf(SwerveModule& module) noexcept { return module.speed_rpm; }

struct SwerveModules {
  SwerveModule front_left;
  SwerveModule front_right;
  SwerveModule rear_left;
  SwerveModule rear_right;

  static constexpr std::array<SwerveModule SwerveModules::*, 4> kAll{
      &SwerveModules::front_left, &SwerveModules::front_right, &SwerveModules::rear_left,
      &SwerveModules::rear_right};
};

/// Four steered and driven wheels at the corners. A step of a chassis:
///   wanted = inverse(twist, measured);  wanted = limited(wanted, limit_rpm);  wanted = steered(wanted,
///   measured);
///
/// Input that is not finite: speed 0, angles as measured (0 where these are not finite).
class SwerveKinematics {
 public:
  struct Geometry {
    double wheel_radius_m = 0.0;
    double half_track_m = 0.0;      ///< From the middle of the robot sideways to the steering axes.
    double half_wheelbase_m = 0.0;  ///< From the middle of the robot forward to the steering axes.
    /// A wheel that is to be slower than this stays as it stands, with speed 0: the direction of a
    /// tiny velocity is noise.
    double rest_below_m_s = 1e-3;
  };

  explicit SwerveKinematics(const Geometry& geometry) noexcept;

  /// Speeds (never negative) and angles for a motion. `measured` gives the angle of wheels at rest.
  [[nodiscard]] SwerveModules inverse(const Twist2D& twist, const SwerveModules& measured) const noexcept;
  /// The motion from speeds and angles: least squares, for eight numbers are measured.
  [[nodiscard]] Twist2D forward(const SwerveModules& modules) const noexcept;

 private:
  WheelScale scale_;
  double half_track_m_;
  double half_wheelbase_m_;
  double rest_below_m_s_;
};

/// Way of a module to its command: it turns at most 90 degrees, backwards rolling where that is
/// the shorter way, and rolls only with the part of the speed that already points the right way
/// (cosine of what is left to turn), so that the robot does not drive off its path meanwhile.
[[nodiscard]] SwerveModule steered(const SwerveModule& wanted, double measured_angle_deg) noexcept;

/// The same for all four.
[[nodiscard]] SwerveModules steered(const SwerveModules& wanted, const SwerveModules& measured) noexcept;

}  // namespace rc10
