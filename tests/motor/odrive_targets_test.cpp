#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motor/odrive_bench.hpp"

namespace rc10::test::odrive_targets_test {
namespace {

using namespace odrive_bench;

TEST_F(OdriveMotor, ANewModeIsToldThreeTimesBetweenItsInputs) {
  enable();
  motor_->order(FrameKind::kCommand);
  motor_->setTarget({.mode = ControlMode::kVelocity, .value = 60.0});
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(messages(tick()),
                testing::ElementsAre(odrive::Message::kSetInputVel, odrive::Message::kSetControllerMode,
                                     odrive::Message::kSetInputVel));
  }
  EXPECT_THAT(messages(tick()), testing::ElementsAre(odrive::Message::kSetInputVel));
}

TEST_F(OdriveMotor, AModeIsToldAgainThoughItsFirstFramesWereLost) {
  enable();
  motor_->order(FrameKind::kCommand);
  motor_->setTarget({.mode = ControlMode::kCurrent, .value = 0.0});
  for (int i = 0; i < 3; ++i) (void)tick();  // lost
  int told = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto sent = messages(tick());
    if (std::count(sent.begin(), sent.end(), odrive::Message::kSetControllerMode) == 0) continue;
    ++told;
    EXPECT_THAT(sent,
                testing::ElementsAre(odrive::Message::kSetInputTorque, odrive::Message::kSetControllerMode,
                                     odrive::Message::kSetInputTorque));
  }
  EXPECT_EQ(told, 2);
}

TEST_F(OdriveMotor, IdleIsZeroTorqueInTorqueControl) {
  enable();
  motor_->order(FrameKind::kIdle);
  const auto frames = tick();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(odrive::messageOf(frames[0].id), odrive::Message::kSetInputTorque);
  EXPECT_EQ(numberAt(frames[0], 0), 0.0F);
  EXPECT_EQ(frames[1].data[0], 1);
}

TEST_F(OdriveMotor, CurrentBecomesTorqueOfTheDrivesShaft) {
  auto settings = odriveSettings();
  settings.gear_ratio = 5.0;
  settings.direction = -1;
  make(settings);
  enable();
  const auto frame = settledInput({.mode = ControlMode::kCurrent, .value = 8.0, .torque_ff_nm = 0.5F});
  EXPECT_EQ(odrive::messageOf(frame.id), odrive::Message::kSetInputTorque);
  // 8 A * 0.05 N·m/A, and 0.5 N·m behind a gear of 5.
  EXPECT_FLOAT_EQ(numberAt(frame, 0), -0.5F);
  EXPECT_FLOAT_EQ(motor_->commandValue(), 10.0F);
  EXPECT_EQ(motor_->commandUnit(), CommandUnit::kAmpere);
}

TEST_F(OdriveMotor, VelocityAndPositionAreOfTheDrivesShaft) {
  auto settings = odriveSettings();
  settings.gear_ratio = 5.0;
  settings.velocity_limit_rpm = 100.0F;
  make(settings);
  enable();
  auto frame = settledInput({.mode = ControlMode::kVelocity, .value = 60.0, .torque_ff_nm = 0.5F});
  EXPECT_FLOAT_EQ(numberAt(frame, 0), 5.0F);
  EXPECT_FLOAT_EQ(numberAt(frame, 4), 0.1F);
  frame = settledInput(
      {.mode = ControlMode::kTotalAngle, .value = 720.0, .velocity_ff_rpm = 12.0F, .torque_ff_nm = -0.5F});
  EXPECT_EQ(odrive::messageOf(frame.id), odrive::Message::kSetInputPos);
  EXPECT_FLOAT_EQ(numberAt(frame, 0), 10.0F);
  EXPECT_EQ(readLittleEndian<std::int16_t>(frame.payload(), 4), 1000);
  EXPECT_EQ(readLittleEndian<std::int16_t>(frame.payload(), 6), -100);
}

TEST_F(OdriveMotor, FromBeyondWhatCanBeToldNoPlaceIsFollowed) {
  enable();
  sample(120'000.0F);
  const double here_deg = motor_->feedback().total_angle_deg;
  for (const double target_deg : {here_deg, here_deg + 90.0, 0.0}) {
    const auto frame = settledInput({.mode = ControlMode::kTotalAngle, .value = target_deg});
    EXPECT_EQ(odrive::messageOf(frame.id), odrive::Message::kSetInputVel) << target_deg;
    EXPECT_EQ(numberAt(frame, 0), 0.0F);
    EXPECT_NE(motor_->limits() & kLimitAngle, 0U);
  }
  motor_->order(FrameKind::kHold);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(odrive::messageOf(tick().back().id), odrive::Message::kSetInputVel);
}

TEST_F(OdriveMotor, AnAngleIsReachedTheShortestWayRound) {
  enable();
  now_ += 1ms;
  sample(0.9F);
  ASSERT_TRUE(motor_->setZero(350.0));
  const auto frame = settledInput({.mode = ControlMode::kAngle, .value = 10.0});
  EXPECT_NEAR(static_cast<double>(numberAt(frame, 0)), 0.9 + 20.0 / 360.0, 1e-5);
}

TEST_F(OdriveMotor, BrakeIsSpeedZeroAndHoldIsThePresentAngle) {
  enable();
  now_ += 1ms;
  sample(0.25F, 3.0F);
  motor_->order(FrameKind::kBrake);
  auto frames = tick();
  EXPECT_EQ(odrive::messageOf(frames.front().id), odrive::Message::kSetInputVel);
  EXPECT_EQ(numberAt(frames.front(), 0), 0.0F);
  motor_->order(FrameKind::kHold);
  frames = tick();
  EXPECT_EQ(odrive::messageOf(frames.front().id), odrive::Message::kSetInputPos);
  EXPECT_FLOAT_EQ(numberAt(frames.front(), 0), 0.25F);
}

TEST_F(OdriveMotor, ItsOwnLoopsAreAtTheLimitByTheTorqueThatItReports) {
  enable();  // 1 Nm is its limit
  for (const Target target : {Target{.mode = ControlMode::kVelocity, .value = 10.0},
                              {.mode = ControlMode::kTotalAngle},
                              {.mode = ControlMode::kBrake}}) {
    for (const auto& [reported_nm, limits] :
         {std::pair{0.94F, 0U}, std::pair{0.96F, std::uint32_t{kLimitCurrent}},
          std::pair{-1.1F, std::uint32_t{kLimitCurrent}}, std::pair{0.0F, 0U}}) {
      feed(odrive::Message::kTorques, 0.0F, reported_nm);
      settledInput(target);
      EXPECT_EQ(motor_->limits(), limits) << toString(target.mode) << ", " << reported_nm;
    }
  }
  feed(odrive::Message::kTorques, 0.0F, 1.0F);
  now_ += 3s;
  sample();
  settledInput({.mode = ControlMode::kVelocity, .value = 10.0});
  EXPECT_EQ(motor_->limits(), 0U) << "telemetry ended";
}

TEST_F(OdriveMotor, LimitsClampWhatIsSentAndSaySo) {
  enable();
  auto frame = settledInput({.mode = ControlMode::kCurrent, .value = -500.0});
  EXPECT_FLOAT_EQ(numberAt(frame, 0), -1.0F);
  EXPECT_EQ(motor_->limits(), kLimitCurrent);
  frame = settledInput({.mode = ControlMode::kVelocity, .value = 1e12, .torque_ff_nm = 50.0F});
  EXPECT_FLOAT_EQ(numberAt(frame, 0), 25.0F);
  EXPECT_FLOAT_EQ(numberAt(frame, 4), 1.0F);
  EXPECT_EQ(motor_->limits(), kLimitVelocity | kLimitCurrent);
  frame = settledInput({.mode = ControlMode::kTotalAngle, .value = -1e300});
  EXPECT_FLOAT_EQ(numberAt(frame, 0), -100'000.0F);
  EXPECT_EQ(motor_->limits(), kLimitAngle);
  EXPECT_TRUE(std::isfinite(motor_->commandValue()));
  settledInput({.mode = ControlMode::kVelocity, .value = 10.0});
  EXPECT_EQ(motor_->limits(), 0U);
}

TEST_F(OdriveMotor, AnAngleBeyondItsFarthestIsToldAsTheFarthestAlsoBeforeFeedback) {
  constexpr float kFarthestDeg = 100'000.0F * 360.0F;
  motor_->order(FrameKind::kCommand, {.mode = ControlMode::kTotalAngle, .value = 1e131});
  tick();
  EXPECT_FLOAT_EQ(motor_->commandValue(), kFarthestDeg);
  sample(12.5F);  // its zero from now on
  tick();
  EXPECT_FLOAT_EQ(motor_->commandValue(), kFarthestDeg - 12.5F * 360.0F);
}

TEST_F(OdriveMotor, FeedForwardsOfAPositionSaturate) {
  const auto frame = odrive::setInputPos(3, 0.0F, 1e9F, -kInfinity);
  EXPECT_EQ(readLittleEndian<std::int16_t>(frame.payload(), 4), 32767);
  EXPECT_EQ(readLittleEndian<std::int16_t>(frame.payload(), 6), -32767);
  EXPECT_EQ(readLittleEndian<std::int16_t>(odrive::setInputPos(3, 0.0F, kNan, 0.0F).payload(), 4), 0);
}

TEST_F(OdriveMotor, DeratingReachesTheDrivesOwnCurrentLimit) {
  enable();
  settledInput({.mode = ControlMode::kVelocity, .value = 10.0});
  motor_->derate(0.25F);
  float told_a = 0.0F;
  int told = 0;
  for (int i = 0; i < 100; ++i) {
    for (const auto& frame : tick()) {
      if (odrive::messageOf(frame.id) != odrive::Message::kSetLimits) continue;
      told_a = numberAt(frame, 4);
      ++told;
    }
  }
  EXPECT_FLOAT_EQ(told_a, 5.0F);
  EXPECT_EQ(told, 1);
}

TEST_F(OdriveMotor, LimitsAreRepeatedSoThatALostFrameDoesNotMatterForLong) {
  enable();
  settledInput({.mode = ControlMode::kVelocity, .value = 10.0});
  int told = 0;
  for (int i = 0; i < 2000; ++i) {
    for (const auto& frame : tick())
      told += odrive::messageOf(frame.id) == odrive::Message::kSetLimits ? 1 : 0;
  }
  EXPECT_GE(told, 3);
  EXPECT_LE(told, 5);
}

TEST_F(OdriveMotor, FramesThatWaitedAndComeAtOnceAreNoJump) {
  auto settings = odriveSettings();
  settings.feedback_hz = 100;
  make(settings);
  sample(0.0F, 80.0F);
  motor_->setZero(0.0);
  for (int i = 1; i <= 50; ++i) {
    if (i % 5 == 0) now_ += 50ms;
    sample(0.8F * static_cast<float>(i), 80.0F);
  }
  EXPECT_EQ(motor_->feedback().jumps, 0U);
  EXPECT_TRUE(motor_->feedback().zeroed);
}

TEST_F(OdriveMotor, TargetsComeBackFromTheirFramesOverTheWholeRange) {
  std::mt19937 random(20261121);
  std::uniform_real_distribution<double> gear(0.2, 50.0);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (int i = 0; i < 500; ++i) {
    auto settings = odriveSettings(i % 2 == 0 ? "ODrive_S1" : "ODrive_v3", i % 63);
    settings.gear_ratio = gear(random);
    settings.direction = i % 3 == 0 ? -1 : 1;
    make(settings);
    const double drive_per_output = settings.gear_ratio * settings.direction;
    enable();
    const double rpm = 1500.0 * share(random);
    auto frame = settledInput({.mode = ControlMode::kVelocity, .value = rpm});
    EXPECT_NEAR(static_cast<double>(numberAt(frame, 0)) * 60.0 / drive_per_output, rpm, 1e-3);
    const double amperes = 20.0 * share(random);
    frame = settledInput({.mode = ControlMode::kCurrent, .value = amperes});
    EXPECT_NEAR(static_cast<double>(numberAt(frame, 0)) / 0.05 * settings.direction, amperes, 1e-4);
    // A position that is sent and then reported is the target again.
    const double deg = 3600.0 * share(random);
    frame = settledInput({.mode = ControlMode::kTotalAngle, .value = deg});
    const float turns = numberAt(frame, 0);
    const float turns_per_s = static_cast<float>(share(random) * 20.0);
    now_ += 1ms;
    sample(turns, turns_per_s);
    EXPECT_NEAR(motor_->feedback().total_angle_deg, deg, 0.05);
    EXPECT_NEAR(static_cast<double>(motor_->feedback().velocity_rpm),
                static_cast<double>(turns_per_s) * 60.0 / drive_per_output, 1e-2);
  }
}

}  // namespace
}  // namespace rc10::test::odrive_targets_test
