// Every command of each family's protocol, sent by somebody else to a motor that obeys us; and settings that
// somebody else writes to its drive, of which the drive's answer tells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"
#include "link/words.hpp"
#include "support/frame_bytes.hpp"

namespace rc10::test::foreign_frames_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMotor = 0;

struct Subject {
  const char* name;
  const char* motor;  ///< Its keys after the name.
  /// candump text of each command that moves, brakes, enables or stops such a drive, but for rc10d's own
  /// rest frame. From the protocols' documents, not from the families' tables.
  std::vector<const char*> commands;
  /// Questions and answers of others, and their settings.
  std::vector<const char*> none;
  const char* bus = "";
};

void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

const std::vector<Subject>& subjects() {
  static const std::vector<Subject> kSubjects{
      {"M3508",
       "model: M3508, id: 1, zero: power_on",
       {"200#03E8000000000000", "200#00000000000003E8"},
       {"1FF#03E8000000000000"}},
      {"GM6020",
       "model: GM6020, id: 5, command: current",
       {"2FE#0100000000000000"},
       {"1FE#0100000000000000"}},
      {"Vesc",
       "model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, feedback_hz: 500, "
       "motor_current_max_a: 40, kv_rpm_per_v: 190",
       {"0000000A#00002710",
        "0000010A#000003E8",
        "0000020A#000003E8",
        "0000030A#000003E8",
        "0000040A#0564EBA0",
        "00000A0A#00001388",
        "00000B0A#00001388",
        "00000C0A#00001388",
        "00000D0A#00001388",
        "0000130A#00",
        "00001F0A#",
        "0000370A#0000271000",
        "000001FF#000003E8",
        "00001FFF#",
        "0000150A#FFFFB1E000004E20",
        "0000160A#FFFFB1E000004E20",
        "0000170A#FFFFB1E000004E20",
        "0000180A#FFFFB1E000004E20",
        "0000190A#0000000000000000",
        "00001A0A#0000000000000000",
        "00001D0A#0000000000000000",
        "00001E0A#0000000000000000",
        "0000080A#640005000003E8",
        "0000080A#640008000003E8",
        "0000080A#64001D",
        "0000080A#640001"},
       {"0000110A#64", "0000080A#640004", "00001237#0A00", "0000010B#000003E8"}},
      {"DamiaoMit",
       "model: DM4310, id: 1, master_id: 17",
       {"001#8A3C7770A3199A65", "101#0000C03F00004040", "201#DB0FC9C0", "301#0000403FF401C409",
        "001#FFFFFFFFFFFFFFFC", "001#FFFFFFFFFFFFFFFE", "001#FFFFFFFFFFFFFFFB", "101#FFFFFFFFFFFFFFFD",
        "7FF#010055170000E041", "7FF#0100550900000000", "7FF#0100550A03000000"},
       {"7FF#0100331500000000", "7FF#0100CC0000000000", "7FF#020055170000E041", "002#8A3C7770A3199A65"}},
      {"DamiaoVelocity",
       "model: DM8009, id: 2, master_id: 18, control: velocity",
       {"002#8A3C7770A3199A65", "202#DB0FC9C0", "202#FFFFFFFFFFFFFFFC", "002#FFFFFFFFFFFFFFFD"},
       {"7FF#0200331500000000", "7FF#010055170000E041"}},
      {"RobStride",
       "model: RS00, id: 3",
       {"01924803#8A2E7FFF0F5C3333", "0300FD03#0000000000000000", "0400FD03#0100000000000000",
        "0400FE03#0000000000000000", "0600FD03#0100000000000000", "0709FD03#0000000000000000",
        "1200FD03#16700000C3F54840"},
       {"1100FD03#1E70000000000000", "0000FD03#0000000000000000", "0300FD04#0000000000000000"}},
      {"CubeMarsMit",
       "model: AK80-9, id: 6, protocol: mit",
       {"006#851E8281993338E3", "006#FFFFFFFFFFFFFFFC", "006#FFFFFFFFFFFFFFFE"},
       {"007#851E8281993338E3"}},
      {"CubeMarsV3",
       "model: AK10-9-V3, id: 7, protocol: mit_v3",
       {"00000807#199333851784884B", "00000107#FFFFF254", "00000307#00002710", "00000407#001B7740"},
       {"00000808#199333851784884B"}},
      {"CubeMarsServo",
       "model: AK80-9, id: 5",
       {"00000005#00002710", "00000105#FFFFF254", "00000205#000003E8", "00000305#00002710",
        "00000405#001B7740", "00000505#00", "00000605#000DBBA001F4012C"},
       {"00000106#FFFFF254"}},
      {"Moteus",
       "model: moteus, id: 7, motor_kv_rpm_per_v: 100",
       {"00008007#01000A", "00008007#01000F", "007#01000F", "0000807F#010000",
        "00008007#01000A0E200000803F000000401100501F01130D", "00008007#400106642073746F7050"},
       {"00008007#110011011F01", "00008007#400104636F6E66", "00008008#010000"},
       "data_bitrate: 5000000\n    "},
      {"OdriveS1",
       "model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: "
       "600, telemetry_hz: 100",
       {"102#", "107#08000000", "107#03000000", "10B#0300000001000000", "10C#00002040DC0506FF",
        "10D#000080C0CDCCCC3D", "10E#0000003F", "10F#0000A0410000A041", "116#00", "118#00", "119#00000000",
        "11F#", "104#01B2000000000000", "111#0000A041", "112#0000A0410000A041", "113#0000003F",
        "11A#0000A041", "11B#0000003E0000003F"},
       {"103#", "104#00B2000000000000", "109#", "127#08000000"}},
      {"OdriveV3",
       "model: ODrive_v3, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: "
       "600",
       {"102#", "107#08000000", "10B#0300000001000000", "10C#00002040DC0506FF", "10D#000080C0CDCCCC3D",
        "10E#0000003F", "10F#0000A0410000A041", "106#09000000", "110#", "116#", "118#", "119#00000000",
        "111#0000A041", "112#0000A0410000A041", "113#0000003F", "11A#0000A041", "11B#0000003E0000003F"},
       {"103#", "104#0100000000000000", "109#"}},
      {"MyActuator",
       "model: RMD-X8-20, id: 11",
       {"280#8000000000000000", "14B#8100000000000000", "14B#7600000000000000", "14B#7700000000000000",
        "14B#7800000000000000", "14B#A10000009CFF0000", "14B#A2000000F0D8FFFF", "14B#A400F401A08C0000",
        "14B#A600F401A08C0000", "14B#A800F401A08C0000", "280#8100000000000000", "280#7600000000000000",
        "280#7700000000000000", "280#7800000000000000", "280#A10000009CFF0000", "40B#E66682E052333B55"},
       {"14B#9C00000000000000", "14B#7000000000000000", "14B#B200000000000000", "24B#7600000000000000",
        "24B#8100000000000000", "14C#7600000000000000"}},
      {"LkTech",
       "model: LK-MG5010E-i10, id: 12",
       {"14C#8000000000000000", "14C#8100000000000000", "14C#8800000000000000", "14C#8C00000000000000",
        "14C#9B00000000000000", "14C#A000000064000000", "14C#A10000000CFE0000", "14C#A200640010270000",
        "14C#A300000060730000", "14C#A400680160730000", "14C#A500000060730000", "14C#A600680160730000",
        "14C#A700000060730000", "14C#A800680160730000"},
       {"14C#9A00000000000000", "14C#9200000000000000", "14C#9B1EF0FF00000000", "14C#A128F80098FE00C0",
        "14D#8800000000000000"}},
      {"LkTechOfAGroup",
       "model: LK-MG5010E-i10, id: 2",
       {"280#640038FF2C0130F8", "281#640038FF2C0130F8", "282#640038FF2C0130F8", "288#640038FF2C0130F8",
        "142#8800000000000000"},
       {"142#9A00000000000000"}},
  };
  return kSubjects;
}

RobotConfig configOf(const Subject& subject) {
  const std::string text = std::string{"robot: rest\nrealtime: preferred\nbuses:\n  - name: bench\n"} +
                           "    type: sim\n    " + subject.bus + "motors:\n      - {name: motor, " +
                           subject.motor + "}\n";
  auto outcome = parseRobotConfig(text, "foreign.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

class ForeignFramesTest : public ::testing::TestWithParam<Subject> {
 protected:
  void start(const Subject& subject) {
    robot = std::make_unique<VirtualRobot>(configOf(subject));
    for (int attempt = 0; attempt < 5 && status() != MotorStatus::kActive; ++attempt) {
      robot->run(1000);
      robot->order(Operation::kEnable);
    }
    ASSERT_EQ(status(), MotorStatus::kActive);
    robot->hold(kMotor, kTurning, 200);
  }
  MotorStatus status() { return robot->motor(kMotor).status; }
  FaultCode fault() { return robot->motor(kMotor).fault; }
  std::string words() { return std::string{link::faultText(static_cast<std::int32_t>(fault()))}; }
  void foreign(std::string text, bool here) {
    std::erase(text, ' ');
    CanFrame frame = frameOf(text);
    frame.fd = frame.length > 8;
    frame.received = robot->now();
    frame.sent_here = here;
    ASSERT_TRUE(robot->inboxes()[0].frames.push(frame));
  }
  void threeIn30Ms(const char* text, bool here) {
    for (int i = 0; i < 3; ++i) {
      foreign(text, here);
      robot->hold(kMotor, kTurning, 10);
    }
  }

  static constexpr Target kTurning{.mode = ControlMode::kVelocity, .value = 30.0};
  std::unique_ptr<VirtualRobot> robot;
};

TEST_P(ForeignFramesTest, EachCommandOfTheProtocolIsAFaultWhenItComesThreeTimes) {
  for (const char* command : GetParam().commands) {
    for (const bool here : {false, true}) {
      ASSERT_NO_FATAL_FAILURE(start(GetParam()));
      threeIn30Ms(command, here);
      EXPECT_EQ(fault(), FaultCode::kForeignCommands) << command << ", " << here << ": " << words();
    }
  }
}

TEST_P(ForeignFramesTest, QuestionsAnswersAndFramesToOtherDrivesAreNone) {
  ASSERT_NO_FATAL_FAILURE(start(GetParam()));
  for (const char* text : GetParam().none) {
    threeIn30Ms(text, false);
    ASSERT_EQ(status(), MotorStatus::kActive) << text << ": " << words();
  }
}

INSTANTIATE_TEST_SUITE_P(All, ForeignFramesTest, ::testing::ValuesIn(subjects()),
                         [](const auto& subject) { return std::string{subject.param.name}; });

// ---- Settings

class ForeignSettingTest : public ForeignFramesTest {
 protected:
  DriveComplaint complaint() { return robot->robot().motors()[kMotor].motor->complaint(); }
  /// To the drive, not to rc10d.
  void toDrive(const std::string& text) { robot->simBus().receive(frameOf(text)); }
};

const Subject kDamiao{"Damiao", "model: DM4310, id: 1, master_id: 17", {}, {}};
const Subject kRobStride{"RobStride", "model: RS00, id: 3", {}, {}};

TEST_F(ForeignSettingTest, AScaleModeOrWatchdogOfADamiaoThatIsWrittenWhileItObeysStopsItWithinATick) {
  for (const auto& [write, code] :
       {std::pair{"7FF#0100551500004842", 0x115U}, std::pair{"7FF#0100551600004842", 0x116U},
        std::pair{"7FF#010055170000E041", 0x117U}, std::pair{"7FF#0100550900000000", 0x109U},
        std::pair{"7FF#0100550A03000000", 0x10AU}}) {
    ASSERT_NO_FATAL_FAILURE(start(kDamiao));
    toDrive(write);
    (void)robot->takeFrames();
    robot->command(kMotor, kTurning);
    robot->tick();
    EXPECT_EQ(complaint().native_code, code) << write;
    EXPECT_EQ(complaint().fault, FaultCode::kDriveSetting);
    for (int i = 0; i < 20; ++i) {
      for (const auto& frame : robot->takeFrames()) {
        EXPECT_TRUE(robot->robot().buses()[0].bus->isRest(frame)) << write;
        robot->simBus().receive(frame);
      }
      robot->command(kMotor, kTurning);
      robot->tick();
    }
    EXPECT_EQ(fault(), FaultCode::kDriveSetting) << words();
  }
}

TEST_F(ForeignSettingTest, WhatADamiaoTellsOthersAndIsAsPlannedStopsNothing) {
  ASSERT_NO_FATAL_FAILURE(start(kDamiao));
  for (const char* text :
       {"7FF#0100331500000000", "7FF#0100331700000000", "7FF#0100330900000000", "7FF#0100330A00000000",
        "7FF#0100550A01000000", "7FF#0100331000000000", "7FF#0100550600002041", "7FF#0100335100000000"}) {
    toDrive(text);
    robot->hold(kMotor, kTurning, 10);
    ASSERT_EQ(status(), MotorStatus::kActive) << text << ": " << words();
  }
}

TEST_F(ForeignSettingTest, ADamiaoIsEnabledAnewOnceItsScaleIsTheRightOneAgain) {
  ASSERT_NO_FATAL_FAILURE(start(kDamiao));
  toDrive("7FF#010055170000E041");
  robot->hold(kMotor, kTurning, 10);
  robot->order(Operation::kClear);
  robot->order(Operation::kEnable);
  robot->run(300);
  EXPECT_EQ(fault(), FaultCode::kDriveSetting) << "still the other scale";
  toDrive("7FF#0100551700002041");
  robot->order(Operation::kClear);
  robot->run(100);
  robot->order(Operation::kEnable);
  EXPECT_EQ(status(), MotorStatus::kActive) << words();
}

TEST_F(ForeignSettingTest, AParameterOfARobStrideThatReadsOtherwiseThanItWasSetStopsIt) {
  ASSERT_NO_FATAL_FAILURE(start(kRobStride));
  toDrive("1100FD03#0B70000000000000");
  toDrive("1100FD03#2870000000000000");
  robot->hold(kMotor, kTurning, 10);
  ASSERT_EQ(status(), MotorStatus::kActive) << words();
  toDrive("1200FD03#2870000000000000");
  toDrive("1100FD03#2870000000000000");
  robot->hold(kMotor, kTurning, 10);
  EXPECT_EQ(fault(), FaultCode::kDriveSetting) << words();
  EXPECT_EQ(complaint().native_code, 0x40007028U);
}

}  // namespace
}  // namespace rc10::test::foreign_frames_test
