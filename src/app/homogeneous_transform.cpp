#include "app/homogeneous_transform.hpp"

#include <algorithm>
#include <cmath>

#include "app/angle.hpp"

namespace rc10 {

HomogeneousTransform2D::HomogeneousTransform2D(double x_m, double y_m, double angle_deg) noexcept
    : translation_m_(x_m, y_m),
      angle_deg_(wrapDegrees(angle_deg)),
      rotation_(Eigen::Rotation2Dd(toRadians(angle_deg_)).toRotationMatrix()) {}

Pose2D HomogeneousTransform2D::pose() const noexcept {
  return {translation_m_.x(), translation_m_.y(), angle_deg_};
}

Eigen::Matrix3d HomogeneousTransform2D::matrix() const noexcept {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix.topLeftCorner<2, 2>() = rotation_;
  matrix.topRightCorner<2, 1>() = translation_m_;
  return matrix;
}

HomogeneousTransform2D HomogeneousTransform2D::inverse() const noexcept {
  const Eigen::Vector2d back = -(rotation_.transpose() * translation_m_);
  return {back.x(), back.y(), -angle_deg_};
}

HomogeneousTransform2D HomogeneousTransform2D::operator*(const HomogeneousTransform2D& right) const noexcept {
  const Eigen::Vector2d moved = apply(right.translation_m_);
  // Angles add: no rotation matrix drifts away from being one.
  return {moved.x(), moved.y(), angle_deg_ + right.angle_deg_};
}

Eigen::Vector2d HomogeneousTransform2D::apply(const Eigen::Vector2d& point_m) const noexcept {
  return rotation_ * point_m + translation_m_;
}

Pose2D HomogeneousTransform2D::apply(const Pose2D& pose) const noexcept {
  const Eigen::Vector2d moved = apply(Eigen::Vector2d(pose.x_m, pose.y_m));
  return {moved.x(), moved.y(), wrapDegrees(angle_deg_ + pose.heading_deg)};
}

namespace {

Eigen::Quaterniond toQuaternion(const EulerZyx& euler) noexcept {
  return Eigen::AngleAxisd(toRadians(euler.yaw_deg), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(toRadians(euler.pitch_deg), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(toRadians(euler.roll_deg), Eigen::Vector3d::UnitX());
}

EulerZyx toEuler(const Eigen::Quaterniond& rotation) noexcept {
  const Eigen::Matrix3d m = rotation.toRotationMatrix();
  const double across = std::hypot(m(0, 0), m(1, 0));
  const double pitch_rad = std::atan2(-m(2, 0), across);
  // Straight up or down: below this nothing is left but rounding.
  if (across < 1e-9) {
    return {.yaw_deg = toDegrees(std::atan2(-m(0, 1), m(1, 1))), .pitch_deg = toDegrees(pitch_rad)};
  }
  return {.yaw_deg = toDegrees(std::atan2(m(1, 0), m(0, 0))),
          .pitch_deg = toDegrees(pitch_rad),
          .roll_deg = toDegrees(std::atan2(m(2, 1), m(2, 2)))};
}

}  // namespace

HomogeneousTransform3D::HomogeneousTransform3D(const Eigen::Vector3d& translation_m,
                                               const Eigen::Quaterniond& rotation) noexcept
    : translation_m_(translation_m), rotation_(rotation.normalized()) {}

HomogeneousTransform3D::HomogeneousTransform3D(const Eigen::Vector3d& translation_m,
                                               const EulerZyx& orientation) noexcept
    : HomogeneousTransform3D(translation_m, toQuaternion(orientation)) {}

HomogeneousTransform3D::HomogeneousTransform3D(const Pose3D& pose) noexcept
    : HomogeneousTransform3D(Eigen::Vector3d(pose.x_m, pose.y_m, pose.z_m), pose.orientation) {}

EulerZyx HomogeneousTransform3D::orientation() const noexcept { return toEuler(rotation_); }

Pose3D HomogeneousTransform3D::pose() const noexcept {
  return {translation_m_.x(), translation_m_.y(), translation_m_.z(), orientation()};
}

Eigen::Matrix4d HomogeneousTransform3D::matrix() const noexcept {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = rotation_.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = translation_m_;
  return matrix;
}

HomogeneousTransform3D HomogeneousTransform3D::inverse() const noexcept {
  const Eigen::Quaterniond back = rotation_.conjugate();
  return {-(back * translation_m_), back};
}

HomogeneousTransform3D HomogeneousTransform3D::operator*(const HomogeneousTransform3D& right) const noexcept {
  return {apply(right.translation_m_), rotation_ * right.rotation_};
}

Eigen::Vector3d HomogeneousTransform3D::apply(const Eigen::Vector3d& point_m) const noexcept {
  return rotation_ * point_m + translation_m_;
}

Pose3D HomogeneousTransform3D::apply(const Pose3D& pose) const noexcept {
  return (*this * HomogeneousTransform3D(pose)).pose();
}

}  // namespace rc10
