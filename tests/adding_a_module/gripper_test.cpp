// The worked example of docs/adding-a-module.md, as a program that embeds rc10d uses it.
#include "gripper.hpp"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/load_config.hpp"
#include "config/module_types.hpp"
#include "daemon/virtual_robot.hpp"
#include "module/fake_robot.hpp"

namespace shop::gripper_test {
namespace {

using namespace rc10;
using namespace std::chrono_literals;
using rc10::test::FakeRobot;
using rc10::test::VirtualRobot;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ModuleSettings settings() {
  ModuleSettings settings;
  settings.name = "hand";
  settings.own.set("motor", 0.0);
  settings.own.set("grip_a", 1.5);
  settings.own.set("still_ms", 100.0);
  return settings;
}

/// A type with texts.
class Labelled : public ModuleType {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "labelled"; }
  [[nodiscard]] std::string_view about() const noexcept override { return "Has texts."; }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override {
    static constexpr std::array kKeys{
        OwnKey{.name = "label", .kind = OwnKey::Kind::kText, .about = "Any text."},
        OwnKey{.name = "code",
               .kind = OwnKey::Kind::kText,
               .default_text = "A1",
               .about = "A letter and a digit.",
               .pattern = "[A-Z][0-9]"}};
    return kKeys;
  }
  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings& /*settings*/,
                                                           const RobotOutline& robot) const override {
    return gripperType().build(settings(), robot);
  }
};

const ModuleType& labelledType() {
  static const Labelled kType;
  return kType;
}

// Before the first configuration, as a main() would.
const bool kAdded = addModuleType(gripperType()).has_value() && addModuleType(labelledType()).has_value();

TEST(Gripper, ClosesUntilItHoldsSomethingAndSaysSoOnce) {
  FakeRobot robot{1};
  const auto hand = std::move(gripperType().build(settings(), test::outlineOf(1)).value());
  robot.motor(0).feedback.velocity_rpm = 20.0F;
  hand->setInputs(std::array{1.0});
  for (int i = 0; i < 200; ++i) robot.update(*hand);
  EXPECT_EQ(robot.motor(0).target->value, 1.5);
  EXPECT_EQ(hand->outputs()[0], 0.0) << "it still moves";
  robot.motor(0).feedback.velocity_rpm = 0.0F;
  std::size_t told = 0;
  for (int i = 0; i < 200; ++i) {
    robot.update(*hand);
    told += robot.events().size();
  }
  EXPECT_EQ(hand->outputs()[0], 1.0);
  EXPECT_EQ(told, 1U);
  hand->setInputs(std::array{0.0});
  robot.update(*hand);
  EXPECT_EQ(robot.motor(0).target->value, -1.5);
}

TEST(Gripper, AsksNothingWithoutACommand) {
  FakeRobot robot{1};
  const auto hand = std::move(gripperType().build(settings(), test::outlineOf(1)).value());
  robot.update(*hand);
  EXPECT_FALSE(robot.motor(0).target.has_value());
}

TEST(Gripper, IsConfiguredAndRunsAsAnyOtherModule) {
  ASSERT_TRUE(kAdded);
  const auto loaded = loadRobotConfig(std::string{RC10_SOURCE_DIR} + "/examples/adding_a_module/robot.yaml");
  ASSERT_TRUE(loaded) << loaded.errorText();
  VirtualRobot robot{*loaded.config};
  robot.run(10);
  (void)robot.order(Operation::kEnable);
  for (int i = 0; i < 300; ++i) {
    SignalMessage message;
    message.client = "test";
    message.received = robot.now();
    message.deadline = robot.now() + 50ms;
    message.values.fill(kNoSignal);
    message.values[0] = 1.0;
    ASSERT_TRUE(robot.exchange().signals.push(message));
    robot.tick();
  }
  EXPECT_EQ(robot.snapshot().modules[0].outputs[0], 1.0);
  EXPECT_EQ(robot.motor(0).owner.view(), "hand");
}

TEST(Gripper, ItsKeysAreAsStrictAsAllOthers) {
  ASSERT_TRUE(kAdded);
  const auto loaded = parseRobotConfig(
      "robot: hero\nmodules:\n  - {name: hand, type: gripper, motor: claw, grip_ma: 1500}\nbuses:\n"
      "  - {name: arm, type: sim, motors: [{name: claw, model: M2006, id: 1}]}\n",
      "hero.yaml");
  EXPECT_THAT(loaded.errorText(), HasSubstr("modules[0].grip_ma: unknown key; did you mean grip_a?"));
}

std::string errorsOfLabelled(const std::string& keys) {
  return parseRobotConfig(
             "robot: hero\nmodules:\n  - {name: tag, type: labelled" + keys +
                 "}\nbuses:\n  - {name: arm, type: sim, motors: [{name: claw, model: M2006, id: 1}]}\n",
             "hero.yaml")
      .errorText();
}

TEST(ModuleKey, OfATextWithoutAPatternTakesAnyTextAndSaysHowLong) {
  EXPECT_EQ(errorsOfLabelled(", label: 'front, left!'"), "");
  EXPECT_THAT(errorsOfLabelled(", label: ''"),
              HasSubstr("'' is not accepted; use a text of 1 to 128 characters"));
}

TEST(ModuleKey, OfAPatternWithoutWordsShowsThePattern) {
  EXPECT_EQ(errorsOfLabelled(", code: B2"), "");
  EXPECT_THAT(errorsOfLabelled(", code: b2"),
              HasSubstr("'b2' is not accepted; use a text of the form [A-Z][0-9]"));
}

TEST(Gripper, ANameThatIsTakenIsRefused) {
  EXPECT_THAT(addModuleType(gripperType()).error().message, HasSubstr("module type 'gripper'"));
}

}  // namespace
}  // namespace shop::gripper_test
