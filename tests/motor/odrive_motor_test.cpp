// Frames to and from an ODrive, one by one. Together with a drive: see
// tests/sim/odrive_closed_loop_test.cpp.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/byte_order.hpp"
#include "drives/odrive/odrive_family.hpp"
#include "support/odrive_settings.hpp"

namespace rc10::test::odrive_motor_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class OdriveMotor : public testing::Test {
 protected:
  void make(const MotorSettings& settings) {
    node_ = settings.id;
    motor_ = odriveMotor(settings);
  }
  void SetUp() override { make(odriveSettings()); }

  FrameVerdict feed(odrive::Message message, float first, float second) {
    std::array<std::uint8_t, 8> payload{};
    writeLittleEndian(std::span<std::uint8_t>{payload}, 0, first);
    writeLittleEndian(std::span<std::uint8_t>{payload}, 4, second);
    return feed(message, payload);
  }
  FrameVerdict feed(odrive::Message message, std::span<const std::uint8_t> payload) {
    CanFrame frame = makeClassicFrame(odrive::canId(node_, message), payload);
    frame.received = now_;
    return motor_->updateFeedback(frame);
  }
  FrameVerdict heartbeat(std::uint32_t error, std::uint8_t state, std::array<std::uint8_t, 3> flags = {}) {
    std::array<std::uint8_t, 8> payload{};
    writeLittleEndian(std::span<std::uint8_t>{payload}, 0, error);
    payload[4] = state;
    std::copy(flags.begin(), flags.end(), payload.begin() + 5);
    return feed(odrive::Message::kHeartbeat, payload);
  }
  void sample(float turns = 0.0F, float turns_per_s = 0.0F) {
    EXPECT_EQ(feed(odrive::Message::kEncoderEstimates, turns, turns_per_s), FrameVerdict::kAccepted);
  }

  std::vector<CanFrame> tick() {
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    motor_->update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_->packCommand(tick, out);
    now_ += 1ms;
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)};
  }

  void enable() {
    heartbeat(0, 1);
    sample();
    motor_->order(FrameKind::kEnable);
    tick();
    tick();
    heartbeat(0, 8);
    tick();
    ASSERT_EQ(motor_->sequenceProgress(), SequenceProgress::kDone);
  }

  /// The last frame of the tick in which the drive has been told the mode often enough.
  CanFrame settledInput(const Target& target) {
    motor_->order(FrameKind::kCommand);
    EXPECT_TRUE(motor_->setTarget(target));
    for (int i = 0; i < 5; ++i) tick();
    const auto frames = tick();
    EXPECT_FALSE(frames.empty());
    return frames.empty() ? CanFrame{} : frames.back();
  }
  static float numberAt(const CanFrame& frame, std::size_t at) {
    return readLittleEndian<float>(frame.payload(), at);
  }
  static std::vector<odrive::Message> messages(const std::vector<CanFrame>& frames) {
    std::vector<odrive::Message> result;
    for (const auto& frame : frames) result.push_back(odrive::messageOf(frame.id));
    return result;
  }
  void expectRest(const std::vector<CanFrame>& frames) {
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[0].id, odrive::canId(node_, odrive::Message::kSetInputTorque));
    EXPECT_EQ(numberAt(frames[0], 0), 0.0F);
    EXPECT_EQ(frames[1].id, odrive::canId(node_, odrive::Message::kSetAxisState));
    EXPECT_EQ(frames[1].data[0], 1);
  }

  int node_ = 0;
  std::unique_ptr<ODrive_Motor> motor_;
  MonotonicTime now_{1h};
  std::uint64_t ticks_ = 0;
};

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

TEST_F(OdriveMotor, EnablingAsksForTorqueControlAndLimitsBeforeClosedLoop) {
  heartbeat(0, 1);
  sample();
  motor_->order(FrameKind::kEnable);
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending);
  expectRest(tick());
  const auto frames = tick();
  EXPECT_THAT(messages(frames),
              testing::ElementsAre(odrive::Message::kSetInputTorque, odrive::Message::kSetControllerMode,
                                   odrive::Message::kSetLimits, odrive::Message::kSetAxisState));
  EXPECT_EQ(numberAt(frames[0], 0), 0.0F);
  EXPECT_EQ(frames[1].data[0], 1);
  EXPECT_EQ(frames[1].data[4], 1);
  EXPECT_FLOAT_EQ(numberAt(frames[2], 0), 25.0F);
  EXPECT_FLOAT_EQ(numberAt(frames[2], 4), 20.0F);
  EXPECT_EQ(frames[3].data[0], 8);
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending);
  // Until it is done nothing but 0 N·m.
  int told = 0;
  for (int i = 0; i < 50; ++i) {
    for (const auto& frame : tick()) {
      EXPECT_EQ(odrive::messageOf(frame.id), odrive::Message::kSetInputTorque);
      EXPECT_EQ(numberAt(frame, 0), 0.0F);
      ++told;
    }
  }
  EXPECT_EQ(told, 50);
  heartbeat(0, 8);
  tick();
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kDone);
}

TEST_F(OdriveMotor, AnOldHeartbeatDoesNotFinishEnabling) {
  heartbeat(0, 8);
  now_ += 1ms;
  motor_->order(FrameKind::kEnable);
  for (int i = 0; i < 20; ++i) tick();
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending);
}

TEST_F(OdriveMotor, ADriveInAnotherStateIsMadeIdleFirst) {
  heartbeat(0, 8);
  sample();
  motor_->order(FrameKind::kEnable);
  for (int i = 0; i < 20; ++i) expectRest(tick());
  heartbeat(0, 1);
  EXPECT_EQ(tick().size(), 4U);
}

TEST_F(OdriveMotor, UnansweredStepsAreAskedFiveTimesAndThenFail) {
  heartbeat(0, 1);
  motor_->order(FrameKind::kEnable);
  int asked = 0;
  for (int i = 0; i < 2000 && motor_->sequenceProgress() == SequenceProgress::kPending; ++i) {
    for (const auto& frame : tick()) {
      asked += odrive::messageOf(frame.id) == odrive::Message::kSetAxisState && frame.data[0] == 8 ? 1 : 0;
    }
  }
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kFailed);
  EXPECT_EQ(asked, 5);
  expectRest(tick());
}

TEST_F(OdriveMotor, EnablingFailsAtOnceOnAnErrorAndClearsNone) {
  heartbeat(0x100, 1);
  motor_->order(FrameKind::kEnable);
  for (int i = 0; i < 3; ++i) {
    for (const auto& frame : tick()) EXPECT_NE(odrive::messageOf(frame.id), odrive::Message::kClearErrors);
  }
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kFailed);
}

TEST_F(OdriveMotor, EnablingBeginsAnewAfterAnotherOrder) {
  enable();
  motor_->order(FrameKind::kRest);
  expectRest(tick());
  heartbeat(0, 1);
  motor_->order(FrameKind::kEnable);
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending);
  tick();
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending);
}

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

TEST_F(OdriveMotor, RefusesWhatNoKeysRangeCanSay) {
  auto settings = odriveSettings();
  EXPECT_TRUE(odriveFamily().check(settings));
  settings.velocity_limit_rpm = 0.0F;
  const auto no_velocity = odriveFamily().check(settings);
  ASSERT_FALSE(no_velocity);
  EXPECT_THAT(no_velocity.error().message, HasSubstr("velocity_limit_rpm"));
  settings = odriveSettings();
  settings.effort_limit = 0.0F;
  const auto no_current = odriveFamily().check(settings);
  ASSERT_FALSE(no_current);
  EXPECT_THAT(no_current.error().message, HasSubstr("current_limit_a"));
}

TEST_F(OdriveMotor, TelemetryThatIsOffIsNotReported) {
  auto settings = odriveSettings();
  EXPECT_TRUE(odriveFamily().traits("ODrive_S1", settings.own).reports_temperature);
  EXPECT_FALSE(odriveFamily().traits("ODrive_v3", settings.own).reports_temperature);
  EXPECT_EQ(odriveFamily().busUse(settings).feedback.size(), 5U);
  settings.own.set("telemetry_hz", 0.0);
  EXPECT_FALSE(odriveFamily().traits("ODrive_S1", settings.own).reports_temperature);
  EXPECT_EQ(odriveFamily().busUse(settings).feedback.size(), 2U);
}

TEST_F(OdriveMotor, ItsBusUseCoversAllThatItSendsAndHears) {
  const auto use = odriveFamily().busUse(odriveSettings());
  ASSERT_FALSE(motor_->filters().empty());
  ASSERT_FALSE(motor_->commandIds().empty());
  for (const auto& filter : motor_->filters()) {
    EXPECT_TRUE(accepts(use.sends.front(), makeClassicFrame(filter.id, {})));
  }
  for (const auto id : motor_->commandIds()) {
    EXPECT_TRUE(accepts(use.obeys.front(), makeClassicFrame(id, {})));
    EXPECT_TRUE(std::any_of(use.commands.begin(), use.commands.end(),
                            [id](const auto& stream) { return stream.id == id; }));
  }
}

}  // namespace
}  // namespace rc10::test::odrive_motor_test
