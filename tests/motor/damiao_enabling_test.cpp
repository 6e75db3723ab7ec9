#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "motor/damiao_desk.hpp"

namespace rc10::test::damiao_enabling_test {
namespace {

using namespace damiao_desk;

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

TEST(DamiaoMotor, AScaleThatIsWrittenAfterItHasBeenReadEndsTheEnabling) {
  for (int ticks = 1; ticks < 30; ++ticks) {
    DamiaoDesk desk(damiaoSettingsOf());
    desk.motor().order(FrameKind::kEnable);
    desk.run(ticks);
    const auto written = damiao::writeRegister(1, damiao::Register::kTMax, damiao::bitsOf(28.0F));
    desk.registers[23] = damiao::bitsOf(28.0F);
    (void)desk.give(written);
    desk.run(100);
    EXPECT_EQ(desk.motor().sequenceProgress(), SequenceProgress::kFailed) << ticks;
    EXPECT_EQ(desk.motor().complaint().native_code, 0x117U) << ticks;
    for (const auto& frame : desk.tickAnswered()) EXPECT_TRUE(isDisable(frame)) << ticks;
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
  const auto command = mitOf(mit.tick());
  EXPECT_EQ(command.stiffness_nm_per_rad, 0.0);
  EXPECT_GT(command.damping_nms_per_rad, 0.0) << "a load sinks, and does not fall";
  DamiaoDesk position(damiaoSettingsOf("DM4310", "position_velocity"));
  position.xout_rad = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(position.enable());
  EXPECT_EQ(position.motor().complaint().native_code, 0x100U + 81U);
}

}  // namespace
}  // namespace rc10::test::damiao_enabling_test
