#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motor/odrive_bench.hpp"

namespace rc10::test::odrive_enabling_test {
namespace {

using namespace odrive_bench;

TEST_F(OdriveMotor, EnablingAsksForTorqueControlAndLimitsBeforeClosedLoop) {
  heartbeat(0, 1);
  sample();
  motor_->order(FrameKind::kEnable);
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending);
  expectIdleAsked(tick());
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
  expectIdleAsked(tick());
  for (int i = 0; i < 20; ++i) expectRest(tick());
  heartbeat(0, 1);
  EXPECT_EQ(messages(tick()).back(), odrive::Message::kSetAxisState);
}

/// A drive whose current is due and does not come.
class OdriveWithoutCurrent : public OdriveMotor {
 protected:
  /// Estimates each millisecond, heartbeats of this state each 100.
  void hears(Duration time, std::uint8_t state, bool current = false) {
    for (const auto end = now_ + time; now_ < end;) {
      if (ticks_ % 100 == 0) heartbeat(0, state);
      if (current) feed(odrive::Message::kTorques, 0.0F, 0.0F);
      sample();
      tick();
    }
  }
  void obey() {
    enable();
    motor_->order(FrameKind::kCommand);
    EXPECT_TRUE(motor_->setTarget({.mode = ControlMode::kVelocity, .value = 10.0}));
  }
  [[nodiscard]] FaultCode fault() const { return motor_->complaint().fault; }
};

TEST_F(OdriveWithoutCurrent, IsNotEnabledOnceItIsDue) {
  hears(2400ms, 1);
  obey();
  EXPECT_EQ(fault(), FaultCode::kNone) << "it is not due yet";
  motor_->order(FrameKind::kRest);
  hears(200ms, 1);
  EXPECT_EQ(fault(), FaultCode::kNone) << "it is to do nothing";
  motor_->order(FrameKind::kEnable);
  tick();
  tick();
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kFailed);
  EXPECT_EQ(fault(), FaultCode::kDriveSetting);
  EXPECT_EQ(motor_->complaint().native_code, ODrive_Motor::kNoCurrentComplaint);
  feed(odrive::Message::kTorques, 0.0F, 0.0F);
  EXPECT_EQ(fault(), FaultCode::kNone);
}

TEST_F(OdriveWithoutCurrent, IsAFaultWhileItObeysUnlessNoneIsAskedFor) {
  for (const int telemetry_hz : {100, 1, 0}) {
    auto settings = odriveSettings("ODrive_v3");
    settings.own.set("telemetry_hz", static_cast<double>(telemetry_hz));
    make(settings);
    hears(200ms, 1);
    obey();
    feed(odrive::Message::kIq, 0.0F, 0.0F);
    hears(telemetry_hz == 1 ? 4990ms : 2490ms, 8);
    EXPECT_EQ(fault(), FaultCode::kNone) << telemetry_hz;
    hears(20ms, 8);
    EXPECT_EQ(fault(), telemetry_hz > 0 ? FaultCode::kDriveSetting : FaultCode::kNone) << telemetry_hz;
    feed(odrive::Message::kIq, 0.0F, 0.0F);
    EXPECT_EQ(fault(), FaultCode::kNone) << telemetry_hz;
  }
}

// Feedback that is lost as a whole is told as such: after it nothing is due before its time.
TEST_F(OdriveWithoutCurrent, IsNoCauseOfASilence) {
  hears(100ms, 1, true);
  obey();
  hears(100ms, 8, true);
  for (int i = 0; i < 5000; ++i) tick();
  EXPECT_EQ(fault(), FaultCode::kNone);
  heartbeat(0, 8);
  sample();
  tick();
  EXPECT_EQ(fault(), FaultCode::kNone);
  hears(2400ms, 8);
  EXPECT_EQ(fault(), FaultCode::kNone);
  hears(200ms, 8);
  EXPECT_EQ(fault(), FaultCode::kDriveSetting);
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

}  // namespace
}  // namespace rc10::test::odrive_enabling_test
