#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "rc10/setpoint.hpp"
#include "robot_client/host_clock.hpp"
#include "robot_client/just_enabled.hpp"
#include "robot_client/motor_reasons.hpp"
#include "robot_client/obstacle.hpp"

namespace rc10 {
inline namespace robot_client {
namespace words_test {
namespace {

using namespace std::chrono_literals;
using namespace rc10::literals;
using testing::HasSubstr;
using testing::IsEmpty;

bool known(std::string_view name) { return name == "left" || name == "right" || name == "arm"; }

TEST(MotorReasons, EachMotorGetsItsOwn) {
  const auto reasons = motorReasons(
      "enable: 0 of 3 motors (left, right: offline: no feedback from the drive; check power, wiring and id; "
      "arm: "
      "in FAULT: clear it first)",
      known);
  ASSERT_EQ(reasons.size(), 3U);
  EXPECT_EQ(reasons[0].motor, "left");
  EXPECT_EQ(reasons[0].reason, "offline: no feedback from the drive; check power, wiring and id");
  EXPECT_EQ(reasons[1].motor, "right");
  EXPECT_EQ(reasons[1].reason, reasons[0].reason);
  EXPECT_EQ(reasons[2].motor, "arm");
  EXPECT_EQ(reasons[2].reason, "in FAULT: clear it first");
}

TEST(MotorReasons, NoneInOtherMessages) {
  EXPECT_THAT(motorReasons("enable: 3 of 3 motors", known), IsEmpty());
  EXPECT_THAT(motorReasons("zero needs a motor: name it", known), IsEmpty());
  EXPECT_THAT(motorReasons(") odd (", known), IsEmpty());
  EXPECT_THAT(motorReasons("", known), IsEmpty());
}

TEST(Setpoint, WhatNoMotorCanBeGivenIsRefused) {
  EXPECT_TRUE(Setpoint::velocity(120_rpm).check());
  EXPECT_TRUE(Setpoint::impedance(10_deg, 2.0, 0.1).check());
  EXPECT_FALSE(Setpoint::velocity(Rpm{kUnknown}).check());
  EXPECT_FALSE(Setpoint::duty(1.01).check());
  EXPECT_FALSE(Setpoint::impedance(10_deg, -1.0, 0.1).check());
  EXPECT_FALSE(Setpoint::impedance(10_deg, 1.0, kUnknown).check());
  EXPECT_FALSE(Setpoint::angle(10_deg, {.torque_nm = 1e39}).check());
}

TEST(Obstacle, SaysWhatToDo) {
  RobotState state;
  EXPECT_EQ(*obstacle(state, "lift", Mode::kVelocity), "there is no motor 'lift'; the motors are: none");
  state.motors.emplace_back();
  state.motors[0].name = "lift";
  state.motors[0].status = MotorStatus::kReady;
  EXPECT_EQ(*obstacle(state, "lift", Mode::kVelocity), "lift is READY: enable it first");
  state.motors[0].status = MotorStatus::kActive;
  EXPECT_FALSE(obstacle(state, "lift", Mode::kVelocity));
  EXPECT_THAT(*obstacle(state, "lift", Mode::kTotalAngle), HasSubstr("zero: power_on"));
  state.status = RobotStatus::kEstop;
  EXPECT_THAT(*obstacle(state, "lift", Mode::kVelocity), HasSubstr("ESTOP: clear it"));
}

TEST(JustEnabled, AStateThatMayBeOlderThanTheAnswerRefusesNothing) {
  auto state = std::make_shared<RobotState>();
  state->motors.resize(2);
  state->motors[0].name = "lift";
  state->motors[1].name = "wheel";
  JustEnabled enabled;
  enabled.answered({"lift"}, 7);
  for (const std::uint64_t older : {7U, 8U}) {
    const auto corrected = enabled.corrected(state, older);
    EXPECT_FALSE(obstacle(*corrected, "lift", Mode::kTotalAngle)) << "zeroed before, too";
    EXPECT_TRUE(obstacle(*corrected, "wheel", Mode::kVelocity));
  }
  EXPECT_EQ(enabled.corrected(state, 9), state) << "news";
  enabled.release("lift");
  EXPECT_EQ(enabled.corrected(state, 8), state);
}

TEST(HostClock, TheQuickestMessageGivesTheDistanceOfTheClocks) {
  HostClock clock;
  const MonotonicTime local{1000s};
  EXPECT_EQ(clock.observe(50s, local), local);
  // This one came 3 ms sooner after it was stamped, the next one 20 ms later.
  EXPECT_EQ(clock.observe(50s + 10ms, local + 7ms), local + 7ms);
  EXPECT_NEAR(std::chrono::duration<double>(clock.observe(50s + 20ms, local + 37ms) - (local + 17ms)).count(),
              0.0, 10e-6);
}

TEST(HostClock, BeginsAnewWhenTheHostHasStartedAgain) {
  HostClock clock;
  const MonotonicTime local{1000s};
  (void)clock.observe(5000s, local);
  EXPECT_EQ(clock.observe(1s, local + 60s), local + 60s);
}

}  // namespace
}  // namespace words_test
}  // namespace robot_client
}  // namespace rc10
