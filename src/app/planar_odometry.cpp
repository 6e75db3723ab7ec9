#include "app/planar_odometry.hpp"

#include <cmath>

#include "app/angle.hpp"

namespace rc10 {
namespace {

// sin(x) / x; the series is exact in double below this.
double sinc(double x) noexcept { return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x; }

}  // namespace

const Pose2D& PlanarOdometry::step(const Twist2D& body, float dt_s) noexcept {
  if (!(dt_s > 0.0F)) return pose_;
  const auto dt = static_cast<double>(dt_s);
  advance(body.vx_m_s * dt, body.vy_m_s * dt, body.wz_deg_s * dt);
  return pose_;
}

const Pose2D& PlanarOdometry::step(const Twist2D& body, double heading_deg, float dt_s) noexcept {
  if (!std::isfinite(heading_deg)) return step(body, dt_s);
  if (!(dt_s > 0.0F)) return pose_;
  const auto dt = static_cast<double>(dt_s);
  advance(body.vx_m_s * dt, body.vy_m_s * dt, shortestAngle(pose_.heading_deg, heading_deg));
  return pose_;
}

void PlanarOdometry::reset(const Pose2D& pose) noexcept {
  if (!isFinite(pose)) return;
  pose_ = {pose.x_m, pose.y_m, wrapDegrees(pose.heading_deg)};
}

void PlanarOdometry::advance(double forward_m, double left_m, double turn_deg) noexcept {
  // The chord of the arc: its length is the arc's times sinc(turn / 2), and it points where the robot
  // looked halfway.
  const double half_rad = toRadians(turn_deg) / 2.0;
  const double chord = sinc(half_rad);
  const double direction_rad = toRadians(pose_.heading_deg) + half_rad;
  const double c = chord * std::cos(direction_rad);
  const double s = chord * std::sin(direction_rad);
  reset({.x_m = pose_.x_m + c * forward_m - s * left_m,
         .y_m = pose_.y_m + s * forward_m + c * left_m,
         .heading_deg = pose_.heading_deg + turn_deg});
}

}  // namespace rc10
