#include "app/swerve_kinematics.hpp"

#include <cmath>

#include "app/angle.hpp"

namespace rc10 {
namespace {

struct Velocity {
  double x_m_s = 0.0;
  double y_m_s = 0.0;
};

SwerveModule atRest(const SwerveModule& measured) noexcept {
  return {.speed_rpm = 0.0,
          .angle_deg = std::isfinite(measured.angle_deg) ? wrapDegrees(measured.angle_deg) : 0.0};
}

SwerveModules atRest(SwerveModules measured) noexcept {
  for (const auto module : SwerveModules::kAll) measured.*module = atRest(measured.*module);
  return measured;
}

}  // namespace

SwerveKinematics::SwerveKinematics(const Geometry& geometry) noexcept
    : scale_(WheelScale::ofRadius(geometry.wheel_radius_m)),
      half_track_m_(geometry.half_track_m),
      half_wheelbase_m_(geometry.half_wheelbase_m),
      rest_below_m_s_(geometry.rest_below_m_s) {}

SwerveModules SwerveKinematics::inverse(const Twist2D& twist, const SwerveModules& measured) const noexcept {
  const double w_rad_s = toRadians(twist.wz_deg_s);
  const double along_m_s = w_rad_s * half_track_m_;       // of the right wheels, forward
  const double across_m_s = w_rad_s * half_wheelbase_m_;  // of the front wheels, to the left
  const auto module = [this](double vx_m_s, double vy_m_s, const SwerveModule& now) noexcept -> SwerveModule {
    const double speed_m_s = std::hypot(vx_m_s, vy_m_s);
    if (speed_m_s == 0.0 || speed_m_s < rest_below_m_s_) return atRest(now);
    return {.speed_rpm = speed_m_s * scale_.rpm_per_m_s,
            .angle_deg = wrapDegrees(toDegrees(std::atan2(vy_m_s, vx_m_s)))};
  };
  const double vx = twist.vx_m_s;
  const double vy = twist.vy_m_s;
  const SwerveModules wanted{.front_left = module(vx - along_m_s, vy + across_m_s, measured.front_left),
                             .front_right = module(vx + along_m_s, vy + across_m_s, measured.front_right),
                             .rear_left = module(vx - along_m_s, vy - across_m_s, measured.rear_left),
                             .rear_right = module(vx + along_m_s, vy - across_m_s, measured.rear_right)};
  if (!isFinite(twist) || !isFinite(wanted)) return atRest(measured);
  return wanted;
}

Twist2D SwerveKinematics::forward(const SwerveModules& modules) const noexcept {
  const auto velocity = [this](const SwerveModule& module) noexcept -> Velocity {
    const double speed_m_s = module.speed_rpm * scale_.m_s_per_rpm;
    const double angle_rad = toRadians(module.angle_deg);
    return {speed_m_s * std::cos(angle_rad), speed_m_s * std::sin(angle_rad)};
  };
  const Velocity fl = velocity(modules.front_left);
  const Velocity fr = velocity(modules.front_right);
  const Velocity rl = velocity(modules.rear_left);
  const Velocity rr = velocity(modules.rear_right);
  // The wheels stand symmetrically: the columns of the inverse are at right angles, and the
  // pseudo-inverse is its transpose, scaled.
  const double square_m2 = half_track_m_ * half_track_m_ + half_wheelbase_m_ * half_wheelbase_m_;
  const double moment_m2_s = half_track_m_ * (-fl.x_m_s + fr.x_m_s - rl.x_m_s + rr.x_m_s) +
                             half_wheelbase_m_ * (fl.y_m_s + fr.y_m_s - rl.y_m_s - rr.y_m_s);
  return finiteOrRest(
      Twist2D{.vx_m_s = (fl.x_m_s + fr.x_m_s + rl.x_m_s + rr.x_m_s) / 4.0,
              .vy_m_s = (fl.y_m_s + fr.y_m_s + rl.y_m_s + rr.y_m_s) / 4.0,
              .wz_deg_s = square_m2 > 0.0 ? toDegrees(moment_m2_s / (4.0 * square_m2)) : 0.0});
}

SwerveModule steered(const SwerveModule& wanted, double measured_angle_deg) noexcept {
  if (!std::isfinite(wanted.speed_rpm) || !std::isfinite(wanted.angle_deg) ||
      !std::isfinite(measured_angle_deg)) {
    return atRest({.angle_deg = measured_angle_deg});
  }
  SwerveModule way = wanted;
  double left_deg = shortestAngle(measured_angle_deg, way.angle_deg);
  if (std::abs(left_deg) > 90.0) {
    way = {.speed_rpm = -way.speed_rpm, .angle_deg = way.angle_deg + 180.0};
    left_deg = shortestAngle(measured_angle_deg, way.angle_deg);
  }
  return {.speed_rpm = way.speed_rpm * std::fmax(0.0, std::cos(toRadians(left_deg))),
          .angle_deg = wrapDegrees(way.angle_deg)};
}

SwerveModules steered(const SwerveModules& wanted, const SwerveModules& measured) noexcept {
  SwerveModules out;
  for (const auto module : SwerveModules::kAll) {
    out.*module = steered(wanted.*module, (measured.*module).angle_deg);
  }
  return out;
}

}  // namespace rc10
