#include <gtest/gtest.h>

#include "motor/vesc_bench.hpp"

namespace rc10::test::vesc_family_test {
namespace {

using namespace vesc_bench;

TEST(VescFamily, EveryKeyHasANameAndWords) {
  for (const OwnKey& key : vescFamily().keys()) {
    EXPECT_FALSE(key.name.empty());
    EXPECT_FALSE(key.about.empty()) << key.name;
    EXPECT_TRUE(key.required || !key.default_text.empty()) << key.name;
  }
}

TEST(VescFamily, ImpossibleSettingsAreRefusedWithTheirKey) {
  auto settings = vescSettings();
  EXPECT_TRUE(vescFamily().check(settings));
  settings.feedback_hz = 20;
  EXPECT_EQ(vescFamily().check(settings).error().message.find("feedback_hz: "), 0U);
  settings = vescSettings({{"host_id", 7.0}});
  EXPECT_EQ(vescFamily().check(settings).error().message.find("host_id: "), 0U);
  settings = vescSettings({{"handbrake_current_a", 5.0}});
  EXPECT_EQ(vescFamily().check(settings).error().message.find("handbrake_current_a: "), 0U);
  settings = vescSettings({{"velocity_zero", std::string{"brake"}}, {"brake_current_a", 0.0}});
  EXPECT_EQ(vescFamily().check(settings).error().message.find("velocity_zero: "), 0U);
}

TEST(VescFamily, AHandbrakeHoldsOnlyWhatABrakeHasStopped) {
  const auto holds = [](double brake_a) {
    const auto own =
        vescSettings({{"angle", kNone}, {"handbrake_current_a", 6.0}, {"brake_current_a", brake_a}}).own;
    return vescFamily().traits("VESC", own).frames.hold;
  };
  EXPECT_EQ(holds(5.0), Provision::kFrame);
  EXPECT_EQ(holds(0.0), Provision::kUnsupported);
}

TEST(VescFamily, WithoutABrakeCurrentThereIsNoBrakeMode) {
  const auto brakes = [](double brake_a) {
    return vescFamily()
        .traits("VESC", vescSettings({{"brake_current_a", brake_a}}).own)
        .modes.contains(ControlMode::kBrake);
  };
  EXPECT_TRUE(brakes(5.0));
  EXPECT_FALSE(brakes(0.0));
}

TEST(VescFamily, TheModesFollowFromTheSourceOfTheAngle) {
  const auto& family = vescFamily();
  EXPECT_TRUE(family.traits("VESC", vescSettings().own).modes.contains(ControlMode::kTotalAngle));
  EXPECT_FALSE(
      family.traits("VESC", vescSettings({{"angle", kNone}}).own).modes.contains(ControlMode::kAngle));
  EXPECT_TRUE(family.traits("VESC", vescSettings({{"angle", kEncoder}}).own).absolute);
  EXPECT_EQ(family.traits("VESC", vescSettings({{"angle", kEncoder}}).own).host_loops, nullptr);
}

TEST(VescFamily, TellsWhatTheDriveSendsAndObeys) {
  const auto use = vescFamily().busUse(vescSettings());
  const auto obeys = [&use](CanFrame frame) {
    return std::any_of(use.obeys.begin(), use.obeys.end(),
                       [&](const auto& filter) { return accepts(filter, frame); });
  };
  EXPECT_TRUE(obeys(vesc::makeCommand(vesc::Packet::kSetErpm, 7, 0)));
  EXPECT_TRUE(obeys(vesc::makeCommand(vesc::Packet::kSetErpm, 255, 0)));
  EXPECT_FALSE(obeys(vesc::makeCommand(vesc::Packet::kSetErpm, 8, 0)));
  EXPECT_FALSE(obeys(vescFrame(0x10007, "00000000")));
  EXPECT_EQ(use.sends.size(), 8U);
}

TEST(VescFamily, SeveralDrivesShareABusAndTheHostId) {
  auto bus = fdCANbus::adopt("can0", UniqueFd{}, false);
  BusParts parts(*bus);
  auto first = vescFamily().build(vescSettings(), parts);
  ASSERT_TRUE(first) << first.error().message;
  auto settings = vescSettings();
  settings.name = "other";
  settings.id = 8;
  auto second = vescFamily().build(settings, parts);
  ASSERT_TRUE(second) << second.error().message;
  settings.name = "third";
  EXPECT_FALSE(vescFamily().build(settings, parts));
}

}  // namespace
}  // namespace rc10::test::vesc_family_test
