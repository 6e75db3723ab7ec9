// Devices and lines that two modules want.
#include <gmock/gmock.h>

#include "config/config_text.hpp"

namespace rc10::test::device_claims_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> errorsAfter(const std::string& head, const std::string& modules) {
  return errorsOf("robot: hero\n" + head + "modules:\n" + modules +
                  "buses:\n  - {name: a, type: sim, motors: [{name: left, model: M3508, id: 1}]}\n");
}

TEST(DeviceClaims, EachSpiDeviceAndPortHasOneUser) {
  EXPECT_THAT(
      errorsAfter("",
                  "  - {name: front, type: led_strip, device: /dev/spidev0.0, pixels: 10}\n"
                  "  - {name: rear, type: led_strip, device: /dev/spidev0.0, pixels: 10}\n"
                  "  - {name: one, type: rangefinder, port: /dev/ttyUSB0}\n"
                  "  - {name: two, type: rangefinder, port: /dev/ttyUSB0}\n"),
      ElementsAre("hero.yaml:4:5: modules[1].device: /dev/spidev0.0 is that of module 'front' already; give "
                  "each its own",
                  "hero.yaml:6:5: modules[3].port: /dev/ttyUSB0 is that of module 'one' already; give each "
                  "its own"));
}

TEST(DeviceClaims, ALineThatTwoModulesWantIsNamedWithBoth) {
  EXPECT_THAT(
      errorsAfter("",
                  "  - {name: switches, type: gpio, chip: gpiochip0, inputs: [{name: limit, line: 4}]}\n"
                  "  - name: valves\n    type: gpio\n    chip: /dev/gpiochip0\n    outputs:\n"
                  "      - {name: pump, line: 5}\n      - {name: valve, line: 4}\n"),
      ElementsAre(
          "hero.yaml:4:5: modules[1].outputs[1].line: /dev/gpiochip0:4 is the line of input 'limit' of "
          "module 'switches' already; use another line for output 'valve' of module 'valves'"));
}

TEST(DeviceClaims, ALineTwiceInOneModuleIsRefused) {
  EXPECT_THAT(
      errorsAfter("",
                  "  - {name: io, type: gpio, chip: gpiochip0, inputs: [{name: a, line: 4}, {name: b, "
                  "line: 4}]}\n"),
      ElementsAre(HasSubstr("modules[0].inputs[1].line: gpiochip0:4 is the line of input 'a' of module 'io' "
                            "already")));
}

TEST(DeviceClaims, TheLinesOfTheRobotItselfAreItsOwn) {
  EXPECT_THAT(
      errorsAfter("estop_gpio: {chip: gpiochip0, line: 17}\nheartbeat_gpio: {chip: pinctrl-rp1, line: 27}\n",
                  "  - name: io\n    type: gpio\n    chip: gpiochip0\n    inputs: [{name: a, line: 17}]\n"
                  "  - name: more\n    type: gpio\n    chip: pinctrl-rp1\n    outputs: [{name: b, line: "
                  "27}]\n"),
      ElementsAre(HasSubstr("modules[0].inputs[0].line: gpiochip0:17 is the line of estop_gpio already"),
                  HasSubstr("modules[1].outputs[0].line: pinctrl-rp1:27 is the line of heartbeat_gpio "
                            "already")));
}

TEST(DeviceClaims, LinesOfOneNumberOnTwoChipsAreTwo) {
  EXPECT_THAT(errorsAfter("estop_gpio: {chip: gpiochip0, line: 17}\n",
                          "  - {name: io, type: gpio, chip: gpiochip1, inputs: [{name: a, line: 17}]}\n"),
              IsEmpty());
}

TEST(DeviceClaims, TwoNamesOfOneChipAreSeenForTheSafetyLinesToo) {
  EXPECT_THAT(
      errorsAfter("estop_gpio: {chip: gpiochip0, line: 17}\nheartbeat_gpio: {chip: /dev/gpiochip0, line: "
                  "17}\n",
                  "  - {name: io, type: gpio, chip: gpiochip1, inputs: [{name: a, line: 17}]}\n"),
      ElementsAre(HasSubstr("heartbeat_gpio: /dev/gpiochip0:17 is the line of estop_gpio")));
}

TEST(DeviceKeys, WrongValuesOfAGpioModuleAreNamed) {
  EXPECT_THAT(
      errorsAfter("",
                  "  - name: io\n    type: gpio\n    chip: gpio chip\n    inputs:\n"
                  "      - {name: Limit, line: 1024, bias: up, debounce_ms: -1}\n"
                  "    outputs:\n      - {name: valve, safe_value: 2, on_estop: off}\n"),
      ElementsAre(
          HasSubstr("modules[0].chip: 'gpio chip' is not accepted"),
          HasSubstr("modules[0].inputs[0].name: 'Limit' is not accepted; use a name of a-z"),
          HasSubstr("modules[0].inputs[0].line: 1024 is above 1023"),
          HasSubstr("modules[0].inputs[0].bias: 'up' is not one of as_is, none, pull_up and pull_down"),
          HasSubstr("modules[0].inputs[0].debounce_ms: -1 is below 0 ms"),
          HasSubstr("modules[0].outputs[0].line: is missing"),
          HasSubstr("modules[0].outputs[0].safe_value: 2 is above 1"),
          HasSubstr("modules[0].outputs[0].on_estop: 'off' is not one of safe and keep")));
}

TEST(DeviceKeys, WrongValuesOfAStripAreNamed) {
  EXPECT_THAT(
      errorsAfter("",
                  "  - name: strip\n    type: led_strip\n    device: spidev0.0\n    pixels: 0\n"
                  "    brightness_limit: 0\n    estop: {pattern: flash, colour: ff0000, period_ms: 50}\n"
                  "  - {name: long, type: led_strip, device: /dev/spidev0.1, pixels: 30}\n"),
      ElementsAre(HasSubstr("modules[0].device: 'spidev0.0' is not accepted; use a path under /dev"),
                  HasSubstr("modules[0].pixels: 0 is below 1"),
                  HasSubstr("modules[0].brightness_limit: 0 is not accepted; use more than 0, at most 1"),
                  HasSubstr("modules[0].estop.pattern: 'flash' is not one of steady, blink, breathe and run"),
                  HasSubstr("modules[0].estop.colour: 'ff0000' is not accepted; use black, white"),
                  HasSubstr("modules[0].estop.period_ms: 50 is below 100 ms")));
  EXPECT_THAT(
      errorsAfter("", "  - {name: long, type: led_strip, device: /dev/spidev0.1, pixels: 400}\n"),
      ElementsAre(HasSubstr("modules[0].pixels: 400 pixels take 5040 bytes, and spidev sends at most 4096")));
}

}  // namespace
}  // namespace rc10::test::device_claims_test
