// Writing into a drive's own memory: frames, reading back, trying again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "bus/frame_text.hpp"
#include "drives/damiao/damiao_family.hpp"
#include "drives/damiao/damiao_motor.hpp"
#include "drives/damiao/damiao_simulated.hpp"
#include "drives/myactuator/myactuator_family.hpp"
#include "drives/myactuator/myactuator_motor.hpp"
#include "drives/myactuator/myactuator_simulated.hpp"
#include "drives/robstride/robstride_family.hpp"
#include "drives/robstride/robstride_motor.hpp"
#include "drives/robstride/robstride_simulated.hpp"
#include "motor/drive_configuring.hpp"
#include "sim/solo_rig.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test::drive_setup_test {
namespace {

using Progress = DriveConfiguring::Progress;
using ::testing::Contains;
using ::testing::Not;

std::uint8_t indexOf(const DriveSetup& setup, std::string_view name) {
  const auto found = std::find_if(setup.settings.begin(), setup.settings.end(),
                                  [name](const DriveSetting& each) { return each.name == name; });
  EXPECT_NE(found, setup.settings.end()) << name;
  return static_cast<std::uint8_t>(found - setup.settings.begin());
}

/// A motor with its simulated drive, and what is to be written to it.
class DriveSetupTest : public ::testing::Test {
 protected:
  void useDamiao() {
    auto settings = defaultSettings(damiaoFamily(), "DM4310", 2);
    settings.own.set("master_id", 18.0);
    use(std::make_unique<Damiao_Motor>(settings), sim::makeDamiaoDrive(settings, {}), damiaoSetup());
  }
  void useRobStride(std::string_view model = "RS00") {
    auto settings = defaultSettings(robstrideFamily(), model, 3);
    settings.own.set("host_id", 253.0);
    use(std::make_unique<RobStride_Motor>(settings), sim::makeRobstrideDrive(settings, {}),
        robstrideSetup(model == "CyberGear"));
  }
  void useMyActuator() {
    const auto settings = defaultSettings(myactuatorFamily(), "RMD-X8-20", 4);
    use(std::make_unique<MyActuator_Motor>(settings, myactuatorFamily().traits(settings.model, settings.own)),
        sim::makeMyactuatorDrive(settings, {}), myactuatorSetup());
  }
  void use(std::unique_ptr<SoloMotor> motor, std::unique_ptr<sim::Drive> drive, const DriveSetup& setup) {
    rig = std::make_unique<SoloRig>(std::move(motor), std::move(drive));
    setup_ = &setup;
    rig->motor().order(FrameKind::kPoll);
    rig->run(std::chrono::milliseconds{100});
    (void)rig->takeSent();
  }

  void begin(std::string_view name, double value, bool save) {
    DriveWrite write;
    write.values[0] = {indexOf(*setup_, name), value};
    write.count = 1;
    write.save = save;
    rig->motor().driveConfiguring()->begin(write);
  }
  Progress finish() {
    auto& configuring = *rig->motor().driveConfiguring();
    for (int i = 0; i < 5000 && configuring.progress() == Progress::kPending; ++i) {
      rig->run(std::chrono::milliseconds{1});
    }
    return configuring.progress();
  }
  /// Frames sent since, as text; repeated ones once.
  std::vector<std::string> sent() {
    std::vector<std::string> out;
    for (const auto& frame : rig->takeSent()) {
      auto text = frameText(frame);
      if (std::find(out.begin(), out.end(), text) == out.end()) out.push_back(std::move(text));
    }
    return out;
  }
  std::ptrdiff_t times(const std::string& text) {
    const auto all = rig->takeSent();
    return std::count_if(all.begin(), all.end(),
                         [&text](const CanFrame& frame) { return frameText(frame) == text; });
  }

  std::unique_ptr<SoloRig> rig;
  const DriveSetup* setup_ = nullptr;
};

TEST_F(DriveSetupTest, ADamiaoRegisterIsWrittenReadBackAndStored) {
  useDamiao();
  begin("timeout_ms", 100, true);
  EXPECT_EQ(finish(), Progress::kDone);
  const auto frames = sent();
  EXPECT_THAT(frames, Contains("7FF#02005509D0070000")) << "DM-J manuals: TIMEOUT = 2000 x 50 us";
  EXPECT_THAT(frames, Contains("7FF#0200330900000000"));
  EXPECT_THAT(frames, Contains("7FF#0200AA0100000000"));
}

TEST_F(DriveSetupTest, ADamiaoFloatIsWrittenAsOne) {
  useDamiao();
  begin("p_max_rad", 12.5, false);
  EXPECT_EQ(finish(), Progress::kDone);
  EXPECT_THAT(sent(), Contains("7FF#0200551500004841"));
}

TEST_F(DriveSetupTest, NothingIsStoredUnlessAsked) {
  useDamiao();
  begin("timeout_ms", 100, false);
  EXPECT_EQ(finish(), Progress::kDone);
  EXPECT_THAT(sent(), Not(Contains("7FF#0200AA0100000000")));
}

TEST_F(DriveSetupTest, WhatIsStoredOutlivesARestartAndTheRestDoesNot) {
  useDamiao();
  for (const bool save : {false, true}) {
    begin("over_voltage_v", 30, save);
    ASSERT_EQ(finish(), Progress::kDone);
    rig->drive().restart();
    rig->run(std::chrono::milliseconds{50});
    (void)rig->takeReceived();
    rig->drive().receive(
        makeClassicFrame({0x7FF, false}, damiao::readRegister(2, damiao::Register::kOverVoltage)));
    rig->run(std::chrono::milliseconds{1});
    std::vector<std::string> answers;
    for (const auto& frame : rig->takeReceived()) answers.push_back(frameText(frame));
    EXPECT_THAT(answers, Contains(save ? "012#0200331D0000F041" : "012#0200331D00000000"));
  }
}

TEST_F(DriveSetupTest, AWriteThatGotLostIsWrittenAgain) {
  useDamiao();
  begin("timeout_ms", 100, true);
  rig->cut(true);
  rig->run(std::chrono::milliseconds{2});
  rig->cut(false);
  EXPECT_EQ(finish(), Progress::kDone);
  EXPECT_EQ(times("7FF#02005509D0070000"), 2);
}

TEST_F(DriveSetupTest, WhatCannotBeReadBackIsNotStored) {
  useDamiao();
  begin("timeout_ms", 100, true);
  rig->cut(true);
  EXPECT_EQ(finish(), Progress::kNotConfirmed);
  const auto frames = rig->takeSent();
  EXPECT_EQ(std::count_if(frames.begin(), frames.end(),
                          [](const CanFrame& f) { return frameText(f) == "7FF#02005509D0070000"; }),
            5);
  for (const auto& frame : frames) EXPECT_NE(frameText(frame), "7FF#0200AA0100000000");
}

TEST_F(DriveSetupTest, ADriveThatDoesNotSayThatItHasStoredIsTold) {
  useDamiao();
  begin("timeout_ms", 100, true);
  // Until the save frame has left: its answer, and all others, get lost.
  for (int i = 0; i < 1000; ++i) {
    rig->run(std::chrono::milliseconds{1}, [&] {
      for (const auto& frame : rig->takeSent()) {
        if (frameText(frame) == "7FF#0200330900000000") rig->cut(true);
      }
    });
    if (rig->motor().driveConfiguring()->progress() != Progress::kPending) break;
  }
  EXPECT_EQ(finish(), Progress::kNotSaved);
}

TEST_F(DriveSetupTest, NoTorqueAndNoCommandWhileItGoesOn) {
  useDamiao();
  begin("timeout_ms", 100, true);
  EXPECT_EQ(finish(), Progress::kDone);
  int told = 0;
  for (const auto& frame : rig->takeSent()) {
    if (frame.id.value != 0x7FF) {
      EXPECT_EQ(frameText(frame), "002#FFFFFFFFFFFFFFFD");
      ++told;
    }
  }
  EXPECT_GT(told, 0);
}

// Damiao: an id counts from the next start on.
TEST_F(DriveSetupTest, ANewDamiaoIdIsStoredUnderTheOldOneWhichAnswersOn) {
  useDamiao();
  begin("id", 5, true);
  EXPECT_EQ(finish(), Progress::kDone);
  const auto frames = sent();
  EXPECT_THAT(frames, Contains("7FF#0200AA0100000000"));
  EXPECT_THAT(frames, Not(Contains("7FF#0500AA0100000000"))) << "another drive may have it";
  rig->drive().restart();
  rig->run(std::chrono::milliseconds{5});
  (void)rig->takeReceived();
  rig->drive().receive(makeClassicFrame({0x7FF, false}, damiao::readRegister(5, damiao::Register::kId)));
  rig->run(std::chrono::milliseconds{1});
  std::vector<std::string> answers;
  for (const auto& frame : rig->takeReceived()) answers.push_back(frameText(frame));
  EXPECT_THAT(answers, Contains("012#0500330805000000"));
}

TEST_F(DriveSetupTest, ANewIdOfADamiaoThatDoesNotSayThatItIsStoredIsTold) {
  for (const auto& [name, value] : {std::pair{"id", 5.0}, std::pair{"master_id", 21.0}}) {
    useDamiao();
    rig->garble([](CanFrame& frame) {
      if (frame.data[2] == damiao::kSaveOperation) frame.length = 0;
    });
    begin(name, value, true);
    EXPECT_EQ(finish(), Progress::kNotSaved) << name;
    EXPECT_EQ(times("7FF#0200AA0100000000"), 3) << name;
  }
}

TEST_F(DriveSetupTest, ARobStrideParameterIsWrittenReadBackAndStored) {
  useRobStride();
  begin("timeout_ms", 1000, true);
  EXPECT_EQ(finish(), Progress::kDone);
  const auto frames = sent();
  EXPECT_THAT(frames, Contains("1200FD03#28700000204E0000")) << "20000 is 1 s";
  EXPECT_THAT(frames, Contains("1100FD03#2870000000000000"));
  EXPECT_THAT(frames, Contains("1600FD03#0102030405060708"));
}

TEST_F(DriveSetupTest, AWriteOfOurOwnToARobStrideThatRestsIsNoFault) {
  useRobStride();
  auto& motor = rig->motor();
  motor.order(FrameKind::kEnable);
  for (int i = 0; i < 2000 && motor.sequenceProgress() == SequenceProgress::kPending; ++i)
    rig->run(std::chrono::milliseconds{1});
  ASSERT_EQ(motor.sequenceProgress(), SequenceProgress::kDone);
  motor.order(FrameKind::kPoll);
  rig->run(std::chrono::milliseconds{10});
  begin("timeout_ms", 1000, false);
  EXPECT_EQ(finish(), Progress::kDone);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kNone);
}

// Its answer to any frame is that to the save frame, too.
TEST_F(DriveSetupTest, ARobStrideThatMissesTheSaveFrameIsNotTakenToHaveStored) {
  useRobStride();
  rig->lose([](const CanFrame& frame) { return frameText(frame).starts_with("1600FD"); });
  begin("timeout_ms", 1000, true);
  EXPECT_EQ(finish(), Progress::kNotSaved);
  EXPECT_EQ(times("1600FD03#0102030405060708"), 3);
}

// A first save frame that is lost leaves it unheard for half of its restart_silence at most.
TEST_F(DriveSetupTest, AroundTheSaveFrameOfARobStrideNothingElseIsSentToIt) {
  useRobStride();
  std::vector<MonotonicTime> saves;
  MonotonicTime last{};
  begin("timeout_ms", 1000, true);
  rig->lose([&](const CanFrame& frame) {
    const bool saved = frameText(frame).starts_with("1600FD");
    if (saved) {
      EXPECT_GE(rig->now() - last, std::chrono::milliseconds{10});
      saves.push_back(rig->now());
    } else if (!saves.empty()) {
      EXPECT_GE(rig->now() - saves.back(), std::chrono::milliseconds{90}) << frameText(frame);
    }
    last = rig->now();
    return saved;
  });
  EXPECT_EQ(finish(), Progress::kNotSaved);
  ASSERT_EQ(saves.size(), 3U);
  EXPECT_LE(saves[1] - saves[0], std::chrono::milliseconds{90 + 1 + 10 + 2});
}

// Its answers to what it was sent meanwhile come all at once.
TEST_F(DriveSetupTest, ARobStrideThatStoresFor150MsHasStoredAtTheSecondTry) {
  useRobStride();
  std::vector<MonotonicTime> saves;
  rig->lose([&](const CanFrame& frame) {
    if (frameText(frame).starts_with("1600FD")) saves.push_back(rig->now());
    const bool storing = saves.size() == 1 && rig->now() - saves[0] < std::chrono::milliseconds{150};
    rig->delay(storing ? std::chrono::milliseconds{150} : std::chrono::milliseconds{0});
    return false;
  });
  begin("timeout_ms", 1000, true);
  EXPECT_EQ(finish(), Progress::kDone);
  ASSERT_EQ(saves.size(), 2U);
  EXPECT_GE(saves[1] - saves[0], std::chrono::milliseconds{160});
  EXPECT_EQ(rig->motor().feedback().losses, 0U);
}

TEST_F(DriveSetupTest, ADriveThatIsGoneAfterTheSaveFrameIsNotToldToStoreAgain) {
  for (const bool damiao : {true, false}) {
    damiao ? useDamiao() : useRobStride();
    begin("timeout_ms", 1000, true);
    int saves = 0;
    MonotonicTime saved{};
    for (int i = 0; i < 5000 && rig->motor().driveConfiguring()->progress() == Progress::kPending; ++i) {
      rig->run(std::chrono::milliseconds{1});
      for (const auto& frame : rig->takeSent()) {
        const auto text = frameText(frame);
        if (text != "1600FD03#0102030405060708" && text != "7FF#0200AA0100000000") continue;
        ++saves;
        saved = rig->now();
        rig->cut(true);
      }
    }
    EXPECT_EQ(rig->motor().driveConfiguring()->progress(), Progress::kNotSaved);
    EXPECT_EQ(saves, 1);
    EXPECT_LE(rig->now() - saved, std::chrono::milliseconds{600});
    EXPECT_FALSE(rig->motor().driveConfiguring()->excusesSilence());
  }
}

TEST_F(DriveSetupTest, ALateAnswerToTheFrameBeforeIsNoneToTheSaveFrame) {
  useRobStride();
  rig->lose([](const CanFrame& frame) { return frameText(frame).starts_with("1600FD"); });
  rig->delay(std::chrono::milliseconds{5});
  begin("timeout_ms", 1000, true);
  EXPECT_EQ(finish(), Progress::kNotSaved);
}

TEST_F(DriveSetupTest, AReportIntervalIsCountedInStepsOfFive) {
  useRobStride();
  begin("report_interval_ms", 20, false);
  EXPECT_EQ(finish(), Progress::kDone);
  EXPECT_THAT(sent(), Contains("1200FD03#2670000003000000")) << "1 is 10 ms, each more 5";
}

TEST_F(DriveSetupTest, ANewRobStrideIdIsSeenByTheSilenceOfTheOldOneAndStoredUnderTheNewOne) {
  useRobStride();
  begin("id", 9, true);
  EXPECT_EQ(finish(), Progress::kDone);
  const auto frames = sent();
  EXPECT_THAT(frames, Contains("0709FD03#0000000000000000"));
  std::vector<std::string> answers;
  for (const auto& frame : rig->takeReceived()) answers.push_back(frameText(frame));
  EXPECT_THAT(answers, Contains(::testing::StartsWith("000009FE#"))) << "who it is now";
  EXPECT_THAT(frames, Contains("1600FD09#0102030405060708"));
}

TEST_F(DriveSetupTest, ACyberGearIsNeverSentTheFrameThatChangesItsBitRate) {
  useRobStride("CyberGear");
  begin("id", 9, true);
  EXPECT_EQ(finish(), Progress::kDone);
  const auto frames = rig->takeSent();
  EXPECT_FALSE(frames.empty());
  for (const auto& frame : frames) EXPECT_NE(frame.id.value >> 24U & 0x1FU, 0x16U);
}

TEST_F(DriveSetupTest, AnIdThatStaysIsNotConfirmed) {
  useRobStride();
  begin("id", 3, true);  // its own: it goes on answering
  EXPECT_EQ(finish(), Progress::kNotConfirmed);
}

TEST_F(DriveSetupTest, AMyActuatorAnswersWithACopyOfWhatItStored) {
  useMyActuator();
  begin("timeout_ms", 1000, true);
  EXPECT_EQ(finish(), Progress::kDone);
  EXPECT_THAT(sent(), Contains("144#B3000000E8030000")) << "Motion Protocol V4.2: 1000 ms";
}

TEST_F(DriveSetupTest, AMyActuatorAccelerationIsReadBack) {
  useMyActuator();
  begin("velocity_acceleration_deg_s2", 2000, true);
  EXPECT_EQ(finish(), Progress::kDone);
  const auto frames = sent();
  EXPECT_THAT(frames, Contains("144#43020000D0070000"));
  EXPECT_THAT(frames, Contains("144#4202000000000000"));
}

TEST_F(DriveSetupTest, AMyActuatorGetsItsIdByItselfAndNotAllOfTheBus) {
  useMyActuator();
  begin("id", 7, true);
  EXPECT_EQ(finish(), Progress::kDone);
  const auto frames = rig->takeSent();
  EXPECT_FALSE(frames.empty());
  for (const auto& frame : frames) EXPECT_EQ(frame.id.value, 0x144U);
}

TEST_F(DriveSetupTest, FlashIsWrittenThreeTimesAtMost) {
  useMyActuator();
  begin("timeout_ms", 1000, true);
  rig->cut(true);
  EXPECT_EQ(finish(), Progress::kNotConfirmed);
  EXPECT_EQ(times("144#B3000000E8030000"), 3);
}

TEST_F(DriveSetupTest, ACancelledOneSendsNothingMore) {
  useDamiao();
  begin("timeout_ms", 100, true);
  rig->run(std::chrono::milliseconds{1});
  rig->motor().driveConfiguring()->cancel();
  (void)rig->takeSent();
  rig->run(std::chrono::milliseconds{500});
  const auto frames = rig->takeSent();
  EXPECT_GE(frames.size(), 500U) << "it is told to rest on and on";
  for (const auto& frame : frames) EXPECT_NE(frame.id.value, 0x7FFU);
}

}  // namespace
}  // namespace rc10::test::drive_setup_test
