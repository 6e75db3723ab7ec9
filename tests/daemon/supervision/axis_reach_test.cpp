// Drives that can be told positions so far from their own 0: what moving and `zero` make of it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>

#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::axis_reach_test {
namespace {

struct Subject {
  const char* name;
  const char* motor;
  double reach_deg;  ///< End of what its drive can be told.
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

const Subject kSprings[] = {
    {"Damiao", "model: DM4310, id: 1, master_id: 17", 716.2},
    {"DamiaoReversed", "model: DM4310, id: 1, master_id: 17, direction: -1", 716.2},
    {"RobStride", "model: RS00, id: 3", 720.0},
    {"CubeMarsMit", "model: AK80-9, id: 6, protocol: mit", 716.2},
    {"CubeMarsMitV3", "model: AK80-8-V3, id: 6, protocol: mit_v3", 716.2},
};
// In its servo mode the drive's own loop holds.
const Subject kServo{"CubeMarsServo", "model: AK80-9, id: 6, position_basis: rotor", 3200.0 / 9.0};

RobotConfig configOf(const Subject& subject, const std::string& keys) {
  auto outcome = parseRobotConfig(std::string{"robot: reach\nrealtime: preferred\nbuses:\n  - name: bench\n"
                                              "    type: sim\n    motors:\n      - {name: arm, "} +
                                      subject.motor + keys + "}\n",
                                  "reach.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

class ReachTest : public ::testing::TestWithParam<Subject> {
 protected:
  static constexpr std::size_t kArm = 0;

  /// Enables it and leads it to this angle, a third of a degree in each tick; then it has so long to settle.
  static void leadTo(VirtualRobot& robot, double angle_deg, int settling_ticks = 1500) {
    for (int i = 0; i < 8 && robot.motor(kArm).status != MotorStatus::kActive; ++i) {
      (void)robot.order(Operation::kEnable);
      robot.run(100);
    }
    ASSERT_EQ(robot.motor(kArm).status, MotorStatus::kActive);
    robot.simBus().setLoad(0, {.load_torque_nm = outwards()});
    double target_deg = robot.motor(kArm).feedback.total_angle_deg;
    while (std::fabs(target_deg - angle_deg) > 0.3) {
      target_deg += std::copysign(0.3, angle_deg - target_deg);
      robot.hold(kArm, {.mode = ControlMode::kTotalAngle, .value = target_deg}, 1);
    }
    robot.hold(kArm, {.mode = ControlMode::kTotalAngle, .value = angle_deg}, settling_ticks);
  }
  /// A load that pulls the way that its targets go.
  static float outwards() {
    return std::string_view{GetParam().motor}.find("direction") == std::string_view::npos ? -1.0F : 1.0F;
  }
  static void letGo(VirtualRobot& robot) {
    robot.simBus().setLoad(0, {});
    (void)robot.order(Operation::kDisable);
    robot.run(500);
  }
};

TEST_P(ReachTest, HoweverOftenItIsMovedAndZeroedItStaysWhereItCanBeHeld) {
  VirtualRobot robot(configOf(GetParam(), ""));
  robot.run(50);
  double drive_deg = 0.0;
  for (int round = 0; round < 4; ++round) {
    ASSERT_EQ(robot.order(Operation::kZero, 0.0).motors[kArm], Refusal::kNone);
    leadTo(robot, 300.0);
    const auto& motor = robot.motor(kArm);
    EXPECT_LT(std::fabs(motor.feedback.velocity_rpm), 0.5F) << round << ": it is held";
    drive_deg = robot.simBus().drive(0).physics().outputAngleDeg();
    EXPECT_LT(std::fabs(drive_deg), GetParam().reach_deg) << round;
    // The first two lie within its reach, and the rest of the way is told.
    if (round < 2) {
      EXPECT_NEAR(motor.feedback.total_angle_deg, 300.0, 5.0);
    } else {
      EXPECT_NE(motor.limits & kLimitAngle, 0U);
    }
    letGo(robot);
  }
  EXPECT_GT(std::fabs(drive_deg), 0.8 * GetParam().reach_deg);
}

TEST_P(ReachTest, AHoldNearTheEndDrawsNothingIn) {
  VirtualRobot robot(configOf(GetParam(), ", on_timeout: hold"));
  robot.run(50);
  ASSERT_EQ(robot.order(Operation::kZero, 0.0).motors[kArm], Refusal::kNone);
  leadTo(robot, 600.0, 200);
  // A velocity leads it on, to where an angle would not.
  for (int i = 0; i < 4000 && robot.motor(kArm).feedback.total_angle_deg < GetParam().reach_deg - 25.0; ++i)
    robot.hold(kArm, {.mode = ControlMode::kVelocity, .value = 10.0}, 1);
  const double there_deg = robot.motor(kArm).feedback.total_angle_deg;
  robot.run(1500);
  EXPECT_EQ(robot.motor(kArm).acting, Acting::kHold);
  EXPECT_GT(robot.motor(kArm).feedback.total_angle_deg, there_deg - 1.0);
  EXPECT_LT(robot.motor(kArm).feedback.total_angle_deg, GetParam().reach_deg);
}

TEST_P(ReachTest, AZeroThatPutsASoftLimitBeyondItIsRefused) {
  VirtualRobot robot(configOf(GetParam(), ", angle_min_deg: -90, angle_max_deg: 600"));
  robot.run(50);
  ASSERT_EQ(robot.order(Operation::kZero, 0.0).motors[kArm], Refusal::kNone);
  leadTo(robot, 300.0);
  letGo(robot);
  const double before_deg = robot.motor(kArm).feedback.total_angle_deg;
  EXPECT_EQ(robot.order(Operation::kZero, 0.0).motors[kArm], Refusal::kOutOfReach);
  EXPECT_NEAR(robot.motor(kArm).feedback.total_angle_deg, before_deg, 5.0) << "nothing has changed";
  EXPECT_EQ(robot.order(Operation::kZero, 310.0).motors[kArm], Refusal::kNone);
}

TEST_P(ReachTest, AWheelIsZeroedAnywhere) {
  VirtualRobot robot(configOf(GetParam(), ""));
  robot.run(50);
  (void)robot.order(Operation::kEnable);
  robot.run(200);
  robot.hold(kArm, {.mode = ControlMode::kVelocity, .value = 120.0}, 3000);
  letGo(robot);
  EXPECT_EQ(robot.order(Operation::kZero, 0.0).motors[kArm], Refusal::kNone);
  EXPECT_NEAR(robot.motor(kArm).feedback.total_angle_deg, 0.0, 5.0);
}

INSTANTIATE_TEST_SUITE_P(All, ReachTest, ::testing::ValuesIn(kSprings),
                         [](const auto& each) { return std::string{each.param.name}; });

TEST(ReachOfAServo, BoundsWhereItsSoftLimitsMayLie) {
  VirtualRobot robot(configOf(kServo, ", angle_min_deg: -90, angle_max_deg: 300"));
  robot.run(50);
  EXPECT_EQ(robot.order(Operation::kZero, 0.0).motors[0], Refusal::kNone);
  EXPECT_EQ(robot.order(Operation::kZero, -70.0).motors[0], Refusal::kOutOfReach);
}

}  // namespace
}  // namespace rc10::test::axis_reach_test
