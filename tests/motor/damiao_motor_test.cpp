// Frames of a Damiao motor, one by one.
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/byte_order.hpp"
#include "support/damiao_motors.hpp"

namespace rc10::test::damiao_motor_test {
namespace {

using std::chrono::milliseconds;

constexpr DamiaoScale kDm4310{12.5, 30.0, 10.0};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool isSpecial(const CanFrame& frame, damiao::Special command) {
  return frame.length == 8 && frame.data[0] == 0xFF && frame.data[6] == 0xFF &&
         frame.data[7] == static_cast<std::uint8_t>(command);
}

bool isDisable(const CanFrame& frame) { return isSpecial(frame, damiao::Special::kDisable); }

damiao::MitCommand mitOf(const std::vector<CanFrame>& sent) {
  EXPECT_GE(sent.size(), 1U);
  if (sent.empty()) return {};  // a question about a register may follow
  return damiao::readMit(std::span(sent[0].data).first<8>(), kDm4310);
}

damiao::State stateAt(double rad, double rad_s = 0.0, std::uint8_t status = 1) {
  return {.status = status,
          .position = damiao::toCode(rad, 12.5, 16),
          .velocity = damiao::toCode(rad_s, 30.0, 12),
          .torque = 0x800,
          .drive_temperature = 30,
          .winding_temperature = 31};
}

struct EnabledDesk : DamiaoDesk {
  explicit EnabledDesk(MotorSettings settings = damiaoSettingsOf()) : DamiaoDesk(std::move(settings)) {
    EXPECT_TRUE(enable());
  }
};

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
  (void)desk.feed({.position = 0x7FFF, .velocity = 0x7FF, .torque = 0x7FF});  // how the drive rounds 0
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
  (void)desk.tick(milliseconds{200});
  (void)desk.feed(desk.state);
  EXPECT_TRUE(desk.motor().feedback().zeroed) << "at 45 rad/s it has not gone round";
  (void)desk.tick(milliseconds{300});
  (void)desk.feed(desk.state);
  EXPECT_FALSE(desk.motor().feedback().zeroed);
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

// --- Enabling ---

TEST(DamiaoMotor, ASilentRegisterIsAskedFiveTimesAndThenTheSequenceHasFailed) {
  DamiaoDesk desk(damiaoSettingsOf());
  desk.answers_registers = false;
  desk.motor().order(FrameKind::kEnable);
  int asked = 0;
  for (int i = 0; i < 300; ++i) {
    for (const auto& frame : desk.tickAnswered()) asked += frame.id.value == 0x7FF ? 1 : 0;
  }
  EXPECT_EQ(asked, 5);
  EXPECT_EQ(desk.motor().sequenceProgress(), SequenceProgress::kFailed);
  EXPECT_EQ(desk.motor().complaint().fault, FaultCode::kDriveSetting);
  EXPECT_EQ(desk.motor().complaint().native_code, 0x100U + 21U);
}

TEST(DamiaoMotor, OtherOrdersInBetweenStartTheSequenceAnew) {
  DamiaoDesk desk(damiaoSettingsOf());
  desk.answers_registers = false;
  ASSERT_FALSE(desk.enable());
  desk.motor().order(FrameKind::kPoll);
  desk.run(2);
  desk.answers_registers = true;
  EXPECT_TRUE(desk.enable());
  EXPECT_EQ(desk.motor().complaint().fault, FaultCode::kNone);
}

TEST(DamiaoMotor, AMotorThatIsHeldIsNotLetGoToBeEnabledAgain) {
  EnabledDesk desk;
  desk.motor().order(FrameKind::kHold);
  desk.run(5);
  desk.motor().order(FrameKind::kEnable);
  const auto sent = desk.tickAnswered();
  ASSERT_FALSE(sent.empty());
  for (const auto& frame : sent) EXPECT_FALSE(isDisable(frame));
  EXPECT_EQ(desk.motor().sequenceProgress(), SequenceProgress::kDone);
}

TEST(DamiaoMotor, WhileTheAnswerToEnableIsMissingTheWatchdogIsFed) {
  DamiaoDesk desk(damiaoSettingsOf());
  desk.motor().order(FrameKind::kEnable);
  bool enables = false;
  for (int i = 0; i < 40 && !enables; ++i) {
    const auto sent = desk.tick();
    for (const auto& frame : sent) enables = enables || isSpecial(frame, damiao::Special::kEnable);
    if (!enables) desk.answerAll(sent);
  }
  ASSERT_TRUE(enables);
  for (int i = 0; i < 40; ++i) {
    const auto sent = desk.tick();
    ASSERT_EQ(sent.size(), 1U);
    EXPECT_TRUE(isSpecial(sent[0], damiao::Special::kEnable));
  }
  for (int i = 0; i < 400; ++i) (void)desk.tick();
  EXPECT_EQ(desk.motor().sequenceProgress(), SequenceProgress::kFailed);
  EXPECT_TRUE(isDisable(desk.tick()[0])) << "it may be enabled after all";
}

TEST(DamiaoMotor, ADriveThatDoesNotTakeItsModeOrWatchdogIsNotEnabled) {
  for (const std::uint8_t stubborn : std::vector<std::uint8_t>{9, 10}) {
    DamiaoDesk desk(damiaoSettingsOf());
    desk.motor().order(FrameKind::kEnable);
    for (int i = 0; i < 100; ++i) {
      for (const auto& frame : desk.tickAnswered()) {
        EXPECT_FALSE(isSpecial(frame, damiao::Special::kEnable));
      }
      desk.registers[stubborn] = 77;
    }
    EXPECT_EQ(desk.motor().sequenceProgress(), SequenceProgress::kFailed);
    EXPECT_EQ(desk.motor().complaint().native_code, 0x100U + stubborn);
  }
}

TEST(DamiaoMotor, WhileEnablingNothingButRestRegistersInRamAndOneEnableLeaves) {
  std::mt19937 generator(1);
  for (int round = 0; round < 50; ++round) {
    DamiaoDesk desk(damiaoSettingsOf("DM4310", std::string{kDamiaoControlNames[generator() % 4]}));
    desk.motor().order(FrameKind::kEnable);
    for (int i = 0; i < 600; ++i) {
      desk.answers_registers = generator() % 3 != 0;
      for (const auto& frame : generator() % 4 == 0 ? desk.tick() : desk.tickAnswered()) {
        if (desk.motor().sequenceProgress() == SequenceProgress::kDone) break;
        if (frame.id.value == 0x7FF) {
          EXPECT_TRUE(frame.data[2] == 0x33 || (frame.data[2] == 0x55 && frame.data[3] <= 10));
        } else {
          EXPECT_TRUE(isDisable(frame) || isSpecial(frame, damiao::Special::kEnable));
        }
      }
    }
  }
}

TEST(DamiaoMotor, WithoutItsCountAMitDriveIsEnabledAndAPositionDriveIsNot) {
  DamiaoDesk mit(damiaoSettingsOf());
  mit.xout_rad = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(mit.enable());
  mit.command({.mode = ControlMode::kImpedance, .value = 0.0, .stiffness_nm_per_rad = 50.0F});
  EXPECT_EQ(mitOf(mit.tick()).kp_nm_per_rad, 0.0);
  DamiaoDesk position(damiaoSettingsOf("DM4310", "position_velocity"));
  position.xout_rad = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(position.enable());
  EXPECT_EQ(position.motor().complaint().native_code, 0x100U + 81U);
}

// --- Targets ---

TEST(DamiaoMotor, TorqueIsWhatTheCurrentMakesAndSaturatesAtTheLimit) {
  auto settings = damiaoSettingsOf();
  settings.effort_limit = 4.0F;
  EnabledDesk desk(settings);
  desk.command({.mode = ControlMode::kCurrent, .value = 2.0, .torque_ff_nm = 0.5F});
  EXPECT_NEAR(mitOf(desk.tick()).torque_nm, 2.0 * 0.945 + 0.5, 0.006);
  EXPECT_EQ(desk.motor().limits(), 0U);
  for (const double a : {100.0, -100.0, 1e300, -kInfinity, kInfinity}) {
    desk.command({.mode = ControlMode::kCurrent, .value = a});
    const double torque_nm = mitOf(desk.tick()).torque_nm;
    if (std::isinf(a)) {
      EXPECT_NEAR(torque_nm, 0.0, 0.003);
    } else {
      EXPECT_NEAR(torque_nm, std::copysign(4.0 * 0.945, a), 0.006);
      EXPECT_EQ(desk.motor().limits(), std::uint32_t{kLimitCurrent});
    }
  }
  desk.motor().derate(0.25F);
  desk.command({.mode = ControlMode::kCurrent, .value = 100.0});
  EXPECT_NEAR(mitOf(desk.tick()).torque_nm, 0.945, 0.006);
}

TEST(DamiaoMotor, ImpedanceIsSentAsTold) {
  EnabledDesk desk;
  desk.command({.mode = ControlMode::kImpedance,
                .value = 20.0,
                .velocity_ff_rpm = 10.0F,
                .torque_ff_nm = 0.3F,
                .stiffness_nm_per_rad = 12.0F,
                .damping_nms_per_rad = 0.7F});
  const auto command = mitOf(desk.tick());
  EXPECT_NEAR(command.position_rad, 20.0 / 57.29578, 0.001);
  EXPECT_NEAR(command.velocity_rad_s, 10.0 * 0.1047198, 0.02);
  EXPECT_NEAR(command.kp_nm_per_rad, 12.0, 0.13);
  EXPECT_NEAR(command.kd_nms_per_rad, 0.7, 0.002);
  EXPECT_NEAR(command.torque_nm, 0.3, 0.006);
}

TEST(DamiaoMotor, AGearBehindTheDriveCountsOnceForAnglesAndSquaredForGains) {
  auto settings = damiaoSettingsOf();
  settings.gear_ratio = 20.0;  // 2 behind the drive's own 10
  settings.direction = -1;
  settings.zero_at_power_on = true;
  EnabledDesk desk(settings);
  desk.command({.mode = ControlMode::kImpedance,
                .value = 10.0,
                .torque_ff_nm = 1.0F,
                .stiffness_nm_per_rad = 40.0F,
                .damping_nms_per_rad = 2.0F});
  const auto command = mitOf(desk.tick());
  EXPECT_NEAR(command.position_rad, -20.0 / 57.29578, 0.001);
  EXPECT_NEAR(command.kp_nm_per_rad, 10.0, 0.13);
  EXPECT_NEAR(command.kd_nms_per_rad, 0.5, 0.002);
  EXPECT_NEAR(command.torque_nm, -0.5, 0.006);
  (void)desk.feed(stateAt(0.0, 4.0));
  EXPECT_NEAR(static_cast<double>(desk.motor().feedback().velocity_rpm), -2.0 * 9.549, 0.1);
}

TEST(DamiaoMotor, BrakeDampAndHoldAreAllWithinTheTorqueLimit) {
  auto settings = damiaoSettingsOf();
  settings.effort_limit = 0.5F;
  EnabledDesk desk(settings);
  for (const auto kind : {FrameKind::kBrake, FrameKind::kDamp, FrameKind::kHold, FrameKind::kIdle}) {
    desk.motor().order(kind);
    (void)desk.tick();
    for (const double rad_s : {25.0, -25.0}) {
      (void)desk.feed(stateAt(0.0, rad_s));
      const auto command = mitOf(desk.tick());
      const double at_rad = damiao::fromCode(damiao::toCode(0.0, 12.5, 16), 12.5, 16);
      const double nm = command.kp_nm_per_rad * (command.position_rad - at_rad) +
                        command.kd_nms_per_rad * (command.velocity_rad_s - rad_s) + command.torque_nm;
      EXPECT_LE(std::fabs(nm), 0.5 * 0.945 + 0.05);
      if (kind != FrameKind::kIdle) {
        EXPECT_LT(nm * rad_s, 0.0) << "against the motion";
      }
    }
  }
}

/// Torque by the motor's last feedback never exceeds the limit, whatever is wanted; every field decodes.
TEST(DamiaoMotor, NoMitTargetWhateverItIsAsksForMoreThanTheLimit) {
  std::mt19937 generator(42);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  const auto odd = [&generator, &share]() {
    switch (generator() % 8) {
      case 0: return kNan;
      case 1: return kInfinity;
      case 2: return -kInfinity;
      case 3: return 1e300 * share(generator);
      case 4: return 1e5 * share(generator);
      default: return 100.0 * share(generator);
    }
  };
  const std::array kModes{ControlMode::kCurrent,    ControlMode::kVelocity,  ControlMode::kAngle,
                          ControlMode::kTotalAngle, ControlMode::kImpedance, ControlMode::kBrake,
                          ControlMode::kDuty,       ControlMode::kCoast};
  for (const float limit_a : {0.8F, 3.0F, 0.0F}) {
    auto settings = damiaoSettingsOf();
    settings.effort_limit = limit_a;
    settings.velocity_limit_rpm = limit_a > 2.0F ? 50.0F : 0.0F;
    EnabledDesk desk(settings);
    const double limit_nm = 0.945 * static_cast<double>(limit_a > 0.0F ? limit_a : 10.261194F);
    double rad = 0.0;
    for (int i = 0; i < 20'000; ++i) {
      const double rad_s = 29.0 * share(generator);
      rad = std::clamp(rad + 0.02 * share(generator), -12.4, 12.4);
      (void)desk.feed(stateAt(rad, rad_s));
      const double at_rad = damiao::fromCode(desk.state.position, 12.5, 16);
      const double at_rad_s = damiao::fromCode(desk.state.velocity, 30.0, 12);
      desk.command({.mode = kModes[generator() % kModes.size()],
                    .value = odd(),
                    .velocity_ff_rpm = static_cast<float>(odd()),
                    .torque_ff_nm = static_cast<float>(odd()),
                    .stiffness_nm_per_rad = static_cast<float>(odd()),
                    .damping_nms_per_rad = static_cast<float>(odd())});
      const auto c = mitOf(desk.tick());
      const double nm = c.kp_nm_per_rad * (c.position_rad - at_rad) +
                        c.kd_nms_per_rad * (c.velocity_rad_s - at_rad_s) + c.torque_nm;
      // A step of the position at full stiffness is 0.19 Nm, one of the speed at full damping 0.07 Nm.
      ASSERT_LE(std::fabs(nm), limit_nm + 0.3);
      ASSERT_TRUE(std::isfinite(desk.motor().commandValue()));
      ASSERT_LE(std::fabs(static_cast<double>(desk.motor().commandValue())) * 0.945, limit_nm + 1e-3);
    }
  }
}

TEST(DamiaoMotor, NoSpeedOrPositionFrameExceedsTheLimits) {
  std::mt19937 generator(7);
  for (const std::string control : {"velocity", "position_velocity", "force_position"}) {
    auto settings = damiaoSettingsOf("DM4310", control);
    settings.velocity_limit_rpm = 100.0F;
    EnabledDesk desk(settings);
    const double limit_rad_s = 100.0 * 0.10471976;
    for (const double value : {0.0, 1e9, -1e9, 1e300, kInfinity, -kInfinity, kNan, 250.0, -250.0}) {
      desk.command({.mode = control == "velocity" ? ControlMode::kVelocity : ControlMode::kTotalAngle,
                    .value = value});
      const auto sent = desk.tick();
      ASSERT_EQ(sent.size(), 1U);
      const auto data = std::span(sent[0].data);
      const auto first = static_cast<double>(readLittleEndian<float>(data, 0));
      ASSERT_TRUE(std::isfinite(first));
      if (control == "velocity") {
        EXPECT_EQ(sent[0].length, 4);
        EXPECT_LE(std::fabs(first), limit_rad_s + 1e-3);
      } else if (control == "position_velocity") {
        const auto second = static_cast<double>(readLittleEndian<float>(data, 4));
        EXPECT_GE(second, 0.0);
        EXPECT_LE(second, limit_rad_s + 1e-3);
      } else {
        EXPECT_LE(readLittleEndian<std::uint16_t>(data, 4), 1048);
        EXPECT_LE(readLittleEndian<std::uint16_t>(data, 6), 10'000);
      }
    }
  }
}

TEST(DamiaoMotor, EveryCodeComesBackThroughItsValue) {
  for (std::uint32_t code = 0; code <= 0xFFFF; ++code) {
    ASSERT_EQ(damiao::toCode(damiao::fromCode(code, 12.5, 16), 12.5, 16), code);
  }
  for (std::uint32_t code = 0; code <= 0xFFF; ++code) {
    ASSERT_EQ(damiao::toCode(damiao::fromCode(code, 30.0, 12), 30.0, 12), code);
    ASSERT_EQ(damiao::toCode(damiao::fromCode(code, 10.0, 12), 10.0, 12), code);
  }
  EXPECT_EQ(damiao::toCode(1e300, 12.5, 16), 0xFFFF);
  EXPECT_EQ(damiao::toCode(-1e300, 12.5, 16), 0);
  EXPECT_EQ(damiao::toCode(kInfinity, 30.0, 12), 0xFFF);
  EXPECT_EQ(damiao::toCode(kNan, 30.0, 12), 0x7FF);
}

TEST(DamiaoMotor, EveryMitCommandComesBackWithinOneStep) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 100'000; ++i) {
    const damiao::MitCommand sent{.position_rad = 25.0 * share(generator) - 12.5,
                                  .velocity_rad_s = 60.0 * share(generator) - 30.0,
                                  .kp_nm_per_rad = 500.0 * share(generator),
                                  .kd_nms_per_rad = 5.0 * share(generator),
                                  .torque_nm = 20.0 * share(generator) - 10.0};
    const auto back = damiao::readMit(damiao::mit(sent, kDm4310), kDm4310);
    ASSERT_NEAR(back.position_rad, sent.position_rad, 25.0 / 65535);
    ASSERT_NEAR(back.velocity_rad_s, sent.velocity_rad_s, 60.0 / 4095);
    ASSERT_NEAR(back.kp_nm_per_rad, sent.kp_nm_per_rad, 500.0 / 4095);
    ASSERT_NEAR(back.kd_nms_per_rad, sent.kd_nms_per_rad, 5.0 / 4095);
    ASSERT_NEAR(back.torque_nm, sent.torque_nm, 20.0 / 4095);
  }
}

TEST(DamiaoMotor, GarbageLeavesFiniteReadings) {
  std::mt19937 generator(11);
  DamiaoDesk desk(damiaoSettingsOf("DM4340", "mit", 15));
  for (int i = 0; i < 100'000; ++i) {
    damiao::Payload payload{};
    for (auto& byte : payload) byte = static_cast<std::uint8_t>(generator());
    payload[0] = static_cast<std::uint8_t>((payload[0] & 0xF0U) | 15U);
    (void)desk.give(payload);
    if (i % 3 == 0) (void)desk.tick();
    const auto& feedback = desk.motor().feedback();
    ASSERT_TRUE(std::isfinite(feedback.total_angle_deg));
    ASSERT_TRUE(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
    ASSERT_TRUE(std::isfinite(feedback.velocity_rpm) && std::isfinite(feedback.current_a));
    ASSERT_TRUE(feedback.temperature_c >= -56.0F && feedback.temperature_c <= 200.0F);
  }
}

}  // namespace
}  // namespace rc10::test::damiao_motor_test
