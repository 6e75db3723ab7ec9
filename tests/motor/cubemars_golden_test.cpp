// Vectors of the CubeMars AK series module driver manual's formats, computed by hand and independently of
// this driver; the commands come out of motors, the feedback goes into them.
#include <array>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "support/cubemars_settings.hpp"
#include "support/frame_bytes.hpp"

namespace rc10::test::cubemars_golden_test {
namespace {

void expectFrame(const CanFrame& frame, CanId id, const std::string& hex) {
  const CanFrame expected = frameOf(id, hex);
  EXPECT_EQ(frame.id, expected.id);
  EXPECT_EQ(frame.length, expected.length);
  EXPECT_EQ(frame.data, expected.data);
  EXPECT_FALSE(frame.fd);
}

CanFrame servoSends(const Target& target, MotorSettings settings) {
  CubemarsServo motor(settings, setupOf(settings));
  EXPECT_TRUE(motor.setTarget(target));
  motor.order(FrameKind::kCommand);
  motor.update(Tick{});
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  EXPECT_EQ(motor.packCommand(Tick{}, out), 1U);
  return out[0];
}

MotorSettings servo() { return cubemarsSettings("AK80-9", 104); }

TEST(CubemarsGolden, AServoCurrentIsInMilliamperes) {
  expectFrame(servoSends({.mode = ControlMode::kCurrent, .value = -3.5}, servo()), {0x168, true}, "FFFFF254");
}

TEST(CubemarsGolden, ServoVelocityIsInElectricalTurns) {
  // 10000 erpm / (21 pole pairs * gear 9) = 5.5407 rad/s
  const double rpm = 5.540740 * 60.0 / (2.0 * 3.14159265358979);
  expectFrame(servoSends({.mode = ControlMode::kVelocity, .value = rpm}, servo()), {0x368, true}, "00002710");
}

TEST(CubemarsGolden, AServoPositionIsInTenThousandthsOfADegree) {
  expectFrame(servoSends({.mode = ControlMode::kTotalAngle, .value = 180.0}, servo()), {0x468, true},
              "001B7740");
}

TEST(CubemarsGolden, AServoPositionCarriesItsSpeedAndAcceleration) {
  auto settings = cubemarsSettings("AK80-9", 104, {{"acceleration_limit_rpm_per_s", 3000.0 / 189.0}});
  settings.velocity_limit_rpm = 5000.0F / 189.0F;
  expectFrame(servoSends({.mode = ControlMode::kTotalAngle, .value = 90.0}, settings), {0x668, true},
              "000DBBA001F4012C");
}

TEST(CubemarsGolden, ServoFeedbackTellsAngleSpeedCurrentAndTemperature) {
  const auto settings = servo();
  CubemarsServo motor(settings, setupOf(settings));
  const CanFrame frame = frameOf({0x2968, true}, "04D2FF0602372A00");
  ASSERT_TRUE(motor.matchesFrame(frame));
  ASSERT_EQ(motor.updateFeedback(frame), FrameVerdict::kAccepted);
  const auto& feedback = motor.feedback();
  EXPECT_NEAR(feedback.velocity_rpm, -2500.0 / 189.0, 1e-4);
  EXPECT_NEAR(feedback.current_a, 5.67, 1e-5);
  EXPECT_NEAR(feedback.torque_nm, 5.67 * 9 * 0.091, 1e-4);
  EXPECT_EQ(feedback.temperature_c, 42.0F);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kNone);
  // Its 123.4 degrees show in the way back to 0.
  const double before = feedback.total_angle_deg;
  CanFrame zero = frameOf({0x2968, true}, "0000FF0602372A00");
  ASSERT_EQ(motor.updateFeedback(zero), FrameVerdict::kAccepted);
  EXPECT_NEAR(before - motor.feedback().total_angle_deg, 123.4, 1e-9);
}

constexpr SpringLaw kSetpoint{.position_rad = 0.5,
                              .velocity_rad_s = 1.0,
                              .stiffness_nm_per_rad = 50.0,
                              .damping_nms_per_rad = 1.0,
                              .torque_nm = 2.0};

TEST(CubemarsGolden, AMitCommandHasTheBytesOfTheManual) {
  const CubemarsRanges ranges = findCubemarsModel("AK80-9")->ranges;
  expectFrame(cubemars::mitFrame(0x68, ranges, kSetpoint), {0x68, false}, "851E8281993338E3");
}

// CubeMars AK series manual, p. 63.
TEST(CubemarsGolden, TheSpeedScaleOfAnAk606EndsAt45RadPerSecond) {
  const CubemarsRanges ranges = findCubemarsModel("AK60-6")->ranges;
  expectFrame(cubemars::mitFrame(1, ranges, {.velocity_rad_s = 45.0}), {1, false}, "7FFFFFF0000007FF");
  expectFrame(cubemars::mitFrame(1, ranges, {.velocity_rad_s = 22.5}), {1, false}, "7FFFBFF0000007FF");
}

TEST(CubemarsGolden, AMitCommandOfAV3DriveHasAnotherOrder) {
  const CubemarsRanges ranges = findCubemarsModel("AK10-9-V3")->ranges;
  expectFrame(cubemars::mitV3Frame(0x68, ranges, kSetpoint), {0x868, true}, "199333851784884B");
}

TEST(CubemarsGolden, AMotorSendsTheMitCommandOfTheManual) {
  auto settings = cubemarsSettings("AK80-9", 0x68, {{"protocol", std::string{"mit"}}});
  CubemarsMit motor(settings, setupOf(settings));
  // At 0.5 rad nothing of it is bounded: the drive's sum is 2 N·m and 1 N·m/(rad/s).
  ASSERT_EQ(motor.updateFeedback(frameOf({0, false}, "68851E7FF7FF4600")), FrameVerdict::kAccepted);
  Target target{.mode = ControlMode::kImpedance,
                .value = 0.0,
                .velocity_ff_rpm = 9.549297F,
                .torque_ff_nm = 2.0F,
                .stiffness_nm_per_rad = 50.0F,
                .damping_nms_per_rad = 1.0F};
  target.value = motor.feedback().total_angle_deg;
  ASSERT_TRUE(motor.setTarget(target));
  motor.order(FrameKind::kCommand);
  motor.update(Tick{});
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  ASSERT_EQ(motor.packCommand(Tick{}, out), 1U);
  EXPECT_EQ(out[0].id, (CanId{0x68, false}));
  // One step at most: the position comes back from a code, and the vendor's code cuts off.
  EXPECT_NEAR((out[0].data[0] << 8) + out[0].data[1], 0x851E, 1);
  EXPECT_NEAR((out[0].data[2] << 4) + (out[0].data[3] >> 4), 0x828, 1);
  EXPECT_NEAR(((out[0].data[3] & 0xF) << 8) + out[0].data[4], 0x199, 1);
  EXPECT_NEAR((out[0].data[5] << 4) + (out[0].data[6] >> 4), 0x333, 1);
  EXPECT_NEAR(((out[0].data[6] & 0xF) << 8) + out[0].data[7], 0x8E3, 1);
}

TEST(CubemarsGolden, AMitReplyTellsAngleSpeedTorqueAndTemperature) {
  auto settings = cubemarsSettings("AK80-9", 104, {{"protocol", std::string{"mit"}}});
  CubemarsMit motor(settings, setupOf(settings));
  const CanFrame reply = frameOf({0, false}, "689EB87FF8004600");
  ASSERT_TRUE(motor.matchesFrame(reply));
  ASSERT_EQ(motor.updateFeedback(reply), FrameVerdict::kAccepted);
  const auto& feedback = motor.feedback();
  EXPECT_NEAR(feedback.velocity_rpm, -0.01221 * 30.0 / 3.14159265, 1e-3);
  EXPECT_NEAR(feedback.torque_nm, 0.00440, 1e-5);
  EXPECT_NEAR(feedback.current_a, 0.00440 / (9 * 0.091), 1e-5);
  EXPECT_EQ(feedback.temperature_c, 30.0F);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kNone);
  const double before = feedback.total_angle_deg;
  ASSERT_EQ(motor.updateFeedback(frameOf({0, false}, "687FFF7FF8004600")), FrameVerdict::kAccepted);
  EXPECT_NEAR(before - motor.feedback().total_angle_deg, (3.00011 + 0.00019) * 180.0 / 3.14159265, 0.02);
}

TEST(CubemarsGolden, OrdersOfMitModeAreThoseOfTheManual) {
  expectFrame(cubemars::mitOrderFrame(1, cubemars::MitOrder::kEnter), {1, false}, "FFFFFFFFFFFFFFFC");
  expectFrame(cubemars::mitOrderFrame(1, cubemars::MitOrder::kExit), {1, false}, "FFFFFFFFFFFFFFFD");
}

}  // namespace
}  // namespace rc10::test::cubemars_golden_test
