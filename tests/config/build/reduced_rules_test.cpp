// mode_gpio and the limits that it reduces.

#include <algorithm>

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "config/motor_families.hpp"
#include "config/report/report.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test::reduced_rules_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string kInput = "mode_gpio: {chip: gpiochip0, line: 23}\n";

std::string robotText(const std::string& head, const std::string& keys,
                      const std::string& model = "M3508, id: 1") {
  return "robot: hero\n" + head +
         "buses:\n  - name: chassis\n    type: sim\n    motors:\n      - {name: a, model: " + model +
         (keys.empty() ? "" : ", ") + keys + "}\n";
}

ReducedConfig reducedOf(const std::string& keys, const std::string& model = "M3508, id: 1") {
  return parseRobotConfig(robotText(kInput, keys, model), "hero.yaml")
      .config.value()
      .buses.at(0)
      .motors.at(0)
      .reduced;
}

TEST(ReducedRules, TheLimitsOfAMotorAreRead) {
  const auto reduced = reducedOf("reduced_velocity_rpm: 60, reduced_within_ms: 700, reduced_current_a: 5");
  EXPECT_EQ(reduced.velocity_rpm, 60.0F);
  EXPECT_EQ(reduced.within, 700ms);
  EXPECT_FLOAT_EQ(reduced.effort_share, 0.25F);
  EXPECT_FLOAT_EQ(reduced.full_rpm, 480.0F);
  EXPECT_NEAR(reduced.tolerance_rpm, 15.0F + 9.64F, 0.1F) << "a quarter, and 2 % of the no-load speed";
}

TEST(ReducedRules, AVoltageIsReducedWhereTheDriveIsToldOne) {
  EXPECT_FLOAT_EQ(reducedOf("reduced_voltage_v: 6", "GM6020, id: 1, command: voltage").effort_share, 0.25F);
  EXPECT_THAT(errorsOf(robotText(kInput, "reduced_velocity_rpm: 60, reduced_voltage_v: 6")),
              ElementsAre(HasSubstr("the M3508 is commanded in amperes; use reduced_current_a")));
}

TEST(ReducedRules, AReducedSpeedThatNoFeedbackShowsExceededIsRefused) {
  EXPECT_THAT(errorsOf(robotText(kInput, "reduced_velocity_rpm: 250", "RS00, id: 1")),
              ElementsAre(HasSubstr("reduced_velocity_rpm: 250 rpm is never seen to be exceeded")));
  EXPECT_EQ(reducedOf("reduced_velocity_rpm: 240", "RS00, id: 1").velocity_rpm, 240.0F);
}

TEST(ReducedRules, WithoutThemNothingIsReduced) {
  EXPECT_FALSE(motorOf("{name: a, model: M3508, id: 1}").reduced.any());
}

TEST(ReducedRules, AnInputThatReducesNothingIsAnError) {
  EXPECT_THAT(
      errorsOf(robotText(kInput, "")),
      ElementsAre(
          "hero.yaml:2:12: mode_gpio: no motor has a limit to reduce; add reduced_velocity_rpm or "
          "reduced_current_a (reduced_voltage_v) to those that a person may come near, or remove it"));
}

// Its limits are not known: the advice to remove the input would be wrong.
TEST(ReducedRules, AnInputIsNotJudgedByAMotorThatIsItselfWrong) {
  EXPECT_THAT(errorsOf(robotText(kInput, "reduced_velocity_rpm: 60, gear_ratio: 0")),
              ElementsAre(HasSubstr("gear_ratio")));
  EXPECT_THAT(errorsOf(robotText(kInput, "reduced_velocity_rpm: fast")),
              ElementsAre(HasSubstr("reduced_velocity_rpm")));
}

TEST(ReducedRules, LimitsThatNothingAsksForAreAnError) {
  EXPECT_THAT(
      errorsOf(robotText("", "reduced_velocity_rpm: 60")),
      ElementsAre(HasSubstr("buses[0].motors[0]: nothing ever asks for the reduced limits of 'a'; add "
                            "mode_gpio, or remove them")));
  EXPECT_THAT(errorsOf(robotText("", "reduced_current_a: 5")), ElementsAre(HasSubstr("add mode_gpio")));
}

TEST(ReducedRules, AReducedLimitIsBelowTheOther) {
  EXPECT_THAT(
      errorsOf(robotText(kInput, "velocity_limit_rpm: 100, reduced_velocity_rpm: 100")),
      ElementsAre(HasSubstr("reduced_velocity_rpm: 100 rpm is not below the 100 rpm that the motor may "
                            "have anyway; lower it")));
  EXPECT_THAT(
      errorsOf(robotText(kInput, "current_limit_a: 4, reduced_current_a: 4, reduced_velocity_rpm: 9")),
      ElementsAre(HasSubstr("reduced_current_a: 4 A is not below the 4 A that the motor may have anyway")));
}

TEST(ReducedRules, ACurrentIsReducedWhereTheDriveObeysALimit) {
  const std::string damiao = "DM4340, id: 1, master_id: 17, control: ";
  for (const std::string control : {"velocity", "position_velocity"}) {
    EXPECT_THAT(
        errorsOf(robotText(kInput, "reduced_velocity_rpm: 9, reduced_current_a: 2", damiao + control)),
        ElementsAre(HasSubstr(
            "reduced_current_a: the DM4340, as it is configured, is told no limit of its current; choose "
            "another value of control, or remove it")));
    EXPECT_THAT(errorsOf(robotText(kInput, "reduced_velocity_rpm: 9", damiao + control)), IsEmpty());
  }
  for (const std::string control : {"mit", "force_position"}) {
    EXPECT_THAT(errorsOf(robotText(kInput, "reduced_current_a: 2", damiao + control)), IsEmpty());
  }
}

TEST(ReducedRules, LoopsThatObeyNoLimitOfOursAreTold) {
  const auto warnings = [](const std::string& model) {
    std::string text;
    for (const auto& each :
         parseRobotConfig(robotText(kInput, "reduced_current_a: 2", model), "hero.yaml").warnings)
      text += each.text + "\n";
    return text;
  };
  EXPECT_THAT(
      warnings("VESC, id: 1, pole_pairs: 7"),
      HasSubstr(
          "does not act in velocity, angle, total_angle and duty, whose loops in the drive obey its own"));
  EXPECT_THAT(warnings("VESC, id: 1, pole_pairs: 7, angle: none"),
              HasSubstr("does not act in velocity and duty, whose"));
  EXPECT_THAT(warnings("AK80-9, id: 1"), HasSubstr("does not act in velocity, angle, total_angle and duty,"));
  EXPECT_THAT(warnings("RMD-X8-25, id: 1"),
              HasSubstr("does not act in velocity, angle and total_angle, whose"));
  EXPECT_THAT(warnings("LK-MG5010E-i10, id: 1"), HasSubstr("does not act in angle and total_angle, whose"));
  for (const std::string bounded :
       {"M3508, id: 1", "AK80-9, id: 1, protocol: mit", "RS03, id: 1", "LK-MG5010E-i10, id: 1, group: true"})
    EXPECT_THAT(warnings(bounded), Not(HasSubstr("does not act in"))) << bounded;
}

TEST(ReducedRules, EveryLoopThatObeysTheDrivesMaximumIsAModeWithALoop) {
  constexpr ModeSet kLoops{ControlMode::kVelocity, ControlMode::kAngle, ControlMode::kTotalAngle,
                           ControlMode::kImpedance, ControlMode::kDuty};
  int judged = 0;
  for (const auto& entry : motorFamilies()) {
    for (const auto& model : entry.family->models()) {
      for (const auto& settings : variants(*entry.family, model, 1)) {
        const auto traits = entry.family->traits(model, settings.own);
        EXPECT_EQ((traits.own_loops & traits.modes & kLoops).bits(), traits.own_loops.bits()) << model;
        judged += traits.own_loops.bits() != 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(judged, 0);
}

TEST(ReducedRules, TheRampFitsIntoTheTime) {
  const std::string slow = "velocity_limit_rpm: 400, reduced_velocity_rpm: 100, velocity_slew_rpm_per_s: 200";
  EXPECT_THAT(
      errorsOf(robotText(kInput, slow)),
      ElementsAre(HasSubstr("velocity_slew_rpm_per_s needs 1500 ms from full to reduced speed, more than "
                            "reduced_within_ms (1000): each change would be a fault")));
  EXPECT_THAT(errorsOf(robotText(kInput, slow + ", reduced_within_ms: 2000")), IsEmpty());
}

TEST(ReducedRules, TheInputHasALineOfItsOwn) {
  const std::string keys = "reduced_current_a: 5";
  EXPECT_THAT(errorsOf(robotText("estop_gpio: {chip: gpiochip0, line: 23}\n" + kInput, keys)),
              ElementsAre(HasSubstr("mode_gpio: gpiochip0:23 is the line of estop_gpio")));
  EXPECT_THAT(errorsOf(robotText(kInput + "heartbeat_gpio: {chip: gpiochip0, line: 23}\n", keys)),
              ElementsAre(HasSubstr("heartbeat_gpio: gpiochip0:23 is the line of mode_gpio")));
}

TEST(ReducedRules, TheReportSaysWhatEachMotorHasThen) {
  const auto text = describe(
      parseRobotConfig(robotText(kInput, "reduced_velocity_rpm: 60, reduced_current_a: 5"), "hero.yaml")
          .config.value());
  EXPECT_THAT(text, HasSubstr("mode input  gpiochip0:23, closed contact reads low, internal pull-up\n"));
  EXPECT_THAT(text, HasSubstr("while the mode input is open:\n"));
  EXPECT_THAT(text, HasSubstr("60 rpm within 1000 ms, 5 A"));
  EXPECT_THAT(describe(parseRobotConfig(robotText("", ""), "hero.yaml").config.value()),
              Not(HasSubstr("mode input")));
}

}  // namespace
}  // namespace rc10::test::reduced_rules_test
