// The frames of public documents and libraries, both ways. Sources: manuals DM-J4310-2EC V1.2 and
// DM-J3507-2EC V1.1; cmjang/DM_Control_Python, enactic/openarm_can, the vendor's control routines. The values
// were computed from these by hand, independently of this driver.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/damiao_motors.hpp"

namespace rc10::test::damiao_golden_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr DamiaoScale kDm4310{12.5, 30.0, 10.0};

template <typename Payload>
Bytes bytes(const Payload& payload) {
  return {payload.begin(), payload.end()};
}

constexpr double rpmOf(double rad_s) { return rad_s * 9.549296585513721; }
constexpr double degOf(double rad) { return rad * 57.29577951308232; }

TEST(DamiaoGolden, AMitCommandHasTheBytesOfTheManual) {
  const auto payload = damiao::mit({.position_rad = 1.0,
                                    .velocity_rad_s = -2.0,
                                    .stiffness_nm_per_rad = 20.0,
                                    .damping_nms_per_rad = 0.5,
                                    .torque_nm = 3.0},
                                   kDm4310);
  EXPECT_EQ(bytes(payload), (Bytes{0x8A, 0x3C, 0x77, 0x70, 0xA3, 0x19, 0x9A, 0x65}));
  const auto back = damiao::readMit(payload, kDm4310);
  EXPECT_NEAR(back.position_rad, 0.99966, 1e-5);
  EXPECT_NEAR(back.velocity_rad_s, -2.0, 1e-5);
  EXPECT_NEAR(back.stiffness_nm_per_rad, 19.9023, 1e-4);
  EXPECT_NEAR(back.damping_nms_per_rad, 0.49939, 1e-5);
  EXPECT_NEAR(back.torque_nm, 2.99634, 1e-5);
}

TEST(DamiaoGolden, AMitCommandOfNothingDecodesToLessThanAStepOfSpeedAndTorque) {
  const auto payload = damiao::mit({}, kDm4310);
  EXPECT_EQ(bytes(payload), (Bytes{0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF}));
  const auto back = damiao::readMit(payload, kDm4310);
  EXPECT_NEAR(back.velocity_rad_s, -0.00733, 1e-5);
  EXPECT_NEAR(back.torque_nm, -0.00244, 1e-5);
}

TEST(DamiaoGolden, TheMotorsIdleFrameIsThat) {
  DamiaoDesk desk(damiaoSettingsOf());
  ASSERT_TRUE(desk.enable());
  desk.motor().order(FrameKind::kIdle);
  const auto sent = desk.tick();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].id, (CanId{0x001, false}));
  EXPECT_EQ(bytesOf(sent[0]), (Bytes{0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF}));
}

TEST(DamiaoGolden, EnableDisableAndClearAreThoseOfTheManual) {
  EXPECT_EQ(bytes(damiao::special(damiao::Special::kEnable)),
            (Bytes{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC}));
  EXPECT_EQ(bytes(damiao::special(damiao::Special::kDisable)),
            (Bytes{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFD}));
  EXPECT_EQ(bytes(damiao::special(damiao::Special::kClear)),
            (Bytes{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFB}));
}

TEST(DamiaoGolden, APositionIsSentWithItsVelocity) {
  EXPECT_EQ(bytes(damiao::positionVelocity(1.5F, 3.0F)),
            (Bytes{0x00, 0x00, 0xC0, 0x3F, 0x00, 0x00, 0x40, 0x40}));
  auto settings = damiaoSettingsOf("DM4310", "position_velocity");
  settings.velocity_limit_rpm = static_cast<float>(rpmOf(3.0));
  DamiaoDesk desk(settings);
  desk.xout_rad = static_cast<float>(damiao::fromCode(0x8000, 12.5, 16));
  ASSERT_TRUE(desk.enable());
  desk.command({.mode = ControlMode::kTotalAngle, .value = degOf(1.5)});
  const auto sent = desk.tick();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].id, (CanId{0x101, false}));
  EXPECT_EQ(bytesOf(sent[0]), (Bytes{0x00, 0x00, 0xC0, 0x3F, 0x00, 0x00, 0x40, 0x40}));
}

TEST(DamiaoGolden, AVelocityIsSentInRadiansPerSecond) {
  DamiaoDesk desk(damiaoSettingsOf("DM4310", "velocity"));
  ASSERT_TRUE(desk.enable());
  desk.command({.mode = ControlMode::kVelocity, .value = -60.0});
  const auto sent = desk.tick();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].id, (CanId{0x201, false}));
  EXPECT_EQ(bytesOf(sent[0]), (Bytes{0xDB, 0x0F, 0xC9, 0xC0}));  // -2 pi rad/s
}

TEST(DamiaoGolden, APositionIsSentWithItsForce) {
  EXPECT_EQ(bytes(damiao::forcePosition(0.75F, 5.0, 0.25)),
            (Bytes{0x00, 0x00, 0x40, 0x3F, 0xF4, 0x01, 0xC4, 0x09}));
  auto settings = damiaoSettingsOf("DM4310", "force_position");
  settings.velocity_limit_rpm = static_cast<float>(rpmOf(5.0));
  settings.effort_limit = 0.25F * 10.261194F;
  DamiaoDesk desk(settings);
  ASSERT_TRUE(desk.enable());
  desk.command({.mode = ControlMode::kTotalAngle, .value = degOf(0.75)});
  const auto sent = desk.tick();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].id, (CanId{0x301, false}));
  EXPECT_EQ(bytesOf(sent[0]), (Bytes{0x00, 0x00, 0x40, 0x3F, 0xF4, 0x01, 0xC4, 0x09}));
}

TEST(DamiaoGolden, FeedbackOfAnEnabledDriveIsInTheUsersUnits) {
  DamiaoDesk desk(damiaoSettingsOf());
  const auto state = damiao::readState(damiao::Payload{0x11, 0x5F, 0xD4, 0x91, 0x06, 0xFF, 0x24, 0x1F});
  desk.state = state;
  desk.xout_rad = -3.14164F;
  ASSERT_TRUE(desk.enable());
  ASSERT_EQ(desk.give({0x11, 0x5F, 0xD4, 0x91, 0x06, 0xFF, 0x24, 0x1F}), FrameVerdict::kAccepted);
  const auto& feedback = desk.motor().feedback();
  EXPECT_NEAR(feedback.total_angle_deg, degOf(-3.14164) + 360.0, 0.001);       // [-180, 180)
  EXPECT_NEAR(static_cast<double>(feedback.velocity_rpm), rpmOf(4.0), 0.001);  // made from 4 and -1.25
  EXPECT_NEAR(static_cast<double>(feedback.torque_nm), -1.25, 4e-4);
  EXPECT_NEAR(static_cast<double>(feedback.current_a), -1.25 / 0.945, 4e-4);
  EXPECT_EQ(feedback.temperature_c, 36.0F);  // 31 in the winding
  EXPECT_TRUE(std::isnan(feedback.voltage_v));
  EXPECT_EQ(desk.motor().complaint().fault, FaultCode::kNone);
  EXPECT_NEAR(damiao::fromCode(state.velocity, 30.0, 12), 3.99267, 1e-5);
  EXPECT_NEAR(damiao::fromCode(state.torque, 10.0, 12), -1.25275, 1e-5);
  EXPECT_EQ(bytes(damiao::writeState(1, state)), (Bytes{0x11, 0x5F, 0xD4, 0x91, 0x06, 0xFF, 0x24, 0x1F}));
}

TEST(DamiaoGolden, FeedbackTellsThatTheWatchdogHasTripped) {
  DamiaoDesk desk(damiaoSettingsOf("DM4310", "mit", 2));
  ASSERT_EQ(desk.give({0xD2, 0x7F, 0xFF, 0x7F, 0xF7, 0xFF, 0x28, 0x28}), FrameVerdict::kAccepted);
  EXPECT_EQ(desk.motor().complaint().fault, FaultCode::kDriveCommunication);
  EXPECT_EQ(desk.motor().complaint().native_code, 0xDU);
}

TEST(DamiaoGolden, RegistersAreReadAndWrittenAsInTheManual) {
  EXPECT_EQ(bytes(damiao::readRegister(1, damiao::Register::kPMax)),
            (Bytes{0x01, 0x00, 0x33, 0x15, 0x00, 0x00, 0x00, 0x00}));
  EXPECT_EQ(bytes(damiao::writeRegister(1, damiao::Register::kControlMode, 2)),
            (Bytes{0x01, 0x00, 0x55, 0x0A, 0x02, 0x00, 0x00, 0x00}));
  EXPECT_EQ(bytes(damiao::writeRegister(1, damiao::Register::kTimeout, 2000)),
            (Bytes{0x01, 0x00, 0x55, 0x09, 0xD0, 0x07, 0x00, 0x00}));
  const auto reply = damiao::readReply(damiao::Payload{0x01, 0x00, 0x33, 0x15, 0x00, 0x00, 0x48, 0x41}, 1);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->address, damiao::Register::kPMax);
  EXPECT_FALSE(reply->written);
  EXPECT_EQ(damiao::floatOf(reply->value), 12.5F);
}

TEST(DamiaoGolden, TheEnableSequenceIsTheseFramesAndNoneWritesFlash) {
  auto settings = damiaoSettingsOf("DM4310", "position_velocity");
  DamiaoDesk desk(settings);
  std::vector<std::string> sent;
  desk.motor().order(FrameKind::kEnable);
  for (int i = 0; i < 40 && desk.motor().sequenceProgress() == SequenceProgress::kPending; ++i) {
    for (const auto& frame : desk.tickAnswered()) {
      if (frame.id.value == 0x101 && frame.data[7] == 0xFD) continue;  // keeps asking for feedback
      std::string text;
      for (const auto byte : bytesOf(frame)) {
        constexpr const char* kDigits = "0123456789ABCDEF";
        text += {kDigits[byte >> 4U], kDigits[byte & 0xFU]};
      }
      sent.push_back((frame.id.value == 0x7FF ? "7FF#" : "101#") + text);
    }
  }
  EXPECT_EQ(desk.motor().sequenceProgress(), SequenceProgress::kDone);
  EXPECT_EQ(sent, (std::vector<std::string>{
                      "7FF#0100331500000000", "7FF#0100331600000000", "7FF#0100331700000000",
                      "7FF#0100550A02000000", "7FF#0100330A00000000", "7FF#01005509D0070000",
                      "7FF#0100330900000000", "7FF#0100335100000000", "101#FFFFFFFFFFFFFFFC"}));
}

}  // namespace
}  // namespace rc10::test::damiao_golden_test
