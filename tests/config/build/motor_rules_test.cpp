// The keys of a motor.

#include <cmath>

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "config/motor_families.hpp"

namespace rc10::test::motor_rules_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

std::vector<std::string> errorsOfMotor(const std::string& motor) { return errorsOf(robotWith(motor)); }

/// An M3508 with these keys, which begin in column 41.
std::vector<std::string> errorsOfWheel(const std::string& keys) {
  return errorsOfMotor("{name: wheel, model: M3508, id: 1, " + keys + "}");
}

TEST(MotorRules, AMotorNeedsANameAnIdAndAModel) {
  EXPECT_THAT(
      errorsOfMotor("{optional: true}"),
      ElementsAre("hero.yaml:6:9: buses[0].motors[0].name: is missing; add it: Name of the motor in commands "
                  "and states, unique in the robot.",
                  "hero.yaml:6:9: buses[0].motors[0].id: is missing; add it: Id set on the drive. On one bus "
                  "GM6020 ids 1-4 collide with M3508 and M2006 ids 5-8.",
                  "hero.yaml:6:9: buses[0].motors[0].model: is missing; add it here or in a profile"));
}

TEST(MotorRules, ANameIsOneToThirtyOnePlainCharacters) {
  const std::string reason = " is not accepted; use 1 to 31 of a-z, 0-9 and _";
  for (const std::string name : {"Left", "left-wheel", "left wheel", "'a.b'", "ä"}) {
    EXPECT_EQ(errorsOfMotor("{name: " + name + ", model: M3508, id: 1}").size(), 1U) << name;
  }
  EXPECT_THAT(errorsOfMotor("{name: left-wheel, model: M3508, id: 1}"),
              ElementsAre("hero.yaml:6:16: buses[0].motors[0].name: 'left-wheel'" + reason));
  EXPECT_THAT(errorsOfMotor("{name: 3, model: M3508, id: 1}"), IsEmpty());
}

TEST(MotorRules, AKeyOfTheAngleNeedsADriveThatReportsOne) {
  const std::string vesc = "{name: a, model: VESC, id: 1, pole_pairs: 7, motor_current_max_a: 40, angle: ";
  for (const std::string key :
       {"angle_min_deg: 0", "angle_max_deg: 90", "angle_slew_deg_per_s: 90", "max_first_step_deg: 20"}) {
    EXPECT_THAT(errorsOfMotor(vesc + "none, " + key + "}"),
                ElementsAre(HasSubstr(key.substr(0, key.find(':')) +
                                      ": the VESC, as it is configured, reports no angle; remove it")));
    EXPECT_THAT(errorsOfMotor(vesc + "tachometer, " + key + "}"), IsEmpty()) << key;
  }
  EXPECT_THAT(errorsOfMotor(vesc + "none, following_error_deg: 5}"),
              Contains(HasSubstr("following_error_deg: the VESC, as it is configured, reports no angle")));
}

TEST(MotorRules, AnUnknownModelListsTheKnownOnes) {
  EXPECT_THAT(
      errorsOfMotor("{name: a, model: Stepper, id: 1}"),
      ElementsAre(
          AllOf(StartsWith(
                    "hero.yaml:6:26: buses[0].motors[0].model: 'Stepper' is not one of M3508, M2006, GM6020, "
                    "VESC, "),
                EndsWith("; use one of these"))));
  EXPECT_THAT(errorsOfMotor("{name: a, model: m3508, id: 1}"),
              ElementsAre(EndsWith("; did you mean M3508?")));
}

TEST(MotorRules, AnIdIsOneThatTheDriveCanHave) {
  EXPECT_THAT(
      errorsOfMotor("{name: a, model: M3508, id: 9}"),
      ElementsAre("hero.yaml:6:37: buses[0].motors[0].id: 9 is above the highest M3508 id 8; use 1 to 8"));
  EXPECT_THAT(
      errorsOfMotor("{name: a, model: GM6020, id: 8}"),
      ElementsAre("hero.yaml:6:38: buses[0].motors[0].id: 8 is above the highest GM6020 id 7; use 1 to 7"));
  EXPECT_THAT(
      errorsOfMotor("{name: a, model: M2006, id: 0}"),
      ElementsAre("hero.yaml:6:37: buses[0].motors[0].id: 0 is below the lowest M2006 id 1; use 1 to 8"));
  EXPECT_THAT(errorsOfMotor("{name: a, model: M2006, id: 1e18}").size(), 1U);
  EXPECT_THAT(errorsOfMotor("{name: a, model: M2006, id: 4294967297}").size(), 1U);
  EXPECT_THAT(
      errorsOfMotor("{name: a, model: M2006, id: 010}"),
      ElementsAre(
          "hero.yaml:6:37: buses[0].motors[0].id: '010' has a leading zero, which some read as octal; "
          "write 10"));
}

TEST(MotorRules, ACurrentLimitStaysWithinTheDrive) {
  EXPECT_THAT(
      errorsOfWheel("current_limit_a: 32"),
      ElementsAre(
          "hero.yaml:6:61: buses[0].motors[0].current_limit_a: 32 is above the M3508 limit of 20; use "
          "more than 0, at most 20"));
  EXPECT_THAT(
      errorsOfWheel("current_limit_a: -5"),
      ElementsAre("hero.yaml:6:61: buses[0].motors[0].current_limit_a: -5 is below 0 A; use more than 0 A"));
  EXPECT_EQ(motorOf("{name: a, model: M3508, id: 1, current_limit_a: 20}").settings.effort_limit, 20.0F);
  EXPECT_EQ(motorOf("{name: a, model: M3508, id: 1, current_limit_a: 0.5}").settings.effort_limit, 0.5F);
}

/// The largest limit, as the message about a larger one has it; empty: the model has none.
std::string mostOf(std::string_view model) {
  const std::string motor = "{name: a, model: " + std::string{model} + ", id: 1, current_limit_a: ";
  for (const std::string& error : errorsOfMotor(motor + "100000}")) {
    const std::string words = " limit of ";
    const auto begin = error.find(words);
    if (begin == std::string::npos) continue;
    const auto most = error.substr(begin + words.size(), error.find(';') - begin - words.size());
    EXPECT_THAT(error, EndsWith("use more than 0, at most " + most));
    return most;
  }
  return "";
}

TEST(MotorRules, TheLimitThatAMessageNamesIsAcceptedForEveryModel) {
  int found = 0;
  for (const auto& entry : motorFamilies()) {
    for (const auto model : entry.family->models()) {
      const auto most = mostOf(model);
      if (most.empty()) continue;
      ++found;
      EXPECT_LT(most.size(), 12U) << model << ": " << most;
      const std::string motor = "{name: a, model: " + std::string{model} + ", id: 1, current_limit_a: ";
      for (const auto& error : errorsOfMotor(motor + most + "}"))
        EXPECT_THAT(error, Not(HasSubstr("limit of"))) << model;
    }
  }
  EXPECT_GT(found, 40);
}

TEST(MotorRules, ALimitOfZeroIsNotTakenForNoLimit) {
  for (const std::string zero : {"0", "0.0", "-0", "1e-60"}) {
    EXPECT_EQ(errorsOfWheel("current_limit_a: " + zero).size(), 1U) << zero;
    EXPECT_EQ(errorsOfWheel("velocity_limit_rpm: " + zero).size(), 1U) << zero;
    EXPECT_EQ(errorsOfWheel("gear_ratio: " + zero).size(), 1U) << zero;
    EXPECT_EQ(errorsOfWheel("angle_pid: {velocity_limit_rpm: " + zero + "}").size(), 1U) << zero;
  }
  EXPECT_THAT(
      errorsOfWheel("current_limit_a: 0"),
      ElementsAre(
          "hero.yaml:6:61: buses[0].motors[0].current_limit_a: 0 is not accepted; use more than 0 A"));
}

TEST(MotorRules, OnlyAGM6020ObeysVoltage) {
  const auto motor = motorOf("{name: a, model: GM6020, id: 1, command: voltage, voltage_limit_v: 12}");
  EXPECT_EQ(motor.settings.own.text("command"), "voltage");
  EXPECT_EQ(motor.settings.effort_limit, 12.0F);
  EXPECT_THAT(
      errorsOfWheel("command: voltage"),
      ElementsAre("hero.yaml:6:53: buses[0].motors[0].command: the M3508 obeys currents only; remove it, or "
                  "write command: current"));
  EXPECT_THAT(
      errorsOfMotor("{name: a, model: GM6020, id: 1, command: voltage, voltage_limit_v: 25}"),
      ElementsAre(
          "hero.yaml:6:76: buses[0].motors[0].voltage_limit_v: 25 is above the GM6020 limit of 24; use "
          "more than 0, at most 24"));
}

TEST(MotorRules, LimitsAndGainsAreInTheUnitOfTheCommand) {
  EXPECT_THAT(
      errorsOfWheel("voltage_limit_v: 12, velocity_pid: {kp_v_per_rpm: 1}"),
      ElementsAre("hero.yaml:6:61: buses[0].motors[0].voltage_limit_v: with command: current the M3508 is "
                  "commanded in amperes; use current_limit_a",
                  "hero.yaml:6:94: buses[0].motors[0].velocity_pid.kp_v_per_rpm: with command: current the "
                  "M3508 is commanded in amperes; use kp_a_per_rpm"));
  EXPECT_THAT(errorsOfMotor("{name: a, model: GM6020, id: 1, command: voltage, current_limit_a: 1}"),
              ElementsAre("hero.yaml:6:76: buses[0].motors[0].current_limit_a: with command: voltage the "
                          "GM6020 is commanded in volts; use voltage_limit_v"));
}

TEST(MotorRules, TheDirectionIsOneOrMinusOne) {
  EXPECT_EQ(motorOf("{name: a, model: M3508, id: 1, direction: -1}").settings.direction, -1);
  EXPECT_THAT(errorsOfWheel("direction: 2"),
              ElementsAre("hero.yaml:6:55: buses[0].motors[0].direction: '2' is not one "
                          "of 1 and -1; use one of these"));
  EXPECT_THAT(errorsOfWheel("direction: 1.0"),
              ElementsAre("hero.yaml:6:55: buses[0].motors[0].direction: '1.0' is not "
                          "one of 1 and -1; use one of these"));
}

TEST(MotorRules, TheAngleOfAnAbsoluteEncoderIsForMotorsThatHaveOne) {
  const auto yaw = motorOf("{name: a, model: GM6020, id: 1, zero_deg: 123.4}");
  EXPECT_EQ(yaw.settings.zero_deg, 123.4);
  EXPECT_FALSE(yaw.settings.zero_at_power_on);
  EXPECT_THAT(
      errorsOfWheel("zero_deg: 5"),
      ElementsAre("hero.yaml:6:54: buses[0].motors[0].zero_deg: the M3508 does not know its output angle at "
                  "power-up; use zero: power_on"));
  EXPECT_THAT(
      errorsOfMotor("{name: a, model: GM6020, id: 1, gear_ratio: 2, zero_deg: 5}"),
      ElementsAre("hero.yaml:6:66: buses[0].motors[0].zero_deg: the GM6020 behind a gear does not know its "
                  "output angle at power-up; use zero: power_on"));
  EXPECT_THAT(
      errorsOfMotor("{name: a, model: GM6020, id: 1, zero: power_on, zero_deg: 5}"),
      ElementsAre("hero.yaml:6:67: buses[0].motors[0].zero_deg: excludes zero: power_on; keep one of them"));
}

TEST(MotorRules, AnAbsoluteEncoderGetsItsTravelAndABoundOfItsFirstStep) {
  const auto arm = motorOf("{name: a, model: GM6020, id: 1, angle_min_deg: -90, angle_max_deg: 200}");
  EXPECT_EQ(arm.settings.travel.min_deg, -90.0);
  EXPECT_EQ(arm.settings.travel.max_deg, 200.0);
  EXPECT_EQ(arm.shaping.max_first_step_deg, 180.0);
  const auto slow = motorOf("{name: a, model: GM6020, id: 1, angle_max_deg: 90, angle_slew_deg_per_s: 90}");
  EXPECT_TRUE(std::isinf(slow.shaping.max_first_step_deg));
  const auto table = motorOf("{name: a, model: GM6020, id: 1}");
  EXPECT_TRUE(std::isinf(table.shaping.max_first_step_deg)) << "it turns freely";
  const auto lift = motorOf("{name: a, model: M2006, id: 1, zero: power_on}");
  EXPECT_TRUE(std::isinf(lift.shaping.max_first_step_deg));
}

TEST(MotorRules, WhereNothingSlowsAMotorDownItsSpeedHasNoBound) {
  const std::string group = "model: LK-MF9025, id: 1, group: true";
  for (const std::string key : {"angle_min_deg: -90", "angle_max_deg: 90"}) {
    EXPECT_THAT(
        errorsOf(robotWith("{name: a, " + group + ", " + key + "}")),
        ElementsAre(AllOf(HasSubstr("hero.yaml:6:"), HasSubstr("nothing could slow the motor down there"),
                          HasSubstr("use group: false"))));
    for (const std::string good :
         {"LK-MF9025, id: 1", "LK-MF9025, id: 1, group: true, velocity_limit_rpm: 100",
          "DM6248P, id: 1, master_id: 17, control: position_velocity"}) {
      EXPECT_THAT(errorsOf(robotWith("{name: a, model: " + good + ", " + key + "}")), IsEmpty()) << good;
    }
  }
  const std::string input = "mode_gpio: {chip: gpiochip0, line: 23}\n";
  EXPECT_THAT(errorsOf(input + robotWith("{name: a, " + group + ", reduced_velocity_rpm: 30}")),
              Contains(HasSubstr("reduced_velocity_rpm: nothing could slow the motor down there")));
}

TEST(MotorRules, ASlewOfTheSpeedEndsAtTheLimitOrWellBeyondTheNoLoadSpeed) {
  const auto bounded = motorOf("{name: a, model: M3508, id: 1, velocity_limit_rpm: 100}");
  EXPECT_EQ(bounded.shaping.velocity_limit_rpm, 100.0F);
  const auto arm = motorOf("{name: a, model: DM4310, id: 1, master_id: 17}");
  ASSERT_EQ(arm.settings.velocity_limit_rpm, 0.0F);
  EXPECT_EQ(arm.shaping.velocity_limit_rpm, 2.0F * arm.traits().no_load_rpm);
}

TEST(MotorRules, AGearedMotorMayCallItsFirstPositionZero) {
  EXPECT_TRUE(motorOf("{name: a, model: M2006, id: 1, zero: power_on}").settings.zero_at_power_on);
  EXPECT_FALSE(motorOf("{name: a, model: M2006, id: 1, zero: none}").settings.zero_at_power_on);
  EXPECT_FALSE(motorOf("{name: a, model: M2006, id: 1}").settings.zero_at_power_on);
  EXPECT_THAT(errorsOfWheel("zero: poweron"),
              ElementsAre("hero.yaml:6:50: buses[0].motors[0].zero: 'poweron' is not "
                          "one of none and power_on; did you mean power_on?"));
}

TEST(MotorRules, TheTimeoutSpansTwoFeedbackFrames) {
  EXPECT_EQ(motorOf("{name: a, model: M3508, id: 1, feedback_timeout_ms: 2}").feedback_timeout,
            std::chrono::milliseconds{2});
  EXPECT_THAT(
      errorsOfWheel("feedback_timeout_ms: 1"),
      ElementsAre(
          "hero.yaml:6:65: buses[0].motors[0].feedback_timeout_ms: 1 is below 2 ms; use 2 to 1000 ms"));
  EXPECT_THAT(
      errorsOfWheel("feedback_timeout_ms: 5, feedback_hz: 300"),
      ElementsAre("hero.yaml:6:65: buses[0].motors[0].feedback_timeout_ms: 5 ms is less than two periods of "
                  "feedback at 300 Hz; use at least 7 ms"));
}

TEST(MotorRules, AVelocityLimitBeyondTheMotorIsWorthAWarning) {
  const auto text = robotWith("{name: a, model: M3508, id: 1, velocity_limit_rpm: 600}");
  EXPECT_THAT(errorsOf(text), IsEmpty());
  EXPECT_THAT(warningsOf(text),
              ElementsAre("hero.yaml:6:60: buses[0].motors[0].velocity_limit_rpm: 600 rpm is more "
                          "than the M3508 reaches without load at 24 V (482 rpm)"));
  EXPECT_THAT(warningsOf(robotWith("{name: a, model: M3508, id: 1, gear_ratio: 1, velocity_limit_rpm: 600}")),
              IsEmpty());
}

TEST(MotorRules, ATravelOfATurnIsWorthAWarningWhereTheTurnFollowsFromIt) {
  const std::string limits = "angle_min_deg: -300, angle_max_deg: 200";
  EXPECT_THAT(warningsOf(robotWith("{name: a, model: GM6020, id: 1, " + limits + "}")),
              ElementsAre(AllOf(HasSubstr("motors[0].angle_max_deg: a travel of a turn or more"),
                                HasSubstr("`rc10ctl zero`"))));
  for (const std::string motor : {"model: M3508, id: 1", "model: GM6020, id: 1, zero: power_on"})
    EXPECT_THAT(warningsOf(robotWith("{name: a, " + motor + ", " + limits + "}")), IsEmpty()) << motor;
  EXPECT_THAT(
      warningsOf(robotWith("{name: a, model: GM6020, id: 1, angle_min_deg: -90, angle_max_deg: 200}")),
      IsEmpty());
}

TEST(MotorRules, ANumberHasNoUnitBehindIt) {
  EXPECT_THAT(
      errorsOfWheel("current_limit_a: 10A"),
      ElementsAre("hero.yaml:6:61: buses[0].motors[0].current_limit_a: '10A' has something after the number; "
                  "write 10: the unit is in the key's name"));
}

TEST(MotorRules, ASimulatedLoadIsTakenOver) {
  const auto load =
      motorOf(
          "{name: a, model: M3508, id: 1, simulated: {inertia_kg_m2: 0.01, viscous_nms_per_rad: 0.02, "
          "coulomb_nm: 0.03, load_torque_nm: -2, gravity_nm: 4, payload_kg: 1.5, payload_at_m: 0.25, "
          "hangs_at_deg: -90, stop_min_deg: -100, stop_max_deg: 110, initial_angle_deg: 30, stalled: true, "
          "silent: true, "
          "lost_frames: 0.5}}")
          .simulated;
  EXPECT_EQ(load.inertia_kg_m2, 0.01F);
  EXPECT_EQ(load.viscous_nms_per_rad, 0.02F);
  EXPECT_EQ(load.coulomb_nm, 0.03F);
  EXPECT_EQ(load.load_torque_nm, -2.0F);
  EXPECT_EQ(load.gravity_nm, 4.0F);
  EXPECT_EQ(load.hangs_at_deg, -90.0F);
  EXPECT_EQ(load.payload_kg, 1.5F);
  EXPECT_EQ(load.payload_at_m, 0.25F);
  EXPECT_EQ(load.stop_min_deg, -100.0F);
  EXPECT_EQ(load.stop_max_deg, 110.0F);
  EXPECT_EQ(load.initial_angle_deg, 30.0F);
  EXPECT_TRUE(load.stalled);
  EXPECT_TRUE(load.silent);
  EXPECT_EQ(load.lost_frames, 0.5F);
  EXPECT_TRUE(std::isnan(motorOf("{name: a, model: M3508, id: 1}").simulated.inertia_kg_m2));
  EXPECT_THAT(
      errorsOfWheel("simulated: {lost_frames: 1.5}"),
      ElementsAre("hero.yaml:6:69: buses[0].motors[0].simulated.lost_frames: 1.5 is above 1; use 0 to 1"));
}

TEST(MotorRules, ASimulatedDriveMayHaveAnotherIdThanItsMotor) {
  EXPECT_EQ(motorOf("{name: a, model: M3508, id: 1, simulated: {drive_id: 3}}").simulated_id, 3);
  EXPECT_FALSE(motorOf("{name: a, model: M3508, id: 1}").simulated_id);
  EXPECT_THAT(errorsOfWheel("simulated: {drive_id: 9}"),
              ElementsAre(testing::HasSubstr("simulated.drive_id: 9 is no id of a M3508; use 1 to 8")));
}

TEST(MotorRules, TheStopsOfASimulatedShaftAreInOrderAndAroundIt) {
  EXPECT_THAT(errorsOfWheel("simulated: {stop_min_deg: 10, stop_max_deg: 10}"),
              ElementsAre(testing::HasSubstr(
                  "simulated.stop_max_deg: 10 deg is not above stop_min_deg (10); change one")));
  EXPECT_THAT(errorsOfWheel("simulated: {stop_min_deg: 10}"),
              ElementsAre(testing::HasSubstr(
                  "simulated.stop_min_deg: the shaft begins at initial_angle_deg, beyond")));
  EXPECT_THAT(errorsOfWheel("simulated: {stop_max_deg: 10, initial_angle_deg: 11}"),
              ElementsAre(testing::HasSubstr(
                  "simulated.initial_angle_deg: the shaft begins at initial_angle_deg, beyond")));
  EXPECT_THAT(errorsOfWheel("simulated: {stop_min_deg: 0, stop_max_deg: 10, initial_angle_deg: 10}"),
              ElementsAre());
}

TEST(MotorRules, ChangesOfALoadAreTakenOver) {
  const auto plan =
      motorOf(
          "{name: a, model: M3508, id: 1, simulated: {payload_at_m: 0.3, changes: [{after_s: 0.5, "
          "payload_kg: 2}, {after_s: 3, payload_kg: 0, coulomb_nm: 0.1}], changes_repeat_s: 4}}")
          .load_plan;
  ASSERT_EQ(plan.steps.size(), 2U);
  EXPECT_EQ(plan.steps[0].after, std::chrono::milliseconds{500});
  const sim::MotorLoad start{.inertia_kg_m2 = 0.01F, .coulomb_nm = 0.03F, .payload_at_m = 0.3F};
  const auto first = plan.steps[0].change.of(start, start);
  EXPECT_EQ(first.payload_kg, 2.0F);
  EXPECT_EQ(first.coulomb_nm, 0.03F);
  const auto second = plan.steps[1].change.of(first, start);
  EXPECT_EQ(second.payload_kg, 0.0F);
  EXPECT_EQ(second.coulomb_nm, 0.1F);
  EXPECT_EQ(plan.repeat, std::chrono::seconds{4});
  EXPECT_TRUE(motorOf("{name: a, model: M3508, id: 1}").load_plan.steps.empty());
}

TEST(MotorRules, ChangesOfALoadComeInTheOrderOfTimeAndChangeSomething) {
  const auto changes = [](const std::string& text) { return errorsOfWheel("simulated: {" + text + "}"); };
  EXPECT_THAT(changes("changes: [{after_s: 2}]"),
              ElementsAre(testing::HasSubstr("simulated.changes[0]: changes nothing; add what changes")));
  EXPECT_THAT(changes("changes: [{after_s: 2, coulomb_nm: 1}, {after_s: 2, coulomb_nm: 2}]"),
              ElementsAre(testing::HasSubstr("changes[1].after_s: 2 s is not after the change before it")));
  EXPECT_THAT(changes("changes: [{after_s: 2, coulomb_nm: 1}], changes_repeat_s: 2"),
              ElementsAre(testing::HasSubstr("changes_repeat_s: 2 s is not after the last change")));
  EXPECT_THAT(changes("changes_repeat_s: 2"),
              ElementsAre(testing::HasSubstr("changes_repeat_s: there are no changes to repeat")));
  EXPECT_THAT(changes("changes: [{after_s: 2, coulomb_nm: 101}]"),
              ElementsAre(testing::HasSubstr("changes[0].coulomb_nm: 101 is above 100 N m; use 0 to 100")));
  EXPECT_THAT(changes("changes: [{after_s: 2, stalled: true}]"),
              ElementsAre(testing::HasSubstr("changes[0].stalled: unknown key")));
}

TEST(MotorRules, ARampAfterATimeoutNeedsADriveThatRestsWithoutATarget) {
  struct Case {
    const char* motor;
    bool allowed;
  };
  for (const auto& [motor, allowed] : {
           Case{"model: M3508, id: 1", true},
           Case{"model: DM4310, id: 1, master_id: 17", true},
           Case{"model: DM4310, id: 1, master_id: 17, control: velocity", false},
           Case{"model: DM4310, id: 1, master_id: 17, control: position_velocity", false},
           Case{"model: DM4310, id: 1, master_id: 17, control: force_position", false},
           Case{"model: RS00, id: 3", true},
           Case{"model: RS00, id: 3, control: velocity", true},
           Case{"model: AK80-9, id: 5", true},
           Case{"model: AK80-9, id: 5, protocol: mit", true},
           Case{"model: RMD-X8-20, id: 11", true},
           Case{"model: LK-MG5010E-i10, id: 12", true},
           Case{"model: VESC, id: 10, pole_pairs: 7", true},
           Case{"model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, "
                "velocity_limit_rpm: 600",
                true},
       }) {
    const auto errors = errorsOf(robotWith("{name: m, on_timeout: ramp, " + std::string{motor} + "}"));
    EXPECT_EQ(errors.empty(), allowed) << motor << (errors.empty() ? "" : ": " + errors[0]);
    for (const char* key : {"on_disable", "on_estop"}) {
      const bool takes_velocities = std::string_view{motor}.find("position") == std::string_view::npos;
      EXPECT_EQ(errorsOf(robotWith("{name: m, " + std::string{key} + ": ramp, " + motor + "}")).empty(),
                takes_velocities)
          << motor << ' ' << key;
    }
  }
  EXPECT_THAT(
      errorsOf(
          robotWith("{name: m, model: DM4310, id: 1, master_id: 17, control: velocity, on_timeout: ramp}")),
      ElementsAre("hero.yaml:6:87: buses[0].motors[0].on_timeout: a ramp ends in no torque, but the DM4310 "
                  "set so stands still with its own torque while it is enabled without a target; use coast "
                  "or brake"));
}

TEST(MotorRules, ADriveThatOnlyAnswersIsAskedBeforeItsSilenceIsARestart) {
  int judged = 0;
  for (const auto& entry : motorFamilies()) {
    if (entry.family->name() != "LK-Tech" && entry.family->name() != "MyActuator") continue;
    ++judged;
    const std::string model{entry.family->models().front()};
    const std::string motor = "{name: a, model: " + model + ", id: 1, command_divider: ";
    EXPECT_THAT(errorsOfMotor(motor + "49}"), IsEmpty());
    EXPECT_THAT(errorsOfMotor(motor + "50}"),
                ElementsAre(EndsWith(
                    "command_divider: 50 asks the drive every 50 ms: with one answer lost it is silent for "
                    "so long that it may have restarted or turned unseen (100 ms); use at most 49")));
  }
  EXPECT_EQ(judged, 2);
}

// At 100 Hz one lost answer is a silence of 30 ms; this drive may turn by 0.8 PMAX in 24 ms.
TEST(MotorRules, ADriveThatNoDividerCouldAskOftenEnoughIsRefusedWithOrWithoutOne) {
  const auto errorsAt = [](int rate_hz, const std::string& keys) {
    return errorsOf("scheduler: {rate_hz: " + std::to_string(rate_hz) + "}\n" +
                    robotWith("{name: a, model: DM4310, id: 1, master_id: 17, watchdog_ms: 1000, "
                              "v_max_rad_s: 100, " +
                              keys + "}"));
  };
  const std::string wrong =
      " asks the drive every 10 ms: with one answer lost it is silent for so long that it may have restarted "
      "or turned unseen (24 ms); raise scheduler.rate_hz, or p_max_rad here and on the drive";
  EXPECT_THAT(errorsAt(100, "p_max_rad: 3"),
              ElementsAre("hero.yaml:7:9: buses[0].motors[0]: command_divider 1, the default," + wrong));
  EXPECT_THAT(errorsAt(100, "p_max_rad: 3, command_divider: 1"),
              ElementsAre(EndsWith("buses[0].motors[0].command_divider: 1" + wrong)));
  EXPECT_THAT(errorsAt(100, "p_max_rad: 3, command_divider: 2"),
              ElementsAre(AllOf(HasSubstr("command_divider: 2 asks the drive every 20 ms"),
                                EndsWith("; raise scheduler.rate_hz, or p_max_rad here and on the drive"))));
  EXPECT_THAT(errorsAt(100, "p_max_rad: 4"), IsEmpty());
  EXPECT_THAT(errorsAt(200, "p_max_rad: 3"), IsEmpty());
  EXPECT_THAT(errorsAt(200, "p_max_rad: 3, command_divider: 2"), ElementsAre(EndsWith("; use at most 1")));
}

TEST(MotorRules, APayloadHasAnArm) {
  EXPECT_THAT(
      errorsOfWheel("simulated: {payload_kg: 1}"),
      ElementsAre(testing::HasSubstr("simulated.payload_kg: has no arm to hang on; add payload_at_m")));
  EXPECT_THAT(errorsOfWheel("simulated: {changes: [{after_s: 1, payload_kg: 1}]}"),
              ElementsAre(testing::HasSubstr("changes[0].payload_kg: has no arm to hang on")));
  EXPECT_THAT(errorsOfWheel("simulated: {payload_at_m: 0.2, changes: [{after_s: 1, payload_kg: 1}]}"),
              ElementsAre());
}

TEST(MotorRules, AMotorKnowsWhereItStands) {
  const auto motor = motorOf("{name: a, model: M3508, id: 1}");
  EXPECT_EQ(motor.place.line, 6);
  EXPECT_EQ(motor.place.column, 9);
}

}  // namespace
}  // namespace rc10::test::motor_rules_test
