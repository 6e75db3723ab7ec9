// The tables themselves, and that the defaults they show are those in force.

#include "config/keys/key_table.hpp"
#include "config/keys/motor_keys.hpp"

#include <cmath>
#include <set>

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "config/fingerprint.hpp"
#include "config/keys/value_check.hpp"

namespace rc10::test::key_table_test {
namespace {

void collect(const Section& section, std::vector<const Section*>& found) {
  if (std::find(found.begin(), found.end(), &section) != found.end()) return;
  found.push_back(&section);
  for (const Key& key : section.keys()) {
    if (key.section != nullptr) collect(*key.section, found);
  }
}

std::vector<const Section*> allSections() {
  std::vector<const Section*> sections;
  collect(kRobotSection, sections);
  return sections;
}

TEST(KeyTable, DescribesEveryKeyInOneLineOfAscii) {
  for (const Section* section : allSections()) {
    std::set<std::string_view> names;
    for (const Key& key : section->keys()) {
      SCOPED_TRACE(std::string{section->name} + "." + std::string{key.name});
      EXPECT_TRUE(names.insert(key.name).second);
      EXPECT_GT(key.about.size(), 10U);
      EXPECT_EQ(key.about.back(), '.');
      for (const char c : key.about) EXPECT_TRUE(c >= ' ' && c <= '~');
    }
  }
}

TEST(KeyTable, GivesEveryKeyWhatItsKindNeeds) {
  for (const Section* section : allSections()) {
    for (const Key& key : section->keys()) {
      SCOPED_TRACE(std::string{section->name} + "." + std::string{key.name});
      const bool is_number = key.kind == ValueKind::kInteger || key.kind == ValueKind::kNumber;
      const bool is_section = key.kind == ValueKind::kSection || key.kind == ValueKind::kSectionList ||
                              key.kind == ValueKind::kNamedSections;
      if (is_number && !key.hasChoices()) {
        EXPECT_LT(key.range.min, key.range.max);
      }
      if (key.kind == ValueKind::kText) {
        EXPECT_TRUE(key.form != nullptr || key.hasChoices());
      }
      EXPECT_EQ(is_section, key.section != nullptr);
      if ((key.needs & (kNeedsCurrent | kNeedsVoltage)) != 0) {
        EXPECT_NE(findKey(*section, key.twin), nullptr);
      }
    }
  }
}

TEST(KeyTable, HasFormsThatAcceptWholeTextsOnly) {
  EXPECT_TRUE(matches("left_1", kNameForm));
  EXPECT_FALSE(matches("", kNameForm));
  EXPECT_FALSE(matches("left wheel", kNameForm));
  EXPECT_FALSE(matches("left\nwheel", kNameForm));
  EXPECT_FALSE(matches(std::string_view{"left\0", 5}, kNameForm));
  EXPECT_FALSE(matches(std::string(32, 'a'), kNameForm));
  const TextForm alternatives{"a|b", "a or b"};
  EXPECT_TRUE(matches("b", alternatives));
  EXPECT_FALSE(matches("ab", alternatives));
  const Key& url = *findKey(*findKey(kRobotSection, "lcm")->section, "url");
  EXPECT_TRUE(matches(url.default_text, *url.form));
  EXPECT_FALSE(matches(std::string{url.default_text} + " ", *url.form));
}

TEST(KeyTable, EndsPhysicalNamesWithTheirUnit) {
  for (const Section* section : allSections()) {
    for (const Key& key : section->keys()) {
      for (const std::string unit : {"A", "V", "rpm", "deg", "Hz", "ms"}) {
        if (key.unit != unit) continue;
        std::string suffix = "_" + unit;
        for (char& c : suffix) c = static_cast<char>(std::tolower(c));
        EXPECT_TRUE(key.name.ends_with(suffix)) << key.name;
      }
    }
  }
}

/// A motor for which the key means something, the key itself still to come.
std::string motorFor(std::uint16_t needs) {
  if ((needs & kNeedsVoltage) != 0) return "{name: a, model: GM6020, id: 1, command: voltage";
  if ((needs & kNeedsAbsolute) != 0) return "{name: a, model: GM6020, id: 1";
  return "{name: a, model: M3508, id: 1";
}

/// The same robot without and with the key.
struct Pair {
  std::string without;
  std::string with;
};

Pair robotsWith(const Section& section, const Key& key) {
  const std::string quote = key.kind == ValueKind::kText ? "\"" : "";
  const std::string given = std::string{key.name} + ": " + quote + std::string{key.default_text} + quote;
  const std::string name{section.name};
  if (name == "robot") return {robotAfter("robot: hero\n"), robotAfter("robot: hero\n" + given + "\n")};
  if (name == "scheduler" || name == "rx" || name == "lcm") {
    return {robotAfter("robot: hero\n"), robotAfter("robot: hero\n" + name + ": {" + given + "}\n")};
  }
  if (name.ends_with("_gpio")) {
    // An input that reduces nothing is refused.
    const std::string robot = robotWith(motorFor(key.needs) + ", reduced_velocity_rpm: 30}");
    const std::string mode = "mode_gpio: {chip: gpiochip0, line: 18}\n";
    const std::string pin = name + ": {chip: gpiochip0, line: 17";
    const auto with = [&](const std::string& input) {
      return robot + (name == "mode_gpio" ? "" : mode) + input + "}\n";
    };
    return {with(pin), with(pin + ", " + given)};
  }
  if (name.starts_with("bus")) {
    const auto bus = [](const std::string& keys) {
      return "robot: hero\nbuses:\n  - {name: a, interface: can0, " + keys +
             "motors: [{name: a, model: M2006, id: 1}]}\n";
    };
    return {bus(""), bus(name == "bus_sim" ? "sim: {" + given + "}, " : given + ", ")};
  }
  if (name == "group") {
    const auto robot = [](const std::string& keys) {
      return "robot: hero\ngroups: [{name: g, " + keys +
             "motors: [a, b]}]\nbuses:\n  - {name: a, interface: can0, "
             "motors: [{name: a, model: M2006, id: 1}, {name: b, model: M2006, id: 2}]}\n";
    };
    return {robot(""), robot(given + ", ")};
  }
  const std::string motor = motorFor(key.needs);
  if (name == "motor" || name == "profile")
    return {robotWith(motor + "}"), robotWith(motor + ", " + given + "}")};
  const bool incremental = (key.needs & kNeedsIncremental) != 0;
  const std::string type = incremental ? "type: incremental" : "";
  return {robotWith(motor + ", " + name + ": {" + type + "}}"),
          robotWith(motor + ", " + name + ": {" + type + (incremental ? ", " : "") + given + "}}")};
}

TEST(KeyTable, ShowsTheDefaultsThatAreInForce) {
  int checked = 0;
  for (const Section* section : allSections()) {
    for (const Key& key : section->keys()) {
      if (key.default_text.empty()) continue;
      const bool of_motors = section == &kMotorSection || section == &kProfileSection;
      if (of_motors && !isCommonMotorKey(key.name)) continue;  // FamilyKeys
      if ((key.needs & kNeedsScaledSpeed) != 0) continue;      // MotorGuardRules: no DJI motor has it
      const auto [without, with] = robotsWith(*section, key);
      const auto bare = parseRobotConfig(without, "bare.yaml");
      const auto written = parseRobotConfig(with, "written.yaml");
      ASSERT_TRUE(bare) << bare.errorText();
      ASSERT_TRUE(written) << written.errorText();
      EXPECT_EQ(fingerprint(*bare.config), fingerprint(*written.config)) << with;
      ++checked;
    }
  }
  EXPECT_GT(checked, 30);
}

}  // namespace
}  // namespace rc10::test::key_table_test
