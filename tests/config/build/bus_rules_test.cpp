// The keys of a bus, and what is unique over all of them.

#include <gmock/gmock.h>

#include "config/config_text.hpp"

namespace rc10::test::bus_rules_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kMotors = "motors: [{name: a, model: M3508, id: 1}]";

std::string robotWithBuses(const std::string& first, const std::string& second = "") {
  return "robot: hero\nbuses:\n  - {" + first + "}\n" + (second.empty() ? "" : "  - {" + second + "}\n");
}

TEST(BusRules, ASocketCanBusHasAnInterface) {
  const auto config =
      parseRobotConfig(robotWithBuses("name: chassis, interface: can0, " + kMotors), "hero.yaml")
          .config.value();
  EXPECT_EQ(config.buses[0].name, "chassis");
  EXPECT_EQ(config.buses[0].type, BusType::kSocketCan);
  EXPECT_EQ(config.buses[0].interface, "can0");
  EXPECT_EQ(config.buses[0].bitrate, 1'000'000);
  EXPECT_THAT(
      errorsOf(robotWithBuses("name: chassis, " + kMotors)),
      ElementsAre(
          "hero.yaml:3:5: buses[0].interface: is missing; add the CAN interface (interface: can0), or "
          "write type: sim"));
}

TEST(BusRules, ASimulatedBusHasNone) {
  const auto config =
      parseRobotConfig(robotWithBuses("name: chassis, type: sim, sim: {seed: 4294967295}, " + kMotors), "")
          .config.value();
  EXPECT_EQ(config.buses[0].type, BusType::kSimulated);
  EXPECT_EQ(config.buses[0].sim_seed, 4'294'967'295U);
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, type: sim, interface: can0, " + kMotors)),
              ElementsAre("hero.yaml:3:43: buses[0].interface: a simulated bus has no interface; remove it"));
}

TEST(BusRules, ManagesTheLinkOnlyWhereThereIsOneAndOnlyIfAsked) {
  const auto parse = [](const std::string& keys) {
    return parseRobotConfig(robotWithBuses("name: chassis, interface: can0, " + keys + kMotors), "")
        .config.value();
  };
  EXPECT_FALSE(parse("").buses[0].manage_link);
  EXPECT_TRUE(parse("manage_link: true, ").buses[0].manage_link);
  EXPECT_THAT(
      errorsOf(robotWithBuses("name: chassis, interface: can0, manage_link: maybe, " + kMotors)).size(), 1U);
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, type: sim, manage_link: false, " + kMotors)),
              IsEmpty());
  EXPECT_THAT(
      errorsOf(robotWithBuses("name: chassis, type: sim, manage_link: true, " + kMotors)),
      ElementsAre(
          "hero.yaml:3:45: buses[0].manage_link: a simulated bus has no interface to manage; remove it"));
}

TEST(BusRules, ABusIsStalledAfterTheTimeThatItsAdapterNeeds) {
  const auto after = [](const std::string& keys) {
    return parseRobotConfig(robotWithBuses("name: chassis, interface: can0, " + keys + kMotors), "")
        .config.value()
        .buses[0]
        .stalled_after;
  };
  EXPECT_EQ(after(""), std::chrono::milliseconds{5});
  EXPECT_EQ(after("stalled_ms: 20, "), std::chrono::milliseconds{20});
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, type: sim, stalled_ms: 20, " + kMotors)),
              ElementsAre("hero.yaml:3:44: buses[0].stalled_ms: a simulated bus does not stall; remove it"));
}

TEST(BusRules, AnFdBusMayBeManagedAndHasSamplePoints) {
  const std::string fd =
      "name: chassis, interface: can0, manage_link: true, sample_point: 0.8, "
      "data_bitrate: 5000000, data_sample_point: 0.666, ";
  const auto outcome = parseRobotConfig(robotWithBuses(fd + kMotors), "");
  ASSERT_TRUE(outcome) << outcome.errorText();
  const auto wanted = outcome.config->buses[0].linkSettings();
  EXPECT_EQ(wanted.bitrate, 1'000'000);
  EXPECT_EQ(wanted.data_bitrate, 5'000'000);
  EXPECT_DOUBLE_EQ(wanted.sample_point, 0.8);
  EXPECT_DOUBLE_EQ(wanted.data_sample_point, 0.666);
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, interface: can0, data_sample_point: 0.7, " + kMotors)),
              ElementsAre("hero.yaml:3:57: buses[0].data_sample_point: a classic bus has no data phase; add "
                          "data_bitrate, or remove it"));
}

TEST(BusRules, AnInterfaceHasANameThatLinuxAccepts) {
  EXPECT_THAT(
      errorsOf(robotWithBuses("name: chassis, interface: can0/1, " + kMotors)),
      ElementsAre("hero.yaml:3:32: buses[0].interface: 'can0/1' is not accepted; use the name of a CAN "
                  "interface, as `ip link` shows it"));
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, interface: sixteencharacter, " + kMotors)).size(), 1U);
}

TEST(BusRules, NamesAndInterfacesAreUnique) {
  EXPECT_THAT(
      errorsOf(robotWithBuses("name: chassis, interface: can0, " + kMotors,
                              "name: chassis, interface: can0, motors: [{name: a, model: M2006, id: 2}]")),
      ElementsAre(
          "hero.yaml:4:12: buses[1].name: bus name 'chassis' is taken by buses[0].name (line 3); it must "
          "be unique in the robot",
          "hero.yaml:4:32: buses[1].interface: interface 'can0' is taken by buses[0].interface (line "
          "3); it must be unique in the robot",
          "hero.yaml:4:54: buses[1].motors[0].name: motor name 'a' is taken by "
          "buses[0].motors[0].name (line 3); it must be unique in the robot, over all buses"));
}

TEST(BusRules, DjiDrivesKnowOneBitRate) {
  EXPECT_THAT(
      errorsOf(robotWithBuses("name: chassis, interface: can0, bitrate: 500000, " + kMotors)),
      ElementsAre("hero.yaml:3:47: buses[0].bitrate: DJI drives speak 1000000 bit/s only; use 1000000"));
  EXPECT_THAT(
      errorsOf(robotWithBuses("name: chassis, interface: can0, bitrate: 8000000, " + kMotors)),
      ElementsAre("hero.yaml:3:47: buses[0].bitrate: 8000000 is above 1000000 bit/s; use 10000 to 1000000 "
                  "bit/s"));
}

TEST(BusRules, ARobotHasOneToFourBuses) {
  EXPECT_THAT(errorsOf("robot: hero\nbuses: []\n"),
              ElementsAre("hero.yaml:2:8: buses: has 0 entries; use 1 to 4"));
  std::string text = "robot: hero\nbuses:\n";
  for (const std::string i : {"0", "1", "2", "3", "4"}) {
    text += "  - {name: b" + i + ", type: sim, motors: [{name: m" + i + ", model: M3508, id: 1}]}\n";
  }
  EXPECT_THAT(errorsOf(text), ElementsAre("hero.yaml:3:3: buses: has 5 entries; use 1 to 4"));
}

TEST(BusRules, ABusHasAtMost32Motors) {
  std::string motors;
  for (int i = 0; i < 33; ++i) motors += "{name: m" + std::to_string(i) + ", model: M3508, id: 1}, ";
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, type: sim, motors: [" + motors + "]")),
              ::testing::Contains("hero.yaml:3:40: buses[0].motors: has 33 entries; use 1 to 32"));
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, type: sim, motors: []")),
              ElementsAre("hero.yaml:3:40: buses[0].motors: has 0 entries; use 1 to 32"));
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, type: sim")),
              ElementsAre(HasSubstr("buses[0].motors: is missing; add it")));
}

TEST(BusRules, AnUnknownTypeIsNoReasonToAskForAnInterface) {
  EXPECT_THAT(
      errorsOf(robotWithBuses("name: chassis, type: simm, " + kMotors)),
      ElementsAre(
          "hero.yaml:3:27: buses[0].type: 'simm' is not one of socketcan and sim; did you mean sim?"));
}

TEST(BusRules, TheSeedIsAWholeNumber) {
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, type: sim, sim: {seed: -1}, " + kMotors)),
              ElementsAre("hero.yaml:3:44: buses[0].sim.seed: -1 is below 0; use 0 to 4294967295"));
  EXPECT_THAT(errorsOf(robotWithBuses("name: chassis, type: sim, sim: {seed: 7}, " + kMotors)), IsEmpty());
}

}  // namespace
}  // namespace rc10::test::bus_rules_test
