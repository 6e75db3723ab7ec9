// Currents and torques that the drives of every family report, and what is refused where they do not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "daemon/supervision/family_variants.hpp"
#include "daemon/supervision/one_motor.hpp"

namespace rc10::test::axis_reported_effort_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Model and last key: what tells the variants of a row apart.
std::string nameOf(const std::string& keys) {
  const auto begin = keys.find(' ') + 1;
  return keys.substr(begin, keys.find(',') - begin) + keys.substr(keys.rfind(' '));
}

/// The first of current, velocity and angle that the motor can be told.
Target pushOf(ModeSet modes) {
  if (modes.contains(ControlMode::kCurrent)) return {.mode = ControlMode::kCurrent, .value = 1.0};
  if (modes.contains(ControlMode::kVelocity)) return {.mode = ControlMode::kVelocity, .value = 20.0};
  return {.mode = ControlMode::kTotalAngle, .value = 20.0};
}

ConfigOutcome withAJoint(const std::string& keys, const std::string& bus) {
  return parseRobotConfig(
      "robot: one\nrealtime: preferred\nmodules:\n  - {name: lift, type: joint, motor: motor, "
      "max_velocity_deg_s: 60, max_acceleration_deg_s2: 240, homing: stop, homing_current_a: 0.5}\n"
      "buses:\n  - name: bench\n    type: sim\n    " +
          bus + "motors:\n      - {name: motor, " + keys + "}\n",
      "one.yaml");
}

TEST(ReportedEffort, HasTheSignOfTheTorqueOrIsNotReportedAndNoStopIsHomedAt) {
  std::vector<std::string> without_current;
  std::vector<std::string> without_torque;
  for (const FamilyRow& row : kEveryControl) {
    for (const auto& keys : variantsOf(row)) {
      if (!OneMotor::parse(keys, row.bus).config) continue;  // a protocol of other models
      SCOPED_TRACE(keys);
      OneMotor motor{keys, row.bus};
      motor.robot().simBus().stall(0, true);
      const auto traits = motor.config().traits();
      auto push = pushOf(traits.modes);
      for (const double sign : {1.0, -1.0}) {
        push.value = sign * std::fabs(push.value);
        motor.robot().hold(0, push, 1000);
        const auto& feedback = motor.seen().feedback;
        EXPECT_EQ(std::isfinite(feedback.current_a), traits.unreported_current_remedy.empty());
        EXPECT_EQ(std::isfinite(feedback.torque_nm), traits.unreported_torque_remedy.empty());
        if (push.mode == ControlMode::kCurrent && traits.unreported_current_remedy.empty()) {
          EXPECT_NEAR(feedback.current_a, push.value, 0.2);
        }
      }
      if (!traits.unreported_current_remedy.empty()) without_current.push_back(nameOf(keys));
      if (!traits.unreported_torque_remedy.empty()) without_torque.push_back(nameOf(keys));
      if (!traits.modes.contains(ControlMode::kCurrent) || !traits.modes.contains(ControlMode::kTotalAngle))
        continue;
      const auto outcome = withAJoint(keys, row.bus);
      EXPECT_EQ(outcome.config.has_value(), traits.unreported_current_remedy.empty()) << outcome.errorText();
      if (!outcome.config) {
        EXPECT_THAT(outcome.errorText(), HasSubstr("homing: motor 'motor' does not report its current"));
      }
    }
  }
  EXPECT_THAT(without_current, ElementsAre("AK10-9-V3 servo", "AK10-9-V3 mit_v3", "ODrive_S1 0.002}"));
  EXPECT_THAT(without_torque, ElementsAre("VESC 0.5}", "AK10-9-V3 servo", "AK10-9-V3 mit_v3",
                                          "ODrive_S1 0.002}", "RMD-X 10", "LK-MF 300"));
}

}  // namespace
}  // namespace rc10::test::axis_reported_effort_test
