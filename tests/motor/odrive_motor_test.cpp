// Frames to and from an ODrive, one by one. Together with a drive: see
// tests/sim/odrive_closed_loop_test.cpp.
#include <array>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "motor/odrive_bench.hpp"

namespace rc10::test::odrive_motor_test {
namespace {

using namespace odrive_bench;

TEST_F(OdriveMotor, RestsBeforeAnythingIsHeard) {
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  const auto count = motor_->packRest(out);
  expectRest({out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)});
  expectRest(tick());
}

TEST_F(OdriveMotor, RestsAtItsDividerOnly) {
  auto settings = odriveSettings();
  settings.command_divider = 4;
  settings.command_phase = 1;
  make(settings);
  std::size_t frames = 0;
  for (int i = 0; i < 40; ++i) frames += tick().size();
  EXPECT_EQ(frames, 20U);
}

TEST_F(OdriveMotor, ListensOnlyToItsOwnMessages) {
  EXPECT_TRUE(motor_->matchesFrame(makeClassicFrame({0x061, false}, {})));
  EXPECT_FALSE(motor_->matchesFrame(makeClassicFrame({0x061, true}, {})));
  EXPECT_FALSE(motor_->matchesFrame(makeClassicFrame({0x081, false}, {})));
  EXPECT_FALSE(motor_->matchesFrame(makeClassicFrame({0x06D, false}, {})));  // a command of somebody else
  CanFrame fd = makeFdFrame({0x061, false}, std::array<std::uint8_t, 8>{}, false);
  EXPECT_FALSE(motor_->matchesFrame(fd));
}

TEST_F(OdriveMotor, Firmware05HasNeitherTorquesNorTemperatureAtThoseIds) {
  make(odriveSettings("ODrive_v3"));
  EXPECT_FALSE(motor_->matchesFrame(makeClassicFrame({0x075, false}, {})));
  EXPECT_FALSE(motor_->matchesFrame(makeClassicFrame({0x07C, false}, {})));
  EXPECT_TRUE(motor_->matchesFrame(makeClassicFrame({0x074, false}, {})));
}

TEST_F(OdriveMotor, FramesThatAreNotWhatTheyShouldBeAreMalformed) {
  const std::array<std::uint8_t, 7> short_payload{};
  EXPECT_EQ(feed(odrive::Message::kHeartbeat, short_payload), FrameVerdict::kMalformed);
  EXPECT_EQ(feed(odrive::Message::kEncoderEstimates, short_payload), FrameVerdict::kMalformed);
  EXPECT_EQ(feed(odrive::Message::kTorques, std::span<const std::uint8_t>{}), FrameVerdict::kMalformed);
  EXPECT_EQ(feed(odrive::Message::kEncoderEstimates, kNan, 0.0F), FrameVerdict::kMalformed);
  EXPECT_EQ(feed(odrive::Message::kEncoderEstimates, 0.0F, kInfinity), FrameVerdict::kMalformed);
  EXPECT_EQ(feed(odrive::Message::kTorques, 0.0F, kNan), FrameVerdict::kMalformed);
  EXPECT_EQ(feed(odrive::Message::kTemperature, kNan, kNan), FrameVerdict::kMalformed);
  CanFrame remote = makeClassicFrame({0x069, false}, std::array<std::uint8_t, 8>{});
  remote.type = FrameType::kRemote;
  EXPECT_EQ(motor_->updateFeedback(remote), FrameVerdict::kMalformed);
  EXPECT_EQ(motor_->feedback().samples, 0U);
}

TEST_F(OdriveMotor, HeartbeatAloneIsNoSample) {
  heartbeat(0, 1);
  EXPECT_EQ(motor_->feedback().samples, 0U);
}

TEST_F(OdriveMotor, ReadingsAreAtTheOutputShaft) {
  auto settings = odriveSettings();
  settings.gear_ratio = 10.0;
  settings.direction = -1;
  make(settings);
  sample(1.0F, 0.0F);
  const double before_deg = motor_->feedback().total_angle_deg;
  now_ += 1ms;
  sample(1.25F, 5.0F);
  EXPECT_NEAR(motor_->feedback().total_angle_deg - before_deg, -9.0, 1e-9);
  EXPECT_FLOAT_EQ(motor_->feedback().velocity_rpm, -30.0F);
  EXPECT_EQ(feed(odrive::Message::kTorques, 0.0F, 0.5F), FrameVerdict::kAccepted);
  EXPECT_FLOAT_EQ(motor_->feedback().torque_nm, -5.0F);
  EXPECT_FLOAT_EQ(motor_->feedback().current_a, -10.0F);
}

TEST_F(OdriveMotor, CurrentOfFirmware05CountsInTheDirectionOfItsCalibration) {
  auto settings = odriveSettings("ODrive_v3");
  make(settings);
  feed(odrive::Message::kIq, 0.0F, 4.0F);
  EXPECT_FLOAT_EQ(motor_->feedback().current_a, 4.0F);
  EXPECT_FLOAT_EQ(motor_->feedback().torque_nm, 0.2F);
  settings.own.set("iq_reversed", 1.0);
  make(settings);
  feed(odrive::Message::kIq, 0.0F, 4.0F);
  EXPECT_FLOAT_EQ(motor_->feedback().current_a, -4.0F);
}

TEST_F(OdriveMotor, TheHotterOfTwoSensorsIsTheTemperature) {
  feed(odrive::Message::kTemperature, 41.0F, kNan);
  EXPECT_FLOAT_EQ(motor_->feedback().temperature_c, 41.0F);
  feed(odrive::Message::kTemperature, 41.0F, 66.0F);
  EXPECT_FLOAT_EQ(motor_->feedback().temperature_c, 66.0F);
}

TEST_F(OdriveMotor, TelemetryThatStoppedIsNotReportedAnyMore) {
  sample();
  feed(odrive::Message::kTorques, 0.0F, 0.5F);
  feed(odrive::Message::kBusVoltage, 24.0F, 1.0F);
  feed(odrive::Message::kTemperature, 30.0F, 30.0F);
  now_ += 100ms;
  sample();
  EXPECT_FALSE(std::isnan(motor_->feedback().current_a));
  for (int i = 0; i < 30; ++i) {
    now_ += 100ms;
    sample();
  }
  EXPECT_TRUE(std::isnan(motor_->feedback().current_a));
  EXPECT_TRUE(std::isnan(motor_->feedback().torque_nm));
  EXPECT_TRUE(std::isnan(motor_->feedback().voltage_v));
  EXPECT_TRUE(std::isnan(motor_->feedback().temperature_c));
}

TEST_F(OdriveMotor, ADriveThatLeftClosedLoopIsNoticed) {
  enable();
  motor_->order(FrameKind::kIdle);
  tick();
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kNone);
  heartbeat(0, 1);
  tick();
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kDriveStopped);
  motor_->order(FrameKind::kRest);
  tick();
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kNone);
}

TEST_F(OdriveMotor, WhatTheDriveReportsComesBeforeItsStop) {
  enable();
  motor_->order(FrameKind::kCommand);
  heartbeat(0x0100'0000, 1);
  tick();
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kDriveCommunication);
  EXPECT_EQ(motor_->complaint().native_code, 0x0100'0000U);
}

TEST_F(OdriveMotor, EveryKnownErrorHasAFaultAndAnyOtherIsAFaultToo) {
  for (const auto* model : {"ODrive_S1", "ODrive_v3"}) {
    make(odriveSettings(model));
    const auto firmware = findOdriveModel(model)->firmware;
    ASSERT_GE(odriveFaults(firmware).size(), 10U);
    for (const auto& row : odriveFaults(firmware)) {
      heartbeat(row.native, 1);
      EXPECT_EQ(motor_->complaint().fault, row.fault) << row.words;
      EXPECT_EQ(motor_->complaint().native_code, row.native);
    }
    heartbeat(0x20'0000, 1);
    EXPECT_EQ(motor_->complaint().fault, FaultCode::kDriveOther);
    heartbeat(0, 1);
    EXPECT_EQ(motor_->complaint().fault, FaultCode::kNone);
  }
}

// ODrive.Error.REQUESTED_CURRENT_TOO_HIGH
TEST_F(OdriveMotor, MoreCurrentAskedForThanItsLimitIsAWrongSetting) {
  make(odriveSettings("ODrive_S1"));
  heartbeat(0x2'0000, 1);
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kDriveSetting);
  EXPECT_EQ(motor_->complaint().native_code, 0x2'0000U);
}

TEST_F(OdriveMotor, OneBitOfATableMeansOneThing) {
  for (const auto firmware : {OdriveFirmware::k05, OdriveFirmware::k06}) {
    std::set<std::uint32_t> bits;
    for (const auto& row : odriveFaults(firmware)) {
      EXPECT_TRUE(bits.insert(row.native).second) << row.words;
      EXPECT_EQ(row.native & (row.native - 1), 0U) << row.words;
    }
  }
}

TEST_F(OdriveMotor, ClearingSendsClearErrorsAndNothingThatMoves) {
  heartbeat(0x100, 1);
  EXPECT_FALSE(tick().empty());
  motor_->clearComplaint();
  const auto frames = tick();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(odrive::messageOf(frames[0].id), odrive::Message::kClearErrors);
  EXPECT_EQ(frames[0].length, 1);
  expectRest({frames.begin() + 1, frames.end()});
  tick();
  expectRest(tick());
}

TEST_F(OdriveMotor, AStartingDriveHasNoPositionAndLosesTheReference) {
  heartbeat(0, 1);
  sample();
  ASSERT_TRUE(motor_->setZero(0.0));
  ASSERT_TRUE(motor_->feedback().zeroed);
  now_ += 100ms;
  heartbeat(1, 0);
  EXPECT_FALSE(motor_->feedback().zeroed);
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kNone);
  const auto samples = motor_->feedback().samples;
  sample(7.0F);
  EXPECT_EQ(motor_->feedback().samples, samples);
  heartbeat(0, 1);
  sample(7.0F);
  EXPECT_EQ(motor_->feedback().samples, samples + 1);
  EXPECT_EQ(motor_->feedback().jumps, 0U);
  EXPECT_FALSE(motor_->feedback().zeroed);
}

TEST_F(OdriveMotor, ASilenceThatMayHideARestartLosesTheReference) {
  sample();
  motor_->setZero(0.0);
  now_ += 190ms;
  sample();
  EXPECT_TRUE(motor_->feedback().zeroed);
  now_ += 210ms;
  sample();
  EXPECT_FALSE(motor_->feedback().zeroed);
}

TEST_F(OdriveMotor, SlowFeedbackIsNoSilence) {
  auto settings = odriveSettings();
  settings.feedback_hz = 10;
  make(settings);
  sample();
  motor_->setZero(0.0);
  now_ += 300ms;
  sample();
  EXPECT_TRUE(motor_->feedback().zeroed);
}

TEST_F(OdriveMotor, APositionThatItCannotHaveReachedIsAJump) {
  sample(0.0F, 10.0F);
  motor_->setZero(0.0);
  now_ += 1ms;
  sample(0.01F, 10.0F);
  EXPECT_EQ(motor_->feedback().jumps, 0U);
  EXPECT_TRUE(motor_->feedback().zeroed);
  now_ += 1ms;
  sample(3.0F, 10.0F);
  EXPECT_EQ(motor_->feedback().jumps, 1U);
  EXPECT_FALSE(motor_->feedback().zeroed);
}

}  // namespace
}  // namespace rc10::test::odrive_motor_test
