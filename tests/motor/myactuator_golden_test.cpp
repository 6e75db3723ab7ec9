// Frames published by the manufacturer (Motion Protocol V4.2) and vectors computed from it by hand.
#include <gtest/gtest.h>

#include "drives/myactuator/myactuator_frames.hpp"
#include "support/frame_bytes.hpp"

namespace rc10::test::myactuator_golden_test {
namespace {

using namespace myactuator;

TEST(MyActuatorGolden, CommandsAreThePublishedFrames) {
  EXPECT_EQ(textOf(currentCommand(1, -1.0)), "141#A10000009CFF0000");
  EXPECT_EQ(textOf(currentCommand(1, 1.0)), "141#A100000064000000");
  EXPECT_EQ(textOf(velocityCommand(1, -100.0)), "141#A2000000F0D8FFFF");
  EXPECT_EQ(textOf(velocityCommand(1, 100.0)), "141#A200000010270000");
  EXPECT_EQ(textOf(positionCommand(1, 360.0, 500.0)), "141#A400F401A08C0000");
  EXPECT_EQ(textOf(positionCommand(1, -360.0, 500.0)), "141#A400F4016073FFFF");
  EXPECT_EQ(textOf(positionCommand(2, -360.0, 360.0)), "142#A40068016073FFFF");
}

TEST(MyActuatorGolden, RequestsAreThePublishedFrames) {
  EXPECT_EQ(textOf(request(1, Code::kStatus)), "141#9A00000000000000");
  EXPECT_EQ(textOf(request(1, Code::kAngle)), "141#9200000000000000");
  EXPECT_EQ(textOf(request(1, Code::kUptime)), "141#B100000000000000");
  EXPECT_EQ(textOf(request(32, Code::kShutdown)), "160#8000000000000000");
}

TEST(MyActuatorGolden, TheMotionCommandIsThePublishedFrame) {
  EXPECT_EQ(textOf(motionCommand(1, {.position_rad = 10.0002,
                                     .velocity_rad_s = 1.0220,
                                     .stiffness_nm_per_rad = 10.0122,
                                     .damping_nms_per_rad = 1.0,
                                     .torque_nm = 10.0044})),
            "401#E66682E052333B55");
}

TEST(MyActuatorGolden, TheStatusReplyTellsTemperatureBrakeVoltageAndErrors) {
  const auto frame = frameOf("241#9A320001E5010400");
  const auto status = decodeStatus(frame.payload());
  EXPECT_EQ(status.temperature_c, 50);
  EXPECT_TRUE(status.brake_released);
  EXPECT_DOUBLE_EQ(status.voltage_v, 48.5);
  EXPECT_EQ(status.errors, 0x0004);
}

TEST(MyActuatorGolden, TheReadingReplyTellsTemperatureCurrentSpeedAndAngle) {
  const auto backwards = frameOf("241#A1329CFF0CFED3FF");
  auto reading = decodeReading(backwards.payload());
  EXPECT_EQ(reading.temperature_c, 50);
  EXPECT_DOUBLE_EQ(reading.current_a, -1.0);
  EXPECT_DOUBLE_EQ(reading.velocity_deg_s, -500.0);
  EXPECT_EQ(reading.angle_deg, -45);
  const auto forwards = frameOf("241#9C326400F4012D00");
  reading = decodeReading(forwards.payload());
  EXPECT_DOUBLE_EQ(reading.current_a, 1.0);
  EXPECT_DOUBLE_EQ(reading.velocity_deg_s, 500.0);
  EXPECT_EQ(reading.angle_deg, 45);
}

TEST(MyActuatorGolden, TheAngleReplyIsInHundredthsOfADegree) {
  const auto frame = frameOf("241#92000000A08C0000");
  EXPECT_EQ(decodeAngle(frame.payload()), 36000);
}

TEST(MyActuatorGolden, TheRunTimeReplyIsInMilliseconds) {
  const auto frame = frameOf("241#B100000000000010");
  EXPECT_EQ(decodeUptimeMs(frame.payload()), 268435456U);
}

TEST(MyActuatorGolden, TheMotionReplyTellsIdAngleSpeedAndTorque) {
  const auto frame = frameOf("501#01E66682EB550000");
  const auto reading = decodeMotion(frame.payload());
  EXPECT_EQ(reading.id, 1);
  EXPECT_NEAR(reading.angle_rad, 10.0, 0.001);
  EXPECT_NEAR(reading.velocity_rad_s, 1.021, 0.002);
  EXPECT_NEAR(reading.torque_nm, 10.004, 0.001);
}

}  // namespace
}  // namespace rc10::test::myactuator_golden_test
