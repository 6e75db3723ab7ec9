// Modules: a chassis, a remote, as a configuration describes them.

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "config/module_types.hpp"
#include "config/report/schema.hpp"

namespace rc10::test::module_rules_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string robotWithModules(const std::string& modules) {
  return "robot: hero\nmodules:\n" + modules +
         "buses:\n  - {name: a, type: sim, motors: [{name: left, model: M3508, id: 1}, {name: right, model: "
         "M3508, id: 2}]}\n";
}

TEST(ModuleRules, AModuleIsReadWithTheDefaultsOfItsType) {
  const auto loaded = parseRobotConfig(
      robotWithModules("  - {name: lift, type: synchronised_pair, priority: 5, left: right, right: left, "
                       "velocity_limit_rpm: 60}\n"),
      "hero.yaml");
  ASSERT_TRUE(loaded) << loaded.errorText();
  const auto& module = loaded.config->modules.at(0);
  EXPECT_EQ(module.type->name(), "synchronised_pair");
  EXPECT_EQ(module.settings.name, "lift");
  EXPECT_EQ(module.settings.priority, 5);
  EXPECT_EQ(module.settings.own.motor("left"), 1U);
  EXPECT_EQ(module.settings.own.motor("right"), 0U);
  EXPECT_EQ(module.settings.own.number("velocity_limit_rpm"), 60.0);
  EXPECT_EQ(module.settings.own.number("max_difference_deg"), 10.0);
}

TEST(ModuleRules, EveryMistakeIsNamed) {
  EXPECT_THAT(
      errorsOf(robotWithModules("  - {name: lift, type: syncronised_pair}\n"
                                "  - {name: lift, left: left}\n"
                                "  - {name: state, type: synchronised_pair, left: left, right: rigt, "
                                "velocity_limit_rpm: 0}\n"
                                "  - {name: state, type: synchronised_pair, left: left, right: right, "
                                "velocity_limit_rpm: 9, wheels: 4}\n"
                                "  - {name: [a], type: [b]}\n"
                                "  - lift\n")),
      ElementsAre(
          HasSubstr("hero.yaml:3:24: modules[0].type: 'syncronised_pair' is not one of"),
          HasSubstr("hero.yaml:4:5: modules[1].type: is missing; add it: one of"),
          "hero.yaml:5:12: modules[2].name: 'state' is a channel of the robot itself; give the module "
          "another "
          "name",
          "hero.yaml:5:63: modules[2].right: there is no motor 'rigt'; did you mean right?",
          "hero.yaml:5:89: modules[2].velocity_limit_rpm: 0 is not accepted; use more than 0, at most 100000 "
          "rpm",
          HasSubstr("hero.yaml:6:12: modules[3].name: module name 'state' is taken by modules[2].name"),
          "hero.yaml:6:12: modules[3].name: 'state' is a channel of the robot itself; give the module "
          "another "
          "name",
          HasSubstr("hero.yaml:6:93: modules[3].wheels: unknown key; known here: name, type, priority, left"),
          "hero.yaml:7:23: modules[4].type: is a list; write a text",
          "hero.yaml:8:5: modules[5]: is a single value; write a map of keys"));
}

TEST(ModuleRules, WhatAModuleItselfRefusesHasItsPlace) {
  EXPECT_THAT(errorsOf(robotWithModules("  - {name: lift, type: synchronised_pair, left: left, right: left, "
                                        "velocity_limit_rpm: 60}\n")),
              ElementsAre("hero.yaml:3:5: modules[0].right: is the same motor as left; name another"));
}

TEST(ModuleRules, WhatAModuleItselfRefusesIsToldWithTheMistakesOfOthers) {
  const auto pair = [](const std::string& name, const std::string& keys) {
    return "  - {name: " + name + ", type: synchronised_pair, velocity_limit_rpm: 60, " + keys + "}\n";
  };
  EXPECT_THAT(errorsOf(robotWithModules(pair("lift", "left: left, right: rigt") +
                                        pair("door", "left: left, right: left"))),
              ElementsAre(HasSubstr("modules[0].right: there is no motor 'rigt'"),
                          HasSubstr("modules[1].right: is the same motor as left")));
  EXPECT_THAT(errorsOf("clients: 3\n" + robotWithModules(pair("door", "left: left, right: left"))),
              ElementsAre(HasSubstr("clients: is a single value"),
                          HasSubstr("modules[0].right: is the same motor as left")));
}

TEST(ModuleRules, NoModuleIsJudgedBeforeTheBusesAreRight) {
  EXPECT_THAT(errorsOf("profiles: 3\n" +
                       robotWithModules("  - {name: door, type: synchronised_pair, velocity_limit_rpm: 60, "
                                        "left: left, right: left}\n")),
              ElementsAre(HasSubstr("profiles: ")));
}

TEST(ModuleRules, AMistakeInWhatModulesShareIsOneMistake) {
  EXPECT_THAT(
      errorsOf(robotWithModules("  - {name: lift, type: synchronised_pair, left: left, right: &r rigt, "
                                "velocity_limit_rpm: 60}\n"
                                "  - {name: door, type: synchronised_pair, left: left, right: *r, "
                                "velocity_limit_rpm: 60}\n")),
      ElementsAre(HasSubstr("there is no motor 'rigt'")));
}

TEST(ModuleRules, TheSchemaHasATableForEachType) {
  const auto schema = configSchema();
  for (const auto* type : moduleTypes())
    EXPECT_THAT(schema, HasSubstr("\"module_" + std::string{type->name()} + "\""));
}

void expectKeysOn(const std::string& page, std::span<const OwnKey> keys, std::string_view type) {
  for (const OwnKey& key : keys) {
    EXPECT_THAT(page, HasSubstr("`" + std::string{key.name} + "`")) << type;
    expectKeysOn(page, key.keys, type);
  }
}

TEST(ModuleRules, EveryTypeStandsOnThePageWithItsKeysAndSignals) {
  std::ostringstream text;
  text << std::ifstream{std::string{RC10_SOURCE_DIR} + "/docs/modules.md"}.rdbuf();
  const std::string all = text.str();
  for (const auto* type : moduleTypes()) {
    const std::string heading = "### `" + std::string{type->name()} + "`\n";
    const auto begin = all.find(heading);
    ASSERT_NE(begin, std::string::npos) << type->name();
    const auto page = all.substr(begin, all.find("\n### ", begin + 1) - begin);
    expectKeysOn(page, type->keys(), type->name());
  }
}

}  // namespace
}  // namespace rc10::test::module_rules_test
