// Frames of the manuals (RS00 to RS06, EL05 and CyberGear), both ways. Values were computed by hand,
// independently of this driver.
#include <array>
#include <cstdint>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "support/robstride_settings.hpp"

namespace rc10::test::robstride_golden_test {
namespace {

using Bytes = std::array<std::uint8_t, 8>;

robstride::Codec codec(std::string_view name, int drive_id = 127) {
  const auto* model = findRobstrideModel(name);
  return {
      .model = model, .position_range_rad = model->position_range_rad, .drive_id = drive_id, .host_id = 0xFD};
}

void expectFrame(const CanFrame& frame, std::uint32_t id, const Bytes& data) {
  EXPECT_EQ(frame.id, (CanId{id, true}));
  EXPECT_EQ(frame.length, 8);
  EXPECT_FALSE(frame.fd);
  for (std::size_t i = 0; i < data.size(); ++i) EXPECT_EQ(frame.data[i], data[i]) << "byte " << i;
}

CanFrame frameOf(std::uint32_t id, const Bytes& data) { return makeClassicFrame({id, true}, data); }

TEST(RobStrideGolden, AnOperationCommandHasItsTorqueInTheId) {
  expectFrame(codec("RS00").operate({.position_rad = 1.0,
                                     .velocity_rad_s = 0.0,
                                     .stiffness_nm_per_rad = 30.0,
                                     .damping_nms_per_rad = 1.0,
                                     .torque_nm = 2.0}),
              0x0192487F, {0x8A, 0x2E, 0x7F, 0xFF, 0x0F, 0x5C, 0x33, 0x33});
}

TEST(RobStrideGolden, EnableAndStopAreThoseOfTheManual) {
  expectFrame(codec("RS00").enable(), 0x0300FD7F, {});
  expectFrame(codec("RS00").stop(), 0x0400FD7F, {});
  expectFrame(codec("RS00").stop(true), 0x0400FD7F, {1});
}

TEST(RobStrideGolden, ParameterWritesAreLittleEndian) {
  expectFrame(codec("RS00").write(robstride::parameter::kPositionRef, 3.14F), 0x1200FD7F,
              {0x16, 0x70, 0, 0, 0xC3, 0xF5, 0x48, 0x40});
  expectFrame(codec("RS00").write(robstride::parameter::kRunMode, std::uint32_t{1}), 0x1200FD7F,
              {0x05, 0x70, 0, 0, 1, 0, 0, 0});
  expectFrame(codec("RS00").write(std::uint16_t{0x7028}, 100 * robstride::kTimeoutPerMs), 0x1200FD7F,
              {0x28, 0x70, 0, 0, 0xD0, 0x07, 0, 0});
}

TEST(RobStrideGolden, AParameterIsReadAsTheVendorPrintsIt) {
  expectFrame(codec("RS00").read(0x701E), 0x1100FD7F, {0x1E, 0x70});
  expectFrame(codec("RS00").parameter(0x701E, 0x41F00000, true), 0x11007FFD,
              {0x1E, 0x70, 0, 0, 0, 0, 0xF0, 0x41});
}

TEST(RobStrideGolden, FeedbackTellsAngleSpeedTorqueAndTemperature) {
  const auto seen =
      codec("RS00").feedback(frameOf(0x02807FFD, {0x70, 0xB9, 0x87, 0xC1, 0x86, 0x65, 0x01, 0x38}));
  EXPECT_NEAR(seen.position_rad, -1.50011, 1e-5);
  EXPECT_NEAR(seen.velocity_rad_s, 1.99959, 1e-5);
  EXPECT_NEAR(seen.torque_nm, 0.69963, 1e-5);
  EXPECT_NEAR(seen.temperature_c, 31.2, 1e-6);
  EXPECT_EQ(seen.mode, robstride::kRunning);
  EXPECT_EQ(seen.status_bits, 0);
  expectFrame(codec("RS00").answer(seen), 0x02807FFD, {0x70, 0xB9, 0x87, 0xC1, 0x86, 0x65, 0x01, 0x38});
}

TEST(RobStrideGolden, FeedbackTellsItsFaults) {
  const auto seen =
      codec("RS00", 1).feedback(frameOf(0x020501FD, {0x7F, 0xFF, 0x7F, 0xFF, 0x7F, 0xFF, 0x05, 0xAF}));
  EXPECT_EQ(seen.mode, 0);
  EXPECT_EQ(seen.status_bits, 0b000101);
  EXPECT_NEAR(seen.temperature_c, 145.5, 1e-6);
  EXPECT_EQ(robstride::faultOf(robstride::nativeCode(0, seen.status_bits), false),
            FaultCode::kDriveUnderVoltage);
}

TEST(RobStrideGolden, TheMotorReadsTheFeedbackInTheUsersUnits) {
  RobStride_Motor motor(robStrideSettings("RS00"));
  auto frame = frameOf(0x02807FFD, {0x70, 0xB9, 0x87, 0xC1, 0x86, 0x65, 0x01, 0x38});
  ASSERT_TRUE(motor.matchesFrame(frame));
  ASSERT_EQ(motor.updateFeedback(frame), FrameVerdict::kAccepted);
  EXPECT_NEAR(motor.feedback().total_angle_deg, -1.50011 * 180.0 / std::numbers::pi, 1e-3);
  EXPECT_NEAR(motor.feedback().velocity_rpm, 1.99959F * 30.0F / std::numbers::pi_v<float>, 1e-3F);
  EXPECT_NEAR(motor.feedback().torque_nm, 0.69963F, 1e-4F);
  // 1.48 N·m per Arms.
  EXPECT_NEAR(motor.feedback().current_a, 0.69963F / 1.48F * 1.41421F, 1e-4F);
  EXPECT_NEAR(motor.feedback().temperature_c, 31.2F, 1e-4F);
  EXPECT_TRUE(motor.feedback().zeroed);
}

}  // namespace
}  // namespace rc10::test::robstride_golden_test
