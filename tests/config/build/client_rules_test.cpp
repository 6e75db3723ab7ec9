// Rights of senders: `clients`, `tuning`, `clear`.

#include <gmock/gmock.h>

#include "config/config_text.hpp"
#include "config/report/report.hpp"

namespace rc10::test::client_rules_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string robotWithClients(const std::string& clients) {
  return "robot: hero\nclients:\n" + clients +
         "buses:\n  - name: a\n    type: sim\n    motors:\n"
         "      - {name: left, model: M2006, id: 3}\n      - {name: right, model: M2006, id: 4}\n"
         "modules:\n  - {name: lift, type: synchronised_pair, left: left, right: right, velocity_limit_rpm: "
         "100}\n";
}

ClientConfig clientOf(const std::string& entry) {
  const auto loaded = parseRobotConfig(robotWithClients("  - " + entry + "\n"), "hero.yaml");
  EXPECT_TRUE(loaded) << loaded.errorText();
  return loaded.config.value().clients.value().entries.at(0);
}

TEST(ClientRules, WithoutTheKeyThereAreNone) {
  const auto loaded = parseRobotConfig(robotAfter("robot: hero\n"), "hero.yaml");
  EXPECT_FALSE(loaded.config.value().clients);
  EXPECT_EQ(loaded.config->tuning_locked_at, 0);
  EXPECT_EQ(loaded.config->clear_local_at, 0);
}

TEST(ClientRules, AnEmptyListLeavesEverybodyAnObserver) {
  const auto loaded = parseRobotConfig(robotAfter("robot: hero\nclients: []\n"), "hero.yaml");
  ASSERT_TRUE(loaded) << loaded.errorText();
  EXPECT_THAT(loaded.config->clients.value().entries, IsEmpty());
  EXPECT_EQ(loaded.config->clients->line, 2);
}

TEST(ClientRules, AnEntrySaysWhoWhatAndWithWhatPriority) {
  const auto client = clientOf(
      "{lcm: tele.op, may: [observe, command, clear], motors: [right], modules: [lift], max_priority: 50}");
  EXPECT_EQ(client.line, 3);
  EXPECT_EQ(
      parseRobotConfig(robotWithClients("  - {lcm: a, may: [command]}\n"), "hero.yaml").config->clients->line,
      2)
      << "the key's, not that of its list";
  EXPECT_EQ(client.by, ClientConfig::By::kLcmName);
  EXPECT_EQ(client.who, "tele.op");
  EXPECT_TRUE(client.has(Right::kCommand) && client.has(Right::kClear));
  EXPECT_FALSE(client.has(Right::kTune) || client.has(Right::kConfigure));
  EXPECT_THAT(client.motors, ElementsAre(1U));
  EXPECT_THAT(client.modules, ElementsAre(0U));
  EXPECT_FALSE(client.all_motors || client.all_modules);
  EXPECT_EQ(client.max_priority, 50);
}

TEST(ClientRules, WithoutMotorsAndModulesItIsAllAndWithOneOfThemNoneOfTheOther) {
  const auto all = clientOf("{user: 1000, may: [command]}");
  EXPECT_TRUE(all.all_motors && all.all_modules);
  EXPECT_EQ(all.who, "1000");
  const auto some = clientOf("{group: drivers, may: [command], motors: [left]}");
  EXPECT_FALSE(some.all_motors || some.all_modules);
  EXPECT_THAT(some.modules, IsEmpty());
}

TEST(ClientRules, ExactlyOneSaysWhoseRightsTheyAre) {
  EXPECT_THAT(errorsOf(robotWithClients("  - {may: [command]}\n")),
              ElementsAre(HasSubstr("clients[0]: says not whose rights these are; add one of lcm, user")));
  EXPECT_THAT(errorsOf(robotWithClients("  - {lcm: a, user: b, may: [command]}\n")),
              ElementsAre(HasSubstr("clients[0]: says twice whose rights these are")));
}

TEST(ClientRules, ATokenIsGivenByItsHashAlone) {
  const std::string hash(64, 'a');
  EXPECT_EQ(clientOf("{token: " + hash + ", may: [command]}").by, ClientConfig::By::kToken);
  EXPECT_EQ(clientOf("{token: " + hash + ", may: [command]}").who, hash);
  EXPECT_THAT(errorsOf(robotWithClients("  - {token: abcdefghijkmnpqrstuvwxyz23456789, may: [command]}\n")),
              ElementsAre(HasSubstr("rc10ctl web --new-token")));
}

TEST(ClientRules, MistakesAreToldWithTheirPlace) {
  EXPECT_THAT(errorsOf(robotWithClients("  - {lcm: a, may: [comand]}\n")),
              ElementsAre(HasSubstr("did you mean command?")));
  EXPECT_THAT(errorsOf(robotWithClients("  - {lcm: a, may: [command], motors: [lefd]}\n")),
              ElementsAre(HasSubstr("there is no motor 'lefd'; did you mean left?")));
  EXPECT_THAT(errorsOf(robotWithClients("  - {lcm: a, may: [command], modules: [lifd]}\n")),
              ElementsAre(HasSubstr("there is no module 'lifd'; did you mean lift?")));
  EXPECT_THAT(errorsOf(robotWithClients("  - {lcm: lift, may: [command]}\n")),
              ElementsAre(HasSubstr("'lift' is a module, whose name no client may use")));
  EXPECT_THAT(errorsOf(robotWithClients("  - {lcm: a}\n")), ElementsAre(HasSubstr("clients[0].may")));
  EXPECT_THAT(errorsOf(robotWithClients("  - {user: a b, may: [command]}\n")),
              ElementsAre(HasSubstr("clients[0].user")));
}

TEST(ClientRules, AnLcmNameOfARobotWithoutLcmIsAWarning) {
  EXPECT_THAT(
      warningsOf(robotAfter("robot: hero\nlcm: {enabled: false}\nclients: [{lcm: a, may: [command]}]\n")),
      ElementsAre(HasSubstr("nothing comes by LCM")));
}

TEST(ClientRules, TheCheckTellsThem) {
  const auto loaded = parseRobotConfig(
      robotAfter(
          "robot: hero\ntuning: locked\nclear: local\nclients: [{lcm: teleop, may: [command, clear]}]\n"),
      "hero.yaml");
  ASSERT_TRUE(loaded) << loaded.errorText();
  EXPECT_EQ(loaded.config->tuning_locked_at, 2);
  EXPECT_EQ(loaded.config->clear_local_at, 3);
  EXPECT_THAT(describe(*loaded.config),
              AllOf(HasSubstr("teleop (LCM): command, clear; all others observe and stop"),
                    HasSubstr("locked"), HasSubstr("from this computer only")));
}

TEST(ClientRules, WithClientsTheNetworkMayOnlyStop) {
  const std::string url = "robot: hero\nlcm: {url: \"udpm://239.255.76.67:7667?ttl=1\"}\n";
  EXPECT_THAT(warningsOf(robotAfter(url)), ElementsAre(HasSubstr("may command this robot")));
  EXPECT_THAT(warningsOf(robotAfter(url + "clients: []\n")), ElementsAre(HasSubstr("may stop this robot")));
}

}  // namespace
}  // namespace rc10::test::client_rules_test
