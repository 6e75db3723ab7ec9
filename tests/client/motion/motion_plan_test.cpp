#include "client/motion/motion_plan.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10::client::test::motion_plan_test {
namespace {

using testing::HasSubstr;

MotionSettings settingsFor(const std::function<void(MotionPlan&)>& change) {
  MotionPlan plan{.motor = "wheel", .amplitude = -60.0, .max_current_a = 3.0};
  change(plan);
  const auto settings = settingsOf(plan, "tester");
  EXPECT_TRUE(settings) << (settings ? "" : settings.error().message);
  return settings.value_or(MotionSettings{});
}

std::string refusal(const std::function<void(MotionPlan&)>& change) {
  MotionPlan plan{.motor = "wheel", .amplitude = 60.0, .max_current_a = 3.0};
  change(plan);
  const auto settings = settingsOf(plan, "tester");
  return settings ? "" : settings.error().message;
}

TEST(MotionPlan, AVelocityHasHalfOfTheAmplitudeBeyondItsTarget) {
  const auto settings = settingsFor([](auto& plan) { plan.base = -20.0; });
  EXPECT_EQ(settings.criteria.velocity_max_rpm, 110.0);
  EXPECT_EQ(settings.criteria.angle_max_deg, std::numeric_limits<double>::infinity());
  EXPECT_EQ(settings.excitation.time_s, 1.5);
  EXPECT_EQ(settings.client, "tester");
  EXPECT_EQ(settingsFor([](auto& plan) { plan.max_speed_rpm = 70.0; }).criteria.velocity_max_rpm, 70.0);
}

TEST(MotionPlan, AnAngleHasTheSameAroundItsWay) {
  const auto settings = settingsFor([](auto& plan) {
    plan.mode = ControlMode::kTotalAngle;
    plan.max_speed_rpm = 30.0;
    plan.max_angle_deg = 5.0;
  });
  EXPECT_EQ(settings.criteria.angle_min_deg, -90.0);
  EXPECT_EQ(settings.criteria.angle_max_deg, 5.0);
}

TEST(MotionPlan, SinesLastTenPeriodsAndTenSecondsAtLeast) {
  const auto lasting = [](double from_hz) {
    return settingsFor([from_hz](auto& plan) {
             plan.kind = ExcitationKind::kSweep;
             plan.from_hz = from_hz;
           })
        .excitation.time_s;
  };
  EXPECT_EQ(lasting(5.0), 10.0);
  EXPECT_EQ(lasting(0.5), 20.0);
}

TEST(MotionPlan, WhatHasNoSenseIsRefusedWithoutARobot) {
  EXPECT_THAT(refusal([](auto& plan) { plan.rate_per_s = 5.0; }),
              HasSubstr("a rate is for a ramp, not for a step"));
  EXPECT_THAT(refusal([](auto& plan) { plan.mode = ControlMode::kCurrent; }),
              HasSubstr("needs a limit of the speed"));
  EXPECT_THAT(refusal([](auto& plan) { plan.max_current_a = 0.0; }), HasSubstr("current has no limit"));
  EXPECT_THAT(refusal([](auto& plan) { plan.max_current_a = std::nan(""); }),
              HasSubstr("current has no limit"));
  EXPECT_THAT(refusal([](auto& plan) { plan.max_feedback_age_s = 0.0; }),
              HasSubstr("age of feedback has no limit"));
  EXPECT_THAT(refusal([](auto& plan) { plan.dead_man_ms = 19; }), HasSubstr("give 20 to 1000 ms"));
  EXPECT_THAT(refusal([](auto& plan) { plan.dead_man_ms = 1001; }), HasSubstr("give 20 to 1000 ms"));
  EXPECT_THAT(refusal([](auto& plan) {
                plan.kind = ExcitationKind::kSweep;
                plan.from_hz = 0.0;
              }),
              HasSubstr("give two frequencies"));
}

}  // namespace
}  // namespace rc10::client::test::motion_plan_test
