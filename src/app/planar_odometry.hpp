#pragma once

#include "app/planar_motion.hpp"

namespace rc10 {

/// Where the robot is, from how it has moved. Between two steps it drives an arc: the pose is exact for
/// a motion that is constant over dt, however far the robot turns in it.
///
/// dt of 0, below, or NaN, and motion that is not finite: the pose stays.
class PlanarOdometry {
 public:
  explicit PlanarOdometry(const Pose2D& pose = {}) noexcept { reset(pose); }

  /// One step with the motion in the robot's frame.
  const Pose2D& step(const Twist2D& body, float dt_s) noexcept;
  /// The same with the heading from an IMU, which wheels that slip do not disturb: of `body` only the
  /// velocity counts. A heading that is not finite: as without one.
  const Pose2D& step(const Twist2D& body, double heading_deg, float dt_s) noexcept;

  /// The robot is known to be here. A pose that is not finite is refused.
  void reset(const Pose2D& pose) noexcept;

  [[nodiscard]] const Pose2D& pose() const noexcept { return pose_; }

 private:
  void advance(double forward_m, double left_m, double turn_deg) noexcept;

  Pose2D pose_;
};

}  // namespace rc10
