#pragma once

#include <array>

#include "app/planar_motion.hpp"
#include "app/wheel_speeds.hpp"

namespace rc10 {

/// Positive drives the robot forward.
struct DifferentialWheels {
  double left_rpm = 0.0;
  double right_rpm = 0.0;

  static constexpr std::array<double DifferentialWheels::*, 2> kAll{&DifferentialWheels::left_rpm,
                                                                    &DifferentialWheels::right_rpm};
};

/// Two driven sides, wheels or tracks: left = (vx - w b) / r, right = (vx + w b) / r with b = half track.
/// It cannot drive sideways: vy is left out on the way in and 0 on the way out.
/// Input that is not finite: rest.
class DifferentialKinematics {
 public:
  struct Geometry {
    double wheel_radius_m = 0.0;
    /// From the middle of the robot sideways to the wheels. Tracks and four driven wheels skid when they
    /// turn: there it is a larger, measured number.
    double half_track_m = 0.0;
  };

  explicit DifferentialKinematics(const Geometry& geometry) noexcept;

  [[nodiscard]] DifferentialWheels inverse(const Twist2D& twist) const noexcept;
  [[nodiscard]] Twist2D forward(const DifferentialWheels& wheels) const noexcept;

 private:
  WheelScale scale_;
  double half_track_m_;
};

}  // namespace rc10
