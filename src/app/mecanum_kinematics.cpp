#include "app/mecanum_kinematics.hpp"

#include "app/angle.hpp"

namespace rc10 {

MecanumKinematics::MecanumKinematics(const Geometry& geometry) noexcept
    : scale_(WheelScale::ofRadius(geometry.wheel_radius_m)),
      lever_m_(geometry.half_track_m + geometry.half_wheelbase_m) {}

MecanumWheels MecanumKinematics::inverse(const Twist2D& twist) const noexcept {
  const double k = scale_.rpm_per_m_s;
  const double turn_m_s = toRadians(twist.wz_deg_s) * lever_m_;
  return finiteOrRest(MecanumWheels{.front_left_rpm = k * (twist.vx_m_s - twist.vy_m_s - turn_m_s),
                                    .front_right_rpm = k * (twist.vx_m_s + twist.vy_m_s + turn_m_s),
                                    .rear_left_rpm = k * (twist.vx_m_s + twist.vy_m_s - turn_m_s),
                                    .rear_right_rpm = k * (twist.vx_m_s - twist.vy_m_s + turn_m_s)});
}

Twist2D MecanumKinematics::forward(const MecanumWheels& wheels) const noexcept {
  // The columns of the inverse are at right angles: its pseudo-inverse is its transpose, scaled.
  const double quarter = scale_.m_s_per_rpm / 4.0;
  const double fl = wheels.front_left_rpm;
  const double fr = wheels.front_right_rpm;
  const double rl = wheels.rear_left_rpm;
  const double rr = wheels.rear_right_rpm;
  const double turn_m_s = quarter * (-fl + fr - rl + rr);
  return finiteOrRest(Twist2D{.vx_m_s = quarter * (fl + fr + rl + rr),
                              .vy_m_s = quarter * (-fl + fr + rl - rr),
                              .wz_deg_s = lever_m_ > 0.0 ? toDegrees(turn_m_s / lever_m_) : 0.0});
}

}  // namespace rc10
