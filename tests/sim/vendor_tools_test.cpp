// Simulated drives and the questions of their makers' tools, which rc10d itself never asks.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drives/damiao/damiao_simulated.hpp"
#include "drives/lktech/lktech_family.hpp"
#include "drives/lktech/lktech_simulated.hpp"
#include "drives/myactuator/myactuator_family.hpp"
#include "drives/myactuator/myactuator_simulated.hpp"
#include "drives/odrive/odrive_simulated.hpp"
#include "drives/robstride/robstride_simulated.hpp"
#include "support/damiao_motors.hpp"
#include "support/frame_bytes.hpp"
#include "support/odrive_settings.hpp"
#include "support/own_defaults.hpp"
#include "support/robstride_settings.hpp"

namespace rc10::test::vendor_tools_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<CanFrame> replies(sim::Drive& drive, const CanFrame& question) {
  drive.receive(question);
  std::vector<CanFrame> frames(sim::Drive::kMaxFrames);
  frames.resize(drive.answers(frames));
  return frames;
}

std::vector<std::string> answers(sim::Drive& drive, const CanFrame& question) {
  std::vector<std::string> texts;
  for (const auto& frame : replies(drive, question)) texts.push_back(textOf(frame));
  return texts;
}

CanFrame remote(std::uint32_t id) {
  CanFrame frame;
  frame.id = {id, false};
  frame.type = FrameType::kRemote;
  return frame;
}

TEST(VendorTools, AnOdriveAnswersRemoteFrames) {
  const auto v06 = sim::makeOdriveDrive(odriveSettings("ODrive_S1"), {});
  EXPECT_THAT(answers(*v06, remote(0x074)), ElementsAre("074#0000000000000000"));
  EXPECT_THAT(answers(*v06, remote(0x077)), ElementsAre("077#0000C04100000000"));  // 24 V
  EXPECT_THAT(answers(*v06, remote(0x07C)), ElementsAre("07C#0000000000000000"));
  EXPECT_EQ(answers(*v06, remote(0x075)).size(), 1U);
  EXPECT_EQ(answers(*v06, remote(0x061)).size(), 1U);
  EXPECT_EQ(answers(*v06, remote(0x069)).size(), 1U);
  EXPECT_THAT(answers(*v06, remote(0x094)), IsEmpty()) << "of another node";
  // The older firmware means something else by these two.
  const auto v05 = sim::makeOdriveDrive(odriveSettings("ODrive_v3"), {});
  EXPECT_THAT(answers(*v05, remote(0x075)), IsEmpty());
  EXPECT_THAT(answers(*v05, remote(0x07C)), IsEmpty());
  EXPECT_THAT(answers(*v05, remote(0x077)), ElementsAre("077#0000C04100000000"));
}

TEST(VendorTools, ARobStrideTellsItsIdAndAnswersWhoeverAsked) {
  const auto drive = sim::makeRobstrideDrive(robStrideSettings("RS00"), {});
  const auto ask = [&](std::uint32_t id) {
    const auto told = replies(*drive, makeClassicFrame({id, true}, std::array<std::uint8_t, 8>{}));
    EXPECT_EQ(told.size(), 1U);
    return told.empty() ? CanFrame{} : told.front();
  };
  const auto identity = ask(0x0000AA7F);
  EXPECT_EQ(identity.id, (CanId{0x00007FFE, true}));
  EXPECT_EQ(identity.length, 8);
  EXPECT_EQ(ask(0x0400AA7F).id, (CanId{0x02007FAA, true})) << "to 0xAA, who told it to stop";
  EXPECT_EQ(ask(0x0400FD7F).id, (CanId{0x02007FFD, true}));
}

TEST(VendorTools, ADamiaoTellsItsStateAndItsNameplate) {
  const auto drive = sim::makeDamiaoDrive(damiaoSettingsOf(), {});
  const auto ask = [&](std::uint8_t operation, std::uint8_t address) {
    return answers(*drive,
                   makeClassicFrame({0x7FF, false}, std::array<std::uint8_t, 8>{1, 0, operation, address}));
  };
  const auto state = ask(0xCC, 0);
  ASSERT_EQ(state.size(), 1U);
  EXPECT_EQ(state[0].substr(0, 6), "011#01");
  for (const int address : {1, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20}) {
    const auto told = ask(0x33, static_cast<std::uint8_t>(address));
    ASSERT_EQ(told.size(), 1U) << address;
    EXPECT_EQ(told[0].substr(0, 10), "011#010033");
    EXPECT_THAT(ask(0x55, static_cast<std::uint8_t>(address)), IsEmpty()) << "read only: " << address;
  }
  EXPECT_EQ(ask(0x33, 20)[0].substr(12), "00002041") << "a gear of 10";
  EXPECT_THAT(ask(0x33, 99), IsEmpty());
}

TEST(VendorTools, LkTechAndMyActuatorStop) {
  const auto stop = makeClassicFrame({0x143, false}, std::array<std::uint8_t, 8>{0x81});
  const auto lktech = sim::makeLktechDrive(defaultSettings(lktechFamily(), "LK-MG5010E-i10", 3), {});
  EXPECT_THAT(answers(*lktech, stop), ElementsAre("143#8100000000000000"));
  EXPECT_EQ(
      answers(*lktech, makeClassicFrame({0x143, false}, std::array<std::uint8_t, 8>{0x9A}))[0].substr(16, 2),
      "00")
      << "it is still on";
  const auto myactuator = sim::makeMyactuatorDrive(defaultSettings(myactuatorFamily(), "RMD-X8-20", 3), {});
  EXPECT_THAT(answers(*myactuator, stop), ElementsAre("243#8100000000000000"));
  const auto read = makeClassicFrame({0x143, false}, std::array<std::uint8_t, 8>{0x42, 1});
  EXPECT_EQ(answers(*myactuator, read).at(0).substr(0, 8), "243#4201");
}

}  // namespace
}  // namespace rc10::test::vendor_tools_test
