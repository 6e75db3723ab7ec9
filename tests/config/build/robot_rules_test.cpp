// The keys of the robot itself, its threads, LCM and profiles.

#include <gmock/gmock.h>

#include "config/config_text.hpp"

namespace rc10::test::robot_rules_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(RobotRules, ARobotNeedsANameAndBuses) {
  EXPECT_THAT(
      errorsOf("realtime: preferred\n"),
      ElementsAre("hero.yaml:1:1: robot: is missing; add it: Name of the robot: the prefix of its LCM "
                  "channels and the name of its socket.",
                  "hero.yaml:1:1: buses: is missing; add it: The CAN buses, each with its motors."));
}

TEST(RobotRules, TheNameIsOneThatChannelsAndFilesCanHave) {
  const std::string reason = "is not accepted; use 1 to 31 of a-z, 0-9, _ and -";
  EXPECT_THAT(errorsOf(robotAfter("robot: Hero\n")), ElementsAre("hero.yaml:1:8: robot: 'Hero' " + reason));
  EXPECT_THAT(errorsOf(robotAfter("robot: a/b\n")), ElementsAre("hero.yaml:1:8: robot: 'a/b' " + reason));
  EXPECT_THAT(errorsOf(robotAfter("robot: ''\n")), ElementsAre("hero.yaml:1:8: robot: '' " + reason));
  EXPECT_THAT(errorsOf(robotAfter("robot: " + std::string(31, 'a') + "\n")), IsEmpty());
  EXPECT_THAT(errorsOf(robotAfter("robot: " + std::string(32, 'a') + "\n")),
              ElementsAre("hero.yaml:1:8: robot: '" + std::string(32, 'a') + "' " + reason));
  EXPECT_THAT(errorsOf(robotAfter("robot: " + std::string(1000, 'a') + "\n")),
              ElementsAre("hero.yaml:1:8: robot: '" + std::string(48, 'a') + "...' " + reason));
}

TEST(RobotRules, AnUnknownKeyIsRefusedWithTheNearestOne) {
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\nscheduller: {}\n")),
              ElementsAre("hero.yaml:2:1: scheduller: unknown key; did you mean scheduler?"));
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\nLCM: {}\n")),
              ElementsAre("hero.yaml:2:1: LCM: unknown key; did you mean lcm?"));
  EXPECT_THAT(
      errorsOf(robotAfter("robot: hero\nwheels: 4\n")),
      ElementsAre(
          "hero.yaml:2:1: wheels: unknown key; known here: robot, realtime, guard, on_unrest, receive, "
          "scheduler, rx, lcm, clients, tuning, clear, "
          "estop_gpio, enabling_gpio, mode_gpio, heartbeat_gpio, blackbox_mib, profiles, buses, groups and "
          "modules"));
}

TEST(RobotRules, AValueOfTheWrongKindIsRefusedWithTheRightOne) {
  EXPECT_THAT(
      errorsOf(robotAfter("robot: [hero]\nlcm: 3\nprofiles: [a]\nrealtime:\nscheduler: {rate_hz: {}}\n")),
      ElementsAre("hero.yaml:1:8: robot: is a list; write a text",
                  "hero.yaml:2:6: lcm: is a single value; write a map of keys",
                  "hero.yaml:3:11: profiles: is a list; write a map from names to maps of keys",
                  "hero.yaml:4:1: realtime: is empty; write required or preferred",
                  "hero.yaml:5:22: scheduler.rate_hz: is a map; write a whole number in Hz"));
}

TEST(RobotRules, RealtimeIsRequiredUnlessPreferredIsEnough) {
  EXPECT_EQ(parseRobotConfig(robotAfter("robot: hero\n"), "").config->realtime, RealtimePolicy::kRequired);
  EXPECT_EQ(parseRobotConfig(robotAfter("robot: hero\nrealtime: preferred\n"), "").config->realtime,
            RealtimePolicy::kPreferred);
  EXPECT_THAT(
      errorsOf(robotAfter("robot: hero\nrealtime: prefered\n")),
      ElementsAre("hero.yaml:2:11: realtime: 'prefered' is not one of required and preferred; did you "
                  "mean preferred?"));
}

TEST(RobotRules, ThePeriodIsAWholeNumberOfNanoseconds) {
  const auto errors = [](const std::string& rate) {
    return errorsOf(robotAfter("robot: hero\nscheduler: {rate_hz: " + rate + "}\n"));
  };
  for (const auto* rate : {"100", "250", "500", "1000", "2000", "4000"})
    EXPECT_THAT(errors(rate), IsEmpty()) << rate;
  EXPECT_THAT(errors("99"),
              ElementsAre("hero.yaml:2:22: scheduler.rate_hz: 99 is below 100 Hz; use 100 to 4000 Hz"));
  EXPECT_THAT(errors("4001"),
              ElementsAre("hero.yaml:2:22: scheduler.rate_hz: 4001 is above 4000 Hz; use 100 to 4000 Hz"));
  EXPECT_THAT(errors("3000"),
              ElementsAre("hero.yaml:2:22: scheduler.rate_hz: a period of 1/3000 s is no whole "
                          "number of nanoseconds; use 2560 or 3125"));
}

TEST(RobotRules, TheReceivingThreadPrecedesTheScheduler) {
  const std::string why =
      ": a frame that has arrived would miss the tick that needs it; raise rx.priority or lower "
      "scheduler.priority";
  EXPECT_THAT(
      errorsOf(robotAfter("robot: hero\nscheduler: {priority: 70}\nrx: {priority: 70}\n")),
      ElementsAre("hero.yaml:3:16: rx.priority: rx.priority 70 is not above scheduler.priority 70" + why));
  EXPECT_THAT(
      errorsOf(robotAfter("robot: hero\nscheduler: {priority: 75}\n")),
      ElementsAre("hero.yaml:2:23: scheduler.priority: rx.priority 65 is not above scheduler.priority 75" +
                  why));
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\nrx: {priority: 80}\nscheduler: {priority: 1}\n")),
              ElementsAre("hero.yaml:2:16: rx.priority: 80 is above 79; use 3 to 79",
                          "hero.yaml:3:23: scheduler.priority: 1 is below 2; use 2 to 78"));
}

TEST(RobotRules, ThreadsAndLcmTakeWhatIsWritten) {
  const auto config =
      parseRobotConfig(robotAfter("robot: hero\nscheduler: {rate_hz: 500, priority: 40, cpu: 3}\n"
                                  "rx: {priority: 41, cpu: 2}\nlcm: {enabled: false, state_hz: 50, "
                                  "url: \"udpm://239.1.2.3:7000?ttl=1\"}\n"),
                       "hero.yaml")
          .config.value();
  EXPECT_EQ(config.rate_hz, 500);
  EXPECT_EQ(config.period(), std::chrono::milliseconds{2});
  EXPECT_EQ(config.scheduler.priority, 40);
  EXPECT_EQ(config.scheduler.cpu, 3);
  EXPECT_EQ(config.rx.priority, 41);
  EXPECT_EQ(config.rx.cpu, 2);
  EXPECT_FALSE(config.lcm.enabled);
  EXPECT_EQ(config.lcm.url, "udpm://239.1.2.3:7000?ttl=1");
  EXPECT_EQ(config.lcm.state_hz, 50);
}

TEST(RobotRules, TheBlackBoxHasSixteenMebibytesUnlessOtherwiseSaid) {
  EXPECT_EQ(parseRobotConfig(robotAfter("robot: hero\n"), "").config->blackbox_mib, 16);
  EXPECT_EQ(parseRobotConfig(robotAfter("robot: hero\nblackbox_mib: 0\n"), "").config->blackbox_mib, 0);
  EXPECT_EQ(parseRobotConfig(robotAfter("robot: hero\nblackbox_mib: 256\n"), "").config->blackbox_mib, 256);
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\nblackbox_mib: 257\n")),
              ElementsAre("hero.yaml:2:15: blackbox_mib: 257 is above 256 MiB; use 0 to 256 MiB"));
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\nblackbox_mib: 1.5\n")),
              ElementsAre("hero.yaml:2:15: blackbox_mib: '1.5' is not a whole number; remove the fraction"));
}

TEST(RobotRules, ABooleanIsTrueOrFalseAndNothingElse) {
  for (const std::string text : {"yes", "no", "on", "off", "True", "FALSE", "1"}) {
    EXPECT_THAT(
        errorsOf(robotAfter("robot: hero\nlcm: {enabled: " + text + "}\n")),
        ElementsAre("hero.yaml:2:16: lcm.enabled: '" + text + "' is not true or false; write one of these"));
  }
  EXPECT_THAT(
      errorsOf(robotAfter("robot: hero\nlcm: {enabled: \"true\"}\n")),
      ElementsAre("hero.yaml:2:16: lcm.enabled: 'true' is a text because of its quotes; remove them"));
}

TEST(RobotRules, AQuotedNumberIsAText) {
  EXPECT_THAT(
      errorsOf(robotAfter("robot: hero\nscheduler: {rate_hz: '1000'}\n")),
      ElementsAre("hero.yaml:2:22: scheduler.rate_hz: '1000' is a text because of its quotes; remove them"));
  EXPECT_THAT(errorsOf(robotAfter("robot: hero\nlcm:\n  state_hz: |\n    200\n")),
              Contains(::testing::HasSubstr("is a text because of its quotes; remove them")));
}

TEST(RobotRules, ANameThatManyRobotsHaveMustNotReachTheNetwork) {
  const auto errors = [](const std::string& name, const std::string& lcm) {
    return errorsOf(robotAfter("robot: " + name + "\nlcm: {url: \"udpm://239.255.76.67:7667?" + lcm + "}\n"));
  };
  for (const std::string name : {"demo", "robot"}) {
    EXPECT_THAT(
        errors(name, "ttl=1\""),
        ElementsAre("hero.yaml:2:12: lcm.url: ttl=1 reaches the network, and '" + name +
                    "' is the name of an example: a neighbour's robot would obey; give the robot a name of "
                    "its own, or use ttl=0"));
    EXPECT_THAT(errors(name, "ttl=0\""), IsEmpty());
    EXPECT_THAT(errors(name, "ttl=1\", enabled: false"), IsEmpty());
  }
  EXPECT_THAT(errors("hero", "ttl=1\""), IsEmpty());
}

TEST(RobotRules, WhoMayCommandIsToldWhenLcmLeavesTheComputer) {
  const auto warnings = [](const std::string& lcm) {
    return warningsOf(robotAfter("robot: hero\nlcm: {url: \"udpm://239.255.76.67:7667?" + lcm + "}\n"));
  };
  EXPECT_THAT(
      warnings("ttl=1\""),
      ElementsAre("hero.yaml:2:12: lcm.url: ttl=1 reaches the network, and LCM has no passwords: every "
                  "computer there may command this robot. Use ttl=0, or a network of the robot alone"));
  EXPECT_THAT(warnings("ttl=0\""), IsEmpty());
  EXPECT_THAT(warnings("ttl=1\", enabled: false"), IsEmpty());
}

TEST(RobotRules, TheLcmUrlIsChecked) {
  const auto errors = [](const std::string& url) {
    return errorsOf(robotAfter("robot: hero\nlcm: {url: \"" + url + "\"}\n"));
  };
  EXPECT_THAT(errors("udpm://239.255.76.67:7667"), IsEmpty());
  EXPECT_THAT(errors("memq://"), ElementsAre("hero.yaml:2:12: lcm.url: 'memq://' is not accepted; use "
                                             "udpm://A.B.C.D:PORT?ttl=N"));
  EXPECT_THAT(errors("udpm://239.255.76.67"),
              ElementsAre("hero.yaml:2:12: lcm.url: 'udpm://239.255.76.67' is not "
                          "accepted; use udpm://A.B.C.D:PORT?ttl=N"));
  EXPECT_THAT(
      errors("udpm://192.168.1.1:7667?ttl=1"),
      ElementsAre("hero.yaml:2:12: lcm.url: the address '192.168.1.1' is not valid; use a multicast group, "
                  "224.0.0.0 to 239.255.255.255"));
  EXPECT_THAT(
      errors("udpm://239.255.076.67:7667"),
      ElementsAre("hero.yaml:2:12: lcm.url: the address '239.255.076.67' is not valid; use four numbers of 0 "
                  "to 255 without leading zeros"));
  EXPECT_THAT(errors("udpm://239.255.76.67:70000"),
              ElementsAre("hero.yaml:2:12: lcm.url: the port '70000' is not valid; use 1 to 65535"));
  EXPECT_THAT(
      errors("udpm://239.255.76.67:7667?ttl=256"),
      ElementsAre("hero.yaml:2:12: lcm.url: the option 'ttl=256' is not valid; use ttl=0 to ttl=255, without "
                  "leading zeros"));
}

TEST(RobotRules, AGuardIsWantedWhereMotorsHangOnARealBus) {
  const auto wants = [](const std::string& guard, const std::string& bus) {
    return parseRobotConfig("robot: hero\nguard: " + guard + "\nbuses: [{name: a, " + bus +
                                ", motors: [{name: wheel, model: M3508, id: 1}]}]\n",
                            "hero.yaml")
        .config.value()
        .wantsGuard();
  };
  EXPECT_TRUE(wants("preferred", "interface: can0"));
  EXPECT_TRUE(wants("required", "interface: can0"));
  EXPECT_FALSE(wants("off", "interface: can0"));
  EXPECT_FALSE(wants("preferred", "type: sim"));
}

}  // namespace
}  // namespace rc10::test::robot_rules_test
