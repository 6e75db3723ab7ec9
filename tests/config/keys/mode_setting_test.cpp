#include "config/keys/mode_setting.hpp"

#include <gtest/gtest.h>

#include "config/motor_families.hpp"

namespace rc10::test::mode_setting_test {
namespace {

TEST(ModeSetting, IsTheKeyThatGivesTheMode) {
  EXPECT_EQ(settingForMode("DM4310", ControlMode::kCurrent), "control: mit");
  EXPECT_EQ(settingForMode("DM4310", ControlMode::kVelocity), "control: mit");
  EXPECT_EQ(settingForMode("RS03", ControlMode::kCurrent), "control: operation");
  EXPECT_EQ(settingForMode("GM6020", ControlMode::kCurrent), "command: current");
  EXPECT_EQ(settingForMode("GM6020", ControlMode::kVoltage), "command: voltage");
}

TEST(ModeSetting, IsEmptyWhereNoKeyDoes) {
  EXPECT_EQ(settingForMode("M3508", ControlMode::kImpedance), "");
  EXPECT_EQ(settingForMode("a stranger's", ControlMode::kCurrent), "");
}

// `rc10ctl commission` needs it.
TEST(ModeSetting, EveryModelWithAChoiceCanBeGivenACurrent) {
  for (const auto& entry : motorFamilies()) {
    for (const auto model : entry.family->models()) {
      bool chooses = false;
      for (const OwnKey& key : entry.family->keys()) chooses |= !key.choices.empty();
      EXPECT_EQ(settingForMode(model, ControlMode::kCurrent).empty(), !chooses) << model;
    }
  }
}

}  // namespace
}  // namespace rc10::test::mode_setting_test
