#include "web/checked_config.hpp"

#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "config/load_config.hpp"
#include "config/report/template.hpp"
#include "web/page_request.hpp"

namespace rc10::web::test::checked_config_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

json checked(const std::string& text) { return json::parse(checkedConfigJson(text)); }

const std::string kRobot =
    "robot: hero\n"
    "buses:\n"
    "  - name: chassis\n"
    "    type: sim\n"
    "    motors:\n"
    "      - {name: left, model: M3508, id: 1, on_estop: ramp, direction: -1,\n"
    "         gear_ratio: 1, zero: power_on}\n"
    "      - {name: right, model: M3508, id: 2}\n"
    "groups:\n"
    "  - {name: wheels, motors: [left, right], on_return: rearm_at_rest}\n";

TEST(CheckedConfig, SaysOfEachMotorItsIdsItsLoadAndItsEstop) {
  const auto robot = checked(kRobot)["robot"];
  const auto& bus = robot["buses"][0];
  EXPECT_EQ(bus["name"], "chassis");
  EXPECT_GT(bus["load_worst"].get<double>(), bus["load"].get<double>());
  const auto& left = bus["motors"][0];
  EXPECT_EQ(left["id"], 1);
  EXPECT_EQ(left["command"], "0x200 slot 1");
  EXPECT_THAT(left["feedback"].get<std::string>(), HasSubstr("0x201"));
  EXPECT_THAT(left["on_estop"].get<std::string>(), HasSubstr("ramp, after"));
  EXPECT_EQ(robot["groups"][0]["motors"], json::parse(R"(["left", "right"])"));
  EXPECT_EQ(robot["groups"][0]["rearms_at_rest"], true);
  EXPECT_THAT(robot["report"].get<std::string>(), HasSubstr("bus chassis: simulated"));
}

TEST(CheckedConfig, SaysOfEachMotorItsDirectionItsGearAndItsZero) {
  const auto motors = checked(kRobot)["robot"]["buses"][0]["motors"];
  EXPECT_EQ(motors[0]["direction"], -1);
  EXPECT_EQ(motors[0]["gear_ratio"], 1.0);
  EXPECT_EQ(motors[0]["zero"], "at power-on");
  EXPECT_EQ(motors[1]["direction"], 1);
  EXPECT_NEAR(motors[1]["gear_ratio"].get<double>(), 19.2, 0.1);
  EXPECT_EQ(motors[1]["zero"], "on request");
}

TEST(CheckedConfig, SaysOfEachMotorWhichLinesWouldActBeforeItsSignIsKnown) {
  const auto motors = checked(kRobot)["robot"]["buses"][0]["motors"];
  EXPECT_EQ(motors[0]["untested_loops"], json::parse(R"(["on_estop: ramp"])"));
  EXPECT_EQ(motors[1]["untested_loops"], json::array());
}

TEST(CheckedConfig, EachMistakeHasItsPlaceAndTheWordsOfTheChecker) {
  auto text = kRobot;
  text.replace(text.find("id: 2"), 5, "id: 1");
  const auto told = checked(text);
  const auto outcome = parseRobotConfig(text, "robot.yaml");
  EXPECT_TRUE(told["robot"].is_null());
  ASSERT_EQ(told["errors"].size(), outcome.errors.size());
  EXPECT_EQ(told["errors"][0]["line"], outcome.errors[0].place.line);
  EXPECT_EQ(told["errors"][0]["text"], outcome.errors[0].text);
  EXPECT_EQ(told["errors"][0]["path"], outcome.errors[0].path);
}

TEST(CheckedConfig, TheTemplateHasNoMistake) {
  const auto told = checked(std::string{configTemplate()});
  EXPECT_TRUE(told["errors"].empty()) << told;
  EXPECT_TRUE(told["warnings"].empty()) << told;
}

// Aliases that stand for ten times what is in them, nine times over.
std::string bomb() {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 10; ++i) {
    const auto name = "a" + std::to_string(i);
    text += name + ": &" + name + " [";
    for (int k = 0; k < 10; ++k) text += std::string{k == 0 ? "" : ", "} + "*a" + std::to_string(i - 1);
    text += "]\n";
  }
  return text;
}

TEST(CheckedConfig, HostileTextsAreRefusedInWords) {
  const std::string long_text(CheckConfig::kMostBytes, '[');
  for (const auto& text :
       {bomb(), long_text, std::string(100'000, '{'), std::string(100'000, '-'),
        std::string{"\xff\xfe\x00robot", 8}, std::string{"- - - - - - - - - - - - - - - - - - -"},
        std::string{"robot: !!python/object:os.system x"}, std::string{"--- \n---\n"}, std::string{},
        "a: " + std::string(100'000, 'x'), std::string{"&a [*a]"}}) {
    const auto told = checked(text);
    EXPECT_TRUE(told["robot"].is_null());
    ASSERT_FALSE(told["errors"].empty());
    EXPECT_LT(told.dump().size(), 300'000U);
  }
}

TEST(CheckedConfig, AMistakeInEachLineOfAFullTextFitsTheAnswer) {
  std::string text;
  while (text.size() + 10 < CheckConfig::kMostBytes) text += "k" + std::to_string(text.size()) + ":\n";
  EXPECT_LT(checkedConfigJson(text).size(), 1'000'000U);
}

TEST(CheckedConfig, TheShownFileIsTheTextBehindTheFirstLine) {
  const auto shown = json::parse(shownConfigJson("\n" + kRobot));
  EXPECT_EQ(shown["text"], kRobot);
  EXPECT_EQ(shown["hidden"], 0);
}

TEST(CheckedConfig, ATokenWithALinesEndIsNoneAndLeavesTheTextAsItIs) {
  EXPECT_EQ(withToken("secret", "robot: hero\n"), "secret\nrobot: hero\n");
  EXPECT_EQ(withToken("secret\nrobot: other", "robot: hero\n"), "\nrobot: hero\n");
}

}  // namespace
}  // namespace rc10::web::test::checked_config_test
