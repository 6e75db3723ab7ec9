#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "app/planar_motion.hpp"

namespace rc10 {

/// Where a frame stands in another, in the plane: turned by an angle, then moved. A value: copies share
/// nothing. x forward, y left, counter-clockwise positive.
///
/// base_to_camera * camera_to_ball is base_to_ball. Numbers that are not finite give
/// NaN, which every command refuses.
class HomogeneousTransform2D {
 public:
  /// The frame itself.
  HomogeneousTransform2D() = default;
  HomogeneousTransform2D(double x_m, double y_m, double angle_deg) noexcept;
  explicit HomogeneousTransform2D(const Pose2D& pose) noexcept
      : HomogeneousTransform2D(pose.x_m, pose.y_m, pose.heading_deg) {}

  [[nodiscard]] const Eigen::Vector2d& translationMeters() const noexcept { return translation_m_; }
  [[nodiscard]] double angleDegrees() const noexcept { return angle_deg_; }  ///< [0, 360)
  [[nodiscard]] Pose2D pose() const noexcept;
  [[nodiscard]] Eigen::Matrix3d matrix() const noexcept;

  [[nodiscard]] HomogeneousTransform2D inverse() const noexcept;
  /// First `right`, then this one.
  [[nodiscard]] HomogeneousTransform2D operator*(const HomogeneousTransform2D& right) const noexcept;
  [[nodiscard]] Eigen::Vector2d apply(const Eigen::Vector2d& point_m) const noexcept;
  /// With its heading.
  [[nodiscard]] Pose2D apply(const Pose2D& pose) const noexcept;

 private:
  Eigen::Vector2d translation_m_ = Eigen::Vector2d::Zero();
  double angle_deg_ = 0.0;
  Eigen::Matrix2d rotation_ = Eigen::Matrix2d::Identity();
};

/// A turn by ZYX Euler angles: yaw about z, then pitch about the new y, then roll about the newest x.
/// Right-handed with y to the left: positive pitch looks down.
struct EulerZyx {
  double yaw_deg = 0.0;
  double pitch_deg = 0.0;
  double roll_deg = 0.0;
};

/// Where a body is in space, and how it is turned.
struct Pose3D {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  EulerZyx orientation;
};

/// The same in space; z up.
class HomogeneousTransform3D {
 public:
  HomogeneousTransform3D() = default;
  HomogeneousTransform3D(const Eigen::Vector3d& translation_m, const EulerZyx& orientation) noexcept;
  explicit HomogeneousTransform3D(const Pose3D& pose) noexcept;

  [[nodiscard]] const Eigen::Vector3d& translationMeters() const noexcept { return translation_m_; }
  [[nodiscard]] const Eigen::Quaterniond& rotation() const noexcept { return rotation_; }
  /// Yaw and roll in [-180, 180], pitch in [-90, 90]. With the pitch at 90 or -90 yaw and roll turn
  /// about the same axis: all of it is told as yaw.
  [[nodiscard]] EulerZyx orientation() const noexcept;
  [[nodiscard]] Pose3D pose() const noexcept;
  [[nodiscard]] Eigen::Matrix4d matrix() const noexcept;

  [[nodiscard]] HomogeneousTransform3D inverse() const noexcept;
  /// First `right`, then this one.
  [[nodiscard]] HomogeneousTransform3D operator*(const HomogeneousTransform3D& right) const noexcept;
  [[nodiscard]] Eigen::Vector3d apply(const Eigen::Vector3d& point_m) const noexcept;
  /// With its orientation.
  [[nodiscard]] Pose3D apply(const Pose3D& pose) const noexcept;

 private:
  HomogeneousTransform3D(const Eigen::Vector3d& translation_m, const Eigen::Quaterniond& rotation) noexcept;

  Eigen::Vector3d translation_m_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
};

}  // namespace rc10
