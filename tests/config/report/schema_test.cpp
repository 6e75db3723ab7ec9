#include "config/report/schema.hpp"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "config/keys/key_table.hpp"
#include "config/keys/settings.hpp"
#include "config/motor_families.hpp"
#include "config/yaml/yaml_reader.hpp"

namespace rc10::test::schema_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string contentOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream{std::string{RC10_SOURCE_DIR} + "/" + path}.rdbuf();
  return text.str();
}

/// The schema as a tree: JSON is YAML.
YamlNode schemaTree() {
  Problems problems{"schema"};
  const auto tree = readYaml(configSchema(), problems);
  EXPECT_FALSE(problems.hasErrors());
  return tree.value_or(YamlNode{});
}

OwnValues defaultsOf(const MotorFamily& family) {
  OwnValues own;
  for (const OwnKey& key : family.keys()) own.set(key.name, std::string{key.default_text});
  return own;
}

const YamlNode* at(const YamlNode& root, const std::vector<std::string>& path) {
  const YamlNode* node = &root;
  for (const auto& key : path) {
    if (node != nullptr) node = node->find(key);
  }
  return node;
}

TEST(Schema, IsTheFileThatEditorsUse) {
  EXPECT_EQ(configSchema(), contentOf("config/rc10d.schema.json"))
      << "write the output of rc10d --schema to config/rc10d.schema.json";
}

TEST(Schema, HasEveryKeyOfEveryTableWithItsDescription) {
  const YamlNode schema = schemaTree();
  for (const Section* section : {&kRobotSection, &kBusSection, &kMotorSection, &kProfileSection,
                                 &kVelocityPidSection, &kAnglePidSection, &kSimulatedSection}) {
    const YamlNode* properties = at(schema, {"$defs", std::string{section->name}, "properties"});
    ASSERT_NE(properties, nullptr) << section->name;
    EXPECT_EQ(properties->entries.size(), section->keys().size());
    for (const Key& key : section->keys()) {
      const YamlNode* description = at(*properties, {std::string{key.name}, "description"});
      ASSERT_NE(description, nullptr) << key.name;
      EXPECT_THAT(description->text, HasSubstr(std::string{key.about}));
      if (!key.unit.empty()) {
        EXPECT_THAT(description->text, HasSubstr("Unit: " + std::string{key.unit}));
      }
    }
  }
}

TEST(Schema, RefusesUnknownKeysInEverySection) {
  const YamlNode schema = schemaTree();
  const YamlNode* definitions = at(schema, {"$defs"});
  ASSERT_NE(definitions, nullptr);
  for (const auto& [name, definition] : definitions->entries) {
    const YamlNode* additional = definition.find("additionalProperties");
    ASSERT_NE(additional, nullptr) << name.text;
    EXPECT_EQ(additional->text, "false") << name.text;
  }
}

TEST(Schema, TakesWhatDependsOnTheModelFromTheModelTable) {
  const YamlNode schema = schemaTree();
  const YamlNode* models = at(schema, {"$defs", "motor", "allOf"});
  ASSERT_NE(models, nullptr);
  std::size_t rule = 0;
  for (const auto& entry : motorFamilies()) {
    for (const auto model : entry.family->models()) {
      ASSERT_LT(rule, models->items.size());
      const YamlNode& item = models->items[rule++];
      EXPECT_EQ(at(item, {"if", "properties", "model", "const"})->text, model);
      const MotorTraits traits = entry.family->traits(model, defaultsOf(*entry.family));
      EXPECT_EQ(at(item, {"then", "properties", "id", "maximum"})->text, std::to_string(traits.max_id));
    }
  }
  for (const auto& entry : motorFamilies()) {
    ASSERT_LT(rule, models->items.size());
    const YamlNode& item = models->items[rule++];
    EXPECT_EQ(at(item, {"title"})->text, entry.family->name());
    EXPECT_EQ(at(item, {"if", "properties", "model", "enum"})->items.size(), entry.family->models().size());
  }
  EXPECT_EQ(rule, models->items.size());
}

TEST(Schema, HasAWordThatReadsAsANumberAsOne) {
  EXPECT_THAT(configSchema(), HasSubstr("\"default\": 3200000"));
  EXPECT_THAT(configSchema(), Not(HasSubstr("\"3200000\"")));
}

TEST(Schema, TellsOfEachFamilyItsOwnKeysAndRefusesThoseOfOthers) {
  const YamlNode schema = schemaTree();
  std::size_t families = 0;
  for (const YamlNode& rule : at(schema, {"$defs", "motor", "allOf"})->items) {
    const YamlNode* title = rule.find("title");
    if (title == nullptr) continue;
    ++families;
    for (const auto& entry : motorFamilies()) {
      for (const OwnKey& key : entry.family->keys()) {
        const std::string name{key.name};
        const YamlNode* own = at(rule, {"then", "properties", name});
        ASSERT_NE(own, nullptr) << name;
        if (entry.family->name() != title->text) continue;
        EXPECT_THAT(at(*own, {"description"})->text, HasSubstr(std::string{key.about}));
        const YamlNode* fallback = own->find("default");
        EXPECT_EQ(fallback != nullptr ? fallback->text : "", key.default_text) << name;
      }
    }
    const bool vesc = title->text == "VESC";
    EXPECT_EQ(at(rule, {"then", "properties", "speed_ramp_erpm_per_s"})->text == "false", !vesc);
  }
  EXPECT_EQ(families, motorFamilies().size());
}

}  // namespace
}  // namespace rc10::test::schema_test
