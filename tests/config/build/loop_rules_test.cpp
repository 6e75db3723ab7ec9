// velocity_pid and angle_pid.

#include <array>
#include <string>
#include <variant>

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "config/motor_families.hpp"
#include "config/yaml/number_text.hpp"
#include "drives/dji/dji_model.hpp"

namespace rc10::test::loop_rules_test {
namespace {

using ::testing::ElementsAre;

CascadeConfig loopsOf(const std::string& model, const std::string& keys) {
  return motorOf("{name: wheel, model: " + model + ", id: 1, " + keys + "}").settings.loops;
}

PID_Position::Config position(const CascadeConfig& loops) {
  return std::get<PID_Position::Config>(loops.velocity);
}

TEST(LoopRules, WithoutKeysTheLoopsAreTheModels) {
  const auto loops = loopsOf("M3508", "optional: true");
  const auto& defaults = kM3508.current.default_loops;
  EXPECT_EQ(position(loops).kp, position(defaults).kp);
  EXPECT_EQ(position(loops).ki, position(defaults).ki);
  EXPECT_EQ(loops.angle.kp, defaults.angle.kp);
  EXPECT_EQ(loops.angle.output_limit, defaults.angle.output_limit);
  EXPECT_EQ(loops.velocity_limit_rpm, defaults.velocity_limit_rpm);
}

struct Geared {
  std::string model;  ///< With its own keys.
  const DjiModel* of;
  DjiCommand command = DjiCommand::kCurrent;
};

const std::array kGeared{Geared{"M3508", &kM3508}, Geared{"M2006", &kM2006}, Geared{"GM6020", &kGM6020},
                         Geared{"GM6020, command: voltage", &kGM6020, DjiCommand::kVoltage}};

/// Gears: none, and one of 1:2 and 2:1 behind the model's own. `turns`: of its output in one of the shaft.
template <typename Check>
void forEachGear(const Check& check) {
  for (const Geared& motor : kGeared) {
    for (const double turns : {1.0 / motor.of->gear_ratio, 0.5, 2.0}) {
      const std::string gear = numberText(turns * motor.of->gear_ratio);
      SCOPED_TRACE(motor.model + ", gear_ratio: " + gear);
      check(motor, "gear_ratio: " + gear, static_cast<float>(turns));
    }
  }
}

TEST(LoopRules, DefaultsFollowTheGearThatIsMounted) {
  forEachGear([](const Geared& motor, const std::string& gear, float turns) {
    const auto& defaults = motor.of->command(motor.command).default_loops;
    const auto loops = loopsOf(motor.model, gear);
    EXPECT_FLOAT_EQ(position(loops).kp, turns * position(defaults).kp);
    EXPECT_FLOAT_EQ(position(loops).ki, turns * position(defaults).ki);
    EXPECT_FLOAT_EQ(position(loops).kd, turns * position(defaults).kd);
    EXPECT_FLOAT_EQ(loops.velocity_limit_rpm, defaults.velocity_limit_rpm / turns);
    EXPECT_FLOAT_EQ(loops.angle.kp, defaults.angle.kp) << "rpm and degrees of one shaft";
    EXPECT_FLOAT_EQ(loops.angle.output_limit, defaults.angle.output_limit / turns);
    const auto incremental = std::get<PID_Incremental::Config>(
        loopsOf(motor.model, gear + ", velocity_pid: {type: incremental}").velocity);
    EXPECT_FLOAT_EQ(incremental.kp, turns * position(defaults).kp);
    EXPECT_FLOAT_EQ(incremental.ki, turns * position(defaults).ki);
  });
}

TEST(LoopRules, LimitsAndThresholdsOfTheShaftFollowItsGear) {
  forEachGear([](const Geared& motor, const std::string& gear, float turns) {
    const auto own = motorOf("{name: a, id: 1, model: " + motor.model + "}");
    const auto geared = motorOf("{name: a, id: 1, model: " + motor.model + ", " + gear + "}");
    EXPECT_FLOAT_EQ(geared.settings.velocity_limit_rpm, own.settings.velocity_limit_rpm / turns);
    EXPECT_FLOAT_EQ(geared.shaping.velocity_limit_rpm, own.shaping.velocity_limit_rpm / turns);
    EXPECT_FLOAT_EQ(geared.shaping.approach_rpm_per_deg, own.shaping.approach_rpm_per_deg);
    EXPECT_FLOAT_EQ(geared.shaping.approach_effort_per_rpm, own.shaping.approach_effort_per_rpm * turns);
    EXPECT_FLOAT_EQ(geared.shaping.effort_per_rpm, own.shaping.effort_per_rpm * turns);
    EXPECT_FLOAT_EQ(geared.guard.overspeed_rpm, own.guard.overspeed_rpm / turns);
    EXPECT_FLOAT_EQ(geared.guard.stall_rpm, own.guard.stall_rpm / turns);
    EXPECT_FLOAT_EQ(geared.guard.runaway_rpm, own.guard.runaway_rpm / turns);
    EXPECT_FLOAT_EQ(geared.rest.gained_rpm, own.rest.gained_rpm / turns);
    EXPECT_FLOAT_EQ(geared.standstill_rpm, own.standstill_rpm / turns);
  });
}

TEST(LoopRules, WhatIsGivenHoldsBehindAnyGear) {
  forEachGear([](const Geared& motor, const std::string& gear, float) {
    const std::string unit = motor.command == DjiCommand::kVoltage ? "v" : "a";
    const auto loops =
        loopsOf(motor.model, gear + ", velocity_limit_rpm: 30, velocity_pid: {kp_" + unit +
                                 "_per_rpm: 0.7, ki_" + unit +
                                 "_per_rpm_s: 0.8, deadband_rpm: 2, integral_separation_rpm: 3}, "
                                 "angle_pid: {kp_rpm_per_deg: 5, velocity_limit_rpm: 20, deadband_deg: 6}");
    EXPECT_EQ(position(loops).kp, 0.7F);
    EXPECT_EQ(position(loops).ki, 0.8F);
    EXPECT_EQ(position(loops).deadband, 2.0F);
    EXPECT_EQ(position(loops).integral_separation, 3.0F);
    EXPECT_EQ(loops.velocity_limit_rpm, 30.0F);
    EXPECT_EQ(loops.angle.kp, 5.0F);
    EXPECT_EQ(loops.angle.output_limit, 20.0F);
    EXPECT_EQ(loops.angle.deadband, 6.0F);
  });
}

TEST(LoopRules, AGearWrittenAsTheModelsOwnChangesNothing) {
  const auto loops = loopsOf("M3508", "gear_ratio: 19.203208556149733");
  EXPECT_EQ(position(loops).kp, position(kM3508.current.default_loops).kp);
  EXPECT_EQ(loops.velocity_limit_rpm, kM3508.current.default_loops.velocity_limit_rpm);
}

TEST(LoopRules, AGivenKeyReplacesOnlyItself) {
  const auto loops =
      loopsOf("M3508", "velocity_pid: {ki_a_per_rpm_s: 0.7}, angle_pid: {kd_rpm_s_per_deg: 0.1}");
  const auto& defaults = kM3508.current.default_loops;
  EXPECT_EQ(position(loops).ki, 0.7F);
  EXPECT_EQ(position(loops).kp, position(defaults).kp);
  EXPECT_EQ(loops.angle.kd, 0.1F);
  EXPECT_EQ(loops.angle.kp, defaults.angle.kp);
}

TEST(LoopRules, EveryKeyOfAPositionLoopArrives) {
  const auto velocity = position(
      loopsOf("M3508",
              "velocity_pid: {type: position, kp_a_per_rpm: 1, ki_a_per_rpm_s: 2, kd_a_s_per_rpm: 3, "
              "deadband_rpm: 4, derivative_filter_hz: 5, integral_limit_a: 6, integral_separation_rpm: 7}"));
  EXPECT_EQ(velocity.kp, 1.0F);
  EXPECT_EQ(velocity.ki, 2.0F);
  EXPECT_EQ(velocity.kd, 3.0F);
  EXPECT_EQ(velocity.deadband, 4.0F);
  EXPECT_EQ(velocity.derivative_filter_hz, 5.0F);
  EXPECT_EQ(velocity.integral_limit, 6.0F);
  EXPECT_EQ(velocity.integral_separation, 7.0F);
}

TEST(LoopRules, EveryKeyOfAnIncrementalLoopArrives) {
  const auto loops =
      loopsOf("M3508",
              "velocity_pid: {type: incremental, kp_a_per_rpm: 1, ki_a_per_rpm_s: 2, kd_a_s_per_rpm: 3, "
              "deadband_rpm: 4, derivative_filter_hz: 5, target_bandwidth_rad_s: 6}");
  const auto velocity = std::get<PID_Incremental::Config>(loops.velocity);
  EXPECT_EQ(velocity.kp, 1.0F);
  EXPECT_EQ(velocity.ki, 2.0F);
  EXPECT_EQ(velocity.kd, 3.0F);
  EXPECT_EQ(velocity.deadband, 4.0F);
  EXPECT_EQ(velocity.derivative_filter_hz, 5.0F);
  EXPECT_EQ(velocity.tracking_rad_s, 6.0F);
}

TEST(LoopRules, AnotherTypeKeepsTheModelsGains) {
  const auto velocity =
      std::get<PID_Incremental::Config>(loopsOf("M3508", "velocity_pid: {type: incremental}").velocity);
  EXPECT_EQ(velocity.kp, position(kM3508.current.default_loops).kp);
  EXPECT_EQ(velocity.ki, position(kM3508.current.default_loops).ki);
}

TEST(LoopRules, EveryKeyOfAVoltageLoopArrives) {
  const auto velocity =
      position(loopsOf("GM6020",
                       "command: voltage, velocity_pid: {kp_v_per_rpm: 1, ki_v_per_rpm_s: 2, "
                       "kd_v_s_per_rpm: 3, integral_limit_v: 4}"));
  EXPECT_EQ(velocity.kp, 1.0F);
  EXPECT_EQ(velocity.ki, 2.0F);
  EXPECT_EQ(velocity.kd, 3.0F);
  EXPECT_EQ(velocity.integral_limit, 4.0F);
}

TEST(LoopRules, EveryKeyOfAnAngleLoopArrives) {
  const auto loops = loopsOf(
      "GM6020",
      "velocity_limit_rpm: 300, angle_pid: {kp_rpm_per_deg: 1, ki_rpm_per_deg_s: 2, kd_rpm_s_per_deg: "
      "3, deadband_deg: 4, velocity_limit_rpm: 5, integral_limit_rpm: 6, integral_separation_deg: 7, "
      "derivative_filter_hz: 8}");
  EXPECT_EQ(loops.velocity_limit_rpm, 300.0F);
  EXPECT_EQ(loops.angle.kp, 1.0F);
  EXPECT_EQ(loops.angle.ki, 2.0F);
  EXPECT_EQ(loops.angle.kd, 3.0F);
  EXPECT_EQ(loops.angle.deadband, 4.0F);
  EXPECT_EQ(loops.angle.output_limit, 5.0F);
  EXPECT_EQ(loops.angle.integral_limit, 6.0F);
  EXPECT_EQ(loops.angle.integral_separation, 7.0F);
  EXPECT_EQ(loops.angle.derivative_filter_hz, 8.0F);
}

/// Keys of a motor of each family and of each of its loops, beside name, model and id.
const std::vector<std::string> kMotorsOfAllFamilies{
    "M3508, id: 1",
    "GM6020, id: 1, command: voltage",
    "VESC, id: 1, pole_pairs: 7, angle: tachometer",
    "VESC, id: 1, pole_pairs: 7, angle: encoder",
    "VESC, id: 1, pole_pairs: 7, angle: none",
    "DM4310, id: 1, master_id: 17",
    "DM4310, id: 1, master_id: 17, control: velocity",
    "RS00, id: 1",
    "RS00, id: 1, control: velocity",
    "AK80-9, id: 1, protocol: mit",
    "LK-MF9025, id: 1",
    "RMD-X6-8, id: 1",
    "moteus, id: 1, motor_kv_rpm_per_v: 300",
    "ODrive_S1, id: 1, torque_constant_nm_per_a: 0.05, current_limit_a: 10, velocity_limit_rpm: 100"};

/// `keys`: behind those of `motor`.
std::string robotOf(const std::string& motor, const std::string& keys = "") {
  const std::string fd = motor.starts_with("moteus") ? "data_bitrate: 5000000, " : "";
  return "robot: hero\nbuses: [{name: chassis, type: sim, " + fd + "motors: [{name: a, model: " + motor +
         keys + "}]}]\n";
}

TEST(LoopRules, ALoopThatTheHostDoesNotCloseHasNoKeys) {
  for (const auto& motor : kMotorsOfAllFamilies) {
    const auto loaded = parseRobotConfig(robotOf(motor), "hero.yaml");
    ASSERT_TRUE(loaded.config) << motor << loaded.errorText();
    const MotorTraits traits = loaded.config->buses.at(0).motors.at(0).traits();
    const std::string kp = traits.effort == CommandUnit::kVolt ? "kp_v_per_rpm" : "kp_a_per_rpm";
    const auto accepts = [&](const std::string& keys) { return errorsOf(robotOf(motor, keys)).empty(); };
    EXPECT_EQ(accepts(", velocity_pid: {" + kp + ": 1}"), traits.hostVelocityLoop()) << motor;
    EXPECT_EQ(accepts(", velocity_pid: {type: incremental}"), traits.hostVelocityLoop()) << motor;
    EXPECT_EQ(accepts(", angle_pid: {kp_rpm_per_deg: 1}"), traits.host_loops != nullptr) << motor;
  }
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: VESC, id: 1, pole_pairs: 7, velocity_pid: {kp_v_per_rpm: 1}}")),
      ElementsAre("hero.yaml:6:68: buses[0].motors[0].velocity_pid: the VESC closes its velocity loop "
                  "itself, and only angle_pid acts; remove it"));
}

TEST(LoopRules, AKeyOfTheOtherTypeIsRefused) {
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M3508, id: 1, velocity_pid: {target_bandwidth_rad_s: 5}}")),
      ElementsAre("hero.yaml:6:79: buses[0].motors[0].velocity_pid.target_bandwidth_rad_s: belongs to type: "
                  "incremental; remove it, or change the type"));
  EXPECT_THAT(errorsOf(robotWith(
                  "{name: a, model: M3508, id: 1, velocity_pid: {type: incremental, integral_limit_a: 5}}")),
              ElementsAre("hero.yaml:6:92: buses[0].motors[0].velocity_pid.integral_limit_a: belongs to "
                          "type: position; remove "
                          "it, or change the type"));
}

TEST(LoopRules, GainsAreFiniteAndNotNegative) {
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M3508, id: 1, angle_pid: {kp_rpm_per_deg: -1}}")),
      ElementsAre(
          "hero.yaml:6:68: buses[0].motors[0].angle_pid.kp_rpm_per_deg: -1 is below 0 rpm/deg; use 0 to "
          "1000000 rpm/deg"));
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M3508, id: 1, angle_pid: {kp_rpm_per_deg: .inf}}")),
      ElementsAre(
          "hero.yaml:6:68: buses[0].motors[0].angle_pid.kp_rpm_per_deg: '.inf' is not finite; write a "
          "number"));
}

TEST(LoopRules, AGainInTheWrongUnitIsUnknown) {
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M3508, id: 1, velocity_pid: {kp_a_per_rad: 1}}")),
      ElementsAre("hero.yaml:6:55: buses[0].motors[0].velocity_pid.kp_a_per_rad: unknown key; did you mean "
                  "kp_a_per_rpm?"));
  EXPECT_THAT(errorsOf(robotWith("{name: a, model: M3508, id: 1, current_limit_ma: 1}")),
              ElementsAre("hero.yaml:6:40: buses[0].motors[0].current_limit_ma: unknown key; did you mean "
                          "current_limit_a?"));
}

}  // namespace
}  // namespace rc10::test::loop_rules_test
