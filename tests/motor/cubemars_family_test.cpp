#include <string>

#include <gtest/gtest.h>

#include "motor/cubemars_bench.hpp"

namespace rc10::test::cubemars_family_test {
namespace {

using namespace cubemars_bench;

// --- the family ----------------------------------------------------------------------------------------

TEST(CubemarsFamily, EveryModelHasTraitsForEachOfItsProtocols) {
  const auto& family = cubemarsFamily();
  EXPECT_EQ(family.name(), "CubeMars");
  EXPECT_EQ(family.models().size(), cubemarsModels().size());
  for (const auto model : family.models()) {
    const bool v3 = findCubemarsModel(model)->v3;
    for (const std::string protocol : {"servo", v3 ? "mit_v3" : "mit"}) {
      SCOPED_TRACE(std::string{model} + " " + protocol);
      const auto settings = cubemarsSettings(model, 1, {{"protocol", protocol}});
      ASSERT_TRUE(family.check(settings));
      const auto traits = family.traits(model, settings.own);
      EXPECT_GT(traits.effort_full_scale, 10.0F);
      EXPECT_LE(traits.effort_full_scale, 60.0F);
      EXPECT_GT(traits.torque_nm_per_a, 0.0F);
      EXPECT_GT(traits.no_load_rpm, 0.0F);
      EXPECT_GT(setupOf(settings).pole_pairs, 0);
      EXPECT_EQ(traits.asked, protocol == "mit");
      EXPECT_EQ(traits.frames.poll == Provision::kFrame, traits.asked);
    }
  }
}

TEST(CubemarsFamily, RefusesAProtocolThatTheDriveDoesNotSpeak) {
  const auto& family = cubemarsFamily();
  auto refused = family.check(cubemarsSettings("AK80-9", 1, {{"protocol", std::string{"mit_v3"}}}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.rfind("protocol: ", 0), 0U) << refused.error().message;
  refused = family.check(cubemarsSettings("AK10-9-V3", 1, {{"protocol", std::string{"mit"}}}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.rfind("protocol: ", 0), 0U) << refused.error().message;
}

TEST(CubemarsFamily, RefusesAPositionBasisWhereThereIsOnlyOne) {
  const auto refused = cubemarsFamily().check(cubemarsSettings(
      "AK80-9", 1, {{"protocol", std::string{"mit"}}, {"position_basis", std::string{"rotor"}}}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.rfind("position_basis: ", 0), 0U) << refused.error().message;
}

TEST(CubemarsFamily, KeysChangeWhatTheTableSays) {
  const auto settings = cubemarsSettings("AK80-9", 1,
                                         {{"protocol", std::string{"mit"}},
                                          {"pole_pairs", 14.0},
                                          {"torque_constant_nm_per_a", 0.115},
                                          {"velocity_range_rad_s", 22.5},
                                          {"torque_range_nm", 12.0}});
  const auto setup = setupOf(settings);
  EXPECT_EQ(setup.pole_pairs, 14);
  EXPECT_NEAR(setup.torque_nm_per_a, 1.035, 1e-6);
  EXPECT_EQ(setup.ranges.velocity_rad_s, 22.5);
  EXPECT_EQ(setup.ranges.torque_nm, 12.0);
  EXPECT_NEAR(cubemarsTraits(setup).effort_full_scale, 12.0 / 1.035, 1e-4);
}

TEST(CubemarsFamily, WithoutABrakeCurrentThereIsNoBrakeMode) {
  const auto brakes = [](double brake_a) {
    const auto settings =
        cubemarsSettings("AK80-9", 1, {{"protocol", std::string{"servo"}}, {"brake_current_a", brake_a}});
    return cubemarsFamily().traits(settings.model, settings.own).modes.contains(ControlMode::kBrake);
  };
  EXPECT_TRUE(brakes(5.0));
  EXPECT_FALSE(brakes(0.0));
}

TEST(CubemarsFamily, TellsEveryIdOnTheBus) {
  const auto& family = cubemarsFamily();
  auto settings = servo();
  settings.feedback_hz = 200;
  settings.command_divider = 5;
  auto use = family.busUse(settings);
  ASSERT_EQ(use.sends.size(), 1U);
  EXPECT_EQ(use.sends[0].id, (CanId{0x2905, true}));
  ASSERT_EQ(use.obeys.size(), 1U);
  EXPECT_TRUE(accepts(use.obeys[0], cubemars::currentFrame(5, 0.0)));
  EXPECT_TRUE(accepts(use.obeys[0], cubemars::positionVelocityFrame(5, 0, 0, 0)));
  EXPECT_FALSE(accepts(use.obeys[0], cubemars::currentFrame(6, 0.0)));
  EXPECT_EQ(use.feedback[0].per_second, 200.0);
  EXPECT_EQ(use.commands[0].per_second, 200.0);
  use = family.busUse(mit());
  ASSERT_EQ(use.sends.size(), 2U);
  EXPECT_EQ(use.sends[0].id, (CanId{0, false}));
  EXPECT_EQ(use.sends[0].discriminators[0]->value, 5);
  EXPECT_EQ(use.feedback[0].per_second, 1000.0);
}

}  // namespace
}  // namespace rc10::test::cubemars_family_test
