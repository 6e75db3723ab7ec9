// The module `joint` on simulated shafts with stops: what its motor does, in each family, and what the rest
// of the robot may do meanwhile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>

#include "config/load_config.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::joint_robot_test {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::Field;
using ::testing::Not;

constexpr std::size_t kArm = 0;
constexpr double kIdle = 0.0;
constexpr double kHoming = 1.0;
constexpr double kFollowing = 2.0;
constexpr double kHomingFailed = 3.0;
constexpr double kStopDeg = -60.0;  // of the shaft itself

struct Keys {
  std::string motor = "model: M3508, id: 1";
  std::string more = ", angle_min_deg: 0, angle_max_deg: 150";
  std::string load = "initial_angle_deg: -20";
  std::string joint = "homing_velocity_rpm: -10, homing_current_a: 2";
  std::string bus{};
};

class JointOfARobot : public ::testing::Test {
 protected:
  void start(const Keys& keys) {
    const bool reduces = keys.more.find("reduced") != std::string::npos;
    const std::string input = reduces ? "mode_gpio: {chip: gpiochip0, line: 1}\n" : "";
    auto outcome = parseRobotConfig(
        "robot: arm\nrealtime: preferred\n" + input + "buses:\n  - name: bench\n    type: sim\n    " +
            keys.bus + "motors:\n      - {name: arm, " + keys.motor + keys.more +
            ", simulated: {stop_min_deg: -60, stop_max_deg: 120, " + keys.load +
            "}}\nmodules:\n  - {name: lift, type: joint, motor: arm, max_velocity_deg_s: 60, "
            "max_acceleration_deg_s2: 240, homing: stop, " +
            keys.joint + "}\n",
        "arm.yaml");
    ASSERT_TRUE(outcome.config) << outcome.errorText();
    robot = std::make_unique<VirtualRobot>(*outcome.config);
    sends = false;
    for (int i = 0; i < 5; ++i) tick();
    enable();
  }
  void enable() {
    for (int attempt = 0; attempt < 8 && status() != MotorStatus::kActive; ++attempt) {
      (void)robot->order(Operation::kEnable);
      for (int i = 0; i < 1000 && status() != MotorStatus::kActive; ++i) tick();
    }
    ASSERT_EQ(status(), MotorStatus::kActive);
  }
  void tick() {
    robot->exchange().mode_contact.show(contact);
    if (sends) send();
    robot->tick();
    fastest_deg_s = std::max(fastest_deg_s, std::fabs(shaft().outputRpm() * 6.0));
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }
  void ask(double angle_deg, double home = kNoSignal) {
    asked = {angle_deg, home};
    sends = true;
  }
  void send() { robot->giveInputs({asked[0], asked[1]}, 50ms); }
  /// Until it is homed, or has failed.
  void home(int ticks = 20'000) {
    ask(kNoSignal, 1.0);
    run(2);
    for (int i = 0; i < ticks && state() == kHoming; ++i) tick();
  }
  double output(std::size_t place) { return robot->snapshot().modules[0].outputs[place]; }
  double state() { return output(0); }
  double moved() { return output(1); }
  MotorStatus status() { return robot->motor(kArm).status; }
  double angleDeg() { return robot->motor(kArm).feedback.total_angle_deg; }
  const sim::MotorPhysics& shaft() { return robot->simBus().drive(0).physics(); }

  std::unique_ptr<VirtualRobot> robot;
  ContactState contact = ContactState::kClosed;
  std::array<double, 2> asked{};
  bool sends = false;
  double fastest_deg_s = 0.0;
};

TEST_F(JointOfARobot, IsHomedAgainThoughItsStopLiesBeyondTheLimitsOfAFalseHome) {
  start({.motor = "model: M3508, id: 1, zero: power_on"});
  ask(30.0);
  run(3000);
  ASSERT_NEAR(shaft().outputAngleDeg(), 10.0, 1.0) << "30 deg from where it was switched on";
  home();
  ASSERT_EQ(state(), kFollowing);
  EXPECT_NEAR(shaft().outputAngleDeg() - angleDeg(), kStopDeg, 0.1);
  EXPECT_THAT(robot->events(), Not(Contains(Field(&Event::code, EventCode::kReferenceLost))))
      << "it was asked";
  ask(30.0);
  run(3000);
  EXPECT_NEAR(shaft().outputAngleDeg(), kStopDeg + 30.0, 1.0);
}

TEST_F(JointOfARobot, ComesBackFromAStopBeyondItsSoftLimitAlongItsProfile) {
  start({.joint = "homing_velocity_rpm: -5, homing_current_a: 2, home_angle_deg: -20"});
  home();
  ASSERT_EQ(state(), kFollowing);
  run(500);
  EXPECT_NEAR(angleDeg(), -20.0, 0.5) << "nobody has asked for more";
  fastest_deg_s = 0.0;
  ask(40.0);
  run(4000);
  EXPECT_NEAR(angleDeg(), 40.0, 1.0);
  EXPECT_LT(fastest_deg_s, 75.0) << "60 deg/s, and what the loops overshoot";
}

TEST_F(JointOfARobot, DoesNotLeapWhenAHandThatHeldItLetsGo) {
  start({});
  home();
  ask(140.0);
  run(300);
  robot->simBus().stall(0, true);
  run(3000);
  EXPECT_EQ(moved(), 3.0) << "failed";
  fastest_deg_s = 0.0;
  robot->simBus().stall(0, false);
  run(5000);
  EXPECT_NEAR(angleDeg(), 140.0, 1.0);
  EXPECT_LT(fastest_deg_s, 450.0) << "of 10 deg at the speed of the loops; it was not led farther";
}

TEST_F(JointOfARobot, MovesSlowlyInReducedModeWithoutAFailureAndWithoutALeapAfterIt) {
  start({.more = ", angle_min_deg: 0, angle_max_deg: 150, reduced_velocity_rpm: 3"});
  home();
  contact = ContactState::kOpen;
  run(1500);
  ask(140.0);
  run(2000);
  EXPECT_EQ(moved(), 1.0) << "under way";
  EXPECT_LT(angleDeg(), 45.0) << "18 deg/s";
  fastest_deg_s = 0.0;
  contact = ContactState::kClosed;
  run(5000);
  EXPECT_EQ(moved(), 2.0) << "done";
  EXPECT_LT(fastest_deg_s, 220.0) << "and it is 10 deg ahead";
}

TEST_F(JointOfARobot, AnEstopInAnyPhaseOfAHomingEndsItAndTheStreamBeginsNoOtherAfterIt) {
  for (const int ticks : {3, 100, 300, 600, 900, 1200, 1500}) {
    start({});
    ask(kNoSignal, 1.0);
    run(ticks);
    ASSERT_EQ(state(), kHoming) << ticks;
    (void)robot->order(Operation::kEstop);
    tick();
    EXPECT_EQ(state(), kIdle);
    EXPECT_EQ(robot->motor(kArm).target.mode, ControlMode::kCoast);
    for (int i = 0; i < 20'000 && robot->order(Operation::kClear).motors[kArm] != Refusal::kNone; ++i) tick();
    enable();
    run(500);
    EXPECT_EQ(state(), kIdle) << ticks;
    EXPECT_EQ(robot->motor(kArm).acting, Acting::kNothing);
    EXPECT_FALSE(robot->motor(kArm).feedback.zeroed);
  }
}

TEST_F(JointOfARobot, ASilenceInAnyPhaseOfAHomingLeavesTheMotorToItsFallback) {
  for (const int ticks : {3, 100, 300, 600, 900, 1200, 1500}) {
    start({});
    ask(kNoSignal, 1.0);
    run(ticks);
    ASSERT_EQ(state(), kHoming) << ticks;
    sends = false;
    run(50 + 20 + 2);
    EXPECT_EQ(state(), kIdle);
    EXPECT_EQ(robot->motor(kArm).acting, Acting::kNothing) << ticks;
  }
}

TEST_F(JointOfARobot, AProgramThatTakesItsMotorEndsAHoming) {
  start({});
  ask(kNoSignal, 1.0);
  run(300);
  ASSERT_EQ(state(), kHoming);
  robot->commandAs("other", 5, kArm, {.mode = ControlMode::kVelocity, .value = 0.0});
  run(2);
  EXPECT_EQ(state(), kIdle);
  run(500);
  EXPECT_EQ(state(), kIdle) << "the homing is not taken up again";
}

TEST_F(JointOfARobot, NobodyElseZeroesItWhileItHomes) {
  start({});
  ask(kNoSignal, 1.0);
  run(300);
  EXPECT_EQ(robot->order(Operation::kZero, 20.0).motors[kArm], Refusal::kActive);
  EXPECT_FALSE(robot->motor(kArm).feedback.zeroed);
}

TEST_F(JointOfARobot, HomesWithACurrentThatIsSlewedAndFromItsFarStop) {
  start({.more = ", angle_min_deg: 0, angle_max_deg: 180, current_slew_a_per_s: 2",
         .load = "initial_angle_deg: 120",
         .joint = "homing_velocity_rpm: -10, homing_current_a: 1, homing_timeout_s: 60"});
  home(60'000);
  ASSERT_EQ(state(), kFollowing);
  EXPECT_NEAR(shaft().outputAngleDeg() - angleDeg(), kStopDeg, 0.1);
}

// The count of a RobStride is in doubt until it is enabled anew: it refuses any zero until then.
TEST_F(JointOfARobot, AHomingThatCannotSucceedDoesNotBeginAndLeavesTheSoftLimits) {
  start({.motor = "model: RS00, id: 3",
         .more = ", angle_min_deg: 0, angle_max_deg: 90, feedback_timeout_ms: 400",
         .load = "initial_angle_deg: 40"});
  robot->simBus().silence(0, true);
  run(230);
  robot->simBus().silence(0, false);
  run(50);
  ASSERT_EQ(status(), MotorStatus::kActive);
  ASSERT_TRUE(robot->motor(kArm).feedback.bounds_only);
  (void)robot->events();
  ask(kNoSignal, 1.0);
  for (int i = 0; i < 500; ++i) {
    tick();
    ASSERT_NE(state(), kHoming);
    ASSERT_EQ(robot->motor(kArm).target.mode, ControlMode::kCoast) << "nothing is pressed";
  }
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(robot->events(), Contains(Field(&Event::code, EventCode::kModule)));
  sends = false;
  run(100);
  robot->hold(kArm, {.mode = ControlMode::kVelocity, .value = 20.0}, 3000);
  EXPECT_GT(shaft().outputAngleDeg(), 80.0);
  EXPECT_LT(shaft().outputAngleDeg(), 95.0) << "its own stop is at 120";
  (void)robot->order(Operation::kDisable);
  run(100);
  enable();
  robot->hold(kArm, {.mode = ControlMode::kVelocity, .value = -20.0}, 1500);
  run(100);
  home();
  EXPECT_EQ(state(), kFollowing) << "enabled anew it homes";
}

/// Motors whose encoder tells their angle at power-up.
class JointWithAnEncoder : public JointOfARobot, public ::testing::WithParamInterface<Keys> {};

TEST_P(JointWithAnEncoder, ThatFailedToHomeHasNoReferenceAfterARestartOfItsDriveEither) {
  start(GetParam());
  robot->simBus().stall(0, true);
  home();
  ASSERT_EQ(state(), kHomingFailed);
  robot->simBus().stall(0, false);
  sends = false;
  robot->simBus().drive(0).restart();
  robot->freezeBus(0, true);
  run(300);
  robot->freezeBus(0, false);
  run(3000);
  EXPECT_EQ(output(4), 0.0) << "homed";
  EXPECT_FALSE(robot->motor(kArm).feedback.zeroed);
  enable();
  for (int i = 0; i < 200; ++i) {
    robot->command(kArm, {.mode = ControlMode::kTotalAngle, .value = 30.0});
    tick();
    ASSERT_NE(robot->motor(kArm).target.mode, ControlMode::kTotalAngle);
  }
  EXPECT_EQ(output(4), 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    Families, JointWithAnEncoder,
    ::testing::Values(Keys{.motor = "model: GM6020, id: 5, command: current",
                           .joint = "homing_velocity_rpm: -10, homing_current_a: 0.5"},
                      Keys{.motor = "model: DM4310, id: 1, master_id: 17"},
                      Keys{.motor = "model: RS00, id: 3"},
                      Keys{.motor = "model: moteus, id: 7, motor_kv_rpm_per_v: 100, absolute: true",
                           .bus = "data_bitrate: 5000000\n    "}));

// ---- In each family

struct Subject {
  const char* name;
  const char* motor;
  double current_a = 2.0;
  const char* bus = "";
  const char* load = "";
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

const Subject kSubjects[] = {
    {"M3508", "model: M3508, id: 1"},
    {"M3508Reversed", "model: M3508, id: 1, direction: -1"},
    {"M2006", "model: M2006, id: 2", 1.0},
    {"GM6020", "model: GM6020, id: 5, command: current", 0.5},
    {"Vesc",
     "model: VESC, id: 10, pole_pairs: 7, gear_ratio: 50, velocity_limit_rpm: 100, feedback_hz: 500, "
     "motor_current_max_a: 40, kv_rpm_per_v: 190",
     3.0},
    {"DamiaoMit", "model: DM4310, id: 1, master_id: 17", 1.5},
    {"RobStride", "model: RS00, id: 3", 2.0},
    {"CubeMarsMit", "model: AK80-9, id: 6, protocol: mit", 4.0},
    {"CubeMarsServo", "model: AK80-9, id: 5", 4.0},
    {"Moteus", "model: moteus, id: 7, motor_kv_rpm_per_v: 100", 3.0, "data_bitrate: 5000000\n    "},
    {"OdriveS1",
     "model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600, "
     "telemetry_hz: 100",
     4.0, "", ", inertia_kg_m2: 0.02"},
    {"OdriveS1BareRotor",
     "model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600, "
     "telemetry_hz: 100",
     4.0},
    {"MyActuator", "model: RMD-X8-20, id: 11", 2.0},
    {"LkTech", "model: LK-MG5010E-i10, id: 12", 1.0},
};

class JointOfAFamily : public JointOfARobot, public ::testing::WithParamInterface<Subject> {};

TEST_P(JointOfAFamily, HomesAtItsStopAndMovesFromThere) {
  const auto& subject = GetParam();
  const bool reversed = std::string_view{subject.motor}.find("direction") != std::string_view::npos;
  Keys keys{.motor = subject.motor, .bus = subject.bus};
  if (reversed) keys.more = ", angle_min_deg: -150, angle_max_deg: 0";
  keys.load += subject.load;
  keys.joint = std::string{"homing_velocity_rpm: "} + (reversed ? "10" : "-10") +
               ", homing_current_a: " + std::to_string(subject.current_a);
  start(keys);
  home();
  ASSERT_EQ(state(), kFollowing);
  const double sign = reversed ? -1.0 : 1.0;
  EXPECT_NEAR(shaft().outputAngleDeg() - sign * angleDeg(), kStopDeg, 0.5);
  ask(sign * 60.0);
  run(5000);
  EXPECT_EQ(moved(), 2.0);
  EXPECT_NEAR(shaft().outputAngleDeg(), kStopDeg + 60.0, 1.5);
}

INSTANTIATE_TEST_SUITE_P(All, JointOfAFamily, ::testing::ValuesIn(kSubjects),
                         [](const auto& each) { return std::string{each.param.name}; });

}  // namespace
}  // namespace rc10::test::joint_robot_test
