// estop_gpio and heartbeat_gpio.

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "config/report/report.hpp"

namespace rc10::test::gpio_rules_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

RobotConfig robotOf(const std::string& head) {
  return parseRobotConfig(robotAfter("robot: hero\n" + head), "hero.yaml").config.value();
}

std::vector<std::string> errorsAfter(const std::string& head) {
  return errorsOf(robotAfter("robot: hero\n" + head));
}

TEST(GpioRules, WithoutTheKeysThereIsNeither) {
  const auto robot = robotOf("");
  EXPECT_FALSE(robot.estop_gpio);
  EXPECT_FALSE(robot.heartbeat_gpio);
  EXPECT_THAT(describe(robot), Not(HasSubstr("e-stop input")));
}

TEST(GpioRules, TheContactGoesToGroundAndTheChipPullsUpByDefault) {
  const auto robot = robotOf("estop_gpio: {chip: gpiochip0, line: 17}\n");
  ASSERT_TRUE(robot.estop_gpio);
  EXPECT_EQ(robot.estop_gpio->pin.name(), "gpiochip0:17");
  EXPECT_TRUE(robot.estop_gpio->closed_is_low);
  EXPECT_TRUE(robot.estop_gpio->internal_bias);
  EXPECT_THAT(describe(robot),
              HasSubstr("e-stop input  gpiochip0:17, closed contact reads low, internal pull-up\n"));
}

TEST(GpioRules, EveryKeyIsRead) {
  const auto robot = robotOf(
      "estop_gpio: {chip: pinctrl-rp1, line: 4, closed_level: high, bias: external}\n"
      "heartbeat_gpio: {chip: /dev/gpiochip4, line: 27, period_ms: 50, stops_on_estop_after_ms: 3000}\n");
  EXPECT_EQ(robot.estop_gpio->pin, (GpioPin{"pinctrl-rp1", 4}));
  EXPECT_FALSE(robot.estop_gpio->closed_is_low);
  EXPECT_FALSE(robot.estop_gpio->internal_bias);
  EXPECT_EQ(robot.heartbeat_gpio->pin, (GpioPin{"/dev/gpiochip4", 27}));
  EXPECT_EQ(robot.heartbeat_gpio->period, 50ms);
  EXPECT_EQ(robot.heartbeat_gpio->rests_in_estop_after, 3000ms);
  EXPECT_THAT(describe(robot), HasSubstr("closed contact reads high, external pull-down\n"));
  EXPECT_THAT(describe(robot), HasSubstr("/dev/gpiochip4:27, every 50 ms, until 3000 ms after an e-stop\n"));
}

TEST(GpioRules, AnEnablingSwitchIsAContactAsTheButtonIs) {
  const auto robot = robotOf("enabling_gpio: {chip: gpiochip0, line: 22, bias: external}\n");
  ASSERT_TRUE(robot.enabling_gpio);
  EXPECT_FALSE(robot.estop_gpio);
  EXPECT_EQ(robot.enabling_gpio->pin.name(), "gpiochip0:22");
  EXPECT_FALSE(robot.enabling_gpio->internal_bias);
  EXPECT_THAT(describe(robot), HasSubstr("gpiochip0:22, closed contact reads low, external pull-up\n"));
}

TEST(GpioRules, TheEnablingSwitchHasALineOfItsOwn) {
  const std::string estop = "estop_gpio: {chip: gpiochip0, line: 22}\n";
  const std::string enabling = "enabling_gpio: {chip: /dev/gpiochip0, line: 22}\n";
  EXPECT_THAT(errorsAfter(estop + enabling), ElementsAre(HasSubstr("is the line of estop_gpio")));
  EXPECT_THAT(errorsAfter(enabling + "heartbeat_gpio: {chip: gpiochip0, line: 22}\n"),
              ElementsAre(HasSubstr("is the line of enabling_gpio: an output that switches itself")));
}

TEST(GpioRules, ChipAndLineAreRequired) {
  EXPECT_THAT(errorsAfter("estop_gpio: {}\n"), ElementsAre(HasSubstr("estop_gpio.chip: is missing"),
                                                           HasSubstr("estop_gpio.line: is missing")));
  EXPECT_THAT(errorsAfter("heartbeat_gpio: {chip: gpiochip0}\n"),
              ElementsAre(HasSubstr("heartbeat_gpio.line: is missing")));
}

TEST(GpioRules, WrongValuesAreRefused) {
  EXPECT_THAT(
      errorsAfter("estop_gpio: {chip: gpio chip, line: -1, closed_level: open, bias: pull_up}\n"),
      ElementsAre(HasSubstr("estop_gpio.chip: 'gpio chip' is not accepted; use name or label of a GPIO chip"),
                  HasSubstr("estop_gpio.line: -1 is below 0"),
                  HasSubstr("estop_gpio.closed_level: 'open' is not one of low and high"),
                  HasSubstr("estop_gpio.bias: 'pull_up' is not one of internal and external")));
  EXPECT_THAT(errorsAfter("heartbeat_gpio: {chip: gpiochip0, line: 1024, period_ms: 5}\n"),
              ElementsAre(HasSubstr("heartbeat_gpio.line: 1024 is above 1023"),
                          HasSubstr("heartbeat_gpio.period_ms: 5 is below 10 ms")));
  EXPECT_THAT(errorsAfter("estop_gpio: {chip: gpiochip0, line: 1, active: low}\n"),
              ElementsAre(HasSubstr("estop_gpio.active: unknown key")));
}

TEST(GpioRules, OneLineIsNotBothInputAndOutput) {
  EXPECT_THAT(errorsAfter("estop_gpio: {chip: gpiochip0, line: 17}\n"
                          "heartbeat_gpio: {chip: gpiochip0, line: 17}\n"),
              ElementsAre("hero.yaml:3:17: heartbeat_gpio: gpiochip0:17 is the line of estop_gpio: an output "
                          "that switches itself; use another line"));
}

TEST(GpioRules, AWaveIsNeverFasterThanTheTicksThatMakeIt) {
  const auto heartbeat = [](const std::string& rest) {
    return "scheduler: {rate_hz: 100}\nheartbeat_gpio: {chip: gpiochip0, line: 27" + rest + "}\n";
  };
  EXPECT_THAT(
      errorsAfter(heartbeat(", period_ms: 39")),
      ElementsAre("hero.yaml:3:56: heartbeat_gpio.period_ms: 39 ms are less than four ticks at 100 Hz: "
                  "a late tick would drop the relay; use 40 ms or more"));
  EXPECT_THAT(errorsAfter(heartbeat(", period_ms: 40")), IsEmpty());
  EXPECT_EQ(robotOf(heartbeat("")).heartbeat_gpio->period, 40ms);  // the default follows
}

}  // namespace
}  // namespace rc10::test::gpio_rules_test
