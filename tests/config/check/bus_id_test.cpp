// Drives of different families on one bus that would take each other's frames for their own.
#include <gmock/gmock.h>

#include "config/config_text.hpp"

namespace rc10::test::bus_id_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kVesc = "model: VESC, pole_pairs: 7, velocity_limit_rpm: 3000, command_divider: 10, ";
constexpr const char* kOdrive =
    "model: ODrive_S1, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600, "
    "command_divider: 10, feedback_hz: 100, ";
constexpr const char* kDamiao = "model: DM4310, command_divider: 10, ";
constexpr const char* kMoteus = "model: moteus, motor_kv_rpm_per_v: 100, command_divider: 10, ";

std::string robotOf(const std::vector<std::string>& motors, const std::string& bus = "") {
  std::string text = "robot: hero\nbuses:\n  - name: chassis\n    type: sim\n" + bus + "    motors:\n";
  for (const auto& motor : motors) text += "      - {" + motor + "}\n";
  return text;
}

TEST(BusIds, FamiliesThatDoNotMeetShareABus) {
  EXPECT_THAT(
      errorsOf(robotOf({"name: wheel, model: M3508, id: 1", kVesc + std::string{"name: shooter, id: 1"},
                        kDamiao + std::string{"name: arm, id: 15, master_id: 16"},
                        "name: lift, model: RS00, id: 9, command_divider: 10",
                        kOdrive + std::string{"name: belt, id: 3"}})),
      IsEmpty());
}

TEST(BusIds, ADamiaoMasterIdAmongDjiFeedbackIsNamedWithWhatIsFree) {
  EXPECT_THAT(errorsOf(robotOf({"name: wheel, model: M3508, id: 1",
                                kDamiao + std::string{"name: arm, id: 15, master_id: 0x201"}}))
                  .size(),
              1U)
      << "hexadecimal is refused";
  EXPECT_THAT(errorsOf(robotOf({"name: wheel, model: M3508, id: 1",
                                kDamiao + std::string{"name: arm, id: 15, master_id: 513"}})),
              ElementsAre(AllOf(HasSubstr("'wheel' (M3508 id 1)"), HasSubstr("'arm' (DM4310 id 15)"),
                                HasSubstr("both answer with 0x201"))));
}

TEST(BusIds, ADamiaoReadsTheLowByteOfDjiFeedback) {
  EXPECT_THAT(errorsOf(robotOf({"name: wheel, model: M3508, id: 1",
                                kDamiao + std::string{"name: arm, id: 1, master_id: 17"}})),
              ElementsAre(AllOf(HasSubstr("'wheel' answers with 0x201, which 'arm' takes for a command"),
                                HasSubstr("free for the DM4310: 2, 3"))));
}

TEST(BusIds, AnOdriveNodeOnTheIdsOfDjiIsRefused) {
  // 16 << 5 = 0x200: C620 commands.
  EXPECT_THAT(
      errorsOf(robotOf({"name: wheel, model: M3508, id: 1", kOdrive + std::string{"name: belt, id: 16"}})),
      ElementsAre(AllOf(HasSubstr("'wheel' (M3508 id 1) and 'belt' (ODrive_S1 id 16)"),
                        HasSubstr("free for the ODrive_S1: 0, 1, 2"))));
}

TEST(BusIds, TwoVescsWithOneIdAreRefused) {
  EXPECT_THAT(
      errorsOf(robotOf({kVesc + std::string{"name: a, id: 7"}, kVesc + std::string{"name: b, id: 7"}})),
      ElementsAre(AllOf(HasSubstr("'a' (VESC id 7) and 'b' (VESC id 7) both answer with"),
                        HasSubstr("(extended)"), HasSubstr("free for the VESC: "))));
}

TEST(BusIds, AVescOfTheNumbersOfDjiIsAnotherDrive) {
  EXPECT_THAT(
      errorsOf(robotOf({"name: wheel, model: M3508, id: 1", kVesc + std::string{"name: shooter, id: 1"}})),
      IsEmpty());
}

TEST(BusIds, AnFdDriveNeedsAnFdBus) {
  EXPECT_THAT(errorsOf(robotOf({kMoteus + std::string{"name: leg, id: 1"}})),
              ElementsAre(AllOf(HasSubstr("'leg' (moteus id 1) speaks CAN FD and the bus is a classic one"),
                                HasSubstr("add data_bitrate"))));
  EXPECT_THAT(errorsOf(robotOf({kMoteus + std::string{"name: leg, id: 1"}}, "    data_bitrate: 5000000\n")),
              IsEmpty());
}

TEST(BusIds, AClassicDriveDoesNotStandBesideFdFrames) {
  EXPECT_THAT(
      errorsOf(robotOf({kMoteus + std::string{"name: leg, id: 1"}, "name: wheel, model: M3508, id: 2"},
                       "    data_bitrate: 5000000\n")),
      ElementsAre(
          AllOf(HasSubstr("'wheel' (M3508 id 2) takes the CAN FD frames of 'leg' (moteus id 1) for errors"),
                HasSubstr("put them on two buses"))));
}

TEST(BusIds, TheDataPhaseIsNotSlowerThanTheRest) {
  EXPECT_THAT(errorsOf(robotOf({kMoteus + std::string{"name: leg, id: 1"}}, "    data_bitrate: 500000\n")),
              ElementsAre(HasSubstr("500000 bit/s is below the bit rate of 1000000")));
}

TEST(BusIds, ALoadThatDoesNotFitNamesTheDividerThatDoes) {
  std::vector<std::string> motors;
  for (int id = 1; id <= 8; ++id) {
    const auto n = std::to_string(id);
    motors.push_back("name: m" + n + ", model: DM4310, id: " + n + ", master_id: " + std::to_string(16 + id));
  }
  EXPECT_THAT(errorsOf(robotOf(motors)),
              ElementsAre(AllOf(HasSubstr("does not fit"), HasSubstr("command_divider: 3 or more"))));
  for (auto& motor : motors) motor += ", command_divider: 3";
  EXPECT_THAT(errorsOf(robotOf(motors)), IsEmpty());
}

}  // namespace
}  // namespace rc10::test::bus_id_test
