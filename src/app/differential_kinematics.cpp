#include "app/differential_kinematics.hpp"

#include "app/angle.hpp"

namespace rc10 {

DifferentialKinematics::DifferentialKinematics(const Geometry& geometry) noexcept
    : scale_(WheelScale::ofRadius(geometry.wheel_radius_m)), half_track_m_(geometry.half_track_m) {}

DifferentialWheels DifferentialKinematics::inverse(const Twist2D& twist) const noexcept {
  if (!isFinite(twist)) return {};
  const double k = scale_.rpm_per_m_s;
  const double turn_m_s = toRadians(twist.wz_deg_s) * half_track_m_;
  return finiteOrRest(DifferentialWheels{.left_rpm = k * (twist.vx_m_s - turn_m_s),
                                         .right_rpm = k * (twist.vx_m_s + turn_m_s)});
}

Twist2D DifferentialKinematics::forward(const DifferentialWheels& wheels) const noexcept {
  const double half = scale_.m_s_per_rpm / 2.0;
  const double turn_m_s = half * (wheels.right_rpm - wheels.left_rpm);
  return finiteOrRest(Twist2D{.vx_m_s = half * (wheels.left_rpm + wheels.right_rpm),
                              .vy_m_s = 0.0,
                              .wz_deg_s = half_track_m_ > 0.0 ? toDegrees(turn_m_s / half_track_m_) : 0.0});
}

}  // namespace rc10
