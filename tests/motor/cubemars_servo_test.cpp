#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "motor/cubemars_bench.hpp"

namespace rc10::test::cubemars_servo_test {
namespace {

using namespace cubemars_bench;

// --- servo: what is told -------------------------------------------------------------------------------

TEST(CubemarsServo, RestIsACurrentOfNothingEvenBeforeAnyFeedback) {
  Servo bench(servo());
  std::array<CanFrame, 4> out{};
  ASSERT_EQ(bench.motor().packRest(out), 1U);
  EXPECT_TRUE(isCurrentZero(out[0]));
  for (const auto kind : {FrameKind::kRest, FrameKind::kPoll, FrameKind::kIdle, FrameKind::kEnable}) {
    const auto frames = bench.tick(kind);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_TRUE(isCurrentZero(frames[0]));
  }
}

TEST(CubemarsServo, CurrentIsBoundedByTheDeratedLimit) {
  auto settings = servo();
  settings.effort_limit = 10.0F;
  Servo bench(settings);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kCurrent, .value = 4.0})), 4000);
  EXPECT_EQ(bench.motor().limits(), 0U);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kCurrent, .value = -12.0})), -10000);
  EXPECT_EQ(bench.motor().limits(), kLimitCurrent);
  bench.motor().derate(0.5F);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kCurrent, .value = 12.0})), 5000);
}

TEST(CubemarsServo, TorqueFeedForwardBecomesCurrent) {
  Servo bench(servo());
  const auto frame = bench.command({.mode = ControlMode::kCurrent, .value = 1.0, .torque_ff_nm = 0.819F});
  EXPECT_NEAR(int32Of(frame), 2000, 1);
}

TEST(CubemarsServo, DirectionTurnsEveryCommandAndEveryReading) {
  auto settings = servo();
  settings.direction = -1;
  Servo bench(settings);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kCurrent, .value = 2.0})), -2000);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kVelocity, .value = 10.0})), -1890);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kDuty, .value = 0.5})), -50000);
  ASSERT_EQ(bench.feedServo(0.0), FrameVerdict::kAccepted);
  ASSERT_EQ(bench.feedServo(1.0, 1890.0, 3.0), FrameVerdict::kAccepted);
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, -1.0, 1e-9);
  EXPECT_NEAR(bench.motor().feedback().velocity_rpm, -10.0, 1e-4);
  EXPECT_NEAR(bench.motor().feedback().current_a, -3.0, 1e-6);
  EXPECT_LT(bench.motor().feedback().torque_nm, 0.0F);
}

TEST(CubemarsServo, VelocityIsBounded) {
  auto settings = servo();
  settings.velocity_limit_rpm = 100.0F;
  Servo bench(settings);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kVelocity, .value = 1e300})), 18900);
  EXPECT_EQ(bench.motor().limits(), kLimitVelocity);
  Servo unbounded(servo());
  EXPECT_EQ(int32Of(unbounded.command({.mode = ControlMode::kVelocity, .value = -1e300})), -100000);
}

TEST(CubemarsServo, AnglesAreThoseOfTheReference) {
  Servo bench(servo());
  (void)bench.feedServo(50.0);
  ASSERT_TRUE(bench.motor().setZero(0.0));
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kTotalAngle, .value = 10.0})), 600000);
  // The shortest way to 350 degrees is 10 degrees back.
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kAngle, .value = 350.0})), 400000);
}

TEST(CubemarsServo, AnglesThatTheFeedbackCannotShowAreNotSent) {
  Servo bench(servo());
  (void)bench.feedServo(0.0);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kTotalAngle, .value = 5000.0})), 32000000);
  EXPECT_EQ(bench.motor().limits(), kLimitAngle);
}

TEST(CubemarsServo, AtTheEndOfThePositionFieldTheReferenceIsLostAndAnAngleBrakes) {
  auto settings = servo();
  settings.zero_at_power_on = true;
  Servo bench(settings);
  (void)bench.feedServo(3199.0);
  EXPECT_TRUE(bench.motor().feedback().zeroed);
  (void)bench.feedServo(3200.0);
  EXPECT_FALSE(bench.motor().feedback().zeroed);
  EXPECT_FALSE(bench.motor().setZero(0.0));
  const auto frame = bench.command({.mode = ControlMode::kTotalAngle, .value = 0.0});
  EXPECT_EQ(frame.id, (CanId{0x205, true}));
  EXPECT_EQ(bench.motor().limits(), kLimitAngle);
  EXPECT_EQ(bench.tick(FrameKind::kHold).front().id, (CanId{0x205, true}));
}

TEST(CubemarsServo, BeyondThePositionFieldOneWithoutABrakeDampsWhatItHolds) {
  Servo bench(servo({{"brake_current_a", 0.0}}));
  (void)bench.feedServo(3199.0);
  (void)bench.feedServo(3200.0);
  const auto frame = bench.tick(FrameKind::kHold).front();
  EXPECT_EQ(frame.id, (CanId{0x005, true}));
  EXPECT_EQ(int32Of(frame), 0);
}

TEST(CubemarsServo, AGearBehindTheDriveIsInEveryNumber) {
  auto settings = servo();
  settings.gear_ratio = 18.0;
  Servo bench(settings);
  (void)bench.feedServo(0.0);
  (void)bench.feedServo(20.0, 1890.0, 1.0);
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, 10.0, 1e-9);
  EXPECT_NEAR(bench.motor().feedback().velocity_rpm, 5.0, 1e-4);
  EXPECT_NEAR(bench.motor().feedback().torque_nm, 18 * 0.091, 1e-4);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kVelocity, .value = 5.0})), 1890);
}

TEST(CubemarsServo, ThePositionBasisScalesBothWays) {
  struct Row {
    const char* basis;
    double factor;
  };
  for (const Row& row : {Row{"output", 1.0}, Row{"rotor", 9.0}, Row{"electrical", 189.0}}) {
    SCOPED_TRACE(row.basis);
    Servo bench(servo({{"position_basis", std::string{row.basis}}}));
    (void)bench.feedServo(0.0);
    (void)bench.feedServo(row.factor);
    EXPECT_NEAR(bench.motor().feedback().total_angle_deg, 1.0, 1e-9);
    const auto frame = bench.command({.mode = ControlMode::kTotalAngle, .value = 2.0});
    EXPECT_NEAR(int32Of(frame), 2e4 * row.factor, 1);
  }
}

TEST(CubemarsServo, BrakeDampAndHoldAreFramesOfTheDrive) {
  Servo bench(servo({{"brake_current_a", 7.0}}));
  (void)bench.feedServo(12.5);
  auto frame = bench.tick(FrameKind::kBrake).front();
  EXPECT_EQ(frame.id, (CanId{0x205, true}));
  EXPECT_EQ(int32Of(frame), 7000);
  frame = bench.command({.mode = ControlMode::kBrake});
  EXPECT_EQ(frame.id, (CanId{0x205, true}));
  frame = bench.tick(FrameKind::kDamp).front();
  EXPECT_EQ(frame.id, (CanId{0x005, true}));
  EXPECT_EQ(int32Of(frame), 0);
  frame = bench.tick(FrameKind::kHold).front();
  EXPECT_EQ(frame.id, (CanId{0x405, true}));
  EXPECT_EQ(int32Of(frame), 125000);
  (void)bench.feedServo(13.0);
  EXPECT_EQ(int32Of(bench.tick(FrameKind::kHold).front()), 125000) << "it stays where the hold began";
}

TEST(CubemarsServo, AHoldWithoutFeedbackLetsGo) {
  Servo bench(servo());
  EXPECT_TRUE(isCurrentZero(bench.tick(FrameKind::kHold).front()));
}

TEST(CubemarsServo, WhenNothingIsLeftOfTheLimitEveryModeLetsGo) {
  Servo bench(servo());
  (void)bench.feedServo(0.0);
  bench.motor().derate(0.0F);
  for (const auto mode : {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kTotalAngle,
                          ControlMode::kDuty, ControlMode::kBrake}) {
    EXPECT_TRUE(isCurrentZero(bench.command({.mode = mode, .value = 0.5})));
    EXPECT_EQ(bench.motor().limits(), kLimitCurrent);
  }
  EXPECT_TRUE(isCurrentZero(bench.tick(FrameKind::kDamp).front()));
}

TEST(CubemarsServo, NumbersThatAreNoneLetGo) {
  Servo bench(servo());
  (void)bench.feedServo(0.0);
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (const auto mode : {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kAngle,
                            ControlMode::kTotalAngle, ControlMode::kDuty}) {
      EXPECT_TRUE(isCurrentZero(bench.command({.mode = mode, .value = value})));
    }
  }
  const auto frame = bench.command({.mode = ControlMode::kCurrent, .value = 1.0, .torque_ff_nm = INFINITY});
  EXPECT_EQ(int32Of(frame), 1000);
}

TEST(CubemarsServo, TellsSomethingInItsOwnTicksOnly) {
  auto settings = servo();
  settings.command_divider = 4;
  settings.command_phase = 1;
  Servo bench(settings);
  bench.motor().order(FrameKind::kIdle);
  std::vector<std::size_t> counts;
  for (int i = 0; i < 8; ++i) counts.push_back(bench.tick().size());
  EXPECT_EQ(counts, (std::vector<std::size_t>{1, 0, 0, 0, 1, 0, 0, 0}));
}

// --- feedback ------------------------------------------------------------------------------------------

TEST(CubemarsServo, ReadsTheWholeRangeAsItWasSent) {
  std::mt19937 random(20'260'101);
  std::uniform_real_distribution<double> degrees(-3199.0, 3199.0);
  std::uniform_real_distribution<double> erpm(-100'000.0, 100'000.0);
  std::uniform_real_distribution<double> amperes(-60.0, 60.0);
  std::uniform_int_distribution<int> celsius(-20, 127);
  for (int i = 0; i < 2000; ++i) {
    Servo bench(servo());
    const double deg = degrees(random);
    const double speed = erpm(random);
    const double current = amperes(random);
    const int temperature = celsius(random);
    (void)bench.feedServo(0.0);
    (void)bench.feedServo(deg, speed, current, temperature, 0, std::chrono::seconds{1});
    const auto& feedback = bench.motor().feedback();
    ASSERT_NEAR(feedback.total_angle_deg, deg, 0.051);
    ASSERT_NEAR(feedback.velocity_rpm, speed / 189.0, 0.03);
    ASSERT_NEAR(feedback.current_a, current, 0.0051);
    ASSERT_EQ(feedback.temperature_c, static_cast<float>(temperature));
  }
}

TEST(CubemarsServo, TakesOnlyWholeFramesOfItsOwnId) {
  Servo bench(servo());
  const CanFrame good = bench.servoFrame(1.0, 0.0, 0.0, 20, 0);
  auto other = good;
  other.id.value = 0x2906;
  EXPECT_FALSE(bench.motor().matchesFrame(other));
  other = good;
  other.id = {0x105, false};
  EXPECT_FALSE(bench.motor().matchesFrame(other));
  other = good;
  other.sent_here = true;  // as on a virtual bus
  EXPECT_TRUE(bench.motor().matchesFrame(other));
  for (int change = 0; change < 3; ++change) {
    auto wrong = good;
    if (change == 0) wrong.length = 7;
    if (change == 1) wrong.type = FrameType::kRemote;
    if (change == 2) wrong.fd = true;
    ASSERT_TRUE(bench.motor().matchesFrame(wrong));
    EXPECT_EQ(bench.motor().updateFeedback(wrong), FrameVerdict::kMalformed);
  }
  EXPECT_EQ(bench.motor().feedback().samples, 0U);
  EXPECT_EQ(bench.motor().updateFeedback(good), FrameVerdict::kAccepted);
}

TEST(CubemarsServo, ADriveWithAnOutputEncoderKnowsItsAngle) {
  auto settings = servo({{"output_encoder", 1.0}});
  settings.zero_deg = 30.0;
  Servo bench(settings);
  (void)bench.feedServo(50.0);
  EXPECT_TRUE(bench.motor().feedback().zeroed);
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, 20.0, 1e-9);
  Servo plain(servo());
  (void)plain.feedServo(50.0);
  EXPECT_FALSE(plain.motor().feedback().zeroed);
}

TEST(CubemarsServo, AModelWithUnsignedCurrentReportsNone) {
  const auto settings = cubemarsSettings("AK10-9-V3", 5);
  Servo bench(settings);
  (void)bench.feedServo(0.0, 100.0, 3.0);
  EXPECT_TRUE(std::isnan(bench.motor().feedback().current_a));
  EXPECT_TRUE(std::isnan(bench.motor().feedback().torque_nm));
  EXPECT_EQ(cubemarsTraits(setupOf(settings)).frozen_a, 0.0F);
}

TEST(CubemarsServo, EveryErrorOfTheDriveIsAComplaint) {
  Servo bench(servo());
  ASSERT_GE(cubemarsFaults().size(), 5U);
  for (const auto& fault : cubemarsFaults()) {
    (void)bench.feedServo(0.0, 0.0, 0.0, 30, static_cast<std::uint8_t>(fault.native));
    EXPECT_EQ(bench.motor().complaint().fault, fault.fault) << fault.words;
    EXPECT_EQ(bench.motor().complaint().native_code, fault.native);
  }
  (void)bench.feedServo(0.0, 0.0, 0.0, 30, 99);
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kDriveOther);
  (void)bench.feedServo(0.0);
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kNone);
}

TEST(CubemarsServo, ASilenceLongEnoughToStartUpInIsARestart) {
  auto settings = servo();
  settings.zero_at_power_on = true;
  Servo bench(settings);
  (void)bench.feedServo(0.0);
  (void)bench.tick(FrameKind::kIdle);
  (void)bench.feedServo(0.0, 0, 0, 30, 0, milliseconds{90});
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kNone);
  EXPECT_TRUE(bench.motor().feedback().zeroed);
  (void)bench.feedServo(0.0, 0, 0, 30, 0, milliseconds{110});
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(bench.motor().feedback().zeroed);
  bench.motor().clearComplaint();
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kNone);
}

TEST(CubemarsServo, ASilenceWhileItRestsIsNoComplaint) {
  Servo bench(servo());
  (void)bench.feedServo(0.0);
  (void)bench.tick(FrameKind::kRest);
  (void)bench.feedServo(0.0, 0, 0, 30, 0, std::chrono::seconds{1});
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kNone);
}

TEST(CubemarsServo, APositionThatItCannotHaveReachedIsAJump) {
  auto settings = servo();
  settings.zero_at_power_on = true;
  Servo bench(settings);
  (void)bench.feedServo(0.0);
  (void)bench.feedServo(4.0);
  EXPECT_EQ(bench.motor().feedback().jumps, 0U);
  (void)bench.feedServo(60.0);
  EXPECT_EQ(bench.motor().feedback().jumps, 1U);
  EXPECT_FALSE(bench.motor().feedback().zeroed);
}

}  // namespace
}  // namespace rc10::test::cubemars_servo_test
