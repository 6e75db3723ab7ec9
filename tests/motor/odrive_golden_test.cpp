// Frames of the public descriptions of CANSimple, both ways, by byte.
#include <array>
#include <initializer_list>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/odrive_settings.hpp"

namespace rc10::test::odrive_golden_test {
namespace {

using testing::ElementsAreArray;

CanFrame frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  return makeClassicFrame({id, false}, std::vector<std::uint8_t>(bytes));
}

void expectFrame(const CanFrame& actual, std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  EXPECT_EQ(actual.id, (CanId{id, false}));
  EXPECT_EQ(actual.type, FrameType::kData);
  EXPECT_FALSE(actual.fd);
  EXPECT_THAT(actual.payload(), ElementsAreArray(bytes));
}

TEST(OdriveGolden, APositionIsSentWithItsFeedForwards) {
  expectFrame(odrive::setInputPos(3, 2.5F, 1.5F, -0.25F), 0x06C,
              {0x00, 0x00, 0x20, 0x40, 0xDC, 0x05, 0x06, 0xFF});
}

TEST(OdriveGolden, AVelocityIsSentWithItsTorque) {
  expectFrame(odrive::setInputVel(3, -4.0F, 0.1F), 0x06D, {0x00, 0x00, 0x80, 0xC0, 0xCD, 0xCC, 0xCC, 0x3D});
}

TEST(OdriveGolden, AnAxisStateIsSentAsItsNumber) {
  expectFrame(odrive::setAxisState(3, odrive::AxisState::kClosedLoop), 0x067, {0x08, 0x00, 0x00, 0x00});
  expectFrame(odrive::setAxisState(0, odrive::AxisState::kIdle), 0x007, {0x01, 0x00, 0x00, 0x00});
}

// The documented vector asks for input mode 5, a trajectory; rc10d always asks for 1, passthrough.
TEST(OdriveGolden, AControlModeIsSentWithInputModePassthrough) {
  expectFrame(odrive::setControllerMode(3, odrive::ControlMode::kPosition), 0x06B,
              {0x03, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00});
}

// Not among the public vectors: by the same table.
TEST(OdriveGolden, TorqueLimitsAndClearingFollowTheTable) {
  expectFrame(odrive::setInputTorque(62, -0.25F), 0x7CE, {0x00, 0x00, 0x80, 0xBE});
  expectFrame(odrive::setLimits(3, 25.0F, 20.0F), 0x06F, {0x00, 0x00, 0xC8, 0x41, 0x00, 0x00, 0xA0, 0x41});
  expectFrame(odrive::clearErrors(3), 0x078, {0x00});
}

TEST(OdriveGolden, AHeartbeatOfFirmware05TellsErrorsAndFlags) {
  const auto motor = odriveMotor(odriveSettings("ODrive_v3"));
  EXPECT_EQ(motor->updateFeedback(frame(0x061, {0x40, 0x00, 0x00, 0x00, 0x01, 0x01, 0x00, 0x01})),
            FrameVerdict::kAccepted);
  // The flags repeat the motor's error and add one of the controller.
  EXPECT_EQ(motor->complaint().native_code, 0x240U);
  EXPECT_EQ(motor->complaint().fault, FaultCode::kDriveHardware);
}

TEST(OdriveGolden, AHeartbeatOfFirmware06TellsItsActiveErrors) {
  const auto motor = odriveMotor(odriveSettings("ODrive_S1"));
  EXPECT_EQ(motor->updateFeedback(frame(0x061, {0x00, 0x01, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00})),
            FrameVerdict::kAccepted);
  EXPECT_EQ(motor->complaint().native_code, 0x100U);
  EXPECT_EQ(motor->complaint().fault, FaultCode::kDriveOverVoltage);
}

TEST(OdriveGolden, EncoderEstimatesAreTurnsAndTurnsPerSecond) {
  const auto motor = odriveMotor(odriveSettings());
  EXPECT_EQ(motor->updateFeedback(frame(0x069, {0x00, 0x00, 0x00, 0xBE, 0x00, 0x00, 0x60, 0x40})),
            FrameVerdict::kAccepted);
  EXPECT_DOUBLE_EQ(motor->feedback().velocity_rpm, 210.0);
  // An unreferenced angle begins at 0, so the next frame shows the scale: three eighths of a turn on.
  const double before_deg = motor->feedback().total_angle_deg;
  EXPECT_EQ(motor->updateFeedback(frame(0x069, {0x00, 0x00, 0x80, 0x3E, 0x00, 0x00, 0x60, 0x40})),
            FrameVerdict::kAccepted);
  EXPECT_NEAR(motor->feedback().total_angle_deg - before_deg, 135.0, 1e-9);
}

TEST(OdriveGolden, TheBusVoltageIsInVolts) {
  const auto motor = odriveMotor(odriveSettings());
  EXPECT_EQ(motor->updateFeedback(frame(0x077, {0xCD, 0xCC, 0xC0, 0x41, 0x00, 0x00, 0xC0, 0x3F})),
            FrameVerdict::kAccepted);
  EXPECT_FLOAT_EQ(motor->feedback().voltage_v, 24.1F);
}

}  // namespace
}  // namespace rc10::test::odrive_golden_test
