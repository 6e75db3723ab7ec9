#pragma once

#include <cmath>

#include "app/angle.hpp"

namespace rc10 {

/// Motion of a robot in the plane: x forward, y left, counter-clockwise positive. In the frame of the
/// robot unless it says otherwise.
struct Twist2D {
  double vx_m_s = 0.0;
  double vy_m_s = 0.0;
  double wz_deg_s = 0.0;

  friend constexpr bool operator==(const Twist2D&, const Twist2D&) = default;
};

/// Where a robot is, in the frame of the world.
struct Pose2D {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_deg = 0.0;  ///< [0, 360) where this project computes it.

  friend constexpr bool operator==(const Pose2D&, const Pose2D&) = default;
};

[[nodiscard]] inline bool isFinite(const Twist2D& twist) noexcept {
  return std::isfinite(twist.vx_m_s) && std::isfinite(twist.vy_m_s) && std::isfinite(twist.wz_deg_s);
}
[[nodiscard]] inline bool isFinite(const Pose2D& pose) noexcept {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.heading_deg);
}

/// The twist itself, or rest where a part of it is not finite.
[[nodiscard]] inline Twist2D finiteOrRest(const Twist2D& twist) noexcept {
  return isFinite(twist) ? twist : Twist2D{};
}

/// The same motion with its velocity seen in a frame that is turned by angle_deg.
[[nodiscard]] inline Twist2D seenFrom(double angle_deg, const Twist2D& twist) noexcept {
  const double c = std::cos(toRadians(angle_deg));
  const double s = std::sin(toRadians(angle_deg));
  return finiteOrRest({.vx_m_s = c * twist.vx_m_s + s * twist.vy_m_s,
                       .vy_m_s = c * twist.vy_m_s - s * twist.vx_m_s,
                       .wz_deg_s = twist.wz_deg_s});
}

/// A velocity in the world as the robot with this heading must drive it. Not finite: rest.
[[nodiscard]] inline Twist2D worldToBody(const Twist2D& world, double heading_deg) noexcept {
  return seenFrom(heading_deg, world);
}

/// Velocity in the world of a robot with this heading. Not finite: rest.
[[nodiscard]] inline Twist2D bodyToWorld(const Twist2D& body, double heading_deg) noexcept {
  return seenFrom(-heading_deg, body);
}

}  // namespace rc10
