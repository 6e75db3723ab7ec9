#include "drives/lktech/lktech_motor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "bus/byte_order.hpp"
#include "drives/lktech/lktech_family.hpp"
#include "drives/lktech/lktech_model.hpp"
#include "motor/lktech_bench.hpp"
#include "support/frame_bytes.hpp"

namespace rc10::test::lktech_motor_test {
namespace {

using namespace lktech_bench;

using testing::Contains;
using testing::ElementsAre;
using testing::Not;

class LKTechMotor : public testing::Test {
 protected:
  explicit LKTechMotor(const MotorSettings& settings = settingsOf()) : motor_(motorOf(settings)) {}

  FrameVerdict hear(CanFrame frame) {
    frame.received = now_;
    EXPECT_TRUE(motor_->matchesFrame(frame));
    return motor_->updateFeedback(frame);
  }
  std::vector<std::string> tick() {
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    motor_->update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_->packCommand(tick, out);
    std::vector<std::string> sent;
    for (std::size_t i = 0; i < count; ++i) sent.push_back(textOf(out[i]));
    return sent;
  }
  /// A drive that is on, at this angle of its encoder, after these turns of the output.
  void comeOnline(std::uint16_t encoder = 0x2000, std::int64_t turns = 0) {
    hear(
        frameOf("141#9A1E6009640000"
                "00"));  // 30 degC, 24 V, on, no error
    hear(readingReply(0, 0, encoder));
    const double deg = encoder * 360.0 / 65536.0 + static_cast<double>(turns) * 360.0;
    hear(angleReply(std::llround(deg * motor_gear_ * 100.0)));
    hear(readingReply(0, 0, encoder));
  }
  /// Heard first while it turns, with its encoder at 0, and told to hold.
  void comeTurning(int deg_s, int count) {
    hear(frameOf("141#9A1E600964000000"));
    hear(readingReply(0, deg_s, 0));
    hear(angleReply(count));
    hear(readingReply(0, deg_s, 0));
    motor_->order(FrameKind::kHold);
  }
  std::string told(const Target& target) {
    motor_->order(FrameKind::kCommand, target);
    return tick().at(0);
  }

  std::unique_ptr<LKTech_Motor> motor_;
  double motor_gear_ = 1.0;
  MonotonicTime now_{std::chrono::hours{1}};
  std::uint64_t ticks_ = 0;
};

class GearedLKTechMotor : public LKTechMotor {
 protected:
  GearedLKTechMotor() : LKTechMotor(settingsOf("LK-MG5010E-i10")) { motor_gear_ = 10.0; }
};

TEST_F(LKTechMotor, AnOffsetOfItsCountIsKnownBeforeItStands) {
  comeTurning(180, 9000);  // 30 rpm, its count at 90 degrees
  const auto frame = frameOf(tick().at(0));
  EXPECT_EQ(frame.data[0], 0xA4);
  EXPECT_NEAR(readLittleEndian<std::int32_t>(frame.data, 4), 9000, 10);
}

TEST_F(LKTechMotor, TheWayBetweenTwoAnswersOfATurningShaftIsNoOffset) {
  hear(frameOf("141#9A1E600964000000"));
  hear(readingReply(0, 1800, 0));  // 300 rpm
  hear(angleReply(2700));          // 15 ms later
  hear(readingReply(0, 1800, 27 * 65536 / 360));
  motor_->order(FrameKind::kHold);
  auto frame = frameOf(tick().at(0));
  EXPECT_EQ(frame.data[0], 0xA2) << "a place that is told now may be another one";
  EXPECT_EQ(readLittleEndian<std::int32_t>(frame.data, 4), 0);
  hear(readingReply(0, 0, 27 * 65536 / 360));
  hear(angleReply(2700));
  frame = frameOf(tick().at(0));
  EXPECT_EQ(frame.data[0], 0xA4);
  EXPECT_NEAR(readLittleEndian<std::int32_t>(frame.data, 4), 2700, 10);
}

TEST_F(LKTechMotor, ASmallOffsetIsKnownBeforeItIsToldAPlace) {
  comeTurning(12, 900);  // 2 rpm, its count at 9 degrees
  EXPECT_EQ(frameOf(tick().at(0)).data[0], 0xA2);
  hear(readingReply(0, 0, 0));
  hear(angleReply(900));
  const auto frame = frameOf(tick().at(0));
  EXPECT_EQ(frame.data[0], 0xA4);
  EXPECT_NEAR(readLittleEndian<std::int32_t>(frame.data, 4), 900, 10) << "where it stands";
}

TEST_F(LKTechMotor, RestsAndPollsWithACurrentOfZero) {
  EXPECT_THAT(tick(), ElementsAre("141#A100000000000000"));
  std::array<CanFrame, 4> out{};
  ASSERT_EQ(motor_->packRest(out), 1U);
  EXPECT_EQ(textOf(out[0]), "141#A100000000000000");
  motor_->order(FrameKind::kPoll);
  EXPECT_THAT(tick(), ElementsAre("141#A100000000000000", "141#9A00000000000000"));
}

TEST_F(LKTechMotor, NeverTurnsTheDriveOff) {
  for (int kind = 0; kind < 9; ++kind) {
    motor_->order(static_cast<FrameKind>(kind));
    for (int i = 0; i < 400; ++i) EXPECT_THAT(tick(), Not(Contains("141#8000000000000000")));
  }
}

TEST_F(LKTechMotor, ReadsItsFeedback) {
  comeOnline();
  hear(readingReply(248, -360, 0x1FF0, 40));
  const auto& feedback = motor_->feedback();
  EXPECT_NEAR(feedback.current_a, 1.998, 1e-3);
  EXPECT_NEAR(feedback.torque_nm, 1.998 * 0.32, 1e-3);
  EXPECT_NEAR(feedback.velocity_rpm, -60.0, 1e-4);
  EXPECT_FLOAT_EQ(feedback.temperature_c, 40.0F);
  EXPECT_FLOAT_EQ(feedback.voltage_v, 24.0F);
  EXPECT_TRUE(feedback.zeroed) << "its encoder is that of the output";
  EXPECT_NEAR(feedback.total_angle_deg, 45.0 - 16 * 360.0 / 65536.0, 1e-9);
}

TEST_F(GearedLKTechMotor, SpeedIsThatOfTheRotorAndTheEncoderThatOfTheOutput) {
  comeOnline(0x4000);
  hear(readingReply(100, 3600, 0x4000));
  EXPECT_NEAR(motor_->feedback().velocity_rpm, 60.0, 1e-4);
  EXPECT_NEAR(motor_->feedback().total_angle_deg, 90.0, 1e-9);
  EXPECT_NEAR(motor_->feedback().torque_nm, 100 * 66.0 / 4096.0 * 0.1 * 10.0, 1e-4);
}

TEST_F(GearedLKTechMotor, AnglesAreCommandedInTheDrivesOwnTurns) {
  comeOnline(0x4000, 3);  // 1170 deg of the output by the drive's count, 90 deg by ours
  EXPECT_NEAR(motor_->feedback().total_angle_deg, 90.0, 1e-9);
  const auto frame = frameOf(told({.mode = ControlMode::kTotalAngle, .value = 100.0}));
  EXPECT_EQ(frame.data[0], 0xA4);
  EXPECT_EQ(readLittleEndian<std::int32_t>(frame.payload(), 4), 1180 * 10 * 100);
}

TEST_F(LKTechMotor, TakesNoSampleBeforeItKnowsTheDrivesTurns) {
  hear(readingReply(0, 0, 100));
  EXPECT_EQ(motor_->feedback().samples, 0U);
  hear(angleReply(55));
  hear(readingReply(0, 0, 100));
  EXPECT_EQ(motor_->feedback().samples, 1U);
}

TEST_F(LKTechMotor, AnotherControllersCommandIsNeverFeedback) {
  comeOnline();
  hear(readingReply(10, 60, 0x2000));
  const MotorFeedback before = motor_->feedback();
  for (const auto& frame :
       {lktech::currentCommand(1, 1234), lktech::velocityCommand(1, -5000.0, 700),
        lktech::positionCommand(1, 90.0, 5.0), lktech::request(1, lktech::Code::kStatus),
        lktech::request(1, lktech::Code::kReading), lktech::request(1, lktech::Code::kAngle),
        lktech::request(1, lktech::Code::kOff)}) {
    for (const bool sent_here : {false, true}) {
      CanFrame foreign = frame;
      foreign.sent_here = sent_here;
      hear(foreign);
    }
  }
  EXPECT_EQ(motor_->feedback().samples, before.samples);
  EXPECT_EQ(motor_->feedback().velocity_rpm, before.velocity_rpm);
  EXPECT_EQ(motor_->feedback().voltage_v, before.voltage_v);
  EXPECT_EQ(motor_->feedback().total_angle_deg, before.total_angle_deg);
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kNone);
}

TEST_F(LKTechMotor, ACopyOfACommandThatItWasNotSentIsSomebodyElses) {
  comeOnline();
  for (const char* text : {"141#8000000000000000", "141#8100000000000000", "141#8800000000000000",
                           "141#8C00000000000000", "141#9B00000000000000"})
    EXPECT_EQ(hear(frameOf(text)), FrameVerdict::kForeign) << text;
  motor_->order(FrameKind::kEnable);
  (void)tick();
  hear(frameOf("141#9A1E600964001000"));  // off
  EXPECT_THAT(tick(), Contains("141#8800000000000000"));
  CanFrame here = frameOf("141#8800000000000000");
  here.sent_here = true;
  EXPECT_EQ(hear(here), FrameVerdict::kForeign) << "the drive is not on this computer";
  EXPECT_EQ(hear(frameOf("141#8800000000000000")), FrameVerdict::kAccepted);
  hear(frameOf("141#9A1E600964000000"));
  for (int i = 0; i < 101; ++i) (void)tick();
  EXPECT_EQ(hear(frameOf("141#8800000000000000")), FrameVerdict::kForeign) << "no longer the copy of ours";
}

TEST_F(LKTechMotor, AFreezingMotorIsUnderstoodAndACommandFromThisComputerStillIsNot) {
  comeOnline();
  hear(frameOf("141#9A00600964000000"));  // 0 degC
  hear(readingReply(0, 0, 0x2000, 0));
  const auto samples = motor_->feedback().samples;
  hear(readingReply(0, 5, 0, 0));
  EXPECT_EQ(motor_->feedback().samples, samples + 1);
  CanFrame foreign = lktech::currentCommand(1, 100);
  foreign.sent_here = true;
  hear(foreign);
  EXPECT_EQ(motor_->feedback().samples, samples + 1);
}

TEST_F(LKTechMotor, CountsTurnsAtAnySpeed) {
  std::mt19937 random(5);  // NOLINT: the same numbers every time
  for (const double rpm : {3.0, -200.0, 900.0, -2500.0}) {
    motor_ = motorOf(settingsOf());
    comeOnline(0, 0);
    hear(angleReply(0));
    hear(angleReply(0));
    hear(angleReply(0));  // at 0 indeed
    hear(readingReply(0, static_cast<int>(rpm * 6.0), 0));
    double deg = 0.0;
    const double first_deg = motor_->feedback().total_angle_deg;
    for (int i = 0; i < 2000; ++i) {
      const auto gap_ms = 1 + static_cast<int>(random() % 12);
      now_ += std::chrono::milliseconds{gap_ms};
      deg += rpm * 6.0 * gap_ms * 1e-3;
      const double turn = deg / 360.0 - std::floor(deg / 360.0);
      hear(readingReply(0, static_cast<int>(rpm * 6.0), static_cast<std::uint16_t>(turn * 65536.0)));
    }
    EXPECT_NEAR(motor_->feedback().total_angle_deg - first_deg, deg, 0.01) << rpm;
  }
}

TEST_F(LKTechMotor, ASilenceIsBridgedWhenTheDrivesTurnsSaySo) {
  comeOnline(0x2000, 2);
  ASSERT_TRUE(motor_->setZero(0.0));
  now_ += std::chrono::seconds{5};
  hear(readingReply(0, 0, 0x2400));
  const auto samples = motor_->feedback().samples;
  hear(angleReply(static_cast<std::int32_t>((720.0 + 0x2400 * 360.0 / 65536.0) * 100.0)));
  hear(readingReply(0, 0, 0x2400));
  EXPECT_EQ(motor_->feedback().samples, samples + 1);
  EXPECT_NEAR(motor_->feedback().total_angle_deg, 0x400 * 360.0 / 65536.0, 1e-6);
  EXPECT_TRUE(motor_->feedback().zeroed);
}

/// Its arm turns once for five turns of the drive, so no encoder tells its angle.
class LKTechArm : public LKTechMotor {
 protected:
  LKTechArm() : LKTechMotor(settingsOfAnArm()) {}
  static MotorSettings settingsOfAnArm() {
    auto settings = settingsOf();
    settings.gear_ratio = 5.0;
    return settings;
  }
  static std::uint16_t encoderAt(double deg) {
    return static_cast<std::uint16_t>(std::lround(std::remainder(deg - 180.0, 360.0) / 360.0 * 65536.0) +
                                      32768);
  }
  /// Its drive is heard with this count after a silence.
  void returnAfter(Duration silence, double count_deg) {
    now_ += silence;
    hear(readingReply(0, 0, encoderAt(count_deg)));
    hear(angleReply(static_cast<std::int32_t>(std::lround(count_deg * 100.0))));
    hear(readingReply(0, 0, encoderAt(count_deg)));
  }
  /// Zeroed at 0, and turned until its drive counts so much.
  void turnTo(double count_deg) {
    comeOnline(encoderAt(10.0));
    ASSERT_TRUE(motor_->setZero(2.0));
    for (double deg = 20.0; deg <= count_deg; deg += 10.0) {
      (void)tick();
      hear(readingReply(0, 0, encoderAt(deg)));
    }
    ASSERT_NEAR(motor_->feedback().total_angle_deg, count_deg / 5.0, 0.01);
    ASSERT_TRUE(motor_->feedback().zeroed);
  }
};

// Turned on by 300 deg of the drive while it was off: it counts from 0 again and shows 40 deg.
TEST_F(LKTechArm, ThatWasOffAndTurnedHasNoReference) {
  turnTo(100.0);
  returnAfter(std::chrono::seconds{5}, 40.0);
  EXPECT_FALSE(motor_->feedback().zeroed);
}

TEST_F(LKTechArm, WhoseDriveCountsMoreThanAFreshOneHasLivedOn) {
  turnTo(800.0);
  returnAfter(std::chrono::seconds{5}, 860.0);
  EXPECT_TRUE(motor_->feedback().zeroed);
  EXPECT_NEAR(motor_->feedback().total_angle_deg, 172.0, 0.01);
}

TEST_F(LKTechArm, KeepsItsReferenceOverASilenceInWhichNoDriveStarts) {
  turnTo(100.0);
  returnAfter(std::chrono::milliseconds{90}, 100.0);
  EXPECT_TRUE(motor_->feedback().zeroed);
}

TEST_F(LKTechMotor, TurnsThatTheDriveHasForgottenAreAComplaintWhileItWasToObey) {
  comeOnline(0x2000, 2);
  (void)told({.mode = ControlMode::kTotalAngle, .value = 10.0});
  hear(angleReply(4500));  // no turns any more
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kDriveStopped);
  EXPECT_EQ(tick().at(0), "141#A100000000000000") << "not started again";
  motor_->clearComplaint();
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kNone);
}

/// At 300 rpm, 20 turns on, after a silence.
class TurningLKTechMotor : public LKTechMotor {
 protected:
  /// `round`: of firmware that fills four bytes, which go round below 0.
  void returnAfter(Duration silence, double count_deg, std::int64_t round = 0) {
    comeOnline(0x2000, 20);
    ASSERT_TRUE(motor_->setZero(0.0));
    hear(readingReply(0, 1800, 0x2000));
    (void)told({.mode = ControlMode::kVelocity, .value = 300.0});
    now_ += silence;
    const double within_deg = count_deg - 360.0 * std::floor(count_deg / 360.0);
    const auto encoder = static_cast<std::uint16_t>(std::lround(within_deg / 360.0 * 65536.0));
    hear(readingReply(0, 1800, encoder));
    hear(angleReply(std::llround(count_deg * 100.0) + round));
    hear(readingReply(0, 1800, encoder));
  }
};

TEST_F(TurningLKTechMotor, HasTurnedOnInASilenceAndWasNotRestarted) {
  for (const int ms : {101, 150, 200, 300, 2000}) {
    SCOPED_TRACE(ms);
    motor_ = motorOf(settingsOf());
    returnAfter(std::chrono::milliseconds{ms}, 7245.0 + 1.8 * ms);
    EXPECT_EQ(motor_->complaint().fault, FaultCode::kNone);
    EXPECT_TRUE(motor_->feedback().zeroed);
    EXPECT_NEAR(motor_->feedback().total_angle_deg, 1.8 * ms, 0.01);
  }
}

TEST_F(TurningLKTechMotor, WhoseDriveCountsAfreshWasRestarted) {
  for (const double count_deg : {20.0, -340.0, 350.0, 500.0}) {
    SCOPED_TRACE(count_deg);
    motor_ = motorOf(settingsOf());
    returnAfter(std::chrono::milliseconds{300}, count_deg);
    EXPECT_EQ(motor_->complaint().fault, FaultCode::kDriveStopped);
  }
}

TEST_F(TurningLKTechMotor, WhoseDriveCountsAfreshInFourBytesWasRestarted) {
  for (const double count_deg : {-40.0, -340.0}) {
    SCOPED_TRACE(count_deg);
    motor_ = motorOf(settingsOf());
    returnAfter(std::chrono::milliseconds{300}, count_deg, std::int64_t{1} << 32);
    EXPECT_EQ(motor_->complaint().fault, FaultCode::kDriveStopped);
  }
}

TEST_F(LKTechMotor, TheTurnsAreTheFirstQuestionAfterASilence) {
  comeOnline(0x2000, 2);
  (void)told({.mode = ControlMode::kVelocity, .value = 60.0});
  for (const int more : {0, 1}) {
    hear(readingReply(0, 360, 0x2000));
    for (int i = 0; i < 50 + more; ++i) (void)tick();
    now_ += std::chrono::milliseconds{150};
    const auto frames = tick();
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[0], "141#A100000000000000") << "until they are known";
    EXPECT_EQ(frames[1], "141#9200000000000000");
    hear(readingReply(0, 360, 0x2000));
    hear(angleReply(76500));
  }
}

TEST_F(LKTechMotor, ADriveThatIsOffWhileItIsToObeyIsAComplaint) {
  comeOnline();
  motor_->order(FrameKind::kPoll);
  (void)tick();
  hear(frameOf("141#9A1E600964001000"));
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kNone);
  motor_->order(FrameKind::kIdle);
  (void)tick();
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kDriveStopped);
}

TEST_F(LKTechMotor, EveryKnownErrorHasItsFaultCodeAndIsClearedOnRequestOnly) {
  comeOnline();
  motor_->order(FrameKind::kPoll);
  for (const DriveFault& fault : lktechFaults()) {
    CanFrame frame = frameOf("141#9A1E600964000000");
    frame.data[7] = static_cast<std::uint8_t>(fault.native);
    hear(frame);
    EXPECT_EQ(motor_->complaint().fault, fault.fault) << fault.words;
    EXPECT_EQ(motor_->complaint().native_code, fault.native);
    EXPECT_THAT(tick(), Not(Contains("141#9B00000000000000")));
  }
  motor_->clearComplaint();
  EXPECT_THAT(tick(), Contains("141#9B00000000000000"));
  EXPECT_THAT(tick(), Not(Contains("141#9B00000000000000")));
  hear(frameOf("141#9B1E600964000000"));
  EXPECT_EQ(motor_->complaint().fault, FaultCode::kNone);
}

TEST_F(LKTechMotor, EnablingTurnsTheDriveOnAndMakesSureThatItObeys) {
  comeOnline();
  motor_->order(FrameKind::kEnable);
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending);
  EXPECT_THAT(tick(), Contains("141#9A00000000000000"));
  hear(frameOf("141#9A1E600964001000"));  // off
  const auto second = tick();
  EXPECT_THAT(second, Contains("141#8800000000000000"));
  EXPECT_EQ(second.at(0), "141#A100000000000000") << "without torque";
  EXPECT_EQ(hear(frameOf("141#8800000000000000")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending) << "a copy proves nothing";
  hear(frameOf("141#9A1E600964000000"));
  EXPECT_THAT(tick(), Contains("141#9200000000000000"));
  hear(angleReply(4500));
  (void)tick();
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending);
  hear(readingReply(0, 0, 0x2000));
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kDone);
  EXPECT_EQ(tick().at(0), "141#A100000000000000");
}

TEST_F(LKTechMotor, EnablingFailsWithoutAnAnswerOrWithAnError) {
  motor_->order(FrameKind::kEnable);
  int ms = 0;
  for (; ms < 1000 && motor_->sequenceProgress() == SequenceProgress::kPending; ++ms) (void)tick();
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kFailed);
  EXPECT_LT(ms, 300);
  motor_->order(FrameKind::kPoll);
  (void)tick();
  motor_->order(FrameKind::kEnable);
  (void)tick();
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kPending);
  hear(frameOf("141#9A1E600964000001"));
  EXPECT_EQ(motor_->sequenceProgress(), SequenceProgress::kFailed);
}

TEST_F(LKTechMotor, LimitsBoundWhatIsSentAndSaySo) {
  MotorSettings settings = settingsOf();
  settings.effort_limit = 1.0F;
  settings.velocity_limit_rpm = 50.0F;
  motor_ = motorOf(settings);
  comeOnline();
  EXPECT_EQ(told({.mode = ControlMode::kCurrent, .value = 1e12}), "141#A10000007C000000");
  EXPECT_EQ(motor_->limits(), kLimitCurrent);
  EXPECT_EQ(told({.mode = ControlMode::kVelocity, .value = 1e12}), "141#A2007C0030750000")
      << "124 raw are 1 A";
  EXPECT_EQ(motor_->limits(), kLimitVelocity);
  EXPECT_EQ(told({.mode = ControlMode::kTotalAngle, .value = -1e300}), "141#A4002C0101000080");
  EXPECT_EQ(motor_->limits(), kLimitAngle);
  motor_->derate(0.0F);
  EXPECT_EQ(told({.mode = ControlMode::kVelocity, .value = 10.0}), "141#A100000000000000");
}

TEST_F(LKTechMotor, FromBeyondWhatCanBeToldNoPlaceIsFollowed) {
  // 2^31 hundredths of a degree end 116 degrees after this.
  comeOnline(0, 59'652);
  const double start_deg = motor_->feedback().total_angle_deg;
  std::uint16_t encoder = 0;
  for (int i = 0; i < 20; ++i) {
    (void)tick();
    encoder = static_cast<std::uint16_t>(encoder + 1820);  // 10 degrees
    hear(readingReply(0, 10'000, encoder));
  }
  ASSERT_NEAR(motor_->feedback().total_angle_deg - start_deg, 200.0, 1.0);
  const auto sent = told({.mode = ControlMode::kTotalAngle, .value = motor_->feedback().total_angle_deg});
  EXPECT_THAT(sent, testing::StartsWith("141#A2")) << "velocity 0";
  EXPECT_THAT(sent, testing::EndsWith("00000000"));
  EXPECT_NE(motor_->limits() & kLimitAngle, 0U);
}

// rc10d was restarted: the drive has gone on counting, in 56 bits of which a command has 32.
TEST_F(LKTechMotor, ACountThatNoCommandCanTellIsFollowedToNoPlace) {
  for (const std::int64_t turns : {59'660LL, -59'660LL, 119'305LL, 1'000'000LL}) {
    SCOPED_TRACE(turns);
    motor_ = motorOf(settingsOf());
    comeOnline(0, turns);
    const auto sent = told({.mode = ControlMode::kTotalAngle, .value = motor_->feedback().total_angle_deg});
    EXPECT_THAT(sent, testing::StartsWith("141#A2")) << "velocity 0";
    EXPECT_THAT(sent, testing::EndsWith("00000000"));
    EXPECT_NE(motor_->limits() & kLimitAngle, 0U);
  }
}

TEST_F(LKTechMotor, NonFiniteAndHugeTargetsAreHarmless) {
  comeOnline();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double value : {std::nan(""), kInfinity, -kInfinity, 1e300, -1e300}) {
    for (int mode = 0; mode < kControlModeCount; ++mode) {
      Target target{.mode = static_cast<ControlMode>(mode), .value = value};
      target.torque_ff_nm = static_cast<float>(value);
      EXPECT_EQ(told(target).size(), 20U);
      EXPECT_FALSE(std::isnan(motor_->commandValue())) << mode;
    }
  }
}

TEST_F(LKTechMotor, FramesThatAreNotItsOwnAreLeftAlone) {
  EXPECT_FALSE(motor_->matchesFrame(frameOf("142#9C1E0000000000")));
  CanFrame frame = readingReply(0, 0, 1);
  frame.id.extended = true;
  EXPECT_FALSE(motor_->matchesFrame(frame));
  frame = readingReply(0, 0, 1);
  frame.fd = true;
  EXPECT_FALSE(motor_->matchesFrame(frame));
  EXPECT_EQ(motor_->updateFeedback(frame), FrameVerdict::kMalformed);
  frame.fd = false;
  frame.type = FrameType::kRemote;
  EXPECT_EQ(motor_->updateFeedback(frame), FrameVerdict::kMalformed);
  EXPECT_EQ(hear(frameOf("141#A11E")), FrameVerdict::kMalformed);
}

TEST_F(LKTechMotor, AnythingMayArriveAndReadingsStayFinite) {
  std::mt19937 random(1);  // NOLINT: the same numbers every time
  comeOnline();
  for (int i = 0; i < 20000; ++i) {
    constexpr std::array<std::uint8_t, 7> kCodes{0x92, 0x9A, 0x9B, 0x9C, 0xA1, 0xA2, 0xA4};
    CanFrame frame = frameOf("141#0000000000000000");
    for (auto& byte : std::span(frame.data).first(8)) byte = static_cast<std::uint8_t>(random());
    frame.data[0] = kCodes[random() % kCodes.size()];
    now_ += std::chrono::milliseconds{random() % 200};
    hear(frame);
    if (random() % 3 == 0) (void)told({.mode = ControlMode::kTotalAngle, .value = 10.0});
    const auto& feedback = motor_->feedback();
    ASSERT_TRUE(std::isfinite(feedback.total_angle_deg) && std::isfinite(feedback.velocity_rpm));
    ASSERT_TRUE(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
  }
}

}  // namespace
}  // namespace rc10::test::lktech_motor_test
