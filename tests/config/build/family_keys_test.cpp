// The keys that only some families have.
#include <algorithm>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "config/motor_families.hpp"
#include "config/yaml/number_text.hpp"

namespace rc10::test::family_keys_test {
namespace {

using ::testing::HasSubstr;

std::string valueOf(const OwnKey& key) {
  if (key.kind == OwnKey::Kind::kChoice) return std::string{key.choices.front()};
  if (key.kind == OwnKey::Kind::kFlag) return "true";
  if (key.kind == OwnKey::Kind::kInteger) return numberText(key.above_min ? key.min + 1 : key.min);
  return numberText(key.above_min ? std::min(key.max, key.min + 1.0) : key.min);
}

/// A motor of the family with what it requires, and with these keys.
std::string motorWith(const MotorFamily& family, const std::string& more = "") {
  std::string text = "{name: a, model: " + std::string{family.models().front()} +
                     ", id: 1, current_limit_a: 1, velocity_limit_rpm: 100";
  for (const OwnKey& key : family.keys()) {
    if (key.required) text += ", " + std::string{key.name} + ": " + valueOf(key);
  }
  return text + more + "}";
}

std::string robotOf(const MotorFamily& family, const std::string& more = "") {
  const bool fd = family.name() == "moteus";
  return "robot: hero\nbuses:\n  - name: chassis\n    type: sim\n" +
         std::string{fd ? "    data_bitrate: 5000000\n" : ""} + "    motors:\n      - " +
         motorWith(family, more) + "\n";
}

const OwnValues& ownOf(const ConfigOutcome& outcome) {
  return outcome.config->buses[0].motors[0].settings.own;
}

TEST(FamilyKeys, AMotorOfEveryFamilyNeedsNoMoreThanWhatItRequires) {
  for (const auto& entry : motorFamilies()) {
    const auto outcome = parseRobotConfig(robotOf(*entry.family), "hero.yaml");
    EXPECT_TRUE(outcome.config) << outcome.errorText();
  }
}

TEST(FamilyKeys, HaveTheDefaultsThatTheyShow) {
  for (const auto& entry : motorFamilies()) {
    for (const OwnKey& key : entry.family->keys()) {
      if (key.default_text.empty()) continue;
      const auto bare = parseRobotConfig(robotOf(*entry.family), "bare.yaml");
      ASSERT_TRUE(bare.config) << bare.errorText();
      const std::string text{key.default_text};
      if (key.kind == OwnKey::Kind::kChoice) {
        EXPECT_EQ(ownOf(bare).text(key.name), text) << key.name;
      } else if (key.kind == OwnKey::Kind::kFlag) {
        EXPECT_EQ(ownOf(bare).flag(key.name), text == "true") << key.name;
      } else {
        EXPECT_EQ(ownOf(bare).number(key.name), std::stod(text)) << key.name;
      }
      if (key.required) continue;
      const auto written = parseRobotConfig(
          robotOf(*entry.family, ", " + std::string{key.name} + ": " + text), "written.yaml");
      EXPECT_TRUE(written.config) << written.errorText();
    }
  }
}

TEST(FamilyKeys, MeanNothingForOtherFamilies) {
  for (const auto& entry : motorFamilies()) {
    for (const OwnKey& key : entry.family->keys()) {
      for (const auto& other : motorFamilies()) {
        const auto own = other.family->keys();
        const bool known =
            std::any_of(own.begin(), own.end(), [&](const OwnKey& mine) { return mine.name == key.name; });
        if (known) continue;
        const auto outcome = parseRobotConfig(
            robotOf(*other.family, ", " + std::string{key.name} + ": " + valueOf(key)), "hero.yaml");
        EXPECT_THAT(outcome.errorText(), HasSubstr(std::string{key.name} + ": means nothing for the"));
      }
    }
  }
}

TEST(FamilyKeys, OfOneNameAreOfOneKindAndUnit) {
  for (const auto& entry : motorFamilies()) {
    for (const OwnKey& key : entry.family->keys()) {
      for (const auto& other : motorFamilies()) {
        for (const OwnKey& same : other.family->keys()) {
          if (same.name != key.name) continue;
          EXPECT_EQ(same.kind, key.kind) << key.name;
          EXPECT_EQ(same.unit, key.unit) << key.name;
        }
      }
    }
  }
}

TEST(FamilyKeys, StandOnThePageOfTheirFamily) {
  for (const auto& entry : motorFamilies()) {
    std::string page;
    for (const char c : entry.family->name()) {
      if (c != '-') page += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    }
    const std::string file = page == "dji" ? "docs/motors.md" : "docs/motors/" + page + ".md";
    std::ostringstream text;
    text << std::ifstream{std::string{RC10_SOURCE_DIR} + "/" + file}.rdbuf();
    ASSERT_FALSE(text.str().empty()) << file;
    for (const OwnKey& key : entry.family->keys()) {
      EXPECT_THAT(text.str(), HasSubstr(std::string{key.name})) << file;
    }
    for (const auto model : entry.family->models())
      EXPECT_THAT(text.str(), HasSubstr(std::string{model})) << file;
  }
}

}  // namespace
}  // namespace rc10::test::family_keys_test
