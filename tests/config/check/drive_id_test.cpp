// Ids that drives on one bus must not share.

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "support/dji_frames.hpp"

namespace rc10::test::drive_id_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Motors of 200 Hz, so that many fit on a bus; each stands in a line of its own from 6 on, its id in
/// the column after the model.
std::string robotWithMotors(const std::vector<std::string>& motors) {
  std::string text = "robot: hero\nbuses:\n  - name: chassis\n    type: sim\n    motors:\n";
  for (const auto& motor : motors) text += "      - {feedback_hz: 200, " + motor + "}\n";
  return text;
}

TEST(DriveIds, TwoDrivesOfOneFamilyNeedTwoIds) {
  EXPECT_THAT(
      errorsOf(robotWithMotors({"name: a, model: M3508, id: 3", "name: b, model: M2006, id: 1",
                                "name: c, model: M2006, id: 3", "name: d, model: M3508, id: 3"})),
      ElementsAre(
          "hero.yaml:8:55: buses[0].motors[2].id: 'a' (M3508 id 3), 'c' (M2006 id 3) and 'd' (M3508 id "
          "3) all answer with 0x203; give each its own: free for M3508: 2, 4, 5, 6, 7 and 8; free for "
          "M2006: 2, 4, 5, 6, 7 and 8"));
}

TEST(DriveIds, TheSameIdOnAnotherBusIsAnotherDrive) {
  EXPECT_THAT(
      errorsOf("robot: hero\nbuses:\n  - {name: x, type: sim, motors: [{name: a, model: M3508, id: 1}]}\n"
               "  - {name: y, type: sim, motors: [{name: b, model: M3508, id: 1}]}\n"),
      IsEmpty());
}

TEST(DriveIds, GM6020OneToFourAnswersLikeC6xxFiveToEight) {
  EXPECT_THAT(
      errorsOf(robotWithMotors({"name: wheel, model: M3508, id: 5", "name: yaw, model: GM6020, id: 1"})),
      ElementsAre("hero.yaml:7:58: buses[0].motors[1].id: 'wheel' (M3508 id 5) and 'yaw' (GM6020 id 1) both "
                  "answer with 0x205; give each its own: free for M3508: 1, 2, 3, 4, 6, 7 and 8; free for "
                  "GM6020: 2, 3, 4, 5, 6 and 7"));
}

TEST(DriveIds, OneCommandFrameIsNotReadAsCurrentsAndAsVoltages) {
  EXPECT_THAT(errorsOf(robotWithMotors(
                  {"name: wheel, model: M2006, id: 6", "name: yaw, model: GM6020, id: 1, command: voltage"})),
              ElementsAre("hero.yaml:7:58: buses[0].motors[1].id: 'wheel' (M2006 id 6) and 'yaw' (GM6020 id "
                          "1) read the command "
                          "frame 0x1FF, which holds either currents for C620 and C610 or voltages for "
                          "GM6020; give the GM6020 "
                          "an id of 5 to 7, or command: current"));
  EXPECT_THAT(
      errorsOf(robotWithMotors({"name: wheel, model: M2006, id: 6", "name: yaw, model: GM6020, id: 1"})),
      IsEmpty());
  EXPECT_THAT(errorsOf(robotWithMotors(
                  {"name: wheel, model: M2006, id: 6", "name: yaw, model: GM6020, id: 5, command: voltage"})),
              IsEmpty());
}

TEST(DriveIds, AClashOfBothKindsIsReportedOnce) {
  EXPECT_THAT(
      errorsOf(robotWithMotors(
          {"name: wheel, model: M3508, id: 5", "name: yaw, model: GM6020, id: 1, command: voltage"})),
      ElementsAre("hero.yaml:7:58: buses[0].motors[1].id: 'wheel' (M3508 id 5) and 'yaw' (GM6020 id 1) both "
                  "answer with "
                  "0x205; give each its own: free for M3508: 1, 2, 3 and 4; free for GM6020: 5, 6 and 7"));
}

TEST(DriveIds, WithoutAFreeIdItSaysSo) {
  std::vector<std::string> motors;
  for (int id = 1; id <= 8; ++id) {
    motors.push_back("name: m" + std::to_string(id) + ", model: M3508, id: " + std::to_string(id));
  }
  motors.emplace_back("name: m9, model: M2006, id: 8");
  EXPECT_THAT(
      errorsOf(robotWithMotors(motors)),
      ElementsAre(
          "hero.yaml:14:56: buses[0].motors[8].id: 'm8' (M3508 id 8) and 'm9' (M2006 id 8) both answer "
          "with 0x208; give each its own: no id is free for M3508; no id is free for M2006"));
}

TEST(DriveIds, AreThoseThatTheMotorsUse) {
  for (const DjiModel* model : djiModels()) {
    for (const auto command : {DjiCommand::kCurrent, DjiCommand::kVoltage}) {
      if (!model->command(command).exists()) continue;
      for (int id = 1; id <= model->max_id; ++id) {
        const MotorSettings config{.name = "a",
                                   .model = std::string{model->name},
                                   .id = id,
                                   .loops = model->command(command).default_loops,
                                   .own = djiOwn(command)};
        const DJI_Motor motor{config};
        EXPECT_EQ(djiCommandId(*model, command, id), motor.commandId());
        EXPECT_EQ(djiFeedbackId(*model, id), motor.filters()[0].id);
        EXPECT_EQ(djiSlot(id), motor.slot());
      }
    }
  }
}

}  // namespace
}  // namespace rc10::test::drive_id_test
