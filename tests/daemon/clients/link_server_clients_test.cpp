// `clients` on a real socket: who a sender is, the kernel and the gateway say.

#include <gmock/gmock.h>
#include <unistd.h>

#include "config/sha256.hpp"
#include "daemon/link_rig.hpp"

namespace rc10::test::link_server_clients_test {
namespace {

using link::Origin;
using ::testing::HasSubstr;

ClientConfig commander(ClientConfig::By by, std::string who) {
  ClientConfig client;
  client.line = 8;
  client.by = by;
  client.who = std::move(who);
  client.all_motors = client.all_modules = true;
  client.rights[static_cast<std::size_t>(Right::kCommand)] = true;
  return client;
}

class LinkServerClientsTest : public LinkRig {
 protected:
  void start(const ClientConfig& client) {
    server.reset();
    robot.config_file = "robot.yaml";
    robot.clients = ClientsConfig{.line = 7, .entries = {client}};
    auto socket = LinkSocket::listen(dir.path(), "hero");
    ASSERT_TRUE(socket);
    server =
        LinkServer::create(std::move(*socket), {.exchange = exchange,
                                                .inboxes = inboxes,
                                                .timing = timing,
                                                .robot = robot,
                                                .page_faults = {},
                                                .log = [this](const link::Event& e) { logged.push_back(e); },
                                                .housekeeping = {}})
            .value();
  }
  std::unique_ptr<TestClient> joinWith(std::string_view token, std::string_view name = "web-1") {
    auto client = std::make_unique<TestClient>(path);
    link::Hello hello;
    hello.client = name;
    hello.token = token;
    EXPECT_TRUE(client->send(hello));
    pump();
    EXPECT_TRUE(client->take<link::Welcome>());
    return client;
  }
  bool obeyed(TestClient& client, Origin origin, std::string_view name = "planner") {
    auto message = velocityCommand(++seq_);
    message.client = name;
    message.origin = origin;
    EXPECT_TRUE(client.send(message));
    pump();
    Command command;
    return exchange.commands.pop(command);
  }
  std::optional<link::Response> answer(TestClient& client, std::string_view operation, Origin origin = {}) {
    auto request = linkRequest(++seq_, operation, "left");
    request.origin = origin;
    EXPECT_TRUE(client.send(request));
    pump();
    return client.take<link::Response>();
  }

  std::int64_t seq_ = 0;
};

std::string me() { return std::to_string(::geteuid()); }
std::string somebodyElse() { return std::to_string(::geteuid() + 1); }

TEST_F(LinkServerClientsTest, ATokenGivesTheRightsOfItsEntry) {
  constexpr std::string_view kToken = "abcdefghijkmnpqrstuvwxyz23456789";
  start(commander(ClientConfig::By::kToken, sha256(kToken)));
  EXPECT_TRUE(obeyed(*joinWith(kToken), Origin::kElsewhere));
  EXPECT_FALSE(obeyed(*joinWith({}), Origin::kElsewhere));
  EXPECT_FALSE(obeyed(*joinWith(kToken.substr(1)), Origin::kElsewhere));
  EXPECT_FALSE(obeyed(*joinWith(sha256(kToken)), Origin::kElsewhere)) << "the hash in the file is no token";
}

TEST_F(LinkServerClientsTest, ATokenAddsToTheRightsOfTheUser) {
  start(commander(ClientConfig::By::kUser, me()));
  EXPECT_TRUE(obeyed(*joinWith("abcdefghijkmnpqrstuvwxyz23456789"), Origin::kElsewhere));
}

TEST_F(LinkServerClientsTest, TheGatewayHasNoToken) {
  constexpr std::string_view kToken = "abcdefghijkmnpqrstuvwxyz23456789";
  start(commander(ClientConfig::By::kToken, sha256(kToken)));
  EXPECT_FALSE(obeyed(*joinWith(kToken, link::kGatewayClient), Origin::kThisComputer));
}

TEST_F(LinkServerClientsTest, ATokenOfNoEntryIsNamedInTheRefusal) {
  start(commander(ClientConfig::By::kToken, sha256("another")));
  const auto response = answer(*joinWith("abcdefghijkmnpqrstuvwxyz23456789"), "enable");
  ASSERT_TRUE(response);
  EXPECT_THAT(std::string{response->message.view()}, HasSubstr("its token is in no entry of `clients`"));
}

TEST_F(LinkServerClientsTest, TheKernelSaysWhoAClientOfTheSocketIs) {
  start(commander(ClientConfig::By::kUser, me()));
  EXPECT_TRUE(obeyed(*join(), Origin::kElsewhere));
  start(commander(ClientConfig::By::kUser, somebodyElse()));
  EXPECT_FALSE(obeyed(*join(), Origin::kThisComputer));
}

TEST_F(LinkServerClientsTest, AMemberOfAGroupIsKnownByIt) {
  start(commander(ClientConfig::By::kGroup, std::to_string(::getegid())));
  EXPECT_TRUE(obeyed(*join(), Origin::kElsewhere));
}

TEST_F(LinkServerClientsTest, TheGatewayVouchesForNamesOfThisComputerOnly) {
  start(commander(ClientConfig::By::kLcmName, "planner"));
  auto gateway = join(0, "rc10-lcm");
  EXPECT_TRUE(obeyed(*gateway, Origin::kThisComputer));
  EXPECT_FALSE(obeyed(*gateway, Origin::kThisComputer, "other"));
  EXPECT_FALSE(obeyed(*gateway, Origin::kElsewhere));
  auto pilot = join();
  EXPECT_FALSE(obeyed(*pilot, Origin::kThisComputer)) << "a client of the socket vouches for nobody";
}

TEST_F(LinkServerClientsTest, ARefusalIsToldCountedAndInTheEvents) {
  start(commander(ClientConfig::By::kUser, somebodyElse()));
  auto pilot = join(link::kDiagnosticsFeed);
  const auto response = answer(*pilot, "enable");
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, link::ResponseStatus::kRefused);
  EXPECT_THAT(std::string(response->message.view()), HasSubstr("clients at robot.yaml:7"));
  ASSERT_FALSE(logged.empty());
  EXPECT_EQ(logged.back().code, static_cast<std::int32_t>(EventCode::kCommandRefused));
  EXPECT_THAT(std::string(logged.back().text.view()), HasSubstr("robot.yaml:7"));
  EXPECT_FALSE(obeyed(*pilot, {}));
  publishSnapshot(1);
  const auto diagnostics = await<link::Diagnostics>(*pilot);
  ASSERT_TRUE(diagnostics);
  std::int64_t counted = 0;
  for (std::size_t i = 0; i < diagnostics->refusal_count; ++i) {
    if (diagnostics->refusals[i].name.view() == "not permitted") counted = diagnostics->refusals[i].count;
  }
  EXPECT_EQ(counted, 2);
}

TEST_F(LinkServerClientsTest, AnEstopOfAnObserverStops) {
  start(commander(ClientConfig::By::kUser, somebodyElse()));
  auto pilot = join();
  EXPECT_FALSE(answer(*pilot, "estop")) << "answered by the scheduler";
  EXPECT_TRUE(exchange.estop.load());
  EXPECT_EQ(takeOrder().operation, Operation::kEstop);
}

}  // namespace
}  // namespace rc10::test::link_server_clients_test
