#include "module/imu.hpp"

#include <array>
#include <cmath>

#include <gmock/gmock.h>

#include "fake_robot.hpp"
#include "module/rangefinder.hpp"

namespace rc10::test::imu_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

enum Output : std::size_t { kYaw, kPitch, kRoll, kYawRate };
constexpr std::size_t kAge = 9;

ModuleSettings settings(const std::string& protocol) {
  ModuleSettings settings;
  settings.name = "imu";
  settings.own.set("protocol", protocol);
  if (protocol != "inputs") settings.own.set("port", std::string{"/dev/ttyX"});
  settings.own.set("baud", 115200.0);
  settings.own.set("max_age_ms", 50.0);
  settings.own.set("yaw_offset_deg", 90.0);
  return settings;
}

// WitMotion's packet of angles: 0x55 0x53, three int16 of 180 deg at 32768, version, sum.
std::array<std::uint8_t, 11> anglePacket(double roll_deg, double pitch_deg, double yaw_deg) {
  std::array<std::uint8_t, 11> packet{0x55, 0x53};
  std::size_t at = 2;
  for (const double angle_deg : {roll_deg, pitch_deg, yaw_deg, 0.0}) {
    const auto raw = static_cast<std::uint16_t>(static_cast<std::int16_t>(angle_deg / 180.0 * 32768.0));
    packet[at++] = static_cast<std::uint8_t>(raw & 0xFFU);
    packet[at++] = static_cast<std::uint8_t>(raw >> 8U);
  }
  std::uint8_t sum = 0;
  for (std::size_t i = 0; i < 10; ++i) sum = static_cast<std::uint8_t>(sum + packet[i]);
  packet[10] = sum;
  return packet;
}

TEST(Imu, GivesWhatItsStreamSaysWhileItIsYoung) {
  FakeRobot robot{1};
  const auto module = std::move(imuType().build(settings("witmotion"), outlineOf(1)).value());
  auto need = module->takeSerialNeed();
  ASSERT_TRUE(need.has_value());
  EXPECT_EQ(need->path, "/dev/ttyX");
  robot.update(*module);
  EXPECT_TRUE(std::isnan(module->outputs()[kYaw])) << "nothing has come yet";
  EXPECT_THAT(robot.events(), IsEmpty());
  need->protocol->parse_stream(anglePacket(10.0, -20.0, 135.0), robot.now());
  robot.update(*module);
  EXPECT_NEAR(module->outputs()[kYaw], -135.0, 0.02) << "135 + 90";
  EXPECT_NEAR(module->outputs()[kRoll], 10.0, 0.02);
  EXPECT_NEAR(module->outputs()[kAge], 1.0, 1e-9);
  for (int i = 0; i < 60; ++i) robot.update(*module);
  EXPECT_TRUE(std::isnan(module->outputs()[kYaw]));
  need->protocol->parse_stream(anglePacket(10.0, -20.0, 135.0), robot.now());
  robot.update(*module);
  EXPECT_THAT(robot.events(), ElementsAre(1U)) << "back";
}

TEST(Imu, SaysOnceThatItIsSilent) {
  FakeRobot robot{1};
  const auto module = std::move(imuType().build(settings("witmotion"), outlineOf(1)).value());
  auto need = module->takeSerialNeed();
  need->protocol->parse_stream(anglePacket(0.0, 0.0, 0.0), robot.now());
  int told = 0;
  for (int i = 0; i < 200; ++i) {
    robot.update(*module);
    told += static_cast<int>(robot.events().size());
  }
  EXPECT_EQ(told, 1);
}

TEST(Imu, TakesValuesFromAnotherProgram) {
  FakeRobot robot{1};
  const auto module = std::move(imuType().build(settings("inputs"), outlineOf(1)).value());
  EXPECT_FALSE(module->takeSerialNeed().has_value());
  std::array<double, 9> values{};
  values.fill(kNoSignal);
  values[kYaw] = -100.0;
  values[kYawRate] = 12.0;
  module->setInputs(values);
  robot.update(*module);
  EXPECT_NEAR(module->outputs()[kYaw], -10.0, 1e-9);
  EXPECT_EQ(module->outputs()[kYawRate], 12.0);
  EXPECT_TRUE(std::isnan(module->outputs()[kPitch]));
  module->clearInputs();
  robot.update(*module);
  EXPECT_TRUE(std::isnan(module->outputs()[kYaw]));
}

TEST(ImuType, APortBelongsToAStreamAndOnlyToOne) {
  auto stream = settings("hipnuc");
  stream.own = OwnValues{};
  stream.own.set("protocol", std::string{"hipnuc"});
  EXPECT_THAT(imuType().build(stream, outlineOf(1)).error().message, HasSubstr("port: is missing"));
  auto inputs = settings("inputs");
  inputs.own.set("port", std::string{"/dev/ttyX"});
  EXPECT_THAT(imuType().build(inputs, outlineOf(1)).error().message, HasSubstr("port: means nothing"));
}

TEST(Rangefinder, GivesADistanceWhileItIsYoungAndValid) {
  FakeRobot robot{1};
  ModuleSettings own;
  own.own.set("port", std::string{"/dev/ttyX"});
  own.own.set("unit", std::string{"cm"});
  own.own.set("max_age_ms", 50.0);
  const auto module = std::move(rangefinderType().build(own, outlineOf(1)).value());
  auto need = module->takeSerialNeed();
  // 1.23 m, strength 500, 25 C: (25 + 256) * 8 = 2248.
  std::array<std::uint8_t, 9> frame{0x59, 0x59, 123, 0, 0xF4, 0x01, 0xC8, 0x08, 0};
  for (std::size_t i = 0; i < 8; ++i) frame[8] = static_cast<std::uint8_t>(frame[8] + frame[i]);
  need->protocol->parse_stream(frame, robot.now());
  robot.update(*module);
  EXPECT_NEAR(module->outputs()[0], 1.23, 1e-6);
  EXPECT_EQ(module->outputs()[1], 500.0);
  for (int i = 0; i < 60; ++i) robot.update(*module);
  EXPECT_TRUE(std::isnan(module->outputs()[0]));
}

}  // namespace
}  // namespace rc10::test::imu_test
