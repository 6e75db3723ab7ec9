#pragma once

#include <array>

#include "app/planar_motion.hpp"
#include "app/wheel_speeds.hpp"

namespace rc10 {

/// Positive pushes the robot round its middle counter-clockwise: wheels that stand alike have equal
/// signs. A motor that looks outwards and turns counter-clockwise seen from outside needs direction -1.
struct Omni3Wheels {
  double left_rpm = 0.0;
  double right_rpm = 0.0;
  double middle_rpm = 0.0;  ///< The wheel on the centre line, in front or at the rear.

  static constexpr std::array<double Omni3Wheels::*, 3> kAll{&Omni3Wheels::left_rpm, &Omni3Wheels::right_rpm,
                                                             &Omni3Wheels::middle_rpm};
};

/// Three omni wheels, 120 degrees apart, each rolling at right angles to the line to the middle.
/// With the wheel at angle p seen from the middle: (-vx sin p + vy cos p + w R) / r.
/// Input that is not finite: rest.
class Omni3Kinematics {
 public:
  enum class MiddleWheel { kFront, kRear };

  struct Geometry {
    double wheel_radius_m = 0.0;
    double centre_distance_m = 0.0;  ///< From the middle of the robot to each wheel.
    MiddleWheel middle_wheel = MiddleWheel::kRear;
  };

  explicit Omni3Kinematics(const Geometry& geometry) noexcept;

  [[nodiscard]] Omni3Wheels inverse(const Twist2D& twist) const noexcept;
  [[nodiscard]] Twist2D forward(const Omni3Wheels& wheels) const noexcept;

 private:
  WheelScale scale_;
  double centre_distance_m_;
  double front_sign_;  // 1: the middle wheel is at the rear, so that two are in front.
};

/// Positive pushes the robot round its middle counter-clockwise, as in Omni3Wheels.
struct Omni4Wheels {
  double front_left_rpm = 0.0;
  double front_right_rpm = 0.0;
  double rear_left_rpm = 0.0;
  double rear_right_rpm = 0.0;

  static constexpr std::array<double Omni4Wheels::*, 4> kAll{
      &Omni4Wheels::front_left_rpm, &Omni4Wheels::front_right_rpm, &Omni4Wheels::rear_left_rpm,
      &Omni4Wheels::rear_right_rpm};
};

/// Four omni wheels at the corners, rolling at 45 degrees to the robot (X drive).
/// With L = half track + half wheelbase and h = sqrt(1/2):
///   front left = h (-vx + vy + w L) / r      front right = h ( vx + vy + w L) / r
///   rear left  = h (-vx - vy + w L) / r      rear right  = h ( vx - vy + w L) / r
/// Input that is not finite: rest.
class Omni4Kinematics {
 public:
  struct Geometry {
    double wheel_radius_m = 0.0;
    double half_track_m = 0.0;      ///< From the middle of the robot sideways to the wheels.
    double half_wheelbase_m = 0.0;  ///< From the middle of the robot forward to the wheels.
  };

  explicit Omni4Kinematics(const Geometry& geometry) noexcept;

  [[nodiscard]] Omni4Wheels inverse(const Twist2D& twist) const noexcept;
  /// Least squares: four wheels measure three numbers.
  [[nodiscard]] Twist2D forward(const Omni4Wheels& wheels) const noexcept;

 private:
  WheelScale scale_;
  double lever_m_;
};

}  // namespace rc10
