// Over-speed, temperature and stall.

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "drives/families.hpp"

namespace rc10::test::motor_guard_rules_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;
using namespace std::chrono_literals;

// Keys that a family's motors need beside model and id.
std::string needsOf(std::string_view family) {
  if (family == "Damiao") return ", master_id: 17";
  if (family == "VESC") return ", pole_pairs: 7, velocity_limit_rpm: 600";
  if (family == "moteus") return ", motor_kv_rpm_per_v: 100";
  if (family == "ODrive")
    return ", torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600";
  if (family == "LK-Tech" || family == "LKTech") return ", velocity_limit_rpm: 300";
  return "";
}

MotorConfig watchedMotor(const std::string& keys) {
  const std::string bus = keys.find("moteus") == std::string::npos ? "" : "    data_bitrate: 5000000\n";
  const auto outcome = parseRobotConfig("robot: r\nbuses:\n  - name: b\n    type: sim\n" + bus +
                                            "    motors:\n      - {name: a, id: 1, " + keys + "}\n",
                                        "r.yaml");
  EXPECT_TRUE(outcome.config) << keys << outcome.errorText();
  return outcome.config.value().buses.at(0).motors.at(0);
}

/// Reason of the one error, without its place.
std::string reasonOf(const std::string& motor) {
  const auto errors = errorsOf(robotWith("{name: a, " + motor + "}"));
  if (errors.empty()) return "";
  EXPECT_EQ(errors.size(), 1U);
  const std::string key = ".stall_ms: ";
  const auto at = errors.front().find(key);
  return at == std::string::npos ? errors.front() : errors.front().substr(at + key.size());
}

TEST(MotorGuardRules, WithoutKeysAMotorIsWatchedByItsModel) {
  const auto wheel = motorOf("{name: a, model: M3508, id: 1}").guard;
  EXPECT_FLOAT_EQ(wheel.overspeed_rpm, 723.0F);
  EXPECT_EQ(wheel.temperature_derate_c, 80.0F);
  EXPECT_EQ(wheel.temperature_trip_c, 100.0F);
  EXPECT_EQ(wheel.stall_time, 0ms);
  EXPECT_TRUE(wheel.stall_trips);
  EXPECT_EQ(motorOf("{name: a, model: M2006, id: 1}").guard.temperature_trip_c, 0.0F);
}

TEST(MotorGuardRules, OverSpeedIsAtTheShaftBehindAnyGear) {
  EXPECT_FLOAT_EQ(motorOf("{name: a, model: GM6020, id: 1, gear_ratio: 2}").guard.overspeed_rpm, 240.0F);
}

TEST(MotorGuardRules, WhatIsWrittenHolds) {
  const auto guard = motorOf(
                         "{name: a, model: M3508, id: 1, overspeed_rpm: 490, temperature_derate_c: 50, "
                         "temperature_trip_c: 60, "
                         "stall_ms: 250, stall_action: notify}")
                         .guard;
  EXPECT_EQ(guard.overspeed_rpm, 490.0F);
  EXPECT_EQ(guard.temperature_derate_c, 50.0F);
  EXPECT_EQ(guard.temperature_trip_c, 60.0F);
  EXPECT_EQ(guard.stall_time, 250ms);
  EXPECT_FALSE(guard.stall_trips);
}

TEST(MotorGuardRules, ARunawayIsATenthOfTheNoLoadSpeedOrWhatIsWritten) {
  const auto wheel = motorOf("{name: a, model: M3508, id: 1}").guard;
  EXPECT_NEAR(wheel.runaway_rpm, 48.2F, 0.1F);
  EXPECT_EQ(wheel.runaway_time, 0ms);
  EXPECT_EQ(motorOf("{name: a, model: M3508, id: 1, runaway_rpm: 90}").guard.runaway_rpm, 90.0F);
}

TEST(MotorGuardRules, ARunawayOfADrivesOwnLoopLastsForTwoReportsOfItsCurrent) {
  const std::string odrive =
      "{name: a, model: ODrive_v3, id: 1, torque_constant_nm_per_a: 0.05, current_limit_a: 20, "
      "velocity_limit_rpm: ";
  const auto slow = motorOf(odrive + "300, telemetry_hz: 10}").guard;
  EXPECT_EQ(slow.runaway_time, 200ms);
  EXPECT_EQ(slow.runaway_rpm, 60.0F) << "its no-load speed is not known";
  EXPECT_EQ(motorOf(odrive + "900, telemetry_hz: 100}").guard.runaway_time, 100ms);
  EXPECT_EQ(motorOf(odrive + "900, telemetry_hz: 100}").guard.runaway_rpm, 90.0F);
}

// Or of its feedback, where the current comes with that.
TEST(MotorGuardRules, TwoReportsAreAwaitedHoweverTheCurrentComes) {
  const std::string vesc =
      "model: VESC, pole_pairs: 7, angle: none, velocity_limit_rpm: 600, motor_current_max_a: 40, "
      "feedback_hz: ";
  EXPECT_EQ(watchedMotor(vesc + "5").guard.runaway_time, 400ms);
  EXPECT_EQ(watchedMotor(vesc + "50").guard.runaway_time, 100ms);
  EXPECT_EQ(reasonOf(vesc + "5, id: 1, stall_ms: 150"),
            "150 ms is shorter than two reports of the current, which comes every 200 ms; write 400 or "
            "more, or let it come more often");
  EXPECT_EQ(reasonOf(vesc + "5, id: 1, stall_ms: 400"), "");
  for (const std::string asked : {"model: moteus, motor_kv_rpm_per_v: 100, watchdog_ms: 300",
                                  "model: RS00, watchdog_ms: 1000, control: velocity",
                                  "model: RS00, watchdog_ms: 1000, control: operation"}) {
    SCOPED_TRACE(asked);
    const bool moteus = asked.find("moteus") != std::string::npos;
    // A RobStride that is asked so seldom may have restarted.
    const int divider = moteus ? 100 : 80;
    const std::string keys = asked + ", command_divider: " + std::to_string(divider);
    const auto two = 2 * std::chrono::milliseconds{divider};
    const auto motor = watchedMotor(keys + ", stall_ms: " + std::to_string(two.count()));
    EXPECT_EQ(motor.guard.stall_time, two);
    if (motor.traits().limit_by_report) {
      EXPECT_EQ(motor.guard.runaway_time, two);
    }
    if (!moteus) {
      EXPECT_THAT(reasonOf(keys + ", id: 1, stall_ms: " + std::to_string(two.count() - 1)),
                  HasSubstr("shorter than two reports"));
    }
  }
  // Its angles come more seldom than its currents.
  EXPECT_EQ(watchedMotor("model: RMD-X8-20, angle_divider: 100, current_limit_a: 5").guard.runaway_time,
            100ms);
}

// Where its loops obey the drive's own limit, which no frame carries, a key tells it.
TEST(MotorGuardRules, NoFamilyTakesTheEndOfAFieldForTheLimitOfTheDrivesLoops) {
  std::vector<std::string> judged;
  for (const auto& entry : builtInFamilies()) {
    const std::string name{entry.family->name()};
    const std::string keys = "model: " + std::string{entry.family->models().front()} + needsOf(name);
    const auto traits = watchedMotor(keys).traits();
    if (traits.own_loops.bits() == 0 || !traits.unseen_limit_remedy.empty()) continue;
    judged.push_back(name);
    const std::string key{traits.own_limit_key};
    ASSERT_NE(key, "") << name;
    const auto warnedOf = [](const std::string& motor) {
      const auto outcome = parseRobotConfig(robotWith("{name: a, id: 1, " + motor + "}"), "hero.yaml");
      std::string texts;
      for (const auto& each : outcome.warnings) texts += each.text;
      return texts;
    };
    EXPECT_THAT(reasonOf(keys + ", id: 1, stall_ms: 300"),
                HasSubstr("needs " + key + ": a stall is a current at the limit that the drive itself has"));
    EXPECT_EQ(reasonOf(keys + ", id: 1, stall_ms: 300, " + key + ": 5"), "");
    EXPECT_THAT(warnedOf(keys + ", runaway_rpm: 20"), HasSubstr("is not known; write " + key));
    EXPECT_THAT(warnedOf(keys + ", runaway_rpm: 20, " + key + ": 5"), Not(HasSubstr("is not known")));
  }
  EXPECT_THAT(judged, UnorderedElementsAre("VESC", "LK-Tech", "MyActuator"));
  EXPECT_EQ(reasonOf("model: LK-MF9025, id: 1, group: true, stall_ms: 300"), "") << "currents alone";
}

// As written, else as the model is delivered where that is known.
TEST(MotorGuardRules, TheLimitOfTheDrivesLoopsIsOneNumber) {
  const auto limitOf = [](const std::string& keys) { return watchedMotor(keys).settings.own_limit_a; };
  const std::string vesc = "model: VESC, pole_pairs: 7, velocity_limit_rpm: 600, current_limit_a: 4";
  const std::string lktech = "model: LK-MF9025, velocity_limit_rpm: 300";
  EXPECT_EQ(limitOf(vesc), 0.0F);
  EXPECT_EQ(limitOf(vesc + ", motor_current_max_a: 5"), 5.0F);
  EXPECT_EQ(limitOf(lktech), 0.0F);
  EXPECT_EQ(limitOf(lktech + ", current_limit_a: 5"), 5.0F);
  EXPECT_EQ(limitOf("model: LK-MF9025, group: true, velocity_limit_rpm: 300, current_limit_a: 5"), 0.0F);
  EXPECT_EQ(limitOf("model: RMD-X8-20"), watchedMotor("model: RMD-X8-20").traits().effort_full_scale);
  EXPECT_EQ(limitOf("model: RMD-X8-20, current_limit_a: 5"), 5.0F);
  EXPECT_EQ(limitOf("model: RMD-X"), 0.0F) << "of an unknown model";
  EXPECT_EQ(limitOf("model: RMD-X, current_limit_a: 5"), 5.0F);
  EXPECT_EQ(limitOf("model: M3508, current_limit_a: 5"), 0.0F) << "has no such loop";
}

TEST(MotorGuardRules, ALoopThatYieldsHasNoRunaway) {
  const std::string gripper = "{name: a, model: DM4340, id: 1, master_id: 17, control: force_position";
  EXPECT_EQ(motorOf(gripper + "}").guard.runaway_rpm, 0.0F);
  EXPECT_THAT(errorsOf(robotWith(gripper + ", runaway_rpm: 20}")),
              ElementsAre(HasSubstr("runaway_rpm: its control bounds a force and yields to a larger one, "
                                    "which is no runaway; remove it")));
}

TEST(MotorGuardRules, ARunawayIsSetWhereItsLimitIsSeen) {
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: DM4340, id: 1, master_id: 17, control: velocity, "
                         "runaway_rpm: 20}")),
      ElementsAre(HasSubstr("runaway_rpm: nothing tells that its loop is at the limit of its current: ")));
  const auto warned = [](const std::string& motor) {
    const auto outcome = parseRobotConfig(robotWith(motor + ", runaway_rpm: 20}"), "hero.yaml");
    EXPECT_TRUE(outcome.config) << motor;
    for (const auto& each : outcome.warnings)
      if (each.text.find("acts on current targets alone") != std::string::npos) return each.text;
    return std::string{};
  };
  EXPECT_THAT(warned("{name: a, model: AK80-9, id: 1"), HasSubstr("is not known"));
  EXPECT_THAT(warned("{name: a, model: VESC, id: 1, pole_pairs: 7"), HasSubstr("write motor_current_max_a"));
  EXPECT_THAT(warned("{name: a, model: VESC, id: 1, pole_pairs: 7, motor_current_max_a: 40"), IsEmpty());
  EXPECT_THAT(warned("{name: a, model: M3508, id: 1"), IsEmpty());
}

TEST(MotorGuardRules, AnRmdXWhoseSpeedIsUnknownIsWatchedAsFarAsItReports) {
  const auto guard = motorOf("{name: a, model: RMD-X, id: 1, velocity_limit_rpm: 1000}").guard;
  EXPECT_EQ(guard.overspeed_rpm, 1500.0F);
}

TEST(MotorGuardRules, TheSpeedScaleHasAThresholdWhereItIsCompared) {
  const std::string motor = "{name: a, model: RS00, id: 1";
  EXPECT_EQ(motorOf(motor + "}").settings.scale_error, 0.2);
  EXPECT_EQ(motorOf(motor + ", scale_error_percent: 20}").settings.scale_error, 0.2) << "the default";
  EXPECT_EQ(motorOf(motor + ", scale_error_percent: 35}").settings.scale_error, 0.35);
  EXPECT_EQ(motorOf(motor + ", scale_error_percent: 0}").settings.scale_error, 0.0);
  EXPECT_THAT(errorsOf(robotWith("{name: a, model: M3508, id: 1, scale_error_percent: 20}")),
              ElementsAre("hero.yaml:6:61: buses[0].motors[0].scale_error_percent: the M3508 does not report "
                          "its speed as a share of a range; remove it"));
}

TEST(MotorGuardRules, OverSpeedMustBeAboveWhatMayBeAskedFor) {
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M3508, id: 1, velocity_limit_rpm: 300, overspeed_rpm: 300}")),
      ElementsAre(
          "hero.yaml:6:80: buses[0].motors[0].overspeed_rpm: 300 rpm is not above the velocity limit of 300 "
          "rpm; raise it, or lower velocity_limit_rpm"));
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M3508, id: 1, velocity_limit_rpm: 300, overspeed_rpm: 301}")),
      IsEmpty());
}

TEST(MotorGuardRules, NoDefaultOfOverSpeedLiesBeyondWhatADriveReports) {
  std::vector<std::string> unwatched;
  for (const auto& entry : builtInFamilies()) {
    for (const auto model : entry.family->models()) {
      for (const char* protocol : {"", ", protocol: mit", ", protocol: mit_v3"}) {
        const bool v3 = model.find("-V3") != std::string_view::npos;
        if (*protocol != '\0' && entry.family->name() != "CubeMars") continue;
        if (*protocol != '\0' && v3 != (std::string_view{protocol} == ", protocol: mit_v3")) continue;
        const auto motor =
            watchedMotor("model: " + std::string{model} + protocol + needsOf(entry.family->name()));
        SCOPED_TRACE(std::string{model} + protocol);
        const auto traits = motor.traits();
        const float rpm = motor.guard.overspeed_rpm;
        if (traits.no_load_rpm > 0.0F && !(rpm > 0.0F)) unwatched.emplace_back(model);
        if (rpm > 0.0F) {
          EXPECT_GE(rpm, 1.1F * traits.no_load_rpm);
        }
        if (rpm > 0.0F && traits.reported_rpm > 0.0F) {
          EXPECT_LE(rpm, 0.99F * traits.reported_rpm);
        }
      }
    }
  }
  EXPECT_THAT(unwatched, UnorderedElementsAre("RS00", "RS01", "RS02", "RS03", "RS04", "RS05", "RS06", "EL05",
                                              "CyberGear"))
      << "fields that end at the no-load speed";
}

TEST(MotorGuardRules, AThresholdThatNoFeedbackReachesIsRefused) {
  EXPECT_THAT(errorsOf(robotWith("{name: a, model: RS00, id: 1, overspeed_rpm: 309}")),
              ElementsAre("hero.yaml:6:54: buses[0].motors[0].overspeed_rpm: 309 rpm is never seen to be "
                          "exceeded: the RS00 reports too low a speed for that; use at most 308 rpm"));
  EXPECT_EQ(motorOf("{name: a, model: RS00, id: 1, overspeed_rpm: 308}").guard.overspeed_rpm, 308.0F);
  EXPECT_EQ(motorOf("{name: a, model: RS00, id: 1, overspeed_rpm: 154, gear_ratio: 20}").guard.overspeed_rpm,
            154.0F);
  EXPECT_THAT(errorsOf(robotWith("{name: a, model: RS00, id: 1, overspeed_rpm: 155, gear_ratio: 20}")),
              ElementsAre(HasSubstr("use at most 154 rpm")));
  EXPECT_THAT(errorsOf(robotWith("{name: a, model: AK80-9, protocol: mit, id: 1, overspeed_rpm: 900}")),
              ElementsAre(HasSubstr("use at most 887 rpm")))
      << "its field wraps, and is followed over that";
}

TEST(MotorGuardRules, DeratingStartsBelowTheTrip) {
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: GM6020, id: 1, temperature_trip_c: 70}")),
      ElementsAre("hero.yaml:6:61: buses[0].motors[0].temperature_trip_c: temperature_derate_c (80) must be "
                  "below temperature_trip_c (70); change one of them"));
}

TEST(MotorGuardRules, AMotorThatReportsNoTemperatureHasNoLimitOfIt) {
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M2006, id: 1, temperature_trip_c: 70}")),
      ElementsAre("hero.yaml:6:60: buses[0].motors[0].temperature_trip_c: the M2006 reports no temperature; "
                  "remove it"));
}

std::string unseen(const std::string& model, const std::string& remedy) {
  return "needs to see when the current is at its limit, which the " + model +
         ", as it is configured, does not show: " + remedy + ", or remove it";
}

TEST(MotorGuardRules, AStallIsRefusedWhereNobodySeesTheLimitOfTheCurrent) {
  const std::string stall = ", stall_ms: 300";
  const std::string damiao = "model: DM4310, id: 1, master_id: 17, control: ";
  for (const std::string control : {"velocity", "position_velocity"}) {
    EXPECT_EQ(reasonOf(damiao + control + stall),
              unseen("DM4310",
                     "its drive obeys a limit that no frame carries; write control: mit or "
                     "force_position"));
  }
  for (const std::string control : {"mit", "force_position"})
    EXPECT_EQ(reasonOf(damiao + control + stall), "");
  const std::string servo = unseen("AK80-9", "set the drive to MIT and write protocol: mit (V3: mit_v3)");
  EXPECT_EQ(reasonOf("model: AK80-9, id: 1" + stall), servo);
  EXPECT_EQ(reasonOf("model: AK80-9, id: 1, stall_ms: 0"), servo) << "as every key that means nothing";
  EXPECT_EQ(reasonOf("model: AK80-9, id: 1, protocol: mit" + stall), "");
  EXPECT_EQ(reasonOf("model: AK80-9-V3, id: 1, protocol: mit_v3" + stall), "");
  const std::string odrive =
      "model: ODrive_v3, id: 1, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600";
  EXPECT_EQ(reasonOf(odrive + stall), unseen("ODrive_v3", "let it send its current and write telemetry_hz"));
  EXPECT_EQ(reasonOf(odrive + ", telemetry_hz: 20" + stall), "");
}

TEST(MotorGuardRules, TheActionOfAStallIsRefusedWithIt) {
  EXPECT_THAT(reasonOf("model: AK80-9, id: 1, stall_action: notify"),
              ::testing::HasSubstr("stall_action: needs to see when the current is at its limit"));
}

TEST(MotorGuardRules, AStallIsLongerThanTwoReportsOfTheCurrent) {
  const std::string odrive =
      "model: ODrive_v3, id: 1, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: "
      "600, "
      "telemetry_hz: 5, stall_ms: ";
  EXPECT_EQ(reasonOf(odrive + "399"),
            "399 ms is shorter than two reports of the current, which comes every 200 ms; write 400 or "
            "more, or let it come more often");
  EXPECT_EQ(reasonOf(odrive + "400"), "");
  EXPECT_EQ(reasonOf(odrive + "0"), "");
}

TEST(MotorGuardRules, AStallOfAVescNeedsTheLimitThatIsSetInTheDrive) {
  const std::string vesc = "model: VESC, id: 1, pole_pairs: 7";
  EXPECT_EQ(reasonOf(vesc + ", stall_ms: 300"),
            "needs motor_current_max_a: a stall is a current at the limit that the drive itself has; write "
            "what is set there");
  EXPECT_EQ(reasonOf(vesc + ", stall_ms: 0"), "");
  EXPECT_EQ(reasonOf(vesc + ", motor_current_max_a: 40, stall_ms: 300"), "");
}

}  // namespace
}  // namespace rc10::test::motor_guard_rules_test
