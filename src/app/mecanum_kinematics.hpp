#pragma once

#include <array>

#include "app/planar_motion.hpp"
#include "app/wheel_speeds.hpp"

namespace rc10 {

/// Positive drives the robot forward.
struct MecanumWheels {
  double front_left_rpm = 0.0;
  double front_right_rpm = 0.0;
  double rear_left_rpm = 0.0;
  double rear_right_rpm = 0.0;

  static constexpr std::array<double MecanumWheels::*, 4> kAll{
      &MecanumWheels::front_left_rpm, &MecanumWheels::front_right_rpm, &MecanumWheels::rear_left_rpm,
      &MecanumWheels::rear_right_rpm};
};

/// Four mecanum wheels whose rollers, seen from above, have axles that form an X: those of front left
/// and rear right point forward and left.
///
/// With L = half track + half wheelbase (the users' L = lx + ly):
///   front left  = (vx - vy - w L) / r      front right = (vx + vy + w L) / r
///   rear left   = (vx + vy - w L) / r      rear right  = (vx - vy + w L) / r
/// Input that is not finite: rest.
class MecanumKinematics {
 public:
  struct Geometry {
    double wheel_radius_m = 0.0;
    double half_track_m = 0.0;      ///< From the middle of the robot sideways to the wheels.
    double half_wheelbase_m = 0.0;  ///< From the middle of the robot forward to the wheels.
  };

  explicit MecanumKinematics(const Geometry& geometry) noexcept;

  /// The wheel speeds for a motion.
  [[nodiscard]] MecanumWheels inverse(const Twist2D& twist) const noexcept;
  /// The motion from wheel speeds: least squares, for four wheels measure three numbers.
  [[nodiscard]] Twist2D forward(const MecanumWheels& wheels) const noexcept;

 private:
  WheelScale scale_;
  double lever_m_;
};

}  // namespace rc10
