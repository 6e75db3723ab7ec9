#include "app/omni_kinematics.hpp"

#include <numbers>

#include "app/angle.hpp"

namespace rc10 {
namespace {

constexpr double kSin60 = std::numbers::sqrt3 / 2.0;
constexpr double kSin45 = std::numbers::sqrt2 / 2.0;

}  // namespace

Omni3Kinematics::Omni3Kinematics(const Geometry& geometry) noexcept
    : scale_(WheelScale::ofRadius(geometry.wheel_radius_m)),
      centre_distance_m_(geometry.centre_distance_m),
      front_sign_(geometry.middle_wheel == MiddleWheel::kRear ? 1.0 : -1.0) {}

Omni3Wheels Omni3Kinematics::inverse(const Twist2D& twist) const noexcept {
  const double k = scale_.rpm_per_m_s;
  const double turn_m_s = toRadians(twist.wz_deg_s) * centre_distance_m_;
  const double along_m_s = kSin60 * twist.vx_m_s;
  const double across_m_s = front_sign_ * twist.vy_m_s;
  return finiteOrRest(Omni3Wheels{.left_rpm = k * (-along_m_s + 0.5 * across_m_s + turn_m_s),
                                  .right_rpm = k * (along_m_s + 0.5 * across_m_s + turn_m_s),
                                  .middle_rpm = k * (-across_m_s + turn_m_s)});
}

Twist2D Omni3Kinematics::forward(const Omni3Wheels& wheels) const noexcept {
  const double k = scale_.m_s_per_rpm;
  const double l = wheels.left_rpm;
  const double r = wheels.right_rpm;
  const double m = wheels.middle_rpm;
  const double turn_m_s = k * (l + r + m) / 3.0;
  return finiteOrRest(
      Twist2D{.vx_m_s = k * (r - l) / (2.0 * kSin60),
              .vy_m_s = front_sign_ * k * (l + r - 2.0 * m) / 3.0,
              .wz_deg_s = centre_distance_m_ > 0.0 ? toDegrees(turn_m_s / centre_distance_m_) : 0.0});
}

Omni4Kinematics::Omni4Kinematics(const Geometry& geometry) noexcept
    : scale_(WheelScale::ofRadius(geometry.wheel_radius_m)),
      lever_m_(geometry.half_track_m + geometry.half_wheelbase_m) {}

Omni4Wheels Omni4Kinematics::inverse(const Twist2D& twist) const noexcept {
  const double k = scale_.rpm_per_m_s * kSin45;
  const double turn_m_s = toRadians(twist.wz_deg_s) * lever_m_;
  return finiteOrRest(Omni4Wheels{.front_left_rpm = k * (-twist.vx_m_s + twist.vy_m_s + turn_m_s),
                                  .front_right_rpm = k * (twist.vx_m_s + twist.vy_m_s + turn_m_s),
                                  .rear_left_rpm = k * (-twist.vx_m_s - twist.vy_m_s + turn_m_s),
                                  .rear_right_rpm = k * (twist.vx_m_s - twist.vy_m_s + turn_m_s)});
}

Twist2D Omni4Kinematics::forward(const Omni4Wheels& wheels) const noexcept {
  // The columns of the inverse are at right angles: its pseudo-inverse is its transpose, scaled.
  const double k = scale_.m_s_per_rpm / (4.0 * kSin45);
  const double fl = wheels.front_left_rpm;
  const double fr = wheels.front_right_rpm;
  const double rl = wheels.rear_left_rpm;
  const double rr = wheels.rear_right_rpm;
  const double turn_m_s = k * (fl + fr + rl + rr);
  return finiteOrRest(Twist2D{.vx_m_s = k * (-fl + fr - rl + rr),
                              .vy_m_s = k * (fl + fr - rl - rr),
                              .wz_deg_s = lever_m_ > 0.0 ? toDegrees(turn_m_s / lever_m_) : 0.0});
}

}  // namespace rc10
