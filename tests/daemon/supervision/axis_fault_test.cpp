// Latched faults, as the drive and the user see them.

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "config/load_config.hpp"
#include "config/report/report.hpp"
#include "daemon/supervision/one_motor.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::axis_fault_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;

RobotConfig robotWith(const GuardConfig& guard, bool stalled = false) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[kLeft].guard = guard;
  config.buses[0].motors[kLeft].simulated.stalled = stalled;
  return config;
}

class FaultTest : public ::testing::Test {
 protected:
  void start(const RobotConfig& config) {
    robot = std::make_unique<VirtualRobot>(config);
    robot->run(5);
    robot->order(Operation::kEnable);
    (void)robot->events();
  }
  void turnBoth(int ticks) {
    const Target velocity{.mode = ControlMode::kVelocity, .value = 120.0};
    for (int i = 0; i < ticks; ++i) {
      robot->command(kRight, velocity);
      robot->hold(kLeft, velocity, 1);
    }
  }
  std::size_t faults() {
    const auto events = robot->events();
    return static_cast<std::size_t>(std::count_if(
        events.begin(), events.end(), [](const Event& e) { return e.code == EventCode::kMotorFault; }));
  }

  std::unique_ptr<VirtualRobot> robot;
};

TEST_F(FaultTest, AMotorThatIsTooFastStopsAndTheOthersGoOn) {
  start(robotWith({.overspeed_rpm = 60.0F}));
  turnBoth(1000);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kFault);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kOverspeed);
  EXPECT_EQ(robot->motor(kLeft).command_value, 0.0F);
  EXPECT_EQ(robot->motor(kRight).status, MotorStatus::kActive);
  EXPECT_NEAR(robot->motor(kRight).feedback.velocity_rpm, 120.0F, 3.0F);
  EXPECT_EQ(faults(), 1U);
}

TEST_F(FaultTest, AFaultIsLatchedUntilClearedAndEnabledAgain) {
  start(robotWith({.overspeed_rpm = 60.0F}));
  turnBoth(1000);
  EXPECT_EQ(robot->order(Operation::kEnable).motors[kLeft], Refusal::kFaulted);
  robot->run(3000);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kOverspeed);
  robot->order(Operation::kClear);
  robot->run(2);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kReady);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kNone);
  EXPECT_EQ(robot->order(Operation::kEnable).motors[kLeft], Refusal::kNone);
  robot->run(100);
  EXPECT_EQ(robot->motor(kLeft).status, MotorStatus::kActive);
}

TEST(DriveThatComplains, ChangesNoFaultThatItsMotorHasAlready) {
  OneMotor one{"model: DM4310, id: 1, master_id: 17"};
  auto& drive = one.robot().simBus().drive(0);
  drive.fault(8);
  one.follow(ControlMode::kVelocity, 30.0, 100);
  ASSERT_EQ(one.seen().status, MotorStatus::kFault);
  ASSERT_EQ(one.seen().fault, FaultCode::kDriveOverVoltage);
  drive.fault(9);
  one.robot().run(100);
  EXPECT_EQ(one.seen().fault, FaultCode::kDriveOverVoltage);
}

TEST_F(FaultTest, AHotMotorIsStoppedAsSoonAsItIsEnabled) {
  start(robotWith({.temperature_derate_c = 10.0F, .temperature_trip_c = 20.0F}));
  turnBoth(5);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kOverheated);
}

// Its fallback acted before, and goes on where its group lets go of it: it would brake for a tick.
TEST(AMotorThatGetsTooHot, WhileItsDriveIsEnabledDoesNotGoBackToItsFallback) {
  const auto outcome = parseRobotConfig(
      "robot: lifter\nrealtime: preferred\nbuses:\n  - name: lifts\n    type: sim\n    motors:\n"
      "      - {name: left, model: RMD-X8-20, id: 1}\n"
      "      - {name: right, model: RMD-X8-20, id: 2, command_divider: 4, on_estop: brake, brake_max_s: 10,"
      " simulated: {load_torque_nm: 1}}\n"
      "groups: [{name: both, motors: [left, right], together: true}]\n",
      "lifter.yaml");
  ASSERT_TRUE(outcome.config) << outcome.errorText();
  for (int phase = 0; phase < 4; ++phase) {  // of the motor's turns
    VirtualRobot robot{*outcome.config};
    robot.run(100);
    robot.order(Operation::kEnable);
    ASSERT_EQ(robot.motor(kRight).status, MotorStatus::kActive);
    robot.order(Operation::kEstop);
    robot.run(500 + phase);
    robot.order(Operation::kClear);
    ASSERT_EQ(robot.motor(kRight).acting, Acting::kBrake);
    robot.beginEnabling(MotorSet{}.set(kLeft).set(kRight));
    for (const auto motor : {kLeft, kRight}) robot.simBus().setTemperature(motor, 120.0);
    for (int i = 0; i < 40; ++i) {
      robot.tick();
      const bool hot = robot.motor(kRight).feedback.temperature_c > 100.0F;
      ASSERT_TRUE(!hot || robot.motor(kRight).acting == Acting::kNothing) << phase << ": " << i;
    }
    EXPECT_EQ(robot.motor(kRight).fault, FaultCode::kOverheated);
  }
}

TEST_F(FaultTest, AWarmMotorGetsLess) {
  start(robotWith({.temperature_derate_c = 20.0F, .temperature_trip_c = 30.0F}));  // it has 25 C
  robot->hold(kLeft, {.mode = ControlMode::kCurrent, .value = 20.0}, 5);
  EXPECT_FLOAT_EQ(robot->motor(kLeft).command_value, 10.0F);
  EXPECT_EQ(robot->motor(kLeft).limits, kLimitCurrent | kLimitTemperature);
}

TEST_F(FaultTest, AStalledMotorStopsPushing) {
  auto config = robotWith({.stall_time = 300ms, .stall_rpm = 10.0F}, true);
  config.buses[0].motors[kLeft].settings.effort_limit = 2.0F;
  start(config);
  turnBoth(2000);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kStalled);
  EXPECT_EQ(robot->motor(kLeft).command_value, 0.0F);
}

// Not from 0, which would brake the shaft with all its current.
TEST(DutyOfATurningShaft, BeginsWhereTheShaftIs) {
  for (const std::string keys : {"", ", current_slew_a_per_s: 40", ", soft_start_ms: 0"}) {
    SCOPED_TRACE(keys);
    OneMotor motor{
        "model: VESC, id: 10, pole_pairs: 7, current_limit_a: 30, velocity_limit_rpm: 3000, "
        "kv_rpm_per_v: 190, feedback_hz: 200" +
        keys};
    motor.follow(ControlMode::kVelocity, 1500.0, 3000);
    ASSERT_NEAR(motor.seen().feedback.velocity_rpm, 1500.0F, 50.0F);
    float least_a = 0.0F;
    for (int i = 0; i < 500; ++i) {
      motor.follow(ControlMode::kDuty, 0.7, 1);
      least_a = std::min(least_a, motor.seen().feedback.current_a);
    }
    EXPECT_GT(least_a, -5.0F);
    EXPECT_GT(motor.seen().feedback.velocity_rpm, 1450.0F);
  }
}

/// Guard of an M3508 as configured.
const GuardConfig kMotion{
    .overspeed_rpm = 723.0F, .encoder_jumps = true, .frozen_a = 1.0F, .runaway_rpm = 48.0F};

TEST_F(FaultTest, ASlippedEncoderStopsTheMotorAndItsReferenceIsLost) {
  start(robotWith(kMotion));
  const Target slow{.mode = ControlMode::kVelocity, .value = 30.0};
  for (int i = 0; i < 1000; ++i) {
    if (i == 998) robot->simBus().setEncoderFault(kLeft, {.slip_turns = 0.4});
    robot->command(kRight, slow);
    robot->hold(kLeft, slow, 1);
  }
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kEncoderJump);
  EXPECT_EQ(robot->motor(kLeft).command_value, 0.0F);
  EXPECT_FALSE(robot->motor(kLeft).feedback.zeroed);
  EXPECT_EQ(robot->motor(kRight).status, MotorStatus::kActive);
}

TEST_F(FaultTest, ADriveThatRepeatsOneFrameForEverIsStopped) {
  start(robotWith(kMotion));
  turnBoth(1000);
  robot->simBus().setEncoderFault(kLeft, {.frozen = true});
  const Target faster{.mode = ControlMode::kVelocity, .value = 240.0};
  int ticks = 0;
  while (robot->motor(kLeft).status == MotorStatus::kActive && ++ticks < 1000) robot->hold(kLeft, faster, 1);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kFrozen);
  EXPECT_LT(ticks, 250);
}

TEST_F(FaultTest, AReversedEncoderIsFoundBeforeTheMotorIsAtFullSpeed) {
  start(robotWith(kMotion));
  robot->simBus().setEncoderFault(kLeft, {.reversed = true});
  robot->run(2);
  int ticks = 0;
  while (robot->motor(kLeft).status == MotorStatus::kActive && ++ticks < 5000) turnBoth(1);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kRunaway);
  EXPECT_LT(std::abs(robot->simBus().motor(kLeft).outputRpm()), 240.0);
}

TEST_F(FaultTest, HardReversalsAndBlocksAreNoFault) {
  start(robotWith(kMotion));
  for (int i = 0; i < 20; ++i) {
    const Target target{.mode = ControlMode::kVelocity, .value = i % 2 == 0 ? 480.0 : -480.0};
    robot->simBus().stall(kLeft, i % 5 == 4);
    robot->hold(kLeft, target, 500);
    ASSERT_EQ(robot->motor(kLeft).status, MotorStatus::kActive) << i;
  }
}

TEST_F(FaultTest, AFollowingErrorStopsAMotorThatDoesNotKeepUp) {
  auto config =
      robotWith({.following_error_deg = 20.0, .following_error_time = std::chrono::milliseconds{200}});
  config.buses[0].motors[kLeft].shaping.angle_slew_deg_per_s = 360.0F;
  start(config);
  const Target turn{.mode = ControlMode::kTotalAngle, .value = 360.0};
  robot->hold(kLeft, turn, 500);
  ASSERT_EQ(robot->motor(kLeft).status, MotorStatus::kActive);
  robot->simBus().stall(kLeft, true);
  robot->hold(kLeft, turn, 500);
  EXPECT_EQ(robot->motor(kLeft).fault, FaultCode::kFollowingError);
}

/// Half a turn to each side for `left`.
RobotConfig robotWithinHalfATurn(float approach_effort_per_rpm) {
  auto config = robotWith({});
  auto& shaping = config.buses[0].motors[kLeft].shaping;
  shaping.angle_min_deg = -180.0;
  shaping.angle_max_deg = 180.0;
  shaping.approach_rpm_per_deg = 2.0F;
  shaping.approach_effort_per_rpm = approach_effort_per_rpm;
  return config;
}

TEST_F(FaultTest, ASoftLimitHoldsACurrentWithGainsThatWereSetLive) {
  auto config = robotWithinHalfATurn(0.02F);
  config.buses[0].motors[kLeft].shaping.approach_effort_is_gain = true;
  start(config);
  Order gains;
  gains.operation = Operation::kSetGains;
  gains.motors.set(kLeft);
  gains.gains.count = 1;
  gains.gains.values[0] = {LoopGain::kVelocityKp, 0.2F};
  ASSERT_EQ(robot->carryOut(gains).motors[kLeft], Refusal::kNone);
  robot->hold(kLeft, {.mode = ControlMode::kCurrent, .value = 5.0}, 3000);
  EXPECT_NEAR(robot->motor(kLeft).feedback.total_angle_deg, 180.0, 5.0);
}

TEST_F(FaultTest, ASoftLimitHoldsInTheTickInWhichAnAbsoluteAngleIsKnownAgain) {
  constexpr std::size_t kYaw = 2;
  auto config = robotWith({});
  auto& yaw = config.buses[0].motors[kYaw];
  yaw.feedback_timeout = 500ms;
  yaw.shaping.angle_max_deg = 45.0;
  yaw.shaping.approach_effort_per_rpm = 0.2F;
  yaw.simulated.initial_angle_deg = 60.0F;
  start(config);
  const Target outwards{.mode = ControlMode::kCurrent, .value = 1.0};
  robot->hold(kYaw, outwards, 20);
  ASSERT_TRUE(robot->motor(kYaw).feedback.zeroed);
  robot->freezeSimulation(true);
  robot->hold(kYaw, outwards, 200);  // long enough to lose a turn
  robot->freezeSimulation(false);
  (void)robot->events();
  robot->hold(kYaw, outwards, 1);
  EXPECT_TRUE(robot->motor(kYaw).feedback.zeroed);
  EXPECT_LE(robot->motor(kYaw).command_value, 0.0F);
  const auto events = robot->events();
  EXPECT_TRUE(std::any_of(events.begin(), events.end(),
                          [](const Event& e) { return e.code == EventCode::kReferenceLost; }));
}

TEST_F(FaultTest, FeedForwardLeadsNoFartherThanTheSoftLimit) {
  auto config = robotWith({});
  config.buses[0].motors[kLeft].shaping.angle_max_deg = 180.0;
  config.buses[0].motors[kLeft].shaping.approach_rpm_per_deg = 2.0F;
  start(config);
  robot->hold(kLeft, {.mode = ControlMode::kTotalAngle, .value = 179.0, .velocity_ff_rpm = 200.0F}, 3000);
  EXPECT_LT(robot->motor(kLeft).feedback.total_angle_deg, 185.0);
}

TEST_F(FaultTest, AFirstAngleTooFarAwayIsSkippedAndALaterOneIsNot) {
  auto config = robotWith({});
  config.buses[0].motors[kLeft].shaping.max_first_step_deg = 10.0;
  start(config);
  robot->hold(kLeft, {.mode = ControlMode::kTotalAngle, .value = 90.0}, 10);
  EXPECT_EQ(robot->snapshot().skipped_setpoints, 10U);
  EXPECT_EQ(robot->motor(kLeft).command_value, 0.0F);
  robot->hold(kLeft, {.mode = ControlMode::kTotalAngle, .value = 5.0}, 10);
  robot->hold(kLeft, {.mode = ControlMode::kTotalAngle, .value = 90.0}, 1000);
  EXPECT_NEAR(robot->motor(kLeft).feedback.total_angle_deg, 90.0, 1.0);
}

}  // namespace
}  // namespace rc10::test::axis_fault_test
