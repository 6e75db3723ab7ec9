// Profiles: keys that motors share.

#include <variant>

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "drives/dji/dji_model.hpp"

namespace rc10::test::profile_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string robotWithProfile(const std::string& profile, const std::string& first,
                             const std::string& second = "") {
  return "robot: hero\nprofiles:\n  wheel: " + profile +
         "\nbuses:\n  - name: chassis\n    type: sim\n    motors:\n      - " + first + "\n" +
         (second.empty() ? "" : "      - " + second + "\n");
}

TEST(Profile, GivesAMotorWhatItDoesNotSayItself) {
  const auto config =
      parseRobotConfig(robotWithProfile("{model: M3508, current_limit_a: 10, direction: -1, optional: true}",
                                        "{name: a, id: 1, profile: wheel}",
                                        "{name: b, id: 2, profile: wheel, direction: 1, current_limit_a: 5}"),
                       "hero.yaml")
          .config.value();
  const auto& motors = config.buses[0].motors;
  EXPECT_EQ(motors[0].settings.model, "M3508");
  EXPECT_EQ(motors[0].settings.effort_limit, 10.0F);
  EXPECT_EQ(motors[0].settings.direction, -1);
  EXPECT_TRUE(motors[0].optional);
  EXPECT_EQ(motors[1].settings.effort_limit, 5.0F);
  EXPECT_EQ(motors[1].settings.direction, 1);
  EXPECT_TRUE(motors[1].optional);
}

TEST(Profile, IsOverriddenKeyByKeyInsideAPid) {
  const auto config =
      parseRobotConfig(
          robotWithProfile("{model: M3508, velocity_pid: {kp_a_per_rpm: 0.5, deadband_rpm: 3}}",
                           "{name: a, id: 1, profile: wheel, velocity_pid: {kp_a_per_rpm: 0.7}}"),
          "hero.yaml")
          .config.value();
  const auto& velocity = std::get<PID_Position::Config>(config.buses[0].motors[0].settings.loops.velocity);
  EXPECT_EQ(velocity.kp, 0.7F);
  EXPECT_EQ(velocity.deadband, 3.0F);
  EXPECT_EQ(velocity.ki, std::get<PID_Position::Config>(kM3508.current.default_loops.velocity).ki);
}

TEST(Profile, ReportsItsMistakeOnceForAllItsMotors) {
  EXPECT_THAT(
      errorsOf(robotWithProfile("{model: M3508, current_limit_a: 32, deadband: 1, velocity_pid: {type: pid}}",
                                "{name: a, id: 1, profile: wheel}", "{name: b, id: 2, profile: wheel}")),
      ElementsAre(
          "hero.yaml:3:42: profiles.wheel.current_limit_a: 32 is above the M3508 limit of 20; use more "
          "than 0, at most 20",
          ::testing::StartsWith(
              "hero.yaml:3:46: profiles.wheel.deadband: unknown key; known here: model, direction, "
              "gear_ratio, current_limit_a, voltage_limit_v, velocity_limit_rpm, overspeed_rpm, "),
          "hero.yaml:3:80: profiles.wheel.velocity_pid.type: 'pid' is not one of position and "
          "incremental; use one of these"));
}

TEST(Profile, MustExist) {
  EXPECT_THAT(
      errorsOf(robotWithProfile("{model: M3508}", "{name: a, id: 1, profile: weel}",
                                "{name: b, id: 2, profile: wheel}")),
      ElementsAre(
          "hero.yaml:8:35: buses[0].motors[0].profile: 'weel' is not one of wheel; did you mean wheel?"));
  EXPECT_THAT(
      errorsOf(robotWith("{name: a, id: 1, profile: wheel}")),
      ElementsAre("hero.yaml:6:35: buses[0].motors[0].profile: there are no profiles; remove it, or add "
                  "'profiles:'"));
}

TEST(Profile, WhoseNameAMotorMisspellsIsNotCalledUnused) {
  EXPECT_THAT(warningsOf(robotWithProfile("{model: M3508}", "{name: a, id: 1, profile: weel}")), IsEmpty());
}

TEST(Profile, HasNoKeysThatBelongToOneMotor) {
  EXPECT_THAT(errorsOf(robotWithProfile("{model: M3508, id: 1, name: a, profile: wheel}",
                                        "{name: a, id: 1, profile: wheel}"))
                  .size(),
              3U);
}

TEST(Profile, HasANameLikeAMotor) {
  EXPECT_THAT(
      errorsOf(robotAfter("robot: hero\nprofiles: {Front Wheel: {model: M3508}}\n")),
      ElementsAre(
          "hero.yaml:2:12: profiles.Front Wheel: 'Front Wheel' is not accepted as a name; use 1 to 31 "
          "of a-z, 0-9 and _"));
}

TEST(Profile, NeedNotNameTheModel) {
  EXPECT_THAT(errorsOf(robotWithProfile("{direction: -1}", "{name: a, model: M2006, id: 1, profile: wheel}")),
              IsEmpty());
  EXPECT_THAT(
      errorsOf(robotWithProfile("{direction: -1}", "{name: a, id: 1, profile: wheel}")),
      ElementsAre("hero.yaml:8:9: buses[0].motors[0].model: is missing; add it here or in a profile"));
}

TEST(Profile, ThatNobodyUsesIsWorthAWarning) {
  const auto text = robotWithProfile("{model: M3508}", "{name: a, model: M2006, id: 1}");
  EXPECT_THAT(errorsOf(text), IsEmpty());
  EXPECT_THAT(warningsOf(text),
              ElementsAre("hero.yaml:3:3: profiles.wheel: no motor uses this profile; remove it"));
}

}  // namespace
}  // namespace rc10::test::profile_test
