#include "drives/dji/dji_group.hpp"

#include <array>
#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

#include "support/dji_frames.hpp"

namespace rc10::test::dji_group_test {
namespace {

using namespace rc10::literals;

MotorSettings named(const char* name, MotorSettings config) {
  config.name = name;
  return config;
}

void command(DJI_Motor& motor, Amperes current) {
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetCurrent(current));
  motor.update(Tick{});
}

TEST(DjiGroup, EveryModelAndIdHasItsCommandIdAndSlot) {
  for (int id = 1; id <= 8; ++id) {
    for (const DjiModel* model : {&kM3508, &kM2006}) {
      const DJI_Motor motor(djiConfig(*model, id));
      EXPECT_EQ(motor.commandId(), (CanId{id <= 4 ? 0x200U : 0x1FFU, false}));
      EXPECT_EQ(motor.slot(), (id - 1) % 4);
    }
  }
  for (int id = 1; id <= 7; ++id) {
    const DJI_Motor current(djiConfig(kGM6020, id));
    EXPECT_EQ(current.commandId().value, id <= 4 ? 0x1FEU : 0x2FEU);
    const DJI_Motor voltage(djiConfig(kGM6020, id, DjiCommand::kVoltage));
    EXPECT_EQ(voltage.commandId().value, id <= 4 ? 0x1FFU : 0x2FFU);
  }
}

TEST(DjiGroup, AMotorMovesItsOwnSlotAndTheOthersStayZero) {
  DJI_Motor second(djiConfig(kM3508, 2));
  DJI_Group group({0x200, false});
  ASSERT_TRUE(group.registerMotor(second));
  command(second, -5_A);
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  ASSERT_EQ(group.packCommand(Tick{}, out), 1U);
  EXPECT_EQ(out[0].id, (CanId{0x200, false}));
  EXPECT_EQ(out[0].length, 8);
  EXPECT_FALSE(out[0].fd);
  const std::array<std::uint8_t, 8> expected{0, 0, 0xF0, 0, 0, 0, 0, 0};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), out[0].data.begin()));
}

TEST(DjiGroup, AMemberAtRestIsZeroWhileTheOthersRun) {
  DJI_Motor first(djiConfig(kM3508, 1));
  DJI_Motor second(djiConfig(kM2006, 2));
  DJI_Group group({0x200, false});
  ASSERT_TRUE(group.registerMotor(first));
  ASSERT_TRUE(group.registerMotor(second));
  command(first, 10_A);
  command(second, 10_A);
  first.order(FrameKind::kRest);
  first.update(Tick{});
  std::array<CanFrame, 1> out{};
  ASSERT_EQ(group.packCommand(Tick{}, out), 1U);
  EXPECT_EQ(out[0].data[0], 0);
  EXPECT_EQ(out[0].data[1], 0);
  EXPECT_EQ((out[0].data[2] << 8) | out[0].data[3], 10000);
}

TEST(DjiGroup, RestFramesAreZeroWhateverTheMembersDo) {
  DJI_Motor motor(djiConfig(kM3508, 3));
  DJI_Group group({0x200, false});
  ASSERT_TRUE(group.registerMotor(motor));
  command(motor, 20_A);
  std::array<CanFrame, 1> out{};
  out[0].data.fill(0xFF);
  ASSERT_EQ(group.packRest(out), 1U);
  EXPECT_EQ(out[0].length, 8);
  for (const auto byte : out[0].data) EXPECT_EQ(byte, 0);
}

TEST(DjiGroup, WithoutMembersOrRoomItPacksNothing) {
  DJI_Group group({0x200, false});
  std::array<CanFrame, 1> out{};
  EXPECT_EQ(group.packCommand(Tick{}, out), 0U);
  EXPECT_EQ(group.packRest(out), 0U);
  DJI_Motor motor(djiConfig(kM3508));
  ASSERT_TRUE(group.registerMotor(motor));
  EXPECT_EQ(group.packCommand(Tick{}, {}), 0U);
  EXPECT_EQ(group.packRest({}), 0U);
}

std::string refusal(DJI_Group& group, DJI_Motor& motor) {
  const auto result = group.registerMotor(motor);
  return result ? std::string{} : result.error().message;
}

TEST(DjiGroup, RefusesATakenSlotAndNamesBothMotors) {
  DJI_Motor first(named("front_left", djiConfig(kM3508, 2)));
  DJI_Motor second(named("front_right", djiConfig(kM2006, 2)));
  DJI_Group group({0x200, false});
  ASSERT_TRUE(group.registerMotor(first));
  const std::string message = refusal(group, second);
  EXPECT_EQ(
      message,
      "DJI group 0x200 refuses motor 'front_right' (M2006 id 2): its slot belongs to motor 'front_left' "
      "(M3508 id 2)");
  EXPECT_NE(refusal(group, first).find("registered already"), std::string::npos);
}

TEST(DjiGroup, RefusesAMotorThatListensToAnotherId) {
  DJI_Motor motor(named("yaw", djiConfig(kGM6020, 5)));
  DJI_Group group({0x200, false});
  EXPECT_NE(refusal(group, motor).find("'yaw' (GM6020 id 5): it listens to 0x2FE"), std::string::npos);
}

TEST(DjiGroup, RefusesGM6020VoltageBesideC620InOneFrameAndSaysWhatToDo) {
  for (const bool wheel_first : {true, false}) {
    DJI_Motor wheel(named("wheel", djiConfig(kM3508, 6)));
    DJI_Motor yaw(named("yaw", djiConfig(kGM6020, 1, DjiCommand::kVoltage)));
    DJI_Group group({0x1FF, false});
    ASSERT_TRUE(group.registerMotor(wheel_first ? wheel : yaw));
    const std::string message = refusal(group, wheel_first ? yaw : wheel);
    EXPECT_NE(message.find("'wheel'"), std::string::npos);
    EXPECT_NE(message.find("'yaw'"), std::string::npos);
    EXPECT_NE(message.find("command: current"), std::string::npos);
  }
}

TEST(DjiGroup, RefusesIdsThatNoDriveListensTo) {
  DJI_Motor motor(djiConfig(kM3508));
  DJI_Group stranger({0x201, false});
  EXPECT_NE(refusal(stranger, motor).find("no DJI drive listens"), std::string::npos);
  DJI_Group extended({0x200, true});
  EXPECT_NE(refusal(extended, motor).find("no DJI drive listens"), std::string::npos);
}

TEST(DjiGroup, C620OnIds5To8AndGM6020OnIds1To4ShareFeedbackFramesWhateverTheCommand) {
  for (int id = 1; id <= 4; ++id) {
    const DJI_Motor wheel(djiConfig(kM3508, id + 4));
    for (const auto kind : {DjiCommand::kCurrent, DjiCommand::kVoltage}) {
      const DJI_Motor yaw(djiConfig(kGM6020, id, kind));
      EXPECT_TRUE(overlaps(wheel.filters().front(), yaw.filters().front()));
    }
  }
  const DJI_Motor wheel(djiConfig(kM3508, 8));
  const DJI_Motor yaw(djiConfig(kGM6020, 5));
  EXPECT_FALSE(overlaps(wheel.filters().front(), yaw.filters().front()));
}

}  // namespace
}  // namespace rc10::test::dji_group_test
