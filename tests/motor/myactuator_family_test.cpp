#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motor/myactuator_bench.hpp"

namespace rc10::test::myactuator_family_test {
namespace {

using namespace myactuator_bench;

TEST(MyactuatorFamily, KnowsItsModelsAndWhatTheyNeed) {
  const auto& family = myactuatorFamily();
  ASSERT_GE(family.models().size(), 10U);
  for (const auto model : family.models()) {
    const auto traits = family.traits(model, ownDefaults(family));
    EXPECT_EQ(traits.max_id, 32);
    EXPECT_TRUE(traits.asked);
    EXPECT_FALSE(traits.watchdog) << "setting it would write the drive's ROM";
    EXPECT_GT(traits.effort_full_scale, 0.0F);
    EXPECT_TRUE(traits.modes.contains(ControlMode::kVelocity));
    EXPECT_EQ(traits.modes.contains(ControlMode::kImpedance), model != "RMD-X") << model;
  }
  auto own = ownDefaults(family);
  own.set("torque_nm_per_a", 2.0);
  EXPECT_TRUE(family.traits("RMD-X", own).modes.contains(ControlMode::kImpedance));
}

TEST(MyactuatorFamily, TellsWhichIdsItUsesAndHowOften) {
  auto settings = settingsOf();
  settings.id = 5;
  settings.command_divider = 2;
  const auto use = myactuatorFamily().busUse(settings);
  EXPECT_EQ(use.sends[0].id.value, 0x245U);
  EXPECT_EQ(use.sends[1].id.value, 0x505U);
  std::vector<std::uint32_t> obeyed;
  for (const auto& filter : use.obeys) obeyed.push_back(filter.id.value);
  EXPECT_THAT(obeyed, ElementsAre(0x145, 0x405, 0x280, 0x300));
  EXPECT_NEAR(use.commands[0].per_second, 1020.0, 1e-9);
  EXPECT_NEAR(use.feedback[0].per_second, 1020.0, 1e-9);
}

}  // namespace
}  // namespace rc10::test::myactuator_family_test
