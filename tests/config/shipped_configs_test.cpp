// The examples in config/, and the names of those in examples/.

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "config/keys/key_table.hpp"
#include "config/keys/motor_keys.hpp"
#include "config/module_types.hpp"
#include "config/motor_families.hpp"
#include "config/report/report.hpp"
#include "config_text.hpp"
#include "fingerprint.hpp"

namespace rc10::test::shipped_configs_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string pathOf(const std::string& file) { return std::string{RC10_SOURCE_DIR} + "/config/" + file; }

std::string contentOf(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream{pathOf(file)}.rdbuf();
  return text.str();
}

RobotConfig load(const std::string& file) {
  const auto outcome = loadRobotConfig(pathOf(file));
  EXPECT_TRUE(outcome) << outcome.errorText();
  return outcome.config.value_or(RobotConfig{});
}

std::vector<std::filesystem::path> examples() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator{pathOf("")}) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  return files;
}

TEST(ShippedConfigs, AllLoadAndCanBeDescribed) {
  EXPECT_GE(examples().size(), 4U);
  for (const auto& path : examples()) {
    const auto outcome = loadRobotConfig(path.string());
    ASSERT_TRUE(outcome) << outcome.errorText();
    EXPECT_THAT(describe(*outcome.config), HasSubstr(outcome.config->robot));
  }
}

TEST(ShippedConfigs, OfferTheirKeysToEditors) {
  for (const auto& path : examples()) {
    EXPECT_TRUE(contentOf(path.filename()).starts_with("# yaml-language-server: $schema=rc10d.schema.json\n"))
        << path;
  }
}

/// Every robot that is shipped: those of examples/ may have families and modules of their own.
std::vector<std::filesystem::path> shippedRobots() {
  auto files = examples();
  for (const auto& entry : std::filesystem::directory_iterator{pathOf("../examples")}) {
    if (const auto robot = entry.path() / "robot.yaml"; std::filesystem::exists(robot))
      files.push_back(robot);
  }
  return files;
}

/// Its line `robot: NAME`; empty if it has none.
std::string nameLineOf(const std::filesystem::path& path) {
  std::ifstream file{path};
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("robot:")) return line + "\n";
  }
  return {};
}

TEST(ShippedConfigs, HaveNamesThatMustNotReachTheNetwork) {
  EXPECT_GE(shippedRobots().size(), examples().size() + 3);
  for (const auto& path : shippedRobots()) {
    const auto name = nameLineOf(path);
    ASSERT_NE(name, "") << path;
    EXPECT_THAT(errorsOf(robotAfter(name + "lcm: {url: \"udpm://239.255.76.67:7667?ttl=1\"}\n")),
                ElementsAre(HasSubstr("is the name of an example: a neighbour's robot would obey")))
        << path;
  }
}

TEST(ShippedConfigs, TheDemoIsSevenSimulatedMotors) {
  const auto demo = load("demo.yaml");
  EXPECT_EQ(demo.robot, "demo");
  EXPECT_EQ(demo.realtime, RealtimePolicy::kPreferred);
  ASSERT_EQ(demo.buses.size(), 2U);
  std::vector<std::string> names;
  for (const auto& bus : demo.buses) {
    EXPECT_EQ(bus.type, BusType::kSimulated);
    for (const auto& motor : bus.motors) names.push_back(bus.name + "." + motor.name());
  }
  EXPECT_THAT(names, ElementsAre("chassis.front_left", "chassis.front_right", "chassis.rear_left",
                                 "chassis.rear_right", "gimbal.yaw", "gimbal.pitch", "gimbal.feeder"));
  EXPECT_THAT(loadRobotConfig(pathOf("demo.yaml")).warningText(), IsEmpty());
}

TEST(ShippedConfigs, FourWheelsAreOnCan0) {
  const auto config = load("four_wheels_can0.yaml");
  ASSERT_EQ(config.buses.size(), 1U);
  EXPECT_EQ(config.buses[0].type, BusType::kSocketCan);
  EXPECT_EQ(config.buses[0].interface, "can0");
  EXPECT_EQ(config.buses[0].motors.size(), 4U);
  EXPECT_EQ(config.realtime, RealtimePolicy::kRequired);
  EXPECT_THAT(loadRobotConfig(pathOf("four_wheels_can0.yaml")).warningText(), IsEmpty());
}

TEST(ShippedConfigs, TheMixedBusIsOnVcan0) {
  const auto config = load("vcan_mixed.yaml");
  ASSERT_EQ(config.buses.size(), 1U);
  EXPECT_EQ(config.buses[0].interface, "vcan0");
  EXPECT_EQ(config.realtime, RealtimePolicy::kPreferred);
  std::vector<std::string> motors;
  for (const auto& motor : config.buses[0].motors) {
    motors.push_back(motor.settings.model + " " + std::to_string(motor.settings.id));
    EXPECT_EQ(motor.settings.zero_at_power_on, !motor.traits().absolute);
  }
  EXPECT_THAT(motors, ElementsAre("M3508 1", "M3508 2", "M2006 3", "GM6020 5", "GM6020 6"));
}

/// Whether "key:" stands in the text, not as the end of a longer name.
bool showsKey(const std::string& text, const std::string& key) {
  constexpr std::string_view kNameCharacters = "abcdefghijklmnopqrstuvwxyz0123456789_";
  for (auto found = text.find(key + ":"); found != std::string::npos;
       found = text.find(key + ":", found + 1)) {
    if (found == 0 || kNameCharacters.find(text[found - 1]) == std::string_view::npos) return true;
  }
  return false;
}

void expectKeysIn(const Section& section, const std::string& text) {
  const bool of_motors = &section == &kMotorSection || &section == &kProfileSection;
  for (const Key& key : section.keys()) {
    if (of_motors && !isCommonMotorKey(key.name)) continue;  // on the page of its family
    EXPECT_TRUE(showsKey(text, std::string{key.name})) << section.name << "." << key.name;
    if (key.section != nullptr) expectKeysIn(*key.section, text);
  }
}

TEST(ShippedConfigs, TheReferenceShowsEveryKey) {
  expectKeysIn(kRobotSection, contentOf("full_reference.yaml"));
}

/// From behind `title` up to the next title of its kind.
std::string partOf(const std::string& text, const std::string& title) {
  const auto start = text.find(title + "\n");
  if (start == std::string::npos) return {};
  const auto body = start + title.size();
  return text.substr(body, text.find("#   - ", body) - body);
}

TEST(ShippedConfigs, TheReferenceShowsEveryKeyOfEveryFamilyAndModule) {
  const auto text = contentOf("full_reference.yaml");
  for (const auto& entry : motorFamilies()) {
    const auto part = partOf(text, "#   - # " + std::string{entry.family->name()});
    for (const auto& key : entry.family->keys()) {
      // The motors of the example with such keys are DJI's.
      const bool shown = entry.family->name() == "DJI" ? showsKey(text, std::string{key.name})
                                                       : showsKey(part, std::string{key.name});
      EXPECT_TRUE(shown) << entry.family->name() << " " << key.name;
    }
  }
  for (const auto* type : moduleTypes()) {
    const auto part = partOf(text, "#   - type: " + std::string{type->name()});
    for (const auto& key : type->keys())
      EXPECT_TRUE(showsKey(part, std::string{key.name})) << type->name() << " " << key.name;
  }
}

TEST(ShippedConfigs, TheReferenceShowsTheDefaults) {
  const auto bare = parseRobotConfig(R"(robot: full_reference
buses:
  - name: chassis
    interface: can0
    motors:
      - {name: wheel, id: 1, model: M3508}
      - {name: roller, id: 2, model: M2006, velocity_pid: {type: incremental}}
  - name: gimbal
    type: sim
    motors:
      - {name: yaw, model: GM6020, id: 5, command: voltage}
)",
                                     "bare.yaml");
  ASSERT_TRUE(bare) << bare.errorText();
  EXPECT_EQ(fingerprint(load("full_reference.yaml")), fingerprint(*bare.config));
}

}  // namespace
}  // namespace rc10::test::shipped_configs_test
