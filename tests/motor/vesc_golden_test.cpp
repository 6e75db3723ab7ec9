// VESC frames with values from public documents: vedderb/bldc documentation/comm_can.md and comm/comm_can.c.
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/vesc_motors.hpp"

namespace rc10::test::vesc_golden_test {
namespace {

struct CommandVector {
  const char* what;
  int id;
  int pole_pairs;
  double motor_current_max_a;
  bool relative;
  double handbrake_a;
  Target target;
  std::uint32_t frame_id;
  const char* payload;
};

const std::vector<CommandVector>& commands() {
  using Mode = ControlMode;
  static const std::vector<CommandVector> list{
      {"SET_CURRENT 51 A", 23, 7, 100, false, 0, {.mode = Mode::kCurrent, .value = 51.0}, 0x117, "0000C738"},
      {"SET_DUTY -0.25", 1, 7, 60, false, 0, {.mode = Mode::kDuty, .value = -0.25}, 0x001, "FFFF9E58"},
      {"SET_RPM 1000 rpm, 21 pole pairs",
       5,
       21,
       60,
       false,
       0,
       {.mode = Mode::kVelocity, .value = 1000.0},
       0x305,
       "00005208"},
      {"SET_CURRENT_REL -0.5",
       1,
       7,
       60,
       true,
       0,
       {.mode = Mode::kCurrent, .value = -30.0},
       0xA01,
       "FFFF3CB0"},
      {"SET_CURRENT_BRAKE 10 A", 1, 7, 60, false, 0, {.mode = Mode::kBrake}, 0x201, "00002710"},
      {"SET_CURRENT_HANDBRAKE 5 A", 1, 7, 60, false, 5, {.mode = Mode::kBrake}, 0xC01, "00001388"},
  };
  return list;
}

TEST(VescGolden, CommandsHaveTheBytesOfTheDocuments) {
  for (const auto& vector : commands()) {
    SCOPED_TRACE(vector.what);
    auto settings = vescSettings({{"pole_pairs", static_cast<double>(vector.pole_pairs)},
                                  {"motor_current_max_a", vector.motor_current_max_a},
                                  {"relative_current", vector.relative ? 1.0 : 0.0},
                                  {"handbrake_current_a", vector.handbrake_a},
                                  {"angle", std::string{"none"}},
                                  {"ask_status", 0.0}});
    settings.id = vector.id;
    VESC_Motor motor(settings);
    const Tick tick{.index = 1, .now = MonotonicTime{std::chrono::seconds{5}}};
    auto status = vescFrame(vesc::canId(vesc::Packet::kStatus1, vector.id).value, "0000000000000000");
    status.received = tick.now;
    ASSERT_EQ(motor.updateFeedback(status), FrameVerdict::kAccepted);  // it stands still
    motor.order(FrameKind::kCommand);
    ASSERT_TRUE(motor.setTarget(vector.target));
    motor.update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    ASSERT_EQ(motor.packCommand(tick, out), 1U);
    const CanFrame expected = vescFrame(vector.frame_id, vector.payload);
    EXPECT_EQ(out[0].id, expected.id);
    EXPECT_EQ(out[0].length, 4);
    EXPECT_EQ(out[0].data, expected.data);
  }
}

TEST(VescGolden, APositionHasTheBytesOfTheDocuments) {
  auto settings = vescSettings({{"angle", std::string{"encoder"}}, {"ask_status", 0.0}});
  settings.id = 1;
  VESC_Motor motor(settings);
  const Tick tick{.index = 1, .now = MonotonicTime{std::chrono::seconds{5}}};
  for (auto status : {vescFrame(0x901, "0000000000000000"), vescFrame(0x1001, "0159020000000F96")}) {
    status.received = tick.now;  // 0 rpm, 79.80 deg
    ASSERT_EQ(motor.updateFeedback(status), FrameVerdict::kAccepted);
  }
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTarget({.mode = ControlMode::kAngle, .value = 90.5}));
  motor.update(tick);
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  ASSERT_EQ(motor.packCommand(tick, out), 1U);
  EXPECT_EQ(out[0].id, (CanId{0x401, true}));
  EXPECT_EQ(out[0].data, vescFrame(0x401, "0564EBA0").data);
}

TEST(VescGolden, StatusFramesHaveTheValuesOfTheDocuments) {
  const auto one = vesc::decodeStatus1(vescFrame(0x907, "FFFFCFC7FF63FE50"));
  EXPECT_EQ(one.erpm, -12345);
  EXPECT_FLOAT_EQ(one.current_a, -15.7F);
  EXPECT_FLOAT_EQ(one.duty, -0.432F);
  const auto four = vesc::decodeStatus4(vescFrame(0x1007, "01590200FFE91199"));
  EXPECT_FLOAT_EQ(four.drive_c, 34.5F);
  EXPECT_FLOAT_EQ(four.motor_c, 51.2F);
  EXPECT_FLOAT_EQ(four.input_a, -2.3F);
  EXPECT_FLOAT_EQ(four.position_deg, 90.1F);
  const auto five = vesc::decodeStatus5(vescFrame(0x1B07, "0000313801E10000"));
  EXPECT_EQ(five.steps, 12600);
  EXPECT_FLOAT_EQ(five.input_v, 48.1F);
  const auto six = vesc::decodeStatus6(vescFrame(0x3A07, "06720CE4000001F4"));
  EXPECT_FLOAT_EQ(six.adc1_v, 1.65F);
  EXPECT_FLOAT_EQ(six.adc2_v, 3.3F);
  EXPECT_FLOAT_EQ(six.adc3_v, 0.0F);
  EXPECT_FLOAT_EQ(six.ppm, 0.5F);
  const auto two = vesc::decodeStatus2(vescFrame(0xE07, "0000303900002710"));
  EXPECT_DOUBLE_EQ(two.charge_used_ah, 1.2345);
  EXPECT_DOUBLE_EQ(two.charge_returned_ah, 1.0);
  const auto three = vesc::decodeStatus3(vescFrame(0xF07, "0001E240FFFFFFFF"));
  EXPECT_DOUBLE_EQ(three.energy_used_wh, 12.3456);
  EXPECT_DOUBLE_EQ(three.energy_returned_wh, -0.0001);
}

TEST(VescGolden, AHundredTurnsOfTwentyOnePolePairsAreAHundredTurns) {
  VESC_Motor motor(vescSettings({{"pole_pairs", 21.0}}));
  for (auto frame : {vescFrame(0x907, "0000000000000000"), vescFrame(0x1B07, "0000313801E10000")}) {
    frame.received = MonotonicTime{std::chrono::seconds{1}};
    ASSERT_EQ(motor.updateFeedback(frame), FrameVerdict::kAccepted);
  }
  EXPECT_NEAR(motor.feedback().total_angle_deg, 0.0, 1e-9);  // it begins at 0, without a reference
  ASSERT_TRUE(motor.setZero(36'000.0));
  EXPECT_NEAR(motor.feedback().total_angle_deg, 36'000.0, 1e-6);
  EXPECT_FLOAT_EQ(motor.feedback().voltage_v, 48.1F);
}

TEST(VescGolden, AQuestionAndItsAnswerFitIntoAFrameEach) {
  const CanFrame question = vesc::makeQuestion(7, 0xFD, vesc::kAskFault);
  EXPECT_EQ(question.id, (CanId{0x807, true}));
  EXPECT_EQ(question.length, 7);
  EXPECT_EQ(question.data, vescFrame(0x807, "FD003200008000").data);
  const auto answer = vesc::decodeAnswer(vescFrame(0x8FD, "0701320000800005"));
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->mask, vesc::kAskFault);
  EXPECT_EQ(answer->value, 5);
}

}  // namespace
}  // namespace rc10::test::vesc_golden_test
