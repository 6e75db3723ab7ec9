// Clients that misbehave: whatever one of them does, the others are served.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "daemon/link_rig.hpp"

namespace rc10::test::link_server_strangers_test {
namespace {

class LinkServerStrangersTest : public LinkRig {
 protected:
  /// A client gets an answer.
  void expectServed(TestClient& client) {
    static std::int64_t seq = 1000;
    ASSERT_TRUE(client.send(linkRequest(++seq, "dance")));
    pump();
    EXPECT_TRUE(client.take<link::Response>());
  }
  /// Fate of a client that says hello and then sends these bytes.
  bool isSentAwayFor(const void* bytes, std::size_t size) {
    auto client = join();
    EXPECT_TRUE(client->sendBytes(bytes, size));
    pump();
    return client->sentAway();
  }
  bool isSentAwayFor(link::Header header, std::size_t size) {
    std::vector<std::byte> bytes(size);
    std::memcpy(bytes.data(), &header, std::min(size, sizeof header));
    return isSentAwayFor(bytes.data(), size);
  }
};

TEST_F(LinkServerStrangersTest, GarbageSendsTheClientAwayAndNobodyElse) {
  auto other = join();
  EXPECT_TRUE(isSentAwayFor("garbage!garbage!", 16));
  expectServed(*other);
}

TEST_F(LinkServerStrangersTest, ClientsThatNeverSayHelloDoNotKeepOthersOut) {
  auto other = join();
  std::vector<std::unique_ptr<TestClient>> silent;
  for (int i = 0; i < 40; ++i) {
    silent.push_back(std::make_unique<TestClient>(path));
    pump();
  }
  EXPECT_TRUE(silent.front()->sentAway());
  auto late = join();
  expectServed(*late);
  expectServed(*other);
}

TEST_F(LinkServerStrangersTest, AMessageShorterThanAHeaderSendsTheClientAway) {
  EXPECT_TRUE(isSentAwayFor("abc", 3));
}

TEST_F(LinkServerStrangersTest, AnEmptyMessageSendsTheClientAway) { EXPECT_TRUE(isSentAwayFor("", 0)); }

TEST_F(LinkServerStrangersTest, HalfAMessageSendsTheClientAway) {
  auto request = linkRequest(1, "enable");
  const auto bytes = link::seal(request);
  EXPECT_TRUE(isSentAwayFor(bytes.data(), bytes.size() / 2));
  auto command = velocityCommand(1);
  const auto command_bytes = link::seal(command);
  EXPECT_TRUE(isSentAwayFor(command_bytes.data(), command_bytes.size() - 1));
  EXPECT_EQ(exchange.orders.read_available(), 0U);
  EXPECT_EQ(exchange.commands.read_available(), 0U);
}

TEST_F(LinkServerStrangersTest, AShortMessageWithAnHonestHeaderSendsTheClientAway) {
  EXPECT_TRUE(isSentAwayFor({link::MessageType::kRequest, 64}, 64));
}

TEST_F(LinkServerStrangersTest, ARequestWithMoreValuesThanThereIsRoomSendsTheClientAway) {
  auto request = linkRequest(1, "estop");
  request.value_count = link::kMaxValues + 1;
  const auto bytes = link::seal(request);
  EXPECT_TRUE(isSentAwayFor(bytes.data(), bytes.size()));
}

TEST_F(LinkServerStrangersTest, AnEstopIsObeyedWhateverElseItsMessageSays) {
  auto too_many = linkRequest(1, "estop");
  too_many.value_count = 1000;
  const auto sealed = link::seal(too_many);
  EXPECT_TRUE(isSentAwayFor(sealed.data(), sealed.size())) << "it does not speak our protocol";
  EXPECT_TRUE(exchange.estop.exchange(false));
  for (const auto cut : {std::size_t{1}, sealed.size() / 2, sizeof(link::Request::values)}) {
    EXPECT_TRUE(isSentAwayFor(sealed.data(), sealed.size() - cut));
    EXPECT_TRUE(exchange.estop.exchange(false)) << "cut off by " << cut;
  }
  auto unknown = linkRequest(2, "estop");
  unknown.target = "no,such,motors";
  auto client = join();
  ASSERT_TRUE(client->send(unknown));
  pump();
  EXPECT_TRUE(exchange.estop.exchange(false));
  auto other = linkRequest(3, "estopped");
  other.value_count = 1000;
  const auto others = link::seal(other);
  EXPECT_TRUE(isSentAwayFor(others.data(), others.size()));
  EXPECT_FALSE(exchange.estop.load());
}

TEST_F(LinkServerStrangersTest, ATypeThatNoClientSendsSendsTheClientAway) {
  EXPECT_TRUE(isSentAwayFor({link::MessageType::kState, 64}, 64));
  EXPECT_TRUE(isSentAwayFor({link::MessageType{77}, 64}, 64));
  EXPECT_TRUE(isSentAwayFor({link::MessageType::kHello, sizeof(link::Hello)}, sizeof(link::Hello)));
}

TEST_F(LinkServerStrangersTest, AMessageLargerThanAnyThereIsSendsTheClientAway) {
  const auto size = link::kMaxMessageSize + 1;
  EXPECT_TRUE(isSentAwayFor({link::MessageType::kCommand, static_cast<std::uint32_t>(size)}, size));
}

TEST_F(LinkServerStrangersTest, HalfAHelloSendsTheClientAwayWithoutAWelcome) {
  TestClient client(path);
  link::Hello hello;
  const auto bytes = link::seal(hello);
  ASSERT_TRUE(client.sendBytes(bytes.data(), bytes.size() - 4));
  pump();
  EXPECT_FALSE(client.take<link::Welcome>());
  EXPECT_TRUE(client.sentAway());
}

TEST_F(LinkServerStrangersTest, AClientThatNeverReadsBlocksNobody) {
  auto deaf = join(link::kEvents | link::kStates | link::kDiagnosticsFeed);
  auto client = join(link::kEvents);
  int received = 0;
  for (int round = 0; round < 20; ++round) {
    for (int i = 0; i < 100; ++i)
      exchange.events.push({EventCode::kTicksMissed, Severity::kInfo, -1, i, 0, {}});
    for (int i = 0; i < 100; ++i) received += await<link::Event>(*client).has_value() ? 1 : 0;
  }
  EXPECT_EQ(received, 2000);  // more than any socket buffer holds
  expectServed(*client);
  // It lost messages, not its connection.
  int seen = 0;
  while (deaf->take<link::Event>()) ++seen;
  EXPECT_GT(seen, 0);
  EXPECT_LT(seen, 2000);
  expectServed(*deaf);
}

TEST_F(LinkServerStrangersTest, AnEventThatFoundNoRoomIsReadBeforeAnyYoungerState) {
  auto slow = join(link::kEvents | link::kStates);
  for (std::uint64_t tick = 1; tick < 2000; ++tick) {
    publishSnapshot(tick);
    server->poll(2);
  }
  exchange.events.push({EventCode::kRobotState, Severity::kError, -1, 0, 0, {}});
  pump();
  publishSnapshot(5000);
  // All that filled its socket.
  std::uint64_t newest = 0;
  while (auto state = slow->take<link::State>()) newest = static_cast<std::uint64_t>(state->tick);
  EXPECT_LT(newest, 2000U);
  const auto event = await<link::Event>(*slow);
  ASSERT_TRUE(event);
  EXPECT_EQ(EventCode{event->code}, EventCode::kRobotState);
  const auto state = await<link::State>(*slow);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->tick, 5000);
}

TEST_F(LinkServerStrangersTest, AClientThatReadsNothingIsToldOnceUntilItReadsAgain) {
  auto deaf = join(link::kEvents);
  auto client = join(link::kEvents);
  const auto told = [this] {
    return std::count_if(logged.begin(), logged.end(), [](const link::Event& event) {
      return event.text.view().find("reads nothing") != std::string_view::npos;
    });
  };
  const auto loseHundreds = [&](int hundreds) {
    for (int hundred = 0; hundred < hundreds; ++hundred) {
      for (int i = 0; i < 100; ++i)
        exchange.events.push({EventCode::kTicksMissed, Severity::kInfo, -1, i, 0, {}});
      for (int i = 0; i < 100; ++i) EXPECT_TRUE(await<link::Event>(*client));
    }
    pump();
  };
  loseHundreds(20);
  EXPECT_EQ(told(), 1);
  loseHundreds(2);
  EXPECT_EQ(told(), 1);
  while (deaf->take<link::Event>()) continue;
  loseHundreds(20);
  EXPECT_EQ(told(), 2);
}

TEST_F(LinkServerStrangersTest, AClientHearsWhyItIsRefusedThoughAnotherWasAMomentAgo) {
  auto first = join(link::kEvents);
  auto second = join(link::kEvents);
  const auto wrong = linkCommand(1, MonotonicTime::max(), {setpoint("nobody", ControlMode::kVelocity, 1.0)});
  ASSERT_TRUE(first->send(wrong));
  pump();
  ASSERT_TRUE(second->send(wrong));
  pump();
  const auto heard = [](TestClient& client) {
    int events = 0;
    while (client.take<link::Event>()) ++events;
    return events;
  };
  EXPECT_EQ(heard(*first), 1);
  EXPECT_EQ(heard(*second), 2) << "the other's and its own";
  EXPECT_EQ(logged.size(), 1U);
}

// More answers than its socket holds.
TEST_F(LinkServerStrangersTest, EveryAnswerOfABurstArrives) {
  auto client = join();
  std::int64_t asked = 0;
  while (asked < 160) {
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(client->send(linkRequest(++asked, "dance")));
    pump();
  }
  std::int64_t answered = 0;
  for (int turn = 0; turn < 100 && answered < asked; ++turn) {
    while (const auto response = client->take<link::Response>()) EXPECT_EQ(response->seq, ++answered);
    server->poll(100);
  }
  EXPECT_EQ(answered, asked);
  expectServed(*client);
}

TEST_F(LinkServerStrangersTest, AClientThatLeavesItsAnswersUnreadIsSentAwayAndKnowsIt) {
  auto deaf = join();
  auto client = join();
  for (std::int64_t asked = 0; asked < 2000; ++asked) {
    (void)deaf->send(linkRequest(asked, "dance"));
    if (asked % 50 == 0) pump();
  }
  for (int turn = 0; turn < 5; ++turn) server->poll(100);  // some turns of the slow timer
  std::int64_t answered = 0;
  while (deaf->take<link::Response>()) ++answered;
  EXPECT_LT(answered, 2000);
  EXPECT_TRUE(deaf->sentAway());
  expectServed(*client);
}

TEST_F(LinkServerStrangersTest, WithoutDescriptorsAClientIsSentAwayAndTheLogSaysWhy) {
  auto client = join();
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  TestClient late(path);
  const int highest = ::dup(0);
  ::close(highest);
  const rlimit none{.rlim_cur = static_cast<rlim_t>(highest), .rlim_max = before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  server->poll(0);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_TRUE(late.sentAway());
  ASSERT_EQ(logged.size(), 1U);
  EXPECT_THAT(std::string(logged[0].text.view()), testing::HasSubstr("no file descriptors left"));
  expectServed(*client);
  expectServed(*join());
}

TEST_F(LinkServerStrangersTest, AClientThatSendsWithoutPauseLeavesTheOthersTheirTurn) {
  auto flood = join();
  auto client = join();
  for (int i = 1; i <= 60; ++i) ASSERT_TRUE(flood->send(velocityCommand(i)));
  auto request = linkRequest(1, "dance");
  ASSERT_TRUE(client->send(request));
  server->poll(0);
  EXPECT_TRUE(client->take<link::Response>());
  EXPECT_EQ(exchange.commands.read_available(), 1U);
  for (int i = 0; i < 60; ++i) server->poll(0);
  EXPECT_EQ(exchange.commands.read_available(), 60U);
}

TEST_F(LinkServerStrangersTest, TheSeventeenthConnectionIsRefusedUntilOneLeaves) {
  std::vector<std::unique_ptr<TestClient>> clients;
  for (int i = 0; i < 16; ++i) clients.push_back(join(0, link::kWebClient));  // not bounded by its process
  TestClient seventeenth(path);
  (void)seventeenth.send(link::Hello{});
  pump();
  EXPECT_TRUE(seventeenth.sentAway());
  ASSERT_EQ(logged.size(), 1U);
  EXPECT_THAT(std::string(logged[0].text.view()), testing::HasSubstr("all 16 seats are taken"));
  for (auto& client : clients) expectServed(*client);
  clients[7]->leave();
  pump();
  expectServed(*join());
}

TEST_F(LinkServerStrangersTest, AProcessThatConnectsAgainAndAgainLeavesFourSeatsToOthers) {
  std::vector<std::unique_ptr<TestClient>> clients;
  for (int i = 0; i < 12; ++i) clients.push_back(join());
  TestClient thirteenth(path);
  link::Hello hello;
  hello.client = "leak";
  ASSERT_TRUE(thirteenth.send(hello));
  pump();
  EXPECT_TRUE(thirteenth.sentAway());
  ASSERT_EQ(logged.size(), 1U);
  EXPECT_THAT(
      std::string(logged[0].text.view()),
      testing::AllOf(testing::HasSubstr("client 'leak' was sent away"),
                     testing::HasSubstr("(pid " + std::to_string(::getpid()) + ") has 12 connections")));
  clients[3]->leave();
  pump();
  expectServed(*join());
  // A server of pages is not bounded so.
  expectServed(*join(0, link::kWebClient));
}

TEST_F(LinkServerStrangersTest, AGatewayThatComesBackFindsItsSeatWhoeverIsThere) {
  std::vector<std::unique_ptr<TestClient>> clients;
  for (int i = 0; i < 16; ++i) clients.push_back(join(0, link::kWebClient));  // not bounded by its process
  TestClient silent(path);
  for (int restart = 0; restart < 2; ++restart) {
    TestClient gateway(path);
    link::Hello hello;
    hello.client = link::kGatewayClient;
    ASSERT_TRUE(gateway.send(hello));
    pump();
    EXPECT_TRUE(gateway.take<link::Welcome>());
    gateway.leave();
    pump();
  }
  for (auto& client : clients) expectServed(*client);
}

TEST_F(LinkServerStrangersTest, AbruptDisconnectsHurtNobody) {
  auto other = join(link::kEvents);
  auto client = join(link::kEvents | link::kStates);
  ASSERT_TRUE(client->send(linkRequest(1, "enable")));
  pump();
  const auto order = takeOrder();
  // It goes with a request under way, messages unread and messages unhandled.
  ASSERT_TRUE(client->send(velocityCommand(1)));
  client->leave();
  TestClient(path).leave();
  finish(order);
  exchange.events.push({EventCode::kTicksMissed, Severity::kInfo, -1, 1, 0, {}});
  EXPECT_TRUE(await<link::Event>(*other));
  EXPECT_FALSE(other->take<link::Response>());
  expectServed(*other);
  expectServed(*join());
}

TEST_F(LinkServerStrangersTest, AClientThatComesBackGetsTheAnswerItMissed) {
  auto client = join();
  ASSERT_TRUE(client->send(linkRequest(1, "enable")));
  pump();
  client->leave();
  pump();
  finish(takeOrder());
  auto again = join();
  ASSERT_TRUE(again->send(linkRequest(1, "enable")));
  const auto response = await<link::Response>(*again);
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, link::ResponseStatus::kOk);
  EXPECT_EQ(exchange.orders.read_available(), 0U);
}

}  // namespace
}  // namespace rc10::test::link_server_strangers_test
