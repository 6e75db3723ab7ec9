#include "daemon/clients/permissions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "daemon/clients/request_desk.hpp"
#include "daemon/clients/signal_admission.hpp"
#include "daemon/described_robot.hpp"
#include "daemon/link_messages.hpp"
#include "daemon/temp_dir.hpp"

namespace rc10::test::permissions_test {
namespace {

using namespace std::chrono_literals;
using link::ResponseStatus;
using ::testing::AllOf;
using ::testing::HasSubstr;
using By = ClientConfig::By;
using Way = Speaker::Way;

ClientConfig clientAt(int line, By by, std::string who, const std::vector<Right>& rights) {
  ClientConfig client;
  client.line = line;
  client.by = by;
  client.who = std::move(who);
  client.all_motors = client.all_modules = true;
  for (const auto right : rights) client.rights[static_cast<std::size_t>(right)] = true;
  return client;
}

ClientConfig ofMotors(ClientConfig client, std::vector<std::size_t> motors) {
  client.all_motors = client.all_modules = false;
  client.motors = std::move(motors);
  return client;
}

Permissions::Rules robot(std::vector<ClientConfig> entries) {
  Permissions::Rules rules;
  rules.clients = ClientsConfig{.line = 7, .entries = std::move(entries)};
  rules.file = "robot.yaml";
  rules.motors = {"left", "right", "yaw"};
  rules.modules = {"base", "arm"};
  return rules;
}

Permissions::Rules robotWithoutClients() {
  auto rules = robot({});
  rules.clients.reset();
  return rules;
}

/// The link thread's gates, behind one set of rules.
struct Gates {
  explicit Gates(const Permissions::Rules& rules) : permissions(Permissions::resolve(rules).value()) {}

  Speaker user(uid_t user, std::vector<gid_t> groups = {}) const {
    return {.connection = 5, .user = user, .grants = permissions.ofUser(user, groups)};
  }
  Speaker lcm(std::string_view client) const {
    return {.way = Way::kLcm, .grants = permissions.ofLcmClient(client)};
  }

  CommandRefusal command(const Speaker& speaker, std::string_view motor, std::int32_t priority = 0,
                         std::string_view client = "planner") {
    auto message = linkCommand(++seq, now, {setpoint(motor, ControlMode::kCoast)});
    message.priority = priority;
    message.client = client;
    return admission.admit(message, speaker, now, accepted);
  }
  CommandRefusal signals(const Speaker& speaker, std::string_view module) {
    link::Signals message;
    message.client = "planner";
    message.session = 7;
    message.seq = ++seq;
    message.module = module;
    message.received_ns = now.time_since_epoch().count();
    message.value_count = 1;
    message.values[0] = {.name = std::string_view{"speed"}, .value = 1.0};
    return signal_admission.admit(message, speaker, now, accepted_signals);
  }
  RequestDesk::Outcome ask(const Speaker& speaker, std::string_view operation, std::string_view target,
                           std::string_view client = "pilot") {
    auto request = linkRequest(++seq, operation, target);
    request.client = client;
    return desk.begin(request, speaker, kAnyTime);
  }
  bool permits(const Speaker& speaker, std::string_view operation, std::string_view target) {
    return ask(speaker, operation, target).not_permitted.empty();
  }

  MonotonicTime now{1000s};
  std::int64_t seq = 0;
  Permissions permissions;
  static RobotDescription described() {
    auto robot = describedRobot({"left", "right", "yaw"});
    addModule(robot, "base", {"speed"});
    addModule(robot, "arm", {"speed"});
    return robot;
  }
  RobotDescription robot = described();
  Admission admission{robot, permissions};
  SignalAdmission signal_admission{robot, permissions};
  RequestDesk desk{admission, robot};
  Command accepted;
  SignalMessage accepted_signals;
};

constexpr uid_t kAnna = 1000;
constexpr std::array<std::pair<const char*, Right>, 7> kOperations{{{"enable", Right::kCommand},
                                                                    {"enable_alone", Right::kCommand},
                                                                    {"hand", Right::kCommand},
                                                                    {"load", Right::kCommand},
                                                                    {"disable", Right::kCommand},
                                                                    {"zero", Right::kCommand},
                                                                    {"clear", Right::kClear}}};

TEST(PermissionsTest, WithoutTheKeyEverybodyMayDoEverything) {
  Gates gates{robotWithoutClients()};
  for (const auto& [operation, right] : kOperations) EXPECT_TRUE(gates.permits({}, operation, "left"));
  EXPECT_EQ(gates.command({.way = Way::kNetwork}, "left"), CommandRefusal::kNone);
  EXPECT_EQ(gates.signals(gates.user(kAnna), "base"), CommandRefusal::kNone);
}

TEST(PermissionsTest, EveryOperationNeedsItsRightAndNoOther) {
  for (std::size_t granted = 0; granted < kRightWords.size(); ++granted) {
    Gates gates{robot({clientAt(8, By::kUser, "1000", {static_cast<Right>(granted)})})};
    const auto anna = gates.user(kAnna);
    const auto has = [&](Right right) { return static_cast<Right>(granted) == right; };
    for (const auto& [operation, right] : kOperations)
      EXPECT_EQ(gates.permits(anna, operation, "left"), has(right)) << operation << kRightWords[granted];
    EXPECT_EQ(gates.command(anna, "left") == CommandRefusal::kNone, has(Right::kCommand));
    EXPECT_EQ(gates.signals(anna, "base") == CommandRefusal::kNone, has(Right::kCommand));
    for (const auto right : {Right::kTune, Right::kConfigure})
      EXPECT_EQ(gates.permissions.whyNoRequest(anna, "pilot", right, MotorSet{1}, false).empty(), has(right));
  }
}

TEST(PermissionsTest, AnObserverMayAskAndStopAndNothingElse) {
  Gates gates{robot({})};
  for (const auto& speaker : {gates.user(0), gates.lcm("planner"), Speaker{.way = Way::kNetwork}}) {
    for (const auto& [operation, right] : kOperations) {
      const auto outcome = gates.ask(speaker, operation, "left");
      EXPECT_FALSE(outcome.order) << operation;
      ASSERT_TRUE(outcome.response);
      EXPECT_EQ(outcome.response->status, ResponseStatus::kRefused);
    }
    EXPECT_EQ(gates.command(speaker, "left"), CommandRefusal::kNotPermitted);
    EXPECT_EQ(gates.signals(speaker, "base"), CommandRefusal::kNotPermitted);
    EXPECT_TRUE(gates.permits(speaker, "get_config", "left"));
    EXPECT_TRUE(gates.permits(speaker, "drive-settings", "left"));
  }
}

TEST(PermissionsTest, AnEstopIsTakenFromAnybodyInAnyShape) {
  Gates gates{robot({})};
  for (const auto* target : {"", "left", "nobody"}) {
    for (const auto& speaker : {gates.user(0), gates.lcm("x"), Speaker{.way = Way::kNetwork}}) {
      EXPECT_TRUE(gates.ask(speaker, "estop", target).estop) << target;
      EXPECT_TRUE(gates.ask(speaker, "estop", target, "base").estop) << "under the name of a module";
      EXPECT_TRUE(gates.permits(speaker, "estop", target));
    }
  }
}

TEST(PermissionsTest, MotorsThatAreNotNamedAreOthers) {
  Gates gates{
      robot({ofMotors(clientAt(8, By::kLcmName, "planner", {Right::kCommand, Right::kClear}), {0, 1})})};
  const auto planner = gates.lcm("planner");
  EXPECT_EQ(gates.command(planner, "left"), CommandRefusal::kNone);
  EXPECT_EQ(gates.command(planner, "yaw"), CommandRefusal::kNotPermitted);
  EXPECT_THAT(gates.admission.whyNotPermitted(),
              AllOf(HasSubstr("'planner' (LCM, this computer) may not command yaw"),
                    HasSubstr("add it to `motors` at robot.yaml:8")));
  EXPECT_TRUE(gates.permits(planner, "zero", "left"));
  EXPECT_FALSE(gates.permits(planner, "zero", "yaw"));
  EXPECT_FALSE(gates.permits(planner, "enable", "")) << "no target means all motors";
  EXPECT_TRUE(gates.permits(planner, "enable", "left,right"));
  EXPECT_FALSE(gates.permits(planner, "clear", "")) << "the whole robot is more than two motors";
  EXPECT_EQ(gates.signals(planner, "base"), CommandRefusal::kNotPermitted) << "motors alone are no modules";
}

TEST(PermissionsTest, ModulesThatAreNotNamedAreOthers) {
  auto client = clientAt(8, By::kLcmName, "planner", {Right::kCommand});
  client.all_motors = client.all_modules = false;
  client.modules = {1};
  Gates gates{robot({client})};
  EXPECT_EQ(gates.signals(gates.lcm("planner"), "arm"), CommandRefusal::kNone);
  EXPECT_EQ(gates.signals(gates.lcm("planner"), "base"), CommandRefusal::kNotPermitted);
  EXPECT_THAT(gates.signal_admission.whyNotPermitted(), HasSubstr("add it to `modules` at robot.yaml:8"));
  EXPECT_EQ(gates.command(gates.lcm("planner"), "left"), CommandRefusal::kNotPermitted);
}

TEST(PermissionsTest, PriorityEndsWhereTheFileSays) {
  auto client = clientAt(8, By::kUser, "1000", {Right::kCommand});
  client.max_priority = 10;
  Gates gates{robot({client})};
  EXPECT_EQ(gates.command(gates.user(kAnna), "left", 10), CommandRefusal::kNone);
  EXPECT_EQ(gates.command(gates.user(kAnna), "left", 11), CommandRefusal::kNotPermitted);
  EXPECT_THAT(gates.admission.whyNotPermitted(),
              HasSubstr("with priority 11: raise max_priority at robot.yaml:8"));
}

TEST(PermissionsTest, EntriesOfOneSenderAddUp) {
  Gates gates{robot({ofMotors(clientAt(8, By::kUser, "1000", {Right::kCommand}), {0}),
                     ofMotors(clientAt(9, By::kGroup, "44", {Right::kCommand}), {1})})};
  EXPECT_TRUE(gates.permits(gates.user(kAnna, {44}), "enable", "left,right"));
  EXPECT_FALSE(gates.permits(gates.user(kAnna, {45}), "enable", "left,right"));
  EXPECT_FALSE(gates.permits(gates.user(kAnna, {44}), "enable", "yaw"));
}

TEST(PermissionsTest, ANameOnLcmIsNoUserAndFromAnotherComputerItIsNobody) {
  Gates gates{robot({clientAt(8, By::kLcmName, "planner", {Right::kCommand})})};
  EXPECT_EQ(gates.command(gates.lcm("planner"), "left"), CommandRefusal::kNone);
  EXPECT_EQ(gates.command(gates.user(kAnna), "left"), CommandRefusal::kNotPermitted);
  EXPECT_EQ(gates.command({.way = Way::kNetwork}, "left"), CommandRefusal::kNotPermitted);
  EXPECT_THAT(gates.admission.whyNotPermitted(), HasSubstr("nobody vouches for names there"));
}

TEST(PermissionsTest, WhoIsNotNamedIsToldTheLineToWrite) {
  Gates gates{robot({})};
  EXPECT_EQ(gates.ask(gates.user(kAnna), "clear", "left").not_permitted,
            "'pilot' (user 1000) may observe and stop, not clear left: add `- {user: 1000, may: [clear]}` to "
            "clients at robot.yaml:7");
  EXPECT_THAT(gates.ask(gates.lcm("pilot"), "zero", "yaw").not_permitted,
              HasSubstr("add `- {lcm: pilot, may: [command]}` to clients at robot.yaml:7"));
}

TEST(PermissionsTest, AnEntryWithoutTheRightIsNamed) {
  Gates gates{robot({clientAt(8, By::kUser, "1000", {Right::kClear})})};
  EXPECT_THAT(gates.ask(gates.user(kAnna), "enable", "left").not_permitted,
              HasSubstr("add command to `may` at robot.yaml:8"));
}

TEST(PermissionsTest, NobodyUsesTheNameOfAModule) {
  for (const bool with_clients : {false, true}) {
    auto rules = robot({clientAt(8, By::kUser, "1000", {Right::kCommand})});
    if (!with_clients) rules.clients.reset();
    Gates gates{rules};
    EXPECT_EQ(gates.command(gates.user(kAnna), "left", 0, "base"), CommandRefusal::kNotPermitted);
    EXPECT_THAT(gates.admission.whyNotPermitted(), HasSubstr("'base' is a module"));
    EXPECT_FALSE(gates.ask(gates.user(kAnna), "disable", "left", "base").order);
  }
}

TEST(PermissionsTest, NobodyUsesAnothersSession) {
  Gates gates{robotWithoutClients()};
  EXPECT_EQ(gates.command(gates.lcm("planner"), "left"), CommandRefusal::kNone);
  for (const auto& other : {gates.user(kAnna), Speaker{.way = Way::kNetwork}})
    EXPECT_EQ(gates.command(other, "left"), CommandRefusal::kNotPermitted);
  EXPECT_THAT(gates.admission.whyNotPermitted(), HasSubstr("session"));
  auto restarted = gates.lcm("planner");
  restarted.connection = 99;  // the gateway was started again
  EXPECT_EQ(gates.command(restarted, "left"), CommandRefusal::kNone);
  EXPECT_EQ(gates.signals(gates.lcm("planner"), "base"), CommandRefusal::kNone);
  EXPECT_EQ(gates.signals(gates.user(kAnna), "base"), CommandRefusal::kNotPermitted);
}

TEST(PermissionsTest, ARefusalForWantOfARightIsNotRemembered) {
  Gates gates{robot({})};
  const auto request = linkRequest(1, "clear", "left");
  EXPECT_FALSE(gates.desk.begin(request, {.way = Way::kLcm}, kAnyTime).not_permitted.empty());
  Gates granted{robot({clientAt(8, By::kLcmName, "pilot", {Right::kClear})})};
  EXPECT_FALSE(granted.desk.begin(request, {.way = Way::kLcm}, kAnyTime).order);
  EXPECT_TRUE(granted.desk.begin(request, granted.lcm("pilot"), kAnyTime).order);
}

TEST(PermissionsTest, LockedTuningIsNobodys) {
  auto rules = robot({clientAt(8, By::kUser, "1000", {Right::kTune, Right::kConfigure})});
  rules.tuning_locked_at = 3;
  const Gates gates{rules};
  for (const auto right : {Right::kTune, Right::kConfigure}) {
    EXPECT_THAT(gates.permissions.whyNoRequest(gates.user(kAnna), "pilot", right, MotorSet{1}, false),
                HasSubstr("`tuning: locked` at robot.yaml:3"));
  }
}

TEST(PermissionsTest, AnEstopIsClearedHereOnlyIfTheFileSaysSo) {
  auto rules = robotWithoutClients();
  rules.clear_local_at = 4;
  Gates gates{rules};
  const Speaker elsewhere{.way = Way::kNetwork};
  EXPECT_THAT(gates.ask(elsewhere, "clear", "").not_permitted, HasSubstr("`clear: local` at robot.yaml:4"));
  EXPECT_TRUE(gates.permits(elsewhere, "clear", "left")) << "the fault of a motor";
  EXPECT_TRUE(gates.permits(gates.lcm("pilot"), "clear", ""));
  EXPECT_TRUE(gates.permits(gates.user(kAnna), "clear", ""));
}

TEST(PermissionsTest, UsersAndGroupsAreThoseOfThisComputer) {
  const TempDir etc;
  std::ofstream(etc.path() + "/passwd") << "anna:x:1234:100::/home/anna:/bin/sh\n";
  std::ofstream(etc.path() + "/group") << "drivers:x:2345:\n";
  const auto known = Permissions::resolve(
      robot({clientAt(8, By::kUser, "anna", {}), clientAt(9, By::kGroup, "drivers", {})}), etc.path());
  ASSERT_TRUE(known);
  EXPECT_EQ(known->ofUser(1234, {}), GrantSet{0b01});
  EXPECT_EQ(known->ofUser(1, {1, 2345}), GrantSet{0b10});
  const auto unknown = Permissions::resolve(robot({clientAt(8, By::kUser, "drivers", {})}), etc.path());
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("robot.yaml:8: clients: there is no user 'drivers'"));
  EXPECT_FALSE(Permissions::resolve(robot({clientAt(8, By::kGroup, "anna", {})}), etc.path()));
}

}  // namespace
}  // namespace rc10::test::permissions_test
