// Frames of a Damiao motor, one by one.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "motor/damiao_desk.hpp"

namespace rc10::test::damiao_motor_test {
namespace {

using namespace damiao_desk;

// --- Rest ---

TEST(DamiaoMotor, RestIsTheDisableFrameFromTheFirstTickWithoutAnyFeedback) {
  for (const auto control : kDamiaoControlNames) {
    DamiaoDesk desk(damiaoSettingsOf("DM4310", std::string{control}, 3));
    const auto sent = desk.tick();
    ASSERT_EQ(sent.size(), 1U);
    EXPECT_TRUE(isDisable(sent[0]));
    EXPECT_EQ(sent[0].id, desk.motor().commandIds()[0]);
    std::array<CanFrame, kMaxFramesPerPacker> rest{};
    ASSERT_EQ(desk.motor().packRest(rest), 1U);
    EXPECT_TRUE(isDisable(rest[0]));
    EXPECT_EQ(rest[0].id, sent[0].id);
  }
}

TEST(DamiaoMotor, PackRestIsTheSameWhateverTheStateIs) {
  EnabledDesk desk;
  desk.command({.mode = ControlMode::kCurrent, .value = 5.0});
  (void)desk.tick();
  std::array<CanFrame, kMaxFramesPerPacker> rest{};
  ASSERT_EQ(desk.motor().packRest(rest), 1U);
  EXPECT_TRUE(isDisable(rest[0]));
}

TEST(DamiaoMotor, ADriveThatTheSequenceHasNotEnabledGetsNoTargets) {
  DamiaoDesk desk(damiaoSettingsOf());
  for (const auto kind :
       {FrameKind::kIdle, FrameKind::kBrake, FrameKind::kHold, FrameKind::kDamp, FrameKind::kRest}) {
    desk.motor().order(kind);
    const auto sent = desk.tick();
    ASSERT_FALSE(sent.empty());
    for (const auto& frame : sent) EXPECT_TRUE(isDisable(frame));
  }
  (void)desk.feed(stateAt(0.0, 0.0, 1));  // somebody else has enabled it
  desk.command({.mode = ControlMode::kCurrent, .value = 5.0});
  const auto sent = desk.tick();
  EXPECT_TRUE(isDisable(sent[0]));
  EXPECT_EQ(desk.motor().complaint().fault, FaultCode::kDriveStopped);
}

TEST(DamiaoMotor, AfterRestItMustBeEnabledAgain) {
  EnabledDesk desk;
  desk.motor().order(FrameKind::kPoll);
  desk.run(3);
  desk.command({.mode = ControlMode::kCurrent, .value = 5.0});
  EXPECT_TRUE(isDisable(desk.tick()[0]));
}

TEST(DamiaoMotor, KeepsToTheRhythmOfItsDivider) {
  auto settings = damiaoSettingsOf();
  settings.command_divider = 5;
  settings.command_phase = 2;
  DamiaoDesk desk(settings);
  int frames = 0;
  for (int i = 0; i < 100; ++i) frames += static_cast<int>(desk.tick().size());
  EXPECT_EQ(frames, 20);
}

// --- Frames of others ---

TEST(DamiaoMotor, TellsDrivesOnOneMasterIdApart) {
  auto first = damiaoSettingsOf("DM4310", "mit", 1);
  auto second = damiaoSettingsOf("DM8009", "mit", 2);
  first.own.set("master_id", 0.0);
  second.own.set("master_id", 0.0);
  Damiao_Motor a(first);
  Damiao_Motor b(second);
  EXPECT_FALSE(overlaps(a.filters()[0], b.filters()[0]));
  const auto of_b = damiaoFrame(0, {0x12, 0x80, 0x00, 0x80, 0x08, 0x00, 0x20, 0x20});
  EXPECT_FALSE(a.matchesFrame(of_b));
  EXPECT_TRUE(b.matchesFrame(of_b));
  EXPECT_TRUE(accepts(b.filters()[0], of_b));
}

TEST(DamiaoMotor, IgnoresWhatIsNotItsFeedback) {
  Damiao_Motor motor(damiaoSettingsOf());
  const std::vector<std::uint8_t> good{0x01, 0x80, 0x00, 0x80, 0x08, 0x00, 0x20, 0x20};
  EXPECT_FALSE(motor.matchesFrame(damiaoFrame(0x12, good)));
  CanFrame extended = damiaoFrame(0x11, good);
  extended.id.extended = true;
  EXPECT_FALSE(motor.matchesFrame(extended));
  CanFrame remote = damiaoFrame(0x11, good);
  remote.type = FrameType::kRemote;
  EXPECT_FALSE(motor.matchesFrame(remote));
  EXPECT_EQ(motor.updateFeedback(remote), FrameVerdict::kMalformed);
  CanFrame fd = makeFdFrame({0x11, false}, good, true);
  EXPECT_FALSE(motor.matchesFrame(fd));
  EXPECT_EQ(motor.updateFeedback(fd), FrameVerdict::kMalformed);
  for (std::uint8_t length = 0; length < 8; ++length) {
    CanFrame shorter = damiaoFrame(0x11, good);
    shorter.length = length;
    EXPECT_EQ(motor.matchesFrame(shorter), length > 0);
    EXPECT_EQ(motor.updateFeedback(shorter), FrameVerdict::kMalformed);
  }
  EXPECT_EQ(motor.feedback().samples, 0U);
}

TEST(DamiaoMotor, AnAnswerAboutARegisterIsNoPosition) {
  DamiaoDesk desk(damiaoSettingsOf());
  (void)desk.feed(stateAt(1.0, 0.0, 0));
  const auto before = desk.motor().feedback();
  // Late, asked by nobody any more, and even for another tool's question.
  for (const std::uint8_t address : std::vector<std::uint8_t>{0, 9, 10, 21, 22, 23, 80}) {
    EXPECT_EQ(desk.give({0x01, 0x00, 0x33, address, 1, 2, 3, 4}), FrameVerdict::kAccepted);
    EXPECT_EQ(desk.give({0x01, 0x00, 0x55, address, 1, 2, 3, 4}), FrameVerdict::kAccepted);
  }
  EXPECT_EQ(desk.give({0x01, 0x00, 0xAA, 0x01, 0, 0, 0, 0}), FrameVerdict::kAccepted);
  EXPECT_EQ(desk.motor().feedback().samples, before.samples);
  EXPECT_EQ(desk.motor().feedback().total_angle_deg, before.total_angle_deg);
}

// --- Reference ---

TEST(DamiaoMotor, TheAngleIsReferencedOnlyOnceTheDriveHasToldItsCount) {
  DamiaoDesk desk(damiaoSettingsOf());
  desk.motor().order(FrameKind::kPoll);
  desk.xout_rad = static_cast<float>(damiao::fromCode(0x8000, 12.5, 16));
  (void)desk.feed(desk.state);
  EXPECT_FALSE(desk.motor().feedback().zeroed);
  EXPECT_FALSE(desk.motor().setZero(0.0));
  desk.run(2);
  EXPECT_TRUE(desk.motor().feedback().zeroed);
  EXPECT_TRUE(desk.motor().setZero(10.0));
  EXPECT_NEAR(desk.motor().feedback().total_angle_deg, 10.0, 1e-9);
}

TEST(DamiaoMotor, ADriveThatIsSeldomAskedTellsItsCountAsWell) {
  auto settings = damiaoSettingsOf();
  settings.command_divider = 100;
  DamiaoDesk desk(settings);
  desk.motor().order(FrameKind::kPoll);
  desk.run(350);
  EXPECT_TRUE(desk.motor().feedback().zeroed);
}

TEST(DamiaoMotor, AStandstillReadsAsZero) {
  DamiaoDesk desk(damiaoSettingsOf());
  (void)desk.feed({.position = 0x7FFF, .velocity = 0x7FF, .torque = 0x7FF});  // 0, as the drive rounds it
  EXPECT_NEAR(static_cast<double>(desk.motor().feedback().velocity_rpm), 0.0, 1e-5);
  EXPECT_NEAR(static_cast<double>(desk.motor().feedback().torque_nm), 0.0, 1e-5);
}

TEST(DamiaoMotor, ACountThatContradictsTheFeedbackReferencesNothing) {
  for (const float xout : {3.0F, -40.0F, std::numeric_limits<float>::quiet_NaN(), 1e30F}) {
    DamiaoDesk desk(damiaoSettingsOf());
    desk.motor().order(FrameKind::kPoll);
    desk.xout_rad = xout;
    desk.run(100);
    EXPECT_FALSE(desk.motor().feedback().zeroed) << xout;
  }
}

TEST(DamiaoMotor, CountsTurnsOverTheWrapsInBothDirections) {
  for (const double sign : {1.0, -1.0}) {
    DamiaoDesk desk(damiaoSettingsOf());
    desk.motor().order(FrameKind::kPoll);
    desk.run(3);
    ASSERT_TRUE(desk.motor().feedback().zeroed);
    const double step_rad = 25.0 / 65535.0;
    double rad = damiao::fromCode(0x8000, 12.5, 16);
    for (int i = 0; i < 10'000; ++i) {
      rad += sign * 0.02;
      const auto code = static_cast<std::int64_t>(std::floor((rad + 12.5) / step_rad + 1e-9));
      auto state = stateAt(0.0, 20.0 * sign, 0);
      state.position = static_cast<std::uint16_t>(code);
      desk.state = state;
      (void)desk.tick();
      (void)desk.feed(state);
    }
    EXPECT_NEAR(desk.motor().feedback().total_angle_deg, sign * 200.0 * 57.29578, 0.1);
    EXPECT_TRUE(desk.motor().feedback().zeroed);
    EXPECT_EQ(desk.motor().feedback().jumps, 0U);
  }
}

TEST(DamiaoMotor, AGapInWhichAWrapMayHideLosesTheReferenceUntilTheDriveTellsItsCount) {
  DamiaoDesk desk(damiaoSettingsOf("DMH6215"));  // not absolute
  desk.motor().order(FrameKind::kPoll);
  desk.run(3);
  ASSERT_TRUE(desk.motor().setZero(0.0));
  desk.run(1);
  ASSERT_TRUE(desk.motor().feedback().zeroed);
  (void)desk.tick(milliseconds{90});
  (void)desk.feed(desk.state);
  EXPECT_TRUE(desk.motor().feedback().zeroed) << "at 45 rad/s it has not gone round";
  (void)desk.tick(milliseconds{300});
  (void)desk.feed(desk.state);
  EXPECT_FALSE(desk.motor().feedback().zeroed);
}

TEST(DamiaoMotor, WrapsThatItTellsAfterAGapAreNoWayOfTheShaft) {
  DamiaoDesk desk(damiaoSettingsOf("DMH6215"));  // not absolute
  desk.motor().order(FrameKind::kPoll);
  desk.run(3);
  ASSERT_TRUE(desk.motor().setZero(0.0));
  (void)desk.tick(milliseconds{300});
  (void)desk.feed(desk.state);
  const double before_deg = desk.motor().feedback().total_angle_deg;
  desk.xout_rad += 25.0F;
  desk.run(100);
  ASSERT_TRUE(desk.motor().setZero(before_deg)) << "it has told them";
  EXPECT_FALSE(desk.motor().setZero(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_NEAR(desk.motor().feedback().total_angle_deg, before_deg, 1.0);
}

// A drive that starts as fast as nothing that is known: 2 pi lie within its reach of such a silence.
TEST(DamiaoMotor, ASilenceInWhichItMayHaveRestartedAsksForItsCountAnew) {
  for (const auto silence : {milliseconds{110}, milliseconds{220}, milliseconds{400}, milliseconds{800}}) {
    for (const auto* model : {"DM4310", "DM4340", "DM8006", "DM10010"}) {
      DamiaoDesk desk(damiaoSettingsOf(model));
      desk.motor().order(FrameKind::kPoll);
      desk.run(3);
      ASSERT_TRUE(desk.motor().feedback().zeroed) << model;
      (void)desk.tick(silence);
      (void)desk.feed(desk.state);
      EXPECT_FALSE(desk.motor().feedback().zeroed) << model << silence.count();
    }
  }
}

TEST(DamiaoMotor, FramesThatWaitedAndComeAtOnceAreNoJump) {
  auto settings = damiaoSettingsOf("DM4310");
  settings.feedback_hz = 50;
  DamiaoDesk desk(settings);
  desk.motor().order(FrameKind::kPoll);
  desk.run(3);
  (void)desk.feed(stateAt(0.0, 30.0, 0));
  ASSERT_TRUE(desk.motor().setZero(0.0));
  for (int i = 1; i <= 40; ++i) {
    if (i % 5 == 0) (void)desk.tick(milliseconds{100});
    (void)desk.feed(stateAt(std::remainder(0.6 * i, 25.0), 30.0, 0));
  }
  EXPECT_EQ(desk.motor().feedback().jumps, 0U);
  EXPECT_NEAR(desk.motor().feedback().total_angle_deg, 24.0 * kDegPerRad, 0.5);
}

TEST(DamiaoMotor, AJumpWhileEnabledIsCountedAndOneAtRestIsARestart) {
  EnabledDesk desk;
  desk.motor().order(FrameKind::kIdle);
  desk.run(5);
  (void)desk.tick();
  (void)desk.feed(stateAt(6.0));
  EXPECT_EQ(desk.motor().feedback().jumps, 1U);
  EXPECT_FALSE(desk.motor().feedback().zeroed);
  desk.motor().order(FrameKind::kPoll);
  desk.run(3);
  (void)desk.tick();
  (void)desk.feed(stateAt(-3.0, 0.0, 0));
  EXPECT_EQ(desk.motor().feedback().jumps, 1U);
}

// --- Faults ---

TEST(DamiaoMotor, EveryStatusMeansWhatTheManualSays) {
  const std::array<FaultCode, 16> expected{FaultCode::kNone,
                                           FaultCode::kNone,
                                           FaultCode::kDriveCalibration,
                                           FaultCode::kDriveCalibration,
                                           FaultCode::kDriveEncoder,
                                           FaultCode::kDriveCalibration,
                                           FaultCode::kDriveOther,
                                           FaultCode::kDriveOther,
                                           FaultCode::kDriveOverVoltage,
                                           FaultCode::kDriveUnderVoltage,
                                           FaultCode::kDriveOverCurrent,
                                           FaultCode::kDriveTooHot,
                                           FaultCode::kDriveMotorTooHot,
                                           FaultCode::kDriveCommunication,
                                           FaultCode::kDriveOverload,
                                           FaultCode::kDriveOther};
  for (std::uint8_t status = 0; status < 16; ++status) {
    DamiaoDesk desk(damiaoSettingsOf());
    (void)desk.feed(stateAt(0.0, 0.0, status));
    EXPECT_EQ(desk.motor().complaint().fault, expected[status]) << int{status};
    EXPECT_EQ(desk.motor().complaint().native_code, expected[status] == FaultCode::kNone ? 0U : status);
  }
}

TEST(DamiaoMotor, TheClearFrameIsSentWhenAskedForAndAtMostFiveTimes) {
  DamiaoDesk desk(damiaoSettingsOf());
  desk.motor().order(FrameKind::kPoll);
  (void)desk.feed(stateAt(0.0, 0.0, 0xB));
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(isSpecial(desk.tick()[0], damiao::Special::kClear));
  desk.motor().clearComplaint();
  int clears = 0;
  for (int i = 0; i < 50; ++i) {
    clears += isSpecial(desk.tick()[0], damiao::Special::kClear) ? 1 : 0;
    (void)desk.feed(stateAt(0.0, 0.0, 0xB));  // still too hot
  }
  EXPECT_EQ(clears, 5);
  desk.motor().clearComplaint();
  EXPECT_TRUE(isSpecial(desk.tick()[0], damiao::Special::kClear));
  (void)desk.feed(stateAt(0.0, 0.0, 0));
  EXPECT_TRUE(isDisable(desk.tick()[0]));
  EXPECT_EQ(desk.motor().complaint().fault, FaultCode::kNone);
}

TEST(DamiaoMotor, ADriveThatLeavesItsEnabledStateIsReportedAndGetsNoMoreTargets) {
  for (const auto kind : {FrameKind::kIdle, FrameKind::kBrake, FrameKind::kHold, FrameKind::kDamp}) {
    EnabledDesk desk;
    desk.motor().order(kind);
    desk.run(3);
    EXPECT_EQ(desk.motor().complaint().fault, FaultCode::kNone);
    (void)desk.feed(stateAt(0.0, 0.0, 0));
    EXPECT_EQ(desk.motor().complaint().fault, FaultCode::kDriveStopped);
    EXPECT_TRUE(isDisable(desk.tick()[0]));
    desk.motor().order(FrameKind::kPoll);
    desk.motor().clearComplaint();
    desk.run(2);
    EXPECT_EQ(desk.motor().complaint().fault, FaultCode::kNone);
  }
}

}  // namespace
}  // namespace rc10::test::damiao_motor_test
