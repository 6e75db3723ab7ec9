#include "drives/lktech/lktech_group.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "bus/fdcan_bus.hpp"
#include "motor/lktech_bench.hpp"

namespace rc10::test::lktech_group_test {
namespace {

using namespace lktech_bench;
using testing::ElementsAre;
using testing::HasSubstr;

class LKTechGroup : public testing::Test {
 protected:
  static std::string packed(LKTech_Group& group) {
    std::array<CanFrame, 4> out{};
    return group.packCommand(Tick{}, out) == 1 ? textOf(out[0]) : "";
  }
  static void tell(LKTech_Motor& motor, double amperes, std::uint64_t index = 0) {
    motor.order(FrameKind::kCommand, {.mode = ControlMode::kCurrent, .value = amperes});
    CanFrame reply = readingReply(0, 0, 0x2000);
    CanFrame turns = angleReply(4500);
    reply.received = turns.received = MonotonicTime{std::chrono::hours{1}};
    (void)motor.updateFeedback(reply);
    (void)motor.updateFeedback(turns);
    motor.update(Tick{.index = index, .now = reply.received, .dt_s = 0.001F});
  }
};

TEST_F(LKTechGroup, PacksEachMembersCurrentIntoItsSlot) {
  LKTech_Group group;
  auto one = motorOf(settingsOf("LK-MF9025", 1, true));
  auto four = motorOf(settingsOf("LK-MF9025", 4, true));
  ASSERT_TRUE(group.registerMotor(*one));
  ASSERT_TRUE(group.registerMotor(*four));
  tell(*one, 100 * 33.0 / 4096.0);
  tell(*four, -2000 * 33.0 / 4096.0);
  EXPECT_EQ(packed(group), "280#640000000000A3F9") << "its peak current is less than the frame could say";
  std::array<CanFrame, 4> out{};
  for (std::size_t i = 0; i < one->packCommand(Tick{}, out); ++i) EXPECT_NE(out[i].data[0], 0xA1);
}

TEST_F(LKTechGroup, AMemberAtRestHasAZeroAndTheOthersRun) {
  LKTech_Group group;
  auto one = motorOf(settingsOf("LK-MF9025", 1, true));
  auto two = motorOf(settingsOf("LK-MF9025", 2, true));
  ASSERT_TRUE(group.registerMotor(*one) && group.registerMotor(*two));
  tell(*one, 1.0);
  tell(*two, 1.0);
  two->order(FrameKind::kPoll);
  two->update(Tick{});
  EXPECT_EQ(packed(group), "280#7C00000000000000");
}

TEST_F(LKTechGroup, RestIsAFrameOfZerosAndMembersLeaveItToTheGroup) {
  LKTech_Group group;
  std::array<CanFrame, 4> out{};
  EXPECT_EQ(group.packRest(out), 0U);
  auto one = motorOf(settingsOf("LK-MF9025", 1, true));
  ASSERT_TRUE(group.registerMotor(*one));
  ASSERT_EQ(group.packRest(out), 1U);
  EXPECT_EQ(textOf(out[0]), "280#0000000000000000");
  EXPECT_EQ(one->packRest(out), 0U);
}

TEST_F(LKTechGroup, NothingIsSentWhenNoMembersTurnHasCome) {
  LKTech_Group group;
  auto settings = settingsOf("LK-MF9025", 1, true);
  settings.command_divider = 2;
  auto one = motorOf(settings);
  ASSERT_TRUE(group.registerMotor(*one));
  tell(*one, 1.0, 1);
  EXPECT_EQ(packed(group), "280#7C00000000000000") << "another order does not wait for its turn";
  tell(*one, 1.0, 2);
  EXPECT_EQ(packed(group), "280#7C00000000000000");
  tell(*one, 1.0, 3);
  EXPECT_EQ(packed(group), "");
  tell(*one, 1.0, 4);
  group.onUnsent();
  tell(*one, 1.0, 5);
  EXPECT_EQ(packed(group), "280#7C00000000000000") << "the last one was not sent";
  tell(*one, 1.0, 7);
  EXPECT_EQ(packed(group), "");
}

TEST_F(LKTechGroup, RefusesTakenSlotsAndMotorsWithoutOneNamingThem) {
  LKTech_Group group;
  auto one = motorOf(settingsOf("LK-MF9025", 1, true));
  auto again = motorOf(settingsOf("LK-MG5010E-i10", 1, true));
  auto far = motorOf(settingsOf("LK-MF9025", 5, true));
  auto single = motorOf(settingsOf("LK-MF9025", 2));
  ASSERT_TRUE(group.registerMotor(*one));
  EXPECT_THAT(group.registerMotor(*one).error().message, HasSubstr("already"));
  EXPECT_THAT(group.registerMotor(*again).error().message, HasSubstr("LK-MF9025 id 1"));
  EXPECT_THAT(group.registerMotor(*far).error().message, HasSubstr("ids 1 to 4"));
  EXPECT_THAT(group.registerMotor(*single).error().message, HasSubstr("itself"));
}

TEST_F(LKTechGroup, TheFamilyMakesTheGroupOnceForABusAndRegistersBothHalves) {
  UniqueFd none;
  auto bus = fdCANbus::adopt("can0", std::move(none), false);
  BusParts parts(*bus);
  std::vector<std::unique_ptr<Motor_Base>> motors;
  for (int id = 1; id <= 4; ++id) {
    auto built = lktechFamily().build(settingsOf("LK-MF9025", id, true), parts);
    ASSERT_TRUE(built) << built.error().message;
    motors.push_back(std::move(*built));
  }
  EXPECT_EQ(bus->packers().size(), 5U);
  EXPECT_NE(parts.find<LKTech_Group>({0x280, false}), nullptr);
  EXPECT_FALSE(lktechFamily().build(settingsOf("LK-MF9025", 4, true), parts));
}

TEST(LktechFamily, KnowsItsModelsAndWhatAGroupCannot) {
  const auto& family = lktechFamily();
  ASSERT_GE(family.models().size(), 5U);
  for (const auto model : family.models()) {
    auto own = ownDefaults(family);
    const auto traits = family.traits(model, own);
    EXPECT_EQ(traits.max_id, 32);
    EXPECT_TRUE(traits.asked && traits.absolute && !traits.watchdog);
    EXPECT_GT(traits.effort_full_scale, 0.0F);
    EXPECT_TRUE(traits.modes.contains(ControlMode::kTotalAngle));
    own.set("group", 1.0);
    const auto grouped = family.traits(model, own);
    EXPECT_EQ(grouped.max_id, 4);
    EXPECT_FALSE(grouped.modes.contains(ControlMode::kVelocity));
    EXPECT_EQ(grouped.frames.hold, Provision::kUnsupported);
  }
}

TEST(LktechFamily, TellsThatADriveObeysTheSharedFrameEvenAlone) {
  const auto use = lktechFamily().busUse(settingsOf("LK-MF9025", 3));
  std::vector<std::uint32_t> obeyed;
  for (const auto& filter : use.obeys) obeyed.push_back(filter.id.value);
  EXPECT_THAT(obeyed, ElementsAre(0x143, 0x280, 0x281, 0x282, 0x288));
  EXPECT_TRUE(use.layout.empty());
  EXPECT_EQ(lktechFamily().busUse(settingsOf("LK-MF9025", 5)).obeys.size(), 1U);
  const auto grouped = lktechFamily().busUse(settingsOf("LK-MF9025", 3, true));
  EXPECT_EQ(grouped.commands[0].id.value, 0x280U);
  EXPECT_FALSE(grouped.layout.empty());
}

}  // namespace
}  // namespace rc10::test::lktech_group_test
