#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "motor/robstride_bench.hpp"

namespace rc10::test::robstride_motor_test {
namespace {

using namespace robstride_bench;

// --- Rest, poll, rhythm

TEST(RobStrideMotor, RestIsAStopFromTheFirstTickOnAndNeedsNoFeedback) {
  RobStride_Motor motor(robStrideSettings("RS03", 5));
  std::array<CanFrame, 4> out{};
  out[0].data.fill(0xFF);
  ASSERT_EQ(motor.packRest(out), 2U);
  EXPECT_EQ(out[0].id.value, 0x0400FD05U);
  EXPECT_EQ(out[0].length, 8);
  for (const auto byte : out[0].payload()) EXPECT_EQ(byte, 0);
  EXPECT_EQ(out[1].id, motor.commandIds().front());  // whose echo is watched
  EXPECT_EQ(motor.packRest(std::span{out}.first(1)), 1U);
}

TEST(RobStrideMotor, TheWatchedIdIsSentInEveryState) {
  for (const auto kind : {FrameKind::kPoll, FrameKind::kIdle, FrameKind::kCommand, FrameKind::kRest}) {
    Bench bench(robStrideSettings("RS00"));
    bench.run();
    int watched = 0;
    for (int i = 0; i < 200; ++i) {
      for (const auto& frame : bench.tick(kind)) {
        if (frame.id == bench.motor.commandIds().front()) ++watched;
      }
    }
    EXPECT_EQ(watched, 5);
  }
}

TEST(RobStrideMotor, PollingStopsAndNowAndThenReadsTheSupplyVoltage) {
  Bench bench(robStrideSettings("RS00"));
  int stops = 0;
  int reads = 0;
  for (int i = 0; i < 100; ++i) {
    for (const auto& frame : bench.tick(FrameKind::kPoll)) {
      if (typeOf(frame) == 4) ++stops;
      if (typeOf(frame) == 17) ++reads;
    }
  }
  EXPECT_EQ(stops, 100);
  EXPECT_EQ(reads, 3);
}

TEST(RobStrideMotor, TheDividerThinsOutWhatIsSent) {
  auto settings = robStrideSettings("RS00");
  settings.command_divider = 4;
  settings.command_phase = 3;
  Bench bench(settings);
  for (int i = 1; i <= 40; ++i) {
    const bool begins = i == 1;  // another order does not wait for its turn
    EXPECT_EQ(bench.tick(FrameKind::kPoll).empty(), i % 4 != 3 && !begins) << i;
  }
  EXPECT_FALSE(bench.tick(FrameKind::kRest).empty()) << "in tick 41";
}

// docs/safety.md: an e-stop begins its fallback in the next tick; a ramp is a command, as the target before
// it.
TEST(RobStrideMotor, ARampDoesNotWaitForItsTurn) {
  auto settings = robStrideSettings("RS00");
  settings.command_divider = 10;
  Bench bench(settings);
  bench.run();
  const Target fast{.mode = ControlMode::kVelocity, .value = 60.0};
  ASSERT_TRUE(bench.motor.setTarget(fast));
  for (int i = 0; i < 25; ++i) bench.tick(FrameKind::kCommand, fast);
  bench.motor.clearTarget();
  const Target slower{.mode = ControlMode::kVelocity, .value = 59.0};
  EXPECT_FALSE(bench.tick(FrameKind::kCommand, slower).empty()) << "in tick 26";
  EXPECT_TRUE(bench.tick(FrameKind::kCommand, slower).empty());
  ASSERT_TRUE(bench.motor.setTarget(fast));
  EXPECT_FALSE(bench.tick(FrameKind::kCommand, fast).empty()) << "nor does the target after it";
}

// A velocity of 0 with the limit of before is a brake.
TEST(RobStrideMotor, ACurrentLimitThatChangesIsSentInThreeTurns) {
  for (const auto* control : {"velocity", "position"}) {
    SCOPED_TRACE(control);
    Bench bench(controlled(control));
    bench.run();
    const auto mode =
        std::string_view{control} == "velocity" ? ControlMode::kVelocity : ControlMode::kTotalAngle;
    const auto limitsIn = [&](FrameKind kind) {
      int limits = 0;
      for (const auto& frame : bench.tick(kind, {.mode = mode, .value = 1.0})) {
        const auto index = readLittleEndian<std::uint16_t>(frame.payload(), 0);
        if (typeOf(frame) == 18 && index == robstride::parameter::kCurrentLimit) ++limits;
      }
      return limits;
    };
    for (int i = 0; i < 10; ++i) limitsIn(FrameKind::kCommand);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(limitsIn(FrameKind::kIdle), 1) << i;
    EXPECT_EQ(limitsIn(FrameKind::kIdle), 0);
  }
}

// --- Feedback

TEST(RobStrideMotor, TurnsAreCountedAcrossTheEndOfTheScale) {
  Bench bench(robStrideSettings("RS00"));
  const double range = 4 * std::numbers::pi;
  for (double position_rad = 0.0; position_rad < 60.0; position_rad += 0.1) {
    bench.tick(FrameKind::kPoll);
    const double shown = std::remainder(position_rad, 2 * range);
    bench.run(shown);
    EXPECT_NEAR(bench.motor.feedback().total_angle_deg, position_rad * kDegPerRad, 0.05);
  }
  EXPECT_TRUE(bench.motor.feedback().zeroed);
  EXPECT_EQ(bench.motor.feedback().jumps, 0U);
}

TEST(RobStrideMotor, BeyondTheScaleOperationModeOnlyDamps) {
  Bench bench(robStrideSettings("RS00"));
  bench.run(12.5);
  bench.runAfter(milliseconds{2}, -12.5);  // two turns and a little more
  const auto told = bench.operation({.mode = ControlMode::kTotalAngle, .value = 0.0});
  EXPECT_EQ(told.stiffness_nm_per_rad, 0.0);
  EXPECT_GT(told.damping_nms_per_rad, 0.0);
  EXPECT_NE(bench.motor.limits() & kLimitAngle, 0U);
}

TEST(RobStrideMotor, AtTheEndOfAScaleThatDoesNotWrapAnAbsoluteAngleIsLostOnce) {
  auto settings = robStrideSettings("RS00");
  settings.own.set("position_range_rad", 12.5);
  Bench bench(settings);
  bench.codec.position_range_rad = 12.5;
  bench.run(12.4);
  ASSERT_TRUE(bench.motor.feedback().zeroed);
  const auto before = bench.motor.feedback().losses;
  for (int i = 0; i < 20; ++i) {
    bench.runAfter(milliseconds{1}, 13.0);
    EXPECT_FALSE(bench.motor.feedback().zeroed);
  }
  bench.runAfter(milliseconds{1}, 12.4);
  EXPECT_TRUE(bench.motor.feedback().zeroed);
  EXPECT_GE(bench.motor.feedback().losses, before + 1);
}

TEST(RobStrideMotor, TheEndOfAScaleThatDoesNotWrapLosesTheReference) {
  Bench bench(robStrideSettings("CyberGear"));
  bench.run(12.4);
  ASSERT_TRUE(bench.motor.setZero(0.0));
  bench.runAfter(milliseconds{2}, 13.0);
  EXPECT_FALSE(bench.motor.feedback().zeroed);
  EXPECT_TRUE(bench.motor.feedback().angle_at_end);
  EXPECT_FALSE(bench.motor.setZero(0.0)) << "the next sample would lose it";
  EXPECT_FALSE(bench.motor.feedback().zeroed);
  bench.runAfter(milliseconds{2}, 12.4);
  EXPECT_FALSE(bench.motor.feedback().angle_at_end);
  EXPECT_TRUE(bench.motor.setZero(0.0));
}

TEST(RobStrideMotor, AtTheEndOfItsScaleAPlaceIsNotToldAndBackWithinItIs) {
  Bench place(controlled("position", "CyberGear"));
  Bench spring(controlled("operation", "CyberGear"));
  const auto current_limit = [&place](FrameKind kind) {
    const auto frames = place.tick(kind);
    for (const auto& frame : frames) {
      if (readLittleEndian<std::uint16_t>(frame.payload(), 0) == robstride::parameter::kCurrentLimit)
        return readLittleEndian<float>(frame.payload(), 4);
    }
    return -1.0F;
  };
  for (auto* bench : {&place, &spring}) bench->run(12.4);
  EXPECT_GT(current_limit(FrameKind::kBrake), 0.0F);
  for (auto* bench : {&place, &spring}) bench->runAfter(milliseconds{2}, 13.0);
  EXPECT_EQ(current_limit(FrameKind::kBrake), 0.0F);
  EXPECT_EQ(spring.operation({.mode = ControlMode::kTotalAngle, .value = 0.0}).stiffness_nm_per_rad, 0.0);
  for (auto* bench : {&place, &spring}) bench->runAfter(milliseconds{2}, 12.3);
  EXPECT_GT(current_limit(FrameKind::kBrake), 0.0F);
  EXPECT_GT(spring.operation({.mode = ControlMode::kTotalAngle, .value = 0.0}).stiffness_nm_per_rad, 0.0);
  const double moved_deg = -0.1 * 180.0 / std::numbers::pi;
  EXPECT_NEAR(place.motor.feedback().total_angle_deg, moved_deg, 0.1) << "what was cut off is made up for";
}

TEST(RobStrideMotor, AnAbsoluteAngleInDoubtIsNoReferenceWhileItObeysButBoundsIt) {
  auto settings = controlled("operation");
  Bench bench(settings);
  bench.run(1.0);
  bench.tick(FrameKind::kIdle);
  bench.runAfter(milliseconds{300}, 1.0);
  bench.run(1.0);
  EXPECT_FALSE(bench.motor.feedback().zeroed) << "its targets would only be damped";
  EXPECT_TRUE(bench.motor.feedback().bounds_only) << "soft limits hold";
  EXPECT_EQ(bench.motor.feedback().losses, 1U);
  EXPECT_TRUE(bench.motor.feedback().zero_refused);
  EXPECT_FALSE(bench.motor.setZero(0.0)) << "the next sample would take it back";
  bench.tick(FrameKind::kPoll);
  bench.run(1.0);
  EXPECT_TRUE(bench.motor.feedback().zeroed);
  EXPECT_FALSE(bench.motor.feedback().bounds_only);
  EXPECT_FALSE(bench.motor.feedback().zero_refused);
  EXPECT_TRUE(bench.motor.setZero(0.0));
}

TEST(RobStrideMotor, ALongSilenceLosesTheReferenceOfACyberGear) {
  Bench bench(robStrideSettings("CyberGear"));
  bench.run(0.3);
  ASSERT_TRUE(bench.motor.setZero(0.0));
  bench.runAfter(milliseconds{150}, 0.3);
  EXPECT_TRUE(bench.motor.feedback().zeroed);
  bench.runAfter(milliseconds{250}, 0.3);
  EXPECT_FALSE(bench.motor.feedback().zeroed);
}

TEST(RobStrideMotor, AnAngleInDoubtThatNoEncoderTellsTakesNoZeroEither) {
  Bench bench(robStrideSettings("CyberGear"));
  bench.run(0.3);
  bench.tick(FrameKind::kIdle);
  bench.runAfter(milliseconds{250}, 0.3);
  EXPECT_TRUE(bench.motor.feedback().zero_refused);
  EXPECT_FALSE(bench.motor.feedback().bounds_only) << "it has no angle that could bound it";
  EXPECT_FALSE(bench.motor.setZero(0.0));
}

TEST(RobStrideMotor, AJumpIsCountedAndAnglesAreNotFollowedUntilEnabledAnew) {
  Bench bench(robStrideSettings("RS00"));
  bench.run(0.0);
  bench.runAfter(milliseconds{1}, 2.0);
  EXPECT_EQ(bench.motor.feedback().jumps, 1U);
  EXPECT_EQ(bench.operation({.mode = ControlMode::kTotalAngle, .value = 0.0}).stiffness_nm_per_rad, 0.0);
  bench.tick(FrameKind::kEnable);
  EXPECT_GT(bench.operation({.mode = ControlMode::kTotalAngle, .value = 0.0}).stiffness_nm_per_rad, 0.0);
}

TEST(RobStrideMotor, GearAndDirectionApplyToAllReadings) {
  auto settings = robStrideSettings("RS02");
  settings.gear_ratio = 7.75 * 3;
  settings.direction = -1;
  Bench bench(settings);
  bench.say({.position_rad = 0.0, .velocity_rad_s = 3.0, .torque_nm = 1.5, .mode = robstride::kRunning});
  const double before_deg = bench.motor.feedback().total_angle_deg;
  EXPECT_NEAR(bench.motor.feedback().velocity_rpm, -kRpmPerRadPerS, 0.01);
  EXPECT_NEAR(bench.motor.feedback().torque_nm, -4.5, 2e-3);
  EXPECT_NEAR(bench.motor.feedback().current_a, -1.5 / (1.22 / std::numbers::sqrt2), 1e-3);
  bench.runAfter(milliseconds{20}, 0.3);
  EXPECT_NEAR(bench.motor.feedback().total_angle_deg - before_deg, -0.1 * kDegPerRad, 0.02);
  EXPECT_FALSE(bench.motor.feedback().zeroed);  // behind a gear of its own the encoder is not absolute
}

TEST(RobStrideMotor, TheSupplyVoltageIsRead) {
  Bench bench(robStrideSettings("RS00"));
  EXPECT_EQ(bench.parameter(robstride::parameter::kSupplyVoltage, std::bit_cast<std::uint32_t>(47.5F), false),
            FrameVerdict::kAccepted);
  EXPECT_TRUE(std::isnan(bench.motor.feedback().voltage_v));
  bench.parameter(robstride::parameter::kSupplyVoltage, std::bit_cast<std::uint32_t>(47.5F));
  EXPECT_FLOAT_EQ(bench.motor.feedback().voltage_v, 47.5F);
  for (const float odd : {-1.0F, 1e9F, std::numeric_limits<float>::quiet_NaN()}) {
    bench.parameter(robstride::parameter::kSupplyVoltage, std::bit_cast<std::uint32_t>(odd));
    EXPECT_FLOAT_EQ(bench.motor.feedback().voltage_v, 47.5F);
  }
}

TEST(RobStrideMotor, ReportsOfType24AreFeedbackToo) {
  Bench bench(robStrideSettings("RS00"));
  auto frame = bench.codec.answer({.position_rad = 1.0, .mode = robstride::kRunning});
  frame.id.value = (frame.id.value & 0x00FFFFFFU) | 24U << 24U;
  ASSERT_TRUE(bench.motor.matchesFrame(frame));
  EXPECT_EQ(bench.motor.updateFeedback(frame), FrameVerdict::kAccepted);
  EXPECT_NEAR(bench.motor.feedback().total_angle_deg, kDegPerRad, 0.05);
}

TEST(RobStrideMotor, FramesOfOthersAndOddFramesAreNotTaken) {
  Bench bench(robStrideSettings("RS00"));
  const auto good = bench.codec.answer({.mode = robstride::kRunning});
  ASSERT_TRUE(bench.motor.matchesFrame(good));
  auto other = good;
  other.id.value = 0x0280'10FD;  // another drive
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.id.value = 0x0280'7FFE;  // for another host
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.id.extended = false;
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.fd = true;
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.id.value = 0x0300'FD7F;  // a host's command
  EXPECT_FALSE(bench.motor.matchesFrame(other));
  other = good;
  other.length = 7;
  EXPECT_EQ(bench.motor.updateFeedback(other), FrameVerdict::kMalformed);
  other = good;
  other.type = FrameType::kRemote;
  EXPECT_EQ(bench.motor.updateFeedback(other), FrameVerdict::kMalformed);
  EXPECT_EQ(bench.motor.feedback().samples, 0U);
}

TEST(RobStrideMotor, GarbageLeavesFiniteReadings) {
  Bench bench(robStrideSettings("RS06"));
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    CanFrame frame = bench.codec.answer({});
    frame.id.value = (frame.id.value & 0x0000FFFFU) | static_cast<std::uint32_t>(random()) << 16U;
    frame.id.value &= kExtendedIdMask;
    for (std::size_t b = 0; b < 8; ++b) frame.data[b] = static_cast<std::uint8_t>(random());
    frame.received = bench.now += std::chrono::microseconds{random() % 2000};
    if (!bench.motor.matchesFrame(frame)) continue;
    (void)bench.motor.updateFeedback(frame);
    if (bench.motor.feedback().samples == 0) continue;
    ASSERT_TRUE(std::isfinite(bench.motor.feedback().total_angle_deg));
    ASSERT_TRUE(std::isfinite(bench.motor.feedback().current_a));
    ASSERT_LT(bench.motor.feedback().angle_deg, 360.0F);
  }
}

// --- Faults

TEST(RobStrideMotor, EveryFaultBitHasItsCode) {
  using enum FaultCode;
  const auto code = [](std::uint32_t native) { return robstride::faultOf(native, false); };
  EXPECT_EQ(code(0), kNone);
  EXPECT_EQ(code(1U << 0U), kDriveMotorTooHot);
  EXPECT_EQ(code(1U << 1U), kDriveHardware);
  EXPECT_EQ(code(1U << 2U), kDriveUnderVoltage);
  EXPECT_EQ(code(1U << 3U), kDriveOverVoltage);
  for (const unsigned phase : {4U, 5U, 16U}) EXPECT_EQ(code(1U << phase), kDriveOverCurrent);
  EXPECT_EQ(code(1U << 7U), kDriveCalibration);
  EXPECT_EQ(code(1U << 8U), kDriveHardware);
  EXPECT_EQ(code(1U << 9U), kDriveEncoder);
  EXPECT_EQ(code(1U << 14U), kDriveOverload);
  EXPECT_EQ(code(1U << 20U), kDriveOther);
  EXPECT_EQ(code(1U << 24U), kDriveUnderVoltage);
  EXPECT_EQ(code(1U << 25U), kDriveOverCurrent);
  EXPECT_EQ(code(1U << 26U), kDriveMotorTooHot);
  EXPECT_EQ(code(1U << 27U), kDriveEncoder);
  EXPECT_EQ(code(1U << 28U), kDriveOverload);
  EXPECT_EQ(code(1U << 29U), kDriveCalibration);
  EXPECT_EQ(robstride::faultOf(1U << 28U, true), kDrivePhase);
  EXPECT_EQ(robstride::faultOf(1U << 9U, true), kDriveOverload);
}

TEST(RobStrideMotor, AFaultFrameIsAComplaintUntilItIsClearedWhicheverWayRoundItsIdsAre) {
  for (const std::uint32_t id : {0x15007FFDU, 0x1500FD7FU}) {
    Bench bench(robStrideSettings("CyberGear"));
    bench.say({.mode = 0});
    const CanFrame fault = makeClassicFrame({id, true}, std::array<std::uint8_t, 8>{0x08});
    ASSERT_TRUE(bench.motor.matchesFrame(fault));
    ASSERT_EQ(bench.motor.updateFeedback(fault), FrameVerdict::kAccepted);
    EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kDriveOverVoltage);
    EXPECT_EQ(bench.motor.complaint().native_code, 8U);
    bench.say({.mode = 0});
    bench.tick(FrameKind::kPoll);
    EXPECT_NE(bench.motor.complaint().fault, FaultCode::kNone);
    bench.motor.clearComplaint();
    const auto frames = bench.tick(FrameKind::kPoll);
    EXPECT_EQ(typeOf(frames[0]), 4U);
    EXPECT_EQ(frames[0].data[0], 1);
    EXPECT_EQ(bench.tick(FrameKind::kPoll)[0].data[0], 0);  // once
    bench.say({.mode = 0});
    EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kNone);
  }
}

TEST(RobStrideMotor, ADriveThatLeavesItsRunModeComplainsAndItsAnglesAreInDoubt) {
  Bench bench(robStrideSettings("CyberGear"));
  bench.run();
  bench.motor.setZero(0.0);
  bench.tick(FrameKind::kIdle);
  bench.run();
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kNone);
  bench.say({.mode = 0});
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(bench.motor.feedback().zeroed);
  bench.tick(FrameKind::kPoll);  // told to stop: nothing wrong with being stopped
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kNone);
}

}  // namespace
}  // namespace rc10::test::robstride_motor_test
