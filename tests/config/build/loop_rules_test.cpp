// velocity_pid and angle_pid.

#include <variant>

#include <gmock/gmock.h>

#include "config/config_text.hpp"
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
