#include "app/homogeneous_transform.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "app/angle.hpp"

namespace rc10::test::homogeneous_transform_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class Randoms {
 public:
  double meters() { return meters_(random_); }
  double degrees() { return degrees_(random_); }
  HomogeneousTransform2D flat() { return {meters(), meters(), degrees()}; }
  HomogeneousTransform3D spatial() {
    return {Eigen::Vector3d(meters(), meters(), meters()), EulerZyx{degrees(), degrees(), degrees()}};
  }

 private:
  std::mt19937 random_{8};
  std::uniform_real_distribution<double> meters_{-10.0, 10.0};
  std::uniform_real_distribution<double> degrees_{-400.0, 400.0};
};

TEST(HomogeneousTransform2D, TurnsThenMoves) {
  const HomogeneousTransform2D transform(1.0, 2.0, 90.0);
  const Eigen::Vector2d point = transform.apply(Eigen::Vector2d(3.0, 0.0));
  EXPECT_NEAR(point.x(), 1.0, 1e-12);
  EXPECT_NEAR(point.y(), 5.0, 1e-12);
}

TEST(HomogeneousTransform2D, APoseKeepsItsHeadingInTheNewFrame) {
  // A camera 0.3 m in front of the middle, looking to the left, sees a ball that rolls to its right.
  const HomogeneousTransform2D base_to_camera(0.3, 0.0, 90.0);
  const Pose2D ball = base_to_camera.apply(Pose2D{.x_m = 2.0, .y_m = 0.0, .heading_deg = 270.0});
  EXPECT_NEAR(ball.x_m, 0.3, 1e-12);
  EXPECT_NEAR(ball.y_m, 2.0, 1e-12);
  EXPECT_NEAR(shortestAngle(0.0, ball.heading_deg), 0.0, 1e-12);
}

TEST(HomogeneousTransform2D, AnInverseUndoesItAndComposingIsApplyingOneAfterTheOther) {
  Randoms random;
  for (int i = 0; i < 1000; ++i) {
    const HomogeneousTransform2D a = random.flat();
    const HomogeneousTransform2D b = random.flat();
    const Eigen::Vector2d point(random.meters(), random.meters());
    ASSERT_TRUE((a * b).apply(point).isApprox(a.apply(b.apply(point)), 1e-9));
    ASSERT_TRUE((a * a.inverse()).matrix().isApprox(Eigen::Matrix3d::Identity(), 1e-9));
    ASSERT_TRUE((a * b).matrix().isApprox(a.matrix() * b.matrix(), 1e-9));
    ASSERT_TRUE(a.inverse().apply(a.apply(point)).isApprox(point, 1e-9));
    ASSERT_TRUE(HomogeneousTransform2D(a.apply(b.pose())).matrix().isApprox((a * b).matrix(), 1e-9));
  }
}

TEST(HomogeneousTransform2D, ACopySharesNothingWithItsOriginal) {
  HomogeneousTransform2D original(1.0, 2.0, 30.0);
  const HomogeneousTransform2D copy = original;
  original = HomogeneousTransform2D(9.0, 9.0, 99.0);
  EXPECT_EQ(copy.pose(), (Pose2D{1.0, 2.0, 30.0}));
}

TEST(HomogeneousTransform2D, DoesNotDriftOverAMillionTurns) {
  HomogeneousTransform2D transform;
  const HomogeneousTransform2D step(0.0, 0.0, 7.0);
  for (int i = 0; i < 1'000'000; ++i) transform = transform * step;
  EXPECT_NEAR(transform.matrix().determinant(), 1.0, 1e-12);
}

TEST(HomogeneousTransform3D, TurnsByYawThenPitchThenRoll) {
  const HomogeneousTransform3D yaw(Eigen::Vector3d::Zero(), EulerZyx{.yaw_deg = 90.0});
  EXPECT_TRUE(yaw.apply(Eigen::Vector3d(1.0, 0.0, 0.0)).isApprox(Eigen::Vector3d(0.0, 1.0, 0.0), 1e-12));
  const HomogeneousTransform3D pitch(Eigen::Vector3d::Zero(), EulerZyx{.pitch_deg = 90.0});
  EXPECT_TRUE(pitch.apply(Eigen::Vector3d(1.0, 0.0, 0.0)).isApprox(Eigen::Vector3d(0.0, 0.0, -1.0), 1e-12));
  const HomogeneousTransform3D roll(Eigen::Vector3d::Zero(), EulerZyx{.roll_deg = 90.0});
  EXPECT_TRUE(roll.apply(Eigen::Vector3d(0.0, 1.0, 0.0)).isApprox(Eigen::Vector3d(0.0, 0.0, 1.0), 1e-12));
  const HomogeneousTransform3D all(Eigen::Vector3d(1.0, 2.0, 3.0), EulerZyx{30.0, 40.0, 50.0});
  const auto turn = [](const EulerZyx& euler) {
    return HomogeneousTransform3D(Eigen::Vector3d::Zero(), euler);
  };
  const HomogeneousTransform3D composed =
      turn({.yaw_deg = 30.0}) * turn({.pitch_deg = 40.0}) * turn({.roll_deg = 50.0});
  EXPECT_TRUE(all.rotation().isApprox(composed.rotation(), 1e-12));
}

TEST(HomogeneousTransform3D, GivesBackTheAnglesItWasMadeOf) {
  Randoms random;
  for (int i = 0; i < 1000; ++i) {
    const EulerZyx euler{random.degrees() * 0.44, random.degrees() * 0.22, random.degrees() * 0.44};
    const EulerZyx back = HomogeneousTransform3D(Eigen::Vector3d::Zero(), euler).orientation();
    ASSERT_NEAR(back.yaw_deg, euler.yaw_deg, 1e-8);
    ASSERT_NEAR(back.pitch_deg, euler.pitch_deg, 1e-8);
    ASSERT_NEAR(back.roll_deg, euler.roll_deg, 1e-8);
  }
}

TEST(HomogeneousTransform3D, StraightUpAndDownItsAnglesStillDescribeTheTurn) {
  for (const double pitch_deg : {90.0, -90.0}) {
    for (const double roll_deg : {0.0, 35.0, -170.0}) {
      const HomogeneousTransform3D transform(Eigen::Vector3d::Zero(), EulerZyx{25.0, pitch_deg, roll_deg});
      const EulerZyx euler = transform.orientation();
      EXPECT_EQ(euler.roll_deg, 0.0);
      const HomogeneousTransform3D again(Eigen::Vector3d::Zero(), euler);
      EXPECT_TRUE(again.matrix().isApprox(transform.matrix(), 1e-7)) << pitch_deg << ' ' << roll_deg;
    }
  }
}

TEST(HomogeneousTransform3D, AnInverseUndoesItAndComposingIsApplyingOneAfterTheOther) {
  Randoms random;
  for (int i = 0; i < 1000; ++i) {
    const HomogeneousTransform3D a = random.spatial();
    const HomogeneousTransform3D b = random.spatial();
    const Eigen::Vector3d point(random.meters(), random.meters(), random.meters());
    ASSERT_TRUE((a * b).apply(point).isApprox(a.apply(b.apply(point)), 1e-9));
    ASSERT_TRUE((a * a.inverse()).matrix().isApprox(Eigen::Matrix4d::Identity(), 1e-9));
    ASSERT_TRUE((a * b).matrix().isApprox(a.matrix() * b.matrix(), 1e-9));
    ASSERT_TRUE(a.inverse().apply(a.apply(point)).isApprox(point, 1e-9));
    ASSERT_TRUE(HomogeneousTransform3D(a.apply(b.pose())).matrix().isApprox((a * b).matrix(), 1e-6));
  }
}

TEST(HomogeneousTransform3D, DoesNotDriftOverAMillionTurns) {
  HomogeneousTransform3D transform;
  const HomogeneousTransform3D step(Eigen::Vector3d::Zero(), EulerZyx{7.0, 3.0, 1.0});
  for (int i = 0; i < 1'000'000; ++i) transform = transform * step;
  EXPECT_NEAR(transform.matrix().determinant(), 1.0, 1e-12);
}

TEST(HomogeneousTransform, WhatIsNotFiniteStaysNotFinite) {
  const Pose2D flat = HomogeneousTransform2D(1.0, 2.0, kNan).apply(Pose2D{1.0, 1.0, 1.0});
  EXPECT_FALSE(isFinite(flat));
  const HomogeneousTransform3D spatial(Eigen::Vector3d(1.0, kNan, 0.0), EulerZyx{});
  EXPECT_FALSE(spatial.apply(Eigen::Vector3d::Zero()).allFinite());
  const HomogeneousTransform3D turned(Eigen::Vector3d::Zero(), EulerZyx{.yaw_deg = kNan});
  EXPECT_FALSE(turned.apply(Eigen::Vector3d::Ones()).allFinite());
}

}  // namespace
}  // namespace rc10::test::homogeneous_transform_test
