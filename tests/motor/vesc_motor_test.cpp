#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "motor/vesc_bench.hpp"
#include "support/alloc_guard.hpp"

namespace rc10::test::vesc_motor_test {
namespace {

using namespace vesc_bench;

TEST_F(VescMotorTest, AtFirstAndAtRestItSendsNoCurrent) {
  auto& motor = makeWith();
  EXPECT_EQ(sent(), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  std::array<CanFrame, 1> rest{};
  ASSERT_EQ(motor.packRest(rest), 1U);
  EXPECT_EQ(rest[0].id, (CanId{0x107, true}));
  EXPECT_EQ(rest[0].length, 4);
  EXPECT_EQ(rest[0].data, CanFrame{}.data);
}

TEST_F(VescMotorTest, EveryKindThatIsNoCommandSendsNoCurrent) {
  auto& motor = makeWith();
  ASSERT_TRUE(motor.setTarget({.mode = ControlMode::kCurrent, .value = 5.0}));
  for (const auto kind :
       {FrameKind::kRest, FrameKind::kPoll, FrameKind::kIdle, FrameKind::kEnable, FrameKind::kDisable}) {
    motor.order(kind);
    EXPECT_EQ(sent(), 0);
    EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  }
}

TEST_F(VescMotorTest, CurrentsGoThereAndBackOverTheWholeRange) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> amperes(-60.0, 60.0);
  makeWith();
  for (int i = 0; i < 1000; ++i) {
    const double a = amperes(random);
    EXPECT_NEAR(sent({.mode = ControlMode::kCurrent, .value = a}) / 1e3, a, 5.1e-4);
    EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  }
  makeWith({{"relative_current", 1.0}});
  for (int i = 0; i < 1000; ++i) {
    const double a = amperes(random);
    EXPECT_NEAR(sent({.mode = ControlMode::kCurrent, .value = a}) / 1e5 * 60.0, a, 1e-3);
    EXPECT_EQ(packet_, vesc::Packet::kSetCurrentRelative);
  }
}

TEST_F(VescMotorTest, VelocitiesGoThereAndBackBehindAGearAndADirection) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> rpm(-5000.0, 5000.0);
  auto settings = vescSettings({{"ask_status", 0.0}});
  settings.gear_ratio = 4.0;
  settings.direction = -1;
  auto& motor = make(settings);
  for (int i = 0; i < 1000; ++i) {
    const double wanted = rpm(random);
    const auto erpm = sent({.mode = ControlMode::kVelocity, .value = wanted});
    EXPECT_EQ(packet_, vesc::Packet::kSetErpm);
    EXPECT_EQ(erpm, std::lround(-wanted * 4.0 * 7.0));
    status(erpm);
    EXPECT_NEAR(static_cast<double>(motor.feedback().velocity_rpm), wanted, 0.02);
  }
}

TEST_F(VescMotorTest, WhatIsTooMuchIsBoundedAndTold) {
  auto settings = vescSettings({{"ask_status", 0.0}});
  settings.effort_limit = 20.0F;
  settings.velocity_limit_rpm = 1000.0F;
  auto& motor = make(settings);
  EXPECT_EQ(sent({.mode = ControlMode::kCurrent, .value = 1e300}), 20'000);
  EXPECT_EQ(motor.limits(), kLimitCurrent);
  EXPECT_EQ(sent({.mode = ControlMode::kVelocity, .value = -1e300}), -7000);
  EXPECT_EQ(motor.limits(), kLimitVelocity);
  EXPECT_EQ(sent({.mode = ControlMode::kDuty, .value = 7.0}), 100'000);
  motor.derate(0.5F);
  EXPECT_EQ(sent({.mode = ControlMode::kCurrent, .value = -50.0}), -10'000);
  EXPECT_EQ(sent({.mode = ControlMode::kCurrent, .value = 5.0}), 5000);
  EXPECT_EQ(motor.limits(), 0U);
}

TEST_F(VescMotorTest, AMotorThatMayHaveNoCurrentIsReleasedInEveryMode) {
  auto& motor = makeWith();
  motor.derate(0.0F);
  for (const auto mode :
       {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kDuty, ControlMode::kBrake}) {
    EXPECT_EQ(sent({.mode = mode, .value = 1.0}), 0);
    EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  }
}

TEST_F(VescMotorTest, AVelocityWithoutALimitSaturates) {
  makeWith();
  EXPECT_EQ(sent({.mode = ControlMode::kVelocity, .value = 1e300}), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(sent({.mode = ControlMode::kVelocity, .value = -1e300}),
            -std::numeric_limits<std::int32_t>::max());
}

TEST_F(VescMotorTest, NumbersThatAreNoneReleaseTheMotor) {
  for (const char* angle : {"tachometer", "encoder", "none"}) {
    makeWith({{"angle", std::string{angle}}});
    status(0);
    steps(0);
    encoder(10.0);
    for (const auto mode : {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kAngle,
                            ControlMode::kTotalAngle, ControlMode::kDuty}) {
      for (const double value : {kInfinity, -kInfinity, std::nan("")}) {
        EXPECT_EQ(sent({.mode = mode, .value = value}), 0) << angle;
        EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
      }
    }
  }
}

TEST_F(VescMotorTest, WhatAVelocityOfZeroMeansIsConfigured) {
  const Target zero{.mode = ControlMode::kVelocity, .value = 0.0};
  makeWith();
  EXPECT_EQ(sent(zero), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetErpm);
  makeWith({{"velocity_zero", std::string{"coast"}}});
  EXPECT_EQ(sent(zero), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  EXPECT_EQ(sent({.mode = ControlMode::kVelocity, .value = 0.0, .velocity_ff_rpm = 100.0F}), 0)
      << "a field that the mode does not use";
  makeWith({{"velocity_zero", std::string{"brake"}}, {"brake_current_a", 3.0}});
  EXPECT_EQ(sent(zero), 3000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
}

TEST_F(VescMotorTest, ABrakeWorksWithoutFeedbackAndWithinTheLimit) {
  auto settings = vescSettings({{"ask_status", 0.0}});
  settings.effort_limit = 4.0F;
  auto& motor = make(settings);
  motor.order(FrameKind::kBrake);
  EXPECT_EQ(sent(), 4000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
  EXPECT_EQ(motor.limits(), 0U);  // a brake at its limit at standstill is no stalled motor
  EXPECT_EQ(motor.commandUnit(), CommandUnit::kNative);
}

TEST_F(VescMotorTest, TheHandbrakeHoldsOnlyAtStandstill) {
  auto& motor = makeWith({{"angle", kNone}, {"handbrake_current_a", 6.0}});
  EXPECT_EQ(motor.driveFrames().hold, Provision::kFrame);
  motor.order(FrameKind::kHold);
  status(3000);
  EXPECT_EQ(sent(), 10'000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
  status(100);
  EXPECT_EQ(sent(), 6000);
  EXPECT_EQ(packet_, vesc::Packet::kSetHandbrake);
  status(300);  // it trembles
  EXPECT_EQ(sent(), 6000);
  EXPECT_EQ(packet_, vesc::Packet::kSetHandbrake);
  status(1000);  // it is dragged along
  EXPECT_EQ(sent(), 10'000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
  status(0);
  tick(milliseconds{500});  // anything may have happened
  EXPECT_EQ(sent(), 10'000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
}

TEST_F(VescMotorTest, DampBrakesInProportionToTheSpeedAndNeedsAKv) {
  EXPECT_EQ(makeWith().driveFrames().damp, Provision::kUnsupported);
  auto& motor = makeWith({{"kv_rpm_per_v", 100.0}});
  EXPECT_EQ(motor.driveFrames().damp, Provision::kHostLoop);
  motor.order(FrameKind::kDamp);
  EXPECT_EQ(sent(), 0);  // no feedback yet
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  status(-8400);  // 1200 of 2400 rpm
  steps(0);
  EXPECT_EQ(sent(), 30'000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
}

TEST_F(VescMotorTest, TheSignOfTheCurrentIsThatOfTheTorque) {
  auto settings = vescSettings({{"ask_status", 0.0}, {"kv_rpm_per_v", 82.7}});
  auto& motor = make(settings);
  status(5000, 8.0, 0.4);  // drives forwards
  EXPECT_FLOAT_EQ(motor.feedback().current_a, 8.0F);
  EXPECT_NEAR(motor.feedback().torque_nm, 0.8F, 0.001F);
  status(5000, -8.0, 0.3);  // brakes while it turns forwards
  EXPECT_FLOAT_EQ(motor.feedback().current_a, -8.0F);
  status(-5000, 8.0, -0.4);  // drives backwards
  EXPECT_FLOAT_EQ(motor.feedback().current_a, -8.0F);
  status(-12345, -15.7, -0.432);  // brakes while it turns backwards
  EXPECT_FLOAT_EQ(motor.feedback().current_a, 15.7F);
  status(-70, 3.0, 0.0);  // a duty too small to be told
  EXPECT_FLOAT_EQ(motor.feedback().current_a, -3.0F);
  settings.direction = -1;
  auto& reversed = make(settings);
  status(5000, 8.0, 0.4);
  EXPECT_FLOAT_EQ(reversed.feedback().current_a, -8.0F);
  EXPECT_LT(reversed.feedback().velocity_rpm, 0.0F);
}

TEST_F(VescMotorTest, OnlyAnAngleLoopOnTheHostTakesOtherGains) {
  EXPECT_EQ(makeWith({{"angle", kEncoder}}).hostLoops(), nullptr);
  auto& motor = makeWith();
  ASSERT_NE(motor.hostLoops(), nullptr);
  auto loops = *motor.hostLoops();
  loops.angle.kp *= 2.0F;
  motor.retune(loops);
  EXPECT_EQ(motor.hostLoops()->angle.kp, loops.angle.kp);
  status(0);
  steps(0);
  EXPECT_EQ(sent({.mode = ControlMode::kTotalAngle, .value = 40.0}), 840);  // 3 rpm per degree
}

TEST_F(VescMotorTest, TheAngleLoopGivesSpeedsAndStopsWithoutFeedback) {
  auto& motor = makeWith();
  status(0);
  steps(0);
  EXPECT_EQ(sent({.mode = ControlMode::kTotalAngle, .value = 40.0}), 420);  // 1.5 rpm per degree
  status(0);
  steps(0);
  tick();
  status(0);
  steps(0);
  // sqrt(2 * 0.5 * 25000 / 7 * 6 * 1e5) deg/s, from where the drive's ramp can still stop it
  EXPECT_NEAR(sent({.mode = ControlMode::kTotalAngle, .value = 1e5}), 54'006, 10);
  EXPECT_EQ(packet_, vesc::Packet::kSetErpm);
  motor.order(FrameKind::kHold);
  EXPECT_EQ(sent(), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetErpm);
  tick(milliseconds{200});
  EXPECT_EQ(sent({.mode = ControlMode::kTotalAngle, .value = 40.0}), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
}

TEST_F(VescMotorTest, FramesOfOthersAndBrokenOnesAreRefused) {
  auto& motor = make(vescSettings());
  auto good = vescFrame(0x907, "FFFFCFC7FF63FE50");
  EXPECT_TRUE(motor.matchesFrame(good));
  auto other = good;
  other.id.value = 0x908;
  EXPECT_FALSE(motor.matchesFrame(other));
  other = good;
  other.id.extended = false;
  EXPECT_FALSE(motor.matchesFrame(other));
  other = good;
  other.fd = true;
  EXPECT_FALSE(motor.matchesFrame(other));
  other = good;
  other.type = FrameType::kRemote;
  EXPECT_FALSE(motor.matchesFrame(other));
  good.length = 7;
  EXPECT_EQ(motor.updateFeedback(good), FrameVerdict::kMalformed);
  EXPECT_EQ(give(vescFrame(0x8FD, "08013200008000FF")), FrameVerdict::kMalformed);  // another drive's answer
  EXPECT_EQ(give(vescFrame(0x8FD, "0701320000800000")), FrameVerdict::kAccepted);
  EXPECT_EQ(give(vescFrame(0x8FD, "0701330000800000")), FrameVerdict::kMalformed);
  EXPECT_EQ(give(vescFrame(0x8FD, "07013200")), FrameVerdict::kMalformed);
  EXPECT_EQ(motor.feedback().samples, 0U);
}

TEST_F(VescMotorTest, FaultsAreToldWithTheirNativeCode) {
  auto& motor = make(vescSettings());
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320000800006")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kDriveMotorTooHot);
  EXPECT_EQ(motor.complaint().native_code, 6U);
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320000800000")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kNone);
  EXPECT_EQ(vescFault(2), FaultCode::kDriveUnderVoltage);
  EXPECT_EQ(vescFault(31), FaultCode::kDriveLimit);
  EXPECT_EQ(vescFault(34), FaultCode::kDriveOther);
}

TEST_F(VescMotorTest, TheKillSwitchAndADeafDriveAreComplaints) {
  auto& motor = make(vescSettings());
  motor.order(FrameKind::kCommand);
  tick();
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320020000002")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kDriveStopped);
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320020000001")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kNone);  // it may not have heard us yet
  tick(milliseconds{400});
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320020000001")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kDriveCommunication);
}

TEST_F(VescMotorTest, EnablingADriveThatDoesNotAnswerFails) {
  auto& motor = make(vescSettings());
  motor.order(FrameKind::kEnable);
  for (int i = 0; i < 499 && motor.sequenceProgress() != SequenceProgress::kFailed; ++i) tick();
  EXPECT_EQ(motor.sequenceProgress(), SequenceProgress::kFailed);
  motor.order(FrameKind::kRest);
  tick();
  motor.order(FrameKind::kEnable);
  tick();
  EXPECT_EQ(motor.sequenceProgress(), SequenceProgress::kPending);  // anew
}

TEST_F(VescMotorTest, ItIsNotEnabledWhileAFallbackCommandsADriveWhoseWatchdogIsNotProven) {
  for (const bool asks : {true, false}) {
    auto& motor = asks ? make(vescSettings()) : makeWith();
    for (const auto kind : {FrameKind::kHold, FrameKind::kDamp, FrameKind::kBrake}) {
      motor.order(kind);
      tick();
      EXPECT_EQ(motor.sequenceProgress(), asks ? SequenceProgress::kFailed : SequenceProgress::kDone);
    }
  }
}

TEST_F(VescMotorTest, TicksAndFramesAllocateNothing) {
  auto& motor = make(vescSettings());
  motor.order(FrameKind::kCommand, {.mode = ControlMode::kTotalAngle, .value = 100.0});
  auto frame = vescFrame(0x1B07, "00");
  frame.length = 8;
  const AllocGuard guard;
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  for (int i = 0; i < 1000; ++i) {
    tick_.now += milliseconds{1};
    ++tick_.index;
    frame.received = tick_.now;
    (void)motor.updateFeedback(frame);
    motor.update(tick_);
    (void)motor.packCommand(tick_, out);
  }
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST_F(VescMotorTest, CommandsKeepTheirRhythm) {
  auto settings = vescSettings({{"ask_status", 0.0}});
  settings.command_divider = 10;
  settings.command_phase = 3;
  make(settings);
  int count = 0;
  for (int i = 0; i < 100; ++i) {
    const auto frames = tick();
    count += static_cast<int>(frames.size());
    EXPECT_EQ(frames.empty(), tick_.index % 10 != 3);
  }
  EXPECT_EQ(count, 10);
}

}  // namespace
}  // namespace rc10::test::vesc_motor_test
