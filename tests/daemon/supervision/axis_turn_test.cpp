// The turn of an absolute encoder after a power cycle, at each place of the travel, in each family that has
// one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "config/load_config.hpp"
#include "daemon/supervision/absolute_encoders.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::axis_turn_test {
namespace {

constexpr std::size_t kArm = 0;

class TurnTest : public ::testing::TestWithParam<AbsoluteEncoder> {
 protected:
  /// Until the drive is enabled, or refuses for its turn.
  static Refusal enable(VirtualRobot& robot) {
    for (int i = 0; i < 4000 && robot.motor(kArm).status != MotorStatus::kReady; ++i) robot.run(1);
    Refusal refusal = Refusal::kOffline;
    for (int attempt = 0; attempt < 4; ++attempt) {
      refusal = robot.order(Operation::kEnable).motors[kArm];
      if (refusal == Refusal::kNone || refusal == Refusal::kTurnUnclear) break;
      robot.run(1000);
    }
    robot.run(20);
    return refusal;
  }
  /// Its power was away for a moment.
  static void restart(VirtualRobot& robot) {
    robot.simBus().drive(kArm).restart();
    robot.freezeBus(0, true);
    robot.run(300);
    robot.freezeBus(0, false);
    robot.run(3000);
  }
  static bool reversed() {
    return std::string_view{GetParam().motor}.find("direction") != std::string_view::npos;
  }
};

TEST_P(TurnTest, IsFoundAtEachPlaceOfTheTravel) {
  const double zero_deg = reversed() ? 70.0 : 0.0;
  for (const double parked_deg : {-120.0, -90.0, -30.0, 0.0, 95.0, 179.0, 181.0, 190.0, 200.0, 230.0}) {
    VirtualRobot robot(robotOfArm(GetParam(), ", angle_min_deg: -90, angle_max_deg: 200",
                                  (reversed() ? -1.0 : 1.0) * (parked_deg + zero_deg)));
    ASSERT_EQ(enable(robot), Refusal::kNone) << parked_deg;
    EXPECT_TRUE(robot.motor(kArm).feedback.zeroed);
    EXPECT_NEAR(robot.motor(kArm).feedback.total_angle_deg, parked_deg, 0.5);
  }
}

TEST_P(TurnTest, ThatIsUnclearKeepsItFromBeingEnabledUntilItsAngleIsSet) {
  // Some drives can be told no more than two turns to either side: all of it lies within, read from 370 deg.
  VirtualRobot robot(robotOfArm(GetParam(), ", angle_min_deg: -250, angle_max_deg: 400", 10.0));
  EXPECT_EQ(enable(robot), Refusal::kTurnUnclear);
  EXPECT_EQ(robot.motor(kArm).status, MotorStatus::kReady);
  EXPECT_FALSE(robot.motor(kArm).feedback.zeroed);
  const auto set = robot.order(Operation::kZero, 370.0);
  EXPECT_EQ(set.motors[kArm], Refusal::kNone);
  EXPECT_TRUE(std::isnan(set.zero_deg)) << "no file would let it know its turn";
  EXPECT_EQ(enable(robot), Refusal::kNone);
  EXPECT_NEAR(robot.motor(kArm).feedback.total_angle_deg, 370.0, 1.0);
}

TEST_P(TurnTest, OfAWheelWithoutLimitsNeedsNothing) {
  VirtualRobot robot(robotOfArm(GetParam(), "", 100.0));
  EXPECT_EQ(enable(robot), Refusal::kNone);
  EXPECT_TRUE(robot.motor(kArm).feedback.zeroed);
}

// The arm was homed 37 deg from where its file has the zero.
TEST_P(TurnTest, IsInTheFrameOfItsLastZeroAfterItsDriveWasRestarted) {
  for (const char* limits : {"", ", angle_min_deg: -10, angle_max_deg: 100"}) {
    VirtualRobot robot(robotOfArm(GetParam(), limits, (reversed() ? -1.0 : 1.0) * 107.0));
    for (int i = 0; i < 4000 && robot.motor(kArm).status != MotorStatus::kReady; ++i) robot.run(1);
    for (int i = 0; i < 4000 && !robot.motor(kArm).feedback.zeroed; ++i) robot.run(1);
    ASSERT_TRUE(robot.motor(kArm).feedback.zeroed) << limits;
    ASSERT_EQ(robot.order(Operation::kZero, 0.0).motors[kArm], Refusal::kNone) << limits;
    robot.run(3000);  // a clock that shows less than before
    (void)robot.events();
    restart(robot);
    const auto events = robot.events();
    const bool told = std::any_of(events.begin(), events.end(),
                                  [](const Event& event) { return event.code == EventCode::kReferenceLost; });
    // Whose encoder alone tells the angle, that drive has no turn that could be wrong.
    const bool goes_on = std::string_view{GetParam().name} == "LkTech" && *limits == '\0';
    EXPECT_NE(told, goes_on) << limits;
    EXPECT_TRUE(robot.motor(kArm).feedback.zeroed) << "its encoder has found it again" << limits;
    EXPECT_NEAR(robot.motor(kArm).feedback.total_angle_deg, 0.0, 0.5) << limits;
  }
}

INSTANTIATE_TEST_SUITE_P(All, TurnTest, ::testing::ValuesIn(kAbsoluteEncoders),
                         [](const auto& each) { return std::string{each.param.name}; });

// Its feedback wraps after 1432 deg, which is no whole number of turns.
TEST(TurnOfAWheel, IsFoundOnceTheWrapsOfItsDriveAreKnown) {
  VirtualRobot robot(robotOfArm({"", "model: DM4310, id: 1, master_id: 17"}, "", 40.0 * 360.0 + 150.0));
  for (int i = 0; i < 4000 && !robot.motor(kArm).feedback.zeroed; ++i) robot.run(1);
  EXPECT_TRUE(robot.motor(kArm).feedback.zeroed);
  EXPECT_NEAR(robot.motor(kArm).feedback.total_angle_deg, 150.0, 0.5);
}

// After a gap its drive can be told no place until it is enabled anew, but the angle is known.
TEST(TurnOfAnArm, KeepsItsSoftLimitsWhereOnlyTheCountOfTheDriveIsInDoubt) {
  for (const char* control : {"operation", "velocity"}) {
    VirtualRobot robot(robotOfArm(
        {"", "model: RS00, id: 3"},
        std::string{", angle_min_deg: -90, angle_max_deg: 200, feedback_timeout_ms: 400, control: "} +
            control,
        10.0));
    for (int i = 0; i < 4000 && robot.motor(kArm).status != MotorStatus::kReady; ++i) robot.run(1);
    ASSERT_EQ(robot.order(Operation::kEnable).motors[kArm], Refusal::kNone);
    robot.run(500);
    const Target up{.mode = ControlMode::kVelocity, .value = 20.0};
    robot.hold(kArm, up, 300);
    robot.simBus().silence(0, true);
    robot.hold(kArm, up, 230);
    robot.simBus().silence(0, false);
    robot.hold(kArm, up, 20);
    ASSERT_EQ(robot.motor(kArm).status, MotorStatus::kActive) << control;
    robot.hold(kArm, up, 4000);
    EXPECT_FALSE(robot.motor(kArm).feedback.zeroed) << control;
    EXPECT_NEAR(robot.simBus().drive(0).physics().outputAngleDeg(), 200.0, 5.0) << control;
  }
}

TEST(TurnOfAnArm, IsNotWrongByOneAndItsTargetLeadsNowhereElse) {
  VirtualRobot robot(
      robotOfArm({"", "model: GM6020, id: 1"}, ", angle_min_deg: -90, angle_max_deg: 200", 190.0));
  robot.run(10);
  ASSERT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
  const auto start_deg = robot.simBus().drive(0).physics().outputAngleDeg();
  for (int i = 0; i < 1500; ++i) {
    robot.hold(0, {.mode = ControlMode::kTotalAngle, .value = 180.0}, 1);
    ASSERT_LT(std::fabs(robot.simBus().drive(0).physics().outputAngleDeg() - start_deg), 20.0);
  }
  EXPECT_NEAR(robot.motor(0).feedback.total_angle_deg, 180.0, 1.0);
}

TEST(TurnOfAnArm, DoesNotMatterToOneThatIsHomed) {
  auto outcome = parseRobotConfig(R"(
robot: turn
realtime: preferred
buses:
  - name: bench
    type: sim
    motors:
      - {name: arm, model: GM6020, id: 1, command: current, angle_min_deg: -400, angle_max_deg: 400}
modules:
  - {name: lift, type: joint, motor: arm, homing: stop, homing_velocity_rpm: 20, homing_current_a: 0.5,
     max_velocity_deg_s: 100, max_acceleration_deg_s2: 100}
)",
                                  "turn.yaml");
  ASSERT_TRUE(outcome.config) << outcome.errorText();
  VirtualRobot robot(*outcome.config);
  robot.run(10);
  EXPECT_FALSE(robot.motor(0).feedback.zeroed);
  EXPECT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
}

}  // namespace
}  // namespace rc10::test::axis_turn_test
