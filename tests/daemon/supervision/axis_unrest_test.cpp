// The end of an e-stop of a robot that a slope moves.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::axis_unrest_test {
namespace {

constexpr std::size_t kWheel = 0;
constexpr Target kForwards{.mode = ControlMode::kVelocity, .value = 60.0};

/// A wheel on a slope, which runs down for two seconds at most.
RobotConfig onASlope(const std::string& keys, const std::string& top = "",
                     const std::string& motor = "model: M3508, id: 1", const std::string& load_nm = "1.5") {
  auto outcome = parseRobotConfig(
      "robot: slope\nrealtime: preferred\n" + top +
          "buses:\n  - name: bench\n    type: sim\n    motors:\n      - {name: wheel, " + motor +
          ", run_down_s: 2, " + keys + ", simulated: {load_torque_nm: " + load_nm + "}}\n",
      "slope.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

void stopWhileItDrives(VirtualRobot& robot) {
  robot.run(10);
  ASSERT_EQ(robot.order(Operation::kEnable).motors[kWheel], Refusal::kNone);
  robot.hold(kWheel, kForwards, 500);
  robot.exchange().estop.store(true);
  robot.tick();
}

TEST(ClearOnASlope, IsTakenOnceWhatStillTurnsIsPulledAndResisted) {
  for (const char* keys : {"on_estop: brake, brake_max_s: 0.5", "on_estop: damp"}) {
    VirtualRobot robot(onASlope(keys));
    stopWhileItDrives(robot);
    robot.run(1000);
    EXPECT_LT(robot.motor(kWheel).feedback.velocity_rpm, -15.0F) << "it rolls, damped";
    EXPECT_EQ(robot.order(Operation::kClear).motors[kWheel], Refusal::kMoving) << "it may be running down";
    robot.run(1000);
    const float rolls_rpm = robot.motor(kWheel).feedback.velocity_rpm;
    EXPECT_EQ(robot.order(Operation::kClear).motors[kWheel], Refusal::kNone);
    EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun);
    EXPECT_EQ(robot.motor(kWheel).status, MotorStatus::kReady);
    // Nothing has been taken off, and nothing moves by itself.
    robot.run(500);
    EXPECT_EQ(robot.motor(kWheel).acting, Acting::kDamp);
    EXPECT_NEAR(robot.motor(kWheel).feedback.velocity_rpm, rolls_rpm, 5.0F);
    // The driver has it back.
    ASSERT_EQ(robot.order(Operation::kEnable).motors[kWheel], Refusal::kNone);
    robot.hold(kWheel, {.mode = ControlMode::kVelocity, .value = 0.0}, 1000);
    EXPECT_NEAR(robot.motor(kWheel).feedback.velocity_rpm, 0.0F, 3.0F);
  }
}

TEST(ClearOnASlope, IsRefusedAsLongAsNothingResists) {
  VirtualRobot robot(onASlope("on_estop: coast"));
  stopWhileItDrives(robot);
  for (int i = 0; i < 10; ++i) {
    robot.run(500);
    EXPECT_EQ(robot.order(Operation::kClear).motors[kWheel], Refusal::kMoving);
  }
}

constexpr const char* kModeInput = "mode_gpio: {chip: gpiochip0, line: 1}\n";

/// With the contact of the mode input open.
void runReduced(VirtualRobot& robot, int ticks, std::optional<Target> held = {}) {
  for (int i = 0; i < ticks; ++i) {
    robot.exchange().mode_contact.show(ContactState::kOpen);
    if (held) robot.command(kWheel, *held);
    robot.tick();
  }
  ASSERT_NE(robot.snapshot().conditions & kConditionReduced, 0U);
}

TEST(ClearOnASlope, InReducedModeWhatResistsIsNotTakenAwayForASpeed) {
  VirtualRobot robot(
      onASlope("on_estop: damp, reduced_velocity_rpm: 10", kModeInput, "model: M3508, id: 1", "0.6"));
  runReduced(robot, 10);
  ASSERT_EQ(robot.order(Operation::kEnable).motors[kWheel], Refusal::kNone);
  runReduced(robot, 500, Target{.mode = ControlMode::kVelocity, .value = 8.0});
  robot.exchange().estop.store(true);
  runReduced(robot, 1900);
  EXPECT_LT(robot.motor(kWheel).feedback.velocity_rpm, -25.0F) << "faster than reduced mode allows";
  for (int i = 0; i < 1000; ++i) {
    runReduced(robot, 1);
    ASSERT_EQ(robot.motor(kWheel).status, MotorStatus::kReady) << i;
    ASSERT_EQ(robot.motor(kWheel).acting, Acting::kDamp) << i;
  }
  const float rolls_rpm = robot.motor(kWheel).feedback.velocity_rpm;
  EXPECT_EQ(robot.order(Operation::kClear).motors[kWheel], Refusal::kNone);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun);
  runReduced(robot, 500);
  EXPECT_EQ(robot.motor(kWheel).acting, Acting::kDamp);
  EXPECT_NEAR(robot.motor(kWheel).feedback.velocity_rpm, rolls_rpm, 5.0F);
  // Its driver has the whole time for the way down.
  ASSERT_EQ(robot.order(Operation::kEnable).motors[kWheel], Refusal::kNone);
  runReduced(robot, 1500, Target{.mode = ControlMode::kVelocity});
  EXPECT_EQ(robot.motor(kWheel).status, MotorStatus::kActive);
  EXPECT_NEAR(robot.motor(kWheel).feedback.velocity_rpm, 0.0F, 3.0F);
}

/// Fallbacks of a motor that a hand drags along, and what is left of them once it is too fast for reduced
/// mode.
struct Dragged {
  const char* motor;
  const char* keys;
  Acting left;  ///< kNothing: a fault.

  /// The action that is left is not the one that the keys ask for.
  [[nodiscard]] bool replaced() const {
    return left != Acting::kNothing &&
           !std::string_view{keys}.starts_with(left == Acting::kDamp ? "damp" : "brake");
  }
};

void PrintTo(const Dragged& dragged, std::ostream* out) { *out << dragged.motor << ", " << dragged.keys; }

class DraggedInReducedMode : public ::testing::TestWithParam<Dragged> {
 protected:
  /// Since the last call: actions that took the place of a fallback.
  static std::vector<FallbackAction> replacements(VirtualRobot& robot) {
    std::vector<FallbackAction> actions;
    for (const auto& event : robot.events()) {
      if (event.code != EventCode::kFallbackReplaced) continue;
      EXPECT_EQ(event.severity, Severity::kWarning);
      EXPECT_EQ(event.source, static_cast<std::int16_t>(kWheel));
      actions.push_back(static_cast<FallbackAction>(event.value));
    }
    return actions;
  }

  static void enable(VirtualRobot& robot) {
    for (int i = 0; i < 3000 && robot.motor(kWheel).status != MotorStatus::kReady; ++i) robot.run(1);
    for (int attempt = 0; attempt < 5; ++attempt) {
      (void)robot.order(Operation::kEnable);
      robot.run(20);
      if (robot.motor(kWheel).status == MotorStatus::kActive) return;
    }
    FAIL() << "not enabled";
  }

  /// Braked by a target, then taken along by a hand, faster than reduced mode allows.
  static void drag(VirtualRobot& robot, int ticks, bool estop, const std::optional<Target>& target) {
    enable(robot);
    runReduced(robot, 5, Target{.mode = ControlMode::kBrake});
    if (estop) robot.exchange().estop.store(true);
    robot.simBus().drive(kWheel).physics().take({.by_deg = -1500.0, .speed_rpm = 35.0, .torque_nm = 500.0});
    runReduced(robot, ticks, target);
    EXPECT_NEAR(robot.motor(kWheel).feedback.velocity_rpm, -35.0F, 2.0F);
  }
};

TEST_P(DraggedInReducedMode, NoPushGoesOnAndNoResistanceEnds) {
  const auto& dragged = GetParam();
  for (const bool estop : {false, true}) {
    VirtualRobot robot(onASlope(
        std::string{"reduced_velocity_rpm: 10, reduced_within_ms: 500, "
                    "zero: power_on, runaway_rpm: 100, hold_max_s: 60, brake_max_s: 60, ramp_s: 3, "} +
            (estop ? "on_estop: " : "on_timeout: ") + dragged.keys,
        kModeInput, dragged.motor, "0"));
    drag(robot, 2500, estop, {});
    const auto& wheel = robot.motor(kWheel);
    EXPECT_EQ(wheel.acting, dragged.left) << estop;
    EXPECT_EQ(wheel.fault, dragged.left == Acting::kNothing ? FaultCode::kReducedSpeed : FaultCode::kNone);
    EXPECT_EQ(wheel.status, dragged.left == Acting::kNothing ? MotorStatus::kFault
                            : estop                          ? MotorStatus::kReady
                                                             : MotorStatus::kActive);
    runReduced(robot, 1500);
    const bool is_ramp = std::string_view{dragged.keys}.find("ramp") == 0;
    EXPECT_EQ(robot.motor(kWheel).acting, is_ramp ? Acting::kNothing : dragged.left)
        << "a ramp ends when it would have";
    std::vector<FallbackAction> told;
    if (dragged.replaced())
      told = {dragged.left == Acting::kDamp ? FallbackAction::kDamp : FallbackAction::kBrake};
    EXPECT_EQ(replacements(robot), told) << "once, " << estop;
  }
}

class BrakedInReducedMode : public DraggedInReducedMode {};

TEST_P(BrakedInReducedMode, ATargetThatCanOnlyOpposeMotionGoesOnAsItsFallbackWould) {
  const auto& dragged = GetParam();
  VirtualRobot robot(onASlope(
      "reduced_velocity_rpm: 10, reduced_within_ms: 500, zero: power_on, runaway_rpm: 100, on_timeout: " +
          std::string{dragged.keys},
      kModeInput, dragged.motor, "0"));
  drag(robot, 2500, false, Target{.mode = ControlMode::kBrake});
  const auto& wheel = robot.motor(kWheel);
  const bool goes_on = dragged.left != Acting::kNothing;
  EXPECT_EQ(wheel.status, goes_on ? MotorStatus::kActive : MotorStatus::kFault);
  EXPECT_EQ(wheel.fault, goes_on ? FaultCode::kNone : FaultCode::kReducedSpeed);
}

INSTANTIATE_TEST_SUITE_P(
    Families, BrakedInReducedMode,
    ::testing::Values(
        Dragged{"model: M3508, id: 1", "brake, current_limit_a: 1", Acting::kNothing},
        Dragged{"model: DM4310, id: 2, master_id: 18", "brake, current_limit_a: 0.5", Acting::kBrake},
        Dragged{"model: RS00, id: 3", "brake, current_limit_a: 1", Acting::kBrake},
        Dragged{"model: AK80-9, id: 5", "brake, brake_current_a: 1", Acting::kBrake},
        Dragged{"model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, velocity_limit_rpm: 600",
                "brake, current_limit_a: 5", Acting::kNothing},
        Dragged{"model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 100, feedback_hz: 500",
                "brake, brake_current_a: 1", Acting::kBrake}));

INSTANTIATE_TEST_SUITE_P(
    Families, DraggedInReducedMode,
    ::testing::Values(
        Dragged{"model: M3508, id: 1", "hold, current_limit_a: 1", Acting::kDamp},
        Dragged{"model: M3508, id: 1", "brake, current_limit_a: 1", Acting::kDamp},
        Dragged{"model: M3508, id: 1", "ramp, current_limit_a: 1", Acting::kDamp},
        Dragged{"model: M3508, id: 1", "damp", Acting::kDamp},
        Dragged{"model: DM4310, id: 2, master_id: 18", "brake, current_limit_a: 0.5", Acting::kBrake},
        Dragged{"model: DM4310, id: 2, master_id: 18", "hold, current_limit_a: 0.5", Acting::kDamp},
        Dragged{"model: AK80-9, id: 5", "brake, brake_current_a: 1", Acting::kBrake},
        Dragged{"model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, velocity_limit_rpm: 600",
                "brake, current_limit_a: 5", Acting::kNothing},
        Dragged{"model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 100, feedback_hz: 500",
                "ramp, brake_current_a: 1", Acting::kBrake},
        Dragged{"model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 100, feedback_hz: 500",
                "ramp, brake_current_a: 0", Acting::kNothing},
        Dragged{"model: LK-MG5010E-i10, id: 12", "brake, current_limit_a: 0.5", Acting::kNothing}));

}  // namespace
}  // namespace rc10::test::axis_unrest_test
