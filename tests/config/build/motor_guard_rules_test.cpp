// Over-speed, temperature and stall.

#include <gmock/gmock.h>

#include "config/config_text.hpp"

namespace rc10::test::motor_guard_rules_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

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

}  // namespace
}  // namespace rc10::test::motor_guard_rules_test
