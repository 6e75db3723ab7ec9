#include "robot_client/session/held_targets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace held_targets_test {
namespace {

using namespace std::chrono_literals;
using namespace rc10::literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr MonotonicTime kStart{1000s};

/// Two active motors that obey "me", at a time.
RobotState heroState(MonotonicTime taken) {
  RobotState state;
  state.taken = taken;
  for (const auto* name : {"lift", "wheel"}) {
    MotorState motor;
    motor.name = name;
    motor.status = MotorStatus::kActive;
    motor.zeroed = true;
    motor.owner = "me";
    state.motors.push_back(motor);
  }
  return state;
}

MotorSetpoints turn(const std::string& motor, Rpm velocity) {
  return {{motor, Setpoint::velocity(velocity)}};
}

/// The lift stays held.
void expectOnlyTheWheelDropped(HeldTargets& held, const RobotState& state, const std::string& reason) {
  const auto dropped = held.judge(state, "me");
  ASSERT_EQ(dropped.size(), 1U);
  EXPECT_THAT(dropped[0].reason, HasSubstr(reason));
  EXPECT_THAT(held.motors(), ElementsAre("lift"));
}

TEST(HeldTargets, AreSentAgainOnAGrid) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  EXPECT_THAT(held.takeDue(kStart + 19ms), IsEmpty());
  EXPECT_EQ(held.nextDue(), kStart + 20ms);
  EXPECT_EQ(held.takeDue(kStart + 23ms).size(), 1U);
  EXPECT_EQ(held.nextDue(), kStart + 40ms);
}

TEST(HeldTargets, AreNotMadeUpForWhenLate) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  EXPECT_EQ(held.takeDue(kStart + 110ms).size(), 1U);
  EXPECT_THAT(held.takeDue(kStart + 110ms), IsEmpty());
}

TEST(HeldTargets, AfterAPauseAStateOfAfterItComesFirst) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  EXPECT_THAT(held.takeDue(kStart + 900ms), IsEmpty());
  EXPECT_THAT(held.judge(heroState(kStart + 880ms), "me"), IsEmpty());
  EXPECT_THAT(held.takeDue(kStart + 920ms), IsEmpty()) << "that state was taken in the pause";
  // It lapsed in the pause, and on_timeout acts since: nobody stopped the motor.
  auto state = heroState(kStart + 930ms);
  state.motors[1].owner = "";
  state.motors[1].stop_cause = StopCause::kTimeout;
  EXPECT_THAT(held.judge(state, "me"), IsEmpty());
  EXPECT_EQ(held.takeDue(kStart + 940ms).size(), 1U);
}

TEST(HeldTargets, OnesOfAProgramThatIsAlwaysLateAreSentAfterEachConfirmation) {
  HeldTargets held(20ms, 1000ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  EXPECT_THAT(held.takeDue(kStart + 150ms), IsEmpty());
  EXPECT_THAT(held.judge(heroState(kStart + 151ms), "me"), IsEmpty());
  EXPECT_EQ(held.takeDue(kStart + 300ms).size(), 1U);
}

TEST(HeldTargets, AMotorThatWasEnabledAnewInAPauseIsNotDriven) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set({{"lift", Setpoint::brake()}, {"wheel", Setpoint::velocity(60_rpm)}}, kStart);
  EXPECT_THAT(held.takeDue(kStart + 900ms), IsEmpty());
  auto state = heroState(kStart + 905ms);
  state.motors[1].owner = "";
  expectOnlyTheWheelDropped(held, state, "wheel was enabled anew while this program stood still");
}

TEST(HeldTargets, ThatTheProgramSendsItselfAreNotSentAgain) {
  HeldTargets held(0ms, 100ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  EXPECT_THAT(held.takeDue(kStart + 1h), IsEmpty());
  held.set(turn("wheel", 60_rpm), kStart);
  EXPECT_EQ(held.takeAll(kStart + 99ms).size(), 1U);
}

TEST(HeldTargets, WhatWasSetTogetherIsSentTogether) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set({{"lift", Setpoint::totalAngle(90_deg)}, {"wheel", Setpoint::velocity(60_rpm)}}, kStart);
  const auto due = held.takeDue(kStart + 20ms);
  ASSERT_EQ(due.size(), 1U);
  EXPECT_EQ(due[0].size(), 2U);
}

TEST(HeldTargets, ANewTargetTakesTheMotorOutOfItsOldMessage) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set({{"lift", Setpoint::totalAngle(90_deg)}, {"wheel", Setpoint::velocity(60_rpm)}}, kStart);
  held.set(turn("wheel", 30_rpm), kStart + 1ms);
  const auto due = held.takeDue(kStart + 30ms);
  ASSERT_EQ(due.size(), 2U);
  EXPECT_EQ(due[0].size(), 1U);
  EXPECT_EQ(due[0][0].motor, "lift");
  EXPECT_EQ(due[1][0].setpoint.value, 30.0);
}

TEST(HeldTargets, CoastEndsHolding) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  held.set({{"wheel", Setpoint::coast()}}, kStart + 1ms);
  EXPECT_FALSE(held.holds("wheel"));
  EXPECT_FALSE(held.nextDue());
}

TEST(HeldTargets, AMotorThatIsNotActiveIsDroppedAndStaysDropped) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  auto state = heroState(kStart + 200ms);
  state.motors[1].status = MotorStatus::kOffline;
  const auto dropped = held.judge(state, "me");
  ASSERT_EQ(dropped.size(), 1U);
  EXPECT_EQ(dropped[0].motor, "wheel");
  EXPECT_THAT(dropped[0].reason, HasSubstr("OFFLINE"));
  // Back, and enabled by somebody: it does not start to turn.
  EXPECT_THAT(held.judge(heroState(kStart + 300ms), "me"), IsEmpty());
  EXPECT_FALSE(held.holds("wheel"));
}

TEST(HeldTargets, AnEstopDropsAll) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set({{"lift", Setpoint::brake()}, {"wheel", Setpoint::velocity(60_rpm)}}, kStart);
  auto state = heroState(kStart + 200ms);
  state.status = RobotStatus::kEstop;
  EXPECT_EQ(held.judge(state, "me").size(), 2U);
}

TEST(HeldTargets, AMotorThatAnotherClientTookIsDroppedAndTheOthersStay) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set({{"lift", Setpoint::brake()}, {"wheel", Setpoint::velocity(60_rpm)}}, kStart);
  auto state = heroState(kStart + 200ms);
  state.motors[1].owner = "remote";
  expectOnlyTheWheelDropped(held, state, "held by the client 'remote'");
}

TEST(HeldTargets, AMotorThatWasJustTakenOverMayStillShowItsOldOwner) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  auto state = heroState(kStart + 20ms);
  state.motors[1].owner = "planner";
  EXPECT_THAT(held.judge(state, "me"), IsEmpty());
}

TEST(HeldTargets, OnesThatLapsedWhileTheProgramStoodAreNotTakenForTheEnd) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  EXPECT_EQ(held.takeAll(kStart + 99ms).size(), 1U);
  held.set(turn("wheel", 60_rpm), kStart);
  EXPECT_THAT(held.takeAll(kStart + 1s), IsEmpty());
  EXPECT_FALSE(held.holds("wheel"));
}

TEST(HeldTargets, LapseWithoutASignOfLife) {
  HeldTargets held(20ms, 100ms, 500ms);
  held.set(turn("wheel", 60_rpm), kStart);
  held.alive(kStart + 400ms);
  EXPECT_THAT(held.lapse(kStart + 899ms), IsEmpty());
  EXPECT_EQ(held.lapse(kStart + 900ms).size(), 1U);
  EXPECT_FALSE(held.holds("wheel"));
}

TEST(HeldTargets, DoNotLapseUnlessAskedTo) {
  HeldTargets held(20ms, 100ms, 0ms);
  held.set(turn("wheel", 60_rpm), kStart);
  EXPECT_THAT(held.lapse(kStart + 1h), IsEmpty());
}

TEST(HeldTargets, AMotorThatStoppedBetweenTwoStatesIsDropped) {
  const auto judged = [](const std::string& source, const std::string& text, std::int64_t mono_us) {
    HeldTargets held(20ms, 100ms, 0ms);
    held.set(turn("wheel", 60_rpm), kStart, 5'000);
    return held.judge(Event{.mono_us = mono_us, .code = 100, .source = source, .text = text});
  };
  const auto dropped = judged("wheel", "ACTIVE -> READY (disabled by 'panel')", 6'000);
  ASSERT_EQ(dropped.size(), 1U);
  EXPECT_THAT(dropped[0].reason, HasSubstr("disabled by 'panel'"));
  EXPECT_EQ(judged("wheel", "ENABLING -> FAULT", 6'000).size(), 1U);
  EXPECT_THAT(judged("wheel", "ENABLING -> ACTIVE", 6'000), IsEmpty());
  EXPECT_THAT(judged("lift", "ACTIVE -> READY", 6'000), IsEmpty());
  EXPECT_THAT(judged("wheel", "ACTIVE -> READY", 5'000), IsEmpty())
      << "the state that it was set by has that";
}

}  // namespace
}  // namespace held_targets_test
}  // namespace robot_client
}  // namespace rc10
