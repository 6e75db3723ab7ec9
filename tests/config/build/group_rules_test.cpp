// Groups of motors that stop together, fallbacks, slew and soft limits.

#include <gmock/gmock.h>

#include "config/config_text.hpp"

namespace rc10::test::group_rules_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

std::string robotWithGroups(const std::string& groups) {
  return "robot: hero\ngroups:\n" + groups +
         "buses:\n  - {name: a, type: sim, motors: [{name: left, model: M3508, id: 1}]}\n"
         "  - {name: b, type: sim, motors: [{name: right, model: M3508, id: 1}, {name: arm, model: M2006, "
         "id: 2}]}\n";
}

TEST(GroupRules, AGroupSpansBuses) {
  const auto loaded = parseRobotConfig(
      robotWithGroups("  - {name: drive, motors: [right, left], on_return: rearm_at_rest}\n"), "hero.yaml");
  ASSERT_TRUE(loaded) << loaded.errorText();
  const auto& group = loaded.config->groups.at(0);
  EXPECT_EQ(group.name, "drive");
  EXPECT_THAT(group.motors, ElementsAre(1U, 0U));
  EXPECT_EQ(group.on_return, GroupConfig::Return::kRearmAtRest);
}

std::string chassisOf(const std::string& more) {
  return "robot: hero\n" + more +
         "buses:\n  - name: a\n    type: sim\n    motors:\n"
         "      - {name: left, model: M3508, id: 1}\n      - {name: right, model: M3508, id: 2}\n"
         "      - {name: lift_left, model: M2006, id: 3}\n      - {name: lift_right, model: M2006, id: 4}\n"
         "modules:\n  - {name: base, type: differential_chassis, wheel_radius_m: 0.1, track_m: 0.4, "
         "max_speed_m_s: 1, max_turn_deg_s: 90, max_acceleration_m_s2: 1, max_turn_acceleration_deg_s2: 90, "
         "wheels: {left: left, right: right}}\n"
         "  - {name: lift, type: synchronised_pair, left: lift_left, right: lift_right, velocity_limit_rpm: "
         "100}\n";
}

TEST(GroupRules, AChassisAndAPairAreGroups) {
  const auto loaded = parseRobotConfig(chassisOf(""), "hero.yaml");
  ASSERT_TRUE(loaded) << loaded.errorText();
  ASSERT_EQ(loaded.config->groups.size(), 2U);
  const auto& base = loaded.config->groups[0];
  EXPECT_EQ(base.name, "base");
  EXPECT_THAT(base.motors, ElementsAre(0U, 1U));
  EXPECT_EQ(base.on_return, GroupConfig::Return::kRearmAtRest);
  EXPECT_FALSE(base.together) << "a wheel may be tried by itself";
  EXPECT_TRUE(loaded.config->groups[1].together);
  EXPECT_TRUE(loaded.config->groups[1].implied);
}

TEST(GroupRules, ADeclaredGroupWinsOverTheOneOfAModule) {
  const auto loaded = parseRobotConfig(
      chassisOf("groups:\n  - {name: mine, motors: [left, right, lift_left, lift_right], together: true}\n"),
      "hero.yaml");
  ASSERT_TRUE(loaded) << loaded.errorText();
  EXPECT_THAT(loaded.warnings, IsEmpty());
  ASSERT_EQ(loaded.config->groups.size(), 1U);
  EXPECT_FALSE(loaded.config->groups[0].implied);
  EXPECT_TRUE(loaded.config->groups[0].together);
  EXPECT_EQ(loaded.config->groups[0].on_return, GroupConfig::Return::kRequest);
}

TEST(GroupRules, AGroupWithSomeOfAPairIsRefusedAndWithSomeOfAChassisIsNamed) {
  EXPECT_THAT(errorsOf(chassisOf("groups:\n  - {name: mine, motors: [left, lift_left]}\n")),
              ElementsAre(HasSubstr("group mine has only some of its motors")));
  EXPECT_THAT(
      warningsOf(chassisOf("groups:\n  - {name: mine, motors: [left, lift_left, lift_right]}\n")),
      ElementsAre(HasSubstr("put all of them into it, or none"), HasSubstr("give it together: true")));
}

TEST(GroupRules, EveryMistakeIsNamed) {
  EXPECT_THAT(
      errorsOf(robotWithGroups("  - {name: drive, motors: [left, rigt]}\n"
                               "  - {name: drive, motors: [left, arm], on_member_offline: ignore}\n"
                               "  - {name: lift, motors: [arm], on_return: [now]}\n"
                               "  - {motors: [{name: left}, 'a b', right]}\n")),
      ElementsAre(
          "hero.yaml:3:34: groups[0].motors[1]: there is no motor 'rigt'; did you mean right?",
          "hero.yaml:4:12: groups[1].name: group name 'drive' is taken by groups[0].name (line 3); it must "
          "be "
          "unique in the robot",
          "hero.yaml:4:28: groups[1].motors[0]: 'left' is in a group already, at groups[0].motors[0]; a "
          "motor is "
          "in one group at most",
          "hero.yaml:4:59: groups[1].on_member_offline: 'ignore' is not one of stop_group; use one of these",
          "hero.yaml:5:26: groups[2].motors: has 1 entries; use 2 to 128",
          "hero.yaml:5:27: groups[2].motors[0]: 'arm' is in a group already, at groups[1].motors[1]; a motor "
          "is in "
          "one group at most",
          "hero.yaml:5:44: groups[2].on_return: is a list; write request or rearm_at_rest",
          "hero.yaml:6:5: groups[3].name: is missing; add it: Name of the group, unique.",
          "hero.yaml:6:15: groups[3].motors[0]: is a map; write a text",
          "hero.yaml:6:29: groups[3].motors[1]: 'a b' is not accepted; use 1 to 31 of a-z, 0-9 and _"));
}

TEST(FallbackRules, CoastIsTheDefaultAndTheRestIsRead) {
  const auto bare = motorOf("{name: a, model: M3508, id: 1}").fallback;
  EXPECT_EQ(bare.on_timeout, FallbackAction::kCoast);
  EXPECT_EQ(bare.hold_max, 10s);
  const auto given =
      motorOf(
          "{name: a, model: M3508, id: 1, on_timeout: hold, on_disable: damp, on_estop: brake, "
          "hold_max_s: 2.5}")
          .fallback;
  EXPECT_EQ(given.on_timeout, FallbackAction::kHold);
  EXPECT_EQ(given.on_disable, FallbackAction::kDamp);
  EXPECT_EQ(given.on_estop, FallbackAction::kBrake);
  EXPECT_EQ(given.hold_max, 2500ms);
}

TEST(ShapingRules, WhatIsWrittenHolds) {
  const auto shaping =
      motorOf(
          "{name: a, model: M3508, id: 1, current_slew_a_per_s: 50, velocity_slew_rpm_per_s: 900, "
          "angle_slew_deg_per_s: 360, angle_min_deg: -30, angle_max_deg: 45, "
          "max_first_step_deg: 5, angle_pid: {kp_rpm_per_deg: 6}}")
          .shaping;
  EXPECT_EQ(shaping.effort_slew_per_s, 50.0F);
  EXPECT_EQ(shaping.velocity_slew_rpm_per_s, 900.0F);
  EXPECT_EQ(shaping.angle_slew_deg_per_s, 360.0F);
  EXPECT_EQ(shaping.angle_min_deg, -30.0);
  EXPECT_EQ(shaping.angle_max_deg, 45.0);
  EXPECT_EQ(shaping.max_first_step_deg, 5.0);
  EXPECT_EQ(shaping.approach_rpm_per_deg, 3.0F);
  EXPECT_EQ(motorOf("{name: a, model: GM6020, id: 1, command: voltage, voltage_slew_v_per_s: 9}")
                .shaping.effort_slew_per_s,
            9.0F);
}

TEST(ShapingRules, SoftLimitsMustLeaveRoom) {
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M3508, id: 1, angle_min_deg: 10, angle_max_deg: 10}")),
      ElementsAre("hero.yaml:6:74: buses[0].motors[0].angle_max_deg: 10 deg is not above angle_min_deg "
                  "(10); change one of them"));
  EXPECT_THAT(errorsOf(robotWith("{name: a, model: M3508, id: 1, angle_max_deg: 10}")), IsEmpty());
}

TEST(ShapingRules, AFollowingErrorNeedsASlewLimit) {
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, model: M3508, id: 1, following_error_deg: 10}")),
      ElementsAre("hero.yaml:6:61: buses[0].motors[0].following_error_deg: needs angle_slew_deg_per_s: "
                  "without it every step of the target would be a fault; add it"));
  const auto guard =
      motorOf("{name: a, model: M3508, id: 1, following_error_deg: 10, angle_slew_deg_per_s: 90}").guard;
  EXPECT_EQ(guard.following_error_deg, 10.0);
  EXPECT_EQ(guard.following_error_time, 200ms);
}

}  // namespace
}  // namespace rc10::test::group_rules_test
