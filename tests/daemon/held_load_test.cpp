// Every family holds a load in an e-stop, is enabled anew, and takes the load over.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "app/angle.hpp"
#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::held_load_test {
namespace {

struct Subject {
  const char* name;
  const char* motor;  ///< Its keys after the name.
  double load_nm;     ///< A good part of what it can hold.
  const char* bus = "";
  bool springs = false;             ///< It can be told an impedance.
  bool speed_of_zero_holds = true;  ///< A VESC lets go below 900 ERPM.
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

constexpr const char* kOdrive =
    "model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600, "
    "zero: power_on";

constexpr const char* kOdriveV3 =
    "model: ODrive_v3, id: 9, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600, "
    "zero: power_on";
constexpr const char* kVesc =
    "model: VESC, id: 11, pole_pairs: 7, angle: encoder, kv_rpm_per_v: 190, current_limit_a: 20, "
    "velocity_limit_rpm: 600, feedback_hz: 500";

const Subject kSubjects[] = {
    {"M3508", "model: M3508, id: 1, zero: power_on", 1.0},
    {"Gm6020", "model: GM6020, id: 2", 0.4},
    {"DamiaoMit", "model: DM4310, id: 1, master_id: 17, zero: power_on", 1.5, "", true},
    {"RobStride", "model: RS00, id: 3, zero: power_on", 3.0, "", true},
    {"CyberGear", "model: CyberGear, id: 4, zero: power_on", 2.0, "", true},
    {"CubeMarsMit", "model: AK80-9, id: 6, protocol: mit, zero: power_on", 3.0, "", true},
    {"CubeMarsServo", "model: AK80-9, id: 5, zero: power_on", 3.0},
    {"Moteus", "model: moteus, id: 7, motor_kv_rpm_per_v: 100, zero: power_on", 0.3,
     "data_bitrate: 5000000\n    "},
    {"Odrive", kOdrive, 0.3},
    {"MyActuator", "model: RMD-X8-20, id: 11, zero: power_on", 3.0, "", true},
    {"LkTech", "model: LK-MG5010E-i10, id: 12, zero: power_on", 1.0},
    {"M2006", "model: M2006, id: 3, zero: power_on", 0.3},
    {"Gm6020ByVoltage", "model: GM6020, id: 1, command: voltage", 0.4},
    {"OdriveV3", kOdriveV3, 0.3},
    // Not by its tachometer, which sees steps of 8 degrees.
    {"VescByEncoder", kVesc, 0.3, "", false, false},
};

// Keys that slow a target down must not let the load go.
const char* const kSlews[] = {"", "soft_start_ms: 0, angle_slew_deg_per_s: 60", "soft_start_ms: 1000"};

RobotConfig configOf(const Subject& subject, const char* slew) {
  const std::string separator = *slew == '\0' ? "" : ", ";
  const std::string text = std::string{"robot: load\nrealtime: preferred\nbuses:\n  - name: bench\n"} +
                           "    type: sim\n    " + subject.bus + "motors:\n      - {name: motor, " +
                           subject.motor + separator + slew + "}\n";
  auto outcome = parseRobotConfig(text, "load.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  auto config = outcome.config.value_or(twoWheelsAndYaw());
  config.buses[0].motors[0].fallback.on_estop = FallbackAction::kHold;
  config.buses[0].motors[0].fallback.on_timeout = FallbackAction::kHold;
  return config;
}

class HeldLoad : public ::testing::TestWithParam<std::tuple<Subject, const char*>> {
 protected:
  static constexpr std::size_t kMotor = 0;

  double angleDeg() { return drive().physics().outputAngleDeg(); }
  sim::Drive& drive() { return robot.simBus().drive(kMotor); }
  [[nodiscard]] bool enable() {
    for (int attempt = 0; attempt < 4; ++attempt) {
      robot.order(Operation::kEnable);
      if (robot.motor(kMotor).status == MotorStatus::kActive) return true;
      robot.run(1000);
    }
    return false;
  }
  /// Under its load, held at the angle that this returns, and enabled again.
  double heldDeg() {
    for (int i = 0; i < 4000 && robot.motor(kMotor).status != MotorStatus::kReady; ++i) robot.run(1);
    EXPECT_TRUE(enable());
    const Target place{.mode = ControlMode::kTotalAngle, .value = measuredDeg()};
    robot.hold(kMotor, place, 500);
    sim::MotorLoad load = drive().load();
    load.load_torque_nm = static_cast<float>(std::get<0>(GetParam()).load_nm);
    drive().setLoad(load);
    robot.hold(kMotor, place, 3000);
    const double held_deg = measuredDeg();
    robot.order(Operation::kEstop);
    robot.run(2000);
    for (int i = 0; i < 20'000 && robot.snapshot().state != RobotStatus::kRun; ++i)
      robot.order(Operation::kClear);
    EXPECT_TRUE(enable());
    robot.run(300);
    EXPECT_EQ(robot.motor(kMotor).acting, Acting::kHold);
    return held_deg;
  }
  double measuredDeg() { return robot.motor(kMotor).feedback.total_angle_deg; }
  /// Way down while this target comes into force.
  double sinksDeg(const Target& target) {
    const double before_deg = angleDeg();
    double lowest_deg = before_deg;
    for (int i = 0; i < 2000; ++i) {
      robot.hold(kMotor, target, 1);
      lowest_deg = std::min(lowest_deg, angleDeg());
    }
    return before_deg - lowest_deg;
  }

  VirtualRobot robot{configOf(std::get<0>(GetParam()), std::get<1>(GetParam()))};
};

TEST_P(HeldLoad, IsNotLetDownByTheAngleForWhichItWasHeld) {
  const double held_deg = heldDeg();
  EXPECT_LT(sinksDeg({.mode = ControlMode::kTotalAngle, .value = held_deg}), 0.3);
}

// In a pause of the computer no drive that only answers is heard: where it held its load it goes on at once.
TEST_P(HeldLoad, IsNotLetGoWhenItsTargetEndsInAPause) {
  const double held_deg = heldDeg();
  robot.hold(kMotor, {.mode = ControlMode::kTotalAngle, .value = held_deg}, 2000);
  const double before_deg = angleDeg();
  robot.tick(60);
  EXPECT_EQ(robot.robot().motors()[kMotor].motor->ordered(), FrameKind::kHold);
  double lowest_deg = angleDeg();
  for (int i = 0; i < 500; ++i) {
    robot.run(1);
    lowest_deg = std::min(lowest_deg, angleDeg());
  }
  // A spring sags once more from where it is held.
  const bool sags = std::get<0>(GetParam()).springs;
  EXPECT_LT(before_deg - lowest_deg, sags ? 8.0 : 0.6);
}

/// A motor whose own loop carries the load, without a key that slows it down.
class HeldLoadOfALoop : public HeldLoad {
 protected:
  /// Its order in the tick after a pause, in which its target has ended and nothing was heard.
  FrameKind orderedAfter(const Target& target, int ticks) {
    robot.hold(kMotor, target, ticks);
    robot.freezeSimulation(true);
    robot.tick(60);
    robot.freezeSimulation(false);
    return robot.robot().motors()[kMotor].motor->ordered();
  }
};

TEST_P(HeldLoadOfALoop, IsHeldAfterAPauseWhereverItHadNoReasonToLeaveItsPlace) {
  (void)heldDeg();
  if (std::get<0>(GetParam()).speed_of_zero_holds) {
    EXPECT_EQ(orderedAfter({.mode = ControlMode::kVelocity}, 2000), FrameKind::kHold);
  }
  const double turn_deg = static_cast<double>(robot.motor(kMotor).feedback.angle_deg);
  EXPECT_EQ(orderedAfter({.mode = ControlMode::kAngle, .value = turn_deg}, 2000), FrameKind::kHold);
  EXPECT_EQ(orderedAfter({.mode = ControlMode::kBrake}, 2000), FrameKind::kHold);
}

TEST_P(HeldLoadOfALoop, IsNotHeldAfterAPauseWhereItsTargetLedElsewhere) {
  const double place_deg = heldDeg();
  robot.simBus().stall(kMotor, true);
  for (const double rpm : {30.0, -30.0}) {
    EXPECT_EQ(orderedAfter({.mode = ControlMode::kVelocity, .value = rpm}, 2000), FrameKind::kIdle);
  }
  EXPECT_EQ(orderedAfter({.mode = ControlMode::kTotalAngle, .value = place_deg + 30.0}, 2000),
            FrameKind::kIdle);
  const double beside_deg = wrapDegrees(static_cast<double>(robot.motor(kMotor).feedback.angle_deg) + 30.0);
  EXPECT_EQ(orderedAfter({.mode = ControlMode::kAngle, .value = beside_deg}, 2000), FrameKind::kIdle);
}

TEST(HeldAfterAPause, IsNoMotorThatIsStillBeingBraked) {
  auto config = configOf(kSubjects[0], "");
  config.buses[0].motors[0].fallback.on_timeout = FallbackAction::kHold;
  VirtualRobot robot{config};
  robot.run(5);
  robot.order(Operation::kEnable);
  robot.hold(0, {.mode = ControlMode::kVelocity, .value = 120.0}, 1500);
  robot.hold(0, {.mode = ControlMode::kBrake}, 1);
  robot.freezeSimulation(true);
  robot.tick(60);
  EXPECT_EQ(robot.robot().motors()[0].motor->ordered(), FrameKind::kIdle);
}

TEST(HeldAfterAPause, IsAMotorThatAFallbackHasBraked) {
  for (const auto& [action, ordered] : {std::pair{FallbackAction::kBrake, FrameKind::kBrake},
                                        std::pair{FallbackAction::kDamp, FrameKind::kDamp}}) {
    auto config = configOf(kSubjects[0], "");
    config.buses[0].motors[0].fallback.on_timeout = action;
    VirtualRobot robot{config};
    robot.run(5);
    robot.order(Operation::kEnable);
    robot.hold(0, {.mode = ControlMode::kVelocity}, 200);
    robot.run(200);  // silence
    const auto* motor = robot.robot().motors()[0].motor.get();
    ASSERT_EQ(motor->ordered(), ordered);
    robot.exchange().estop.store(true);
    robot.freezeSimulation(true);
    robot.tick(60);
    EXPECT_EQ(motor->ordered(), FrameKind::kHold);
  }
}

// A spring drive has no integral that would hold it.
class HeldLoadOfASpring : public HeldLoad {};

TEST_P(HeldLoadOfASpring, IsTakenOverByAFeedForward) {
  const auto load_nm = static_cast<float>(std::get<0>(GetParam()).load_nm);
  (void)heldDeg();
  EXPECT_LT(sinksDeg({.mode = ControlMode::kImpedance,
                      .value = measuredDeg(),
                      .torque_ff_nm = load_nm,
                      .stiffness_nm_per_rad = 5.0F,
                      .damping_nms_per_rad = 1.0F}),
            1.0);
  robot.order(Operation::kEstop);
  robot.run(2000);
  for (int i = 0; i < 20'000 && robot.snapshot().state != RobotStatus::kRun; ++i)
    robot.order(Operation::kClear);
  ASSERT_TRUE(enable());
  EXPECT_LT(sinksDeg({.mode = ControlMode::kVelocity, .torque_ff_nm = load_nm}), 1.0);
}

TEST_P(HeldLoad, IsNotLetDownByAZero) {
  (void)heldDeg();
  robot.order(Operation::kEstop);
  robot.run(2000);
  const double before_deg = angleDeg();
  for (const double zero_deg : {30.0, -20.0, 0.0}) {
    EXPECT_EQ(robot.order(Operation::kZero, zero_deg).motors[kMotor], Refusal::kNone);
    robot.run(500);
    EXPECT_NEAR(angleDeg(), before_deg, 0.3) << zero_deg;
  }
}

TEST_P(HeldLoad, IsOfASpringOrNot) {
  EXPECT_EQ(robot.robot().motors()[kMotor].motor->modes().contains(ControlMode::kImpedance),
            std::get<0>(GetParam()).springs);
}

std::string nameOf(const ::testing::TestParamInfo<std::tuple<Subject, const char*>>& made) {
  const std::string slew = std::get<1>(made.param);
  return std::string{std::get<0>(made.param).name} + (slew.empty() ? "SoftStart"
                                                      : slew.find("angle_slew") != slew.npos
                                                          ? "AngleSlew"
                                                          : "LongSoftStart");
}

std::vector<Subject> thatAre(bool springs) {
  std::vector<Subject> all;
  std::copy_if(std::begin(kSubjects), std::end(kSubjects), std::back_inserter(all),
               [springs](const Subject& subject) { return subject.springs == springs; });
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, HeldLoad,
                         ::testing::Combine(::testing::ValuesIn(kSubjects), ::testing::ValuesIn(kSlews)),
                         nameOf);

INSTANTIATE_TEST_SUITE_P(All, HeldLoadOfALoop,
                         ::testing::Combine(::testing::ValuesIn(thatAre(false)), ::testing::Values("")),
                         nameOf);

INSTANTIATE_TEST_SUITE_P(All, HeldLoadOfASpring,
                         ::testing::Combine(::testing::ValuesIn(thatAre(true)), ::testing::ValuesIn(kSlews)),
                         nameOf);

}  // namespace
}  // namespace rc10::test::held_load_test
