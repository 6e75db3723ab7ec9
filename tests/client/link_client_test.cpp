#include "client/link_client.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/greeting.hpp"
#include "fake_rc10d.hpp"

namespace rc10::test::link_client_test {
namespace {

using testing::HasSubstr;

constexpr auto kShort = std::chrono::milliseconds{50};

std::string versionWords(std::uint32_t theirs) {
  return "link version " + std::to_string(theirs) + ", not " + std::to_string(link::kProtocolVersion);
}

std::int64_t nowNs() { return Duration{std::chrono::steady_clock::now().time_since_epoch()}.count(); }

TEST(LinkClientGreeting, SaysHelloAndKeepsTheWelcome) {
  FakeRc10d rc10d;
  auto welcome = heroWelcome();
  rc10d.send(welcome);
  const auto client = LinkClient::adopt(rc10d.takeClientEnd(), "/run/rc10d/hero.sock",
                                        {.name = "tester", .subscriptions = link::kStates | link::kEvents});
  ASSERT_TRUE(client) << client.error().message;
  EXPECT_EQ(client->welcome().robot.view(), "hero");
  EXPECT_EQ(client->welcome().motors[1].name.view(), "yaw");
  link::Hello hello;
  ASSERT_TRUE(rc10d.receive(hello));
  EXPECT_EQ(hello.client.view(), "tester");
  EXPECT_EQ(hello.protocol_version, link::kProtocolVersion);
  EXPECT_EQ(hello.subscriptions, link::kStates | link::kEvents);
}

std::string greetingError(FakeRc10d& rc10d) {
  const auto client =
      LinkClient::adopt(rc10d.takeClientEnd(), "/run/rc10d/hero.sock", {.name = "tester", .timeout = kShort});
  return client ? "no error" : client.error().message;
}

TEST(LinkClientGreeting, OfASilentRc10dFailsAfterTheTimeout) {
  FakeRc10d rc10d;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(greetingError(rc10d), HasSubstr("rc10d for robot 'hero' does not answer"));
  EXPECT_GE(std::chrono::steady_clock::now() - start, kShort);
}

TEST(LinkClientGreeting, OfAnRc10dThatClosesSaysSo) {
  FakeRc10d before_hello;
  before_hello.end();
  EXPECT_THAT(greetingError(before_hello), HasSubstr("rc10d for robot 'hero' closed the connection"));

  FakeRc10d after_hello;
  after_hello.endSending();
  EXPECT_THAT(greetingError(after_hello), HasSubstr("rc10d for robot 'hero' closed the connection"));
}

TEST(LinkClientGreeting, OfAnotherVersionNamesBothVersions) {
  FakeRc10d rc10d;
  auto welcome = heroWelcome();
  welcome.protocol_version = link::kProtocolVersion + 7;
  rc10d.send(welcome);
  const auto error = greetingError(rc10d);
  EXPECT_THAT(error, HasSubstr(versionWords(link::kProtocolVersion + 7)));
  EXPECT_THAT(error, HasSubstr("install both from the same"));
}

TEST(LinkClientGreeting, OfAnotherVersionWithAnotherWelcomeIsUnderstoodAllTheSame) {
  FakeRc10d rc10d;
  struct {
    link::Header header{link::MessageType::kWelcome, 20};
    std::uint32_t version = link::kProtocolVersion + 1;
    std::array<char, 8> news{};
  } other;
  static_assert(sizeof(other) == 20);
  rc10d.sendBytes(std::as_bytes(std::span{&other, 1}));
  EXPECT_THAT(greetingError(rc10d), HasSubstr(versionWords(link::kProtocolVersion + 1)));
}

TEST(LinkClientGreeting, LargerThanAnyKnownWelcomeIsAnotherVersion) {
  FakeRc10d rc10d;
  std::vector<std::byte> bytes(link::kMaxMessageSize + 1000);
  const link::Header header{link::MessageType::kWelcome, static_cast<std::uint32_t>(bytes.size())};
  std::memcpy(bytes.data(), &header, sizeof(header));
  const std::uint32_t version = 1;
  std::memcpy(bytes.data() + sizeof(header), &version, sizeof(version));
  rc10d.sendBytes(bytes);
  EXPECT_THAT(greetingError(rc10d), HasSubstr(versionWords(1)));
}

TEST(LinkClientGreeting, OfSomethingElseIsNotAWelcome) {
  for (const std::size_t size : {1U, 8U, 11U, 100U}) {
    FakeRc10d rc10d;
    rc10d.sendBytes(std::vector<std::byte>(size, std::byte{0x5A}));
    EXPECT_THAT(greetingError(rc10d), HasSubstr("another build"));
  }
}

TEST(LinkClientSend, StampsACommandWithTheTimeOfSending) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  link::Command command;
  command.client = "tester";
  command.setpoint_count = 2;
  command.setpoints[1].target.value = 3.5;
  const auto before = nowNs();
  EXPECT_EQ(client.send(command), LinkClient::SendStatus::kSent);
  link::Command received;
  ASSERT_TRUE(rc10d.receive(received));
  EXPECT_GE(received.received_ns, before);
  EXPECT_LE(received.received_ns, nowNs());
  EXPECT_EQ(received.setpoint_count, 2U);
  EXPECT_EQ(received.setpoints[1].target.value, 3.5);
}

TEST(LinkClientSend, KeepsAStampThatIsThere) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  link::Command command;
  command.received_ns = 1234;
  EXPECT_EQ(client.send(command), LinkClient::SendStatus::kSent);
  link::Request request;
  request.received_ns = 5678;
  EXPECT_EQ(client.send(request), LinkClient::SendStatus::kSent);
  link::Command received;
  ASSERT_TRUE(rc10d.receive(received));
  EXPECT_EQ(received.received_ns, 1234);
  link::Request received_request;
  ASSERT_TRUE(rc10d.receive(received_request));
  EXPECT_EQ(received_request.received_ns, 5678);
}

TEST(LinkClientSend, NeverWaitsForAnRc10dThatDoesNotRead) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  link::Command command;
  command.setpoint_count = link::kMaxMotors;
  auto status = LinkClient::SendStatus::kSent;
  for (int i = 0; i < 10'000 && status == LinkClient::SendStatus::kSent; ++i) status = client.send(command);
  EXPECT_EQ(status, LinkClient::SendStatus::kBusy);
  // It is dropped, and the next is sent as soon as there is room again.
  ASSERT_FALSE(rc10d.receiveBytes().empty());
  EXPECT_EQ(client.send(command), LinkClient::SendStatus::kSent);
}

TEST(LinkClientSend, NoticesThatRc10dHasEnded) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  rc10d.end();
  link::Command command;
  EXPECT_EQ(client.send(command), LinkClient::SendStatus::kClosed);
}

TEST(LinkClientReceive, GivesOneMessageAtATimeAndThenNothing) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  std::vector<std::byte> buffer(link::kMaxMessageSize);
  EXPECT_EQ(client.receive(buffer).status, LinkClient::ReceiveStatus::kNothing);
  link::State state;
  state.tick = 7;
  link::Event event;
  event.code = 9;
  rc10d.send(state);
  rc10d.send(event);
  const auto first = client.receive(buffer);
  ASSERT_EQ(first.status, LinkClient::ReceiveStatus::kMessage);
  link::State received;
  ASSERT_TRUE(link::open(first.datagram, received));
  EXPECT_EQ(received.tick, 7);
  link::Event received_event;
  ASSERT_TRUE(link::open(client.receive(buffer).datagram, received_event));
  EXPECT_EQ(received_event.code, 9);
  EXPECT_EQ(client.receive(buffer).status, LinkClient::ReceiveStatus::kNothing);
}

TEST(LinkClientReceive, DeliversWhatWasSentBeforeTheEnd) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  link::Event event;
  rc10d.send(event);
  rc10d.end();
  std::vector<std::byte> buffer(link::kMaxMessageSize);
  EXPECT_EQ(client.receive(buffer).status, LinkClient::ReceiveStatus::kMessage);
  EXPECT_EQ(client.receive(buffer).status, LinkClient::ReceiveStatus::kClosed);
}

TEST(LinkClientReceive, SkipsWhatIsLargerThanAnyMessage) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  rc10d.sendBytes(std::vector<std::byte>(link::kMaxMessageSize + 1));
  link::Event event;
  rc10d.send(event);
  std::vector<std::byte> buffer(link::kMaxMessageSize);
  const auto received = client.receive(buffer);
  ASSERT_EQ(received.status, LinkClient::ReceiveStatus::kMessage);
  EXPECT_EQ(received.datagram.size(), sizeof(link::Event));
}

TEST(LinkClient, MovesWithItsConnection) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  const int descriptor = client.descriptor();
  LinkClient moved = std::move(client);
  EXPECT_EQ(moved.descriptor(), descriptor);
  link::Command command;
  EXPECT_EQ(moved.send(command), LinkClient::SendStatus::kSent);
}

std::string connectError(const std::string& path) {
  const auto client = LinkClient::connect(path, {.name = "tester", .timeout = kShort});
  return client ? "no error" : client.error().message;
}

TEST(LinkClientConnect, WithoutSocketSaysHowToStart) {
  TemporaryRunDir dir;
  const auto error = connectError(dir.path() + "/hero.sock");
  EXPECT_THAT(error,
              HasSubstr("rc10d is not running for robot 'hero' (no socket " + dir.path() + "/hero.sock)"));
  EXPECT_THAT(error, HasSubstr("`rc10d -c FILE` or `systemctl start rc10d`"));
}

TEST(LinkClientConnect, ToTheSocketOfADeadRc10dSaysHowToStart) {
  TemporaryRunDir dir;
  (void)dir.listen("hero");
  EXPECT_THAT(connectError(dir.path() + "/hero.sock"),
              HasSubstr("not running for robot 'hero' (nobody listens"));
}

TEST(LinkClientConnect, WhileRc10dAcceptsNobodyFailsAfterTheTimeout) {
  TemporaryRunDir dir;
  const auto listener = dir.listen("hero", 0);
  std::vector<UniqueFd> queue;
  for (;;) {  // until the queue of the listener is full
    auto waiting = client::openSocket(dir.path() + "/hero.sock", std::chrono::steady_clock::now());
    if (!waiting) break;
    queue.push_back(std::move(*waiting));
    ASSERT_LT(queue.size(), 100U);
  }
  EXPECT_THAT(connectError(dir.path() + "/hero.sock"), HasSubstr("does not answer"));
}

TEST(LinkClientConnect, ToALongPathSaysThatItIsTooLong) {
  EXPECT_THAT(connectError("/run/" + std::string(200, 'x') + "/hero.sock"), HasSubstr("too long"));
}

TEST(LinkClientConnect, ToSomethingElseSaysSo) {
  EXPECT_EQ(client::connectFailure("/x/hero.sock", EPROTOTYPE),
            "/x/hero.sock is not a socket of rc10d: another program made it");
}

TEST(LinkClientConnect, WhereTheCauseIsNotOursTheLogIsNamed) {
  EXPECT_THAT(client::connectFailure("/x/hero.sock", ENOMEM),
              AllOf(HasSubstr("cannot connect to /x/hero.sock: "), HasSubstr("journalctl -eu 'rc10d*'")));
}

TEST(LinkClientConnect, WithoutPermissionNamesTheGroup) {
  EXPECT_THAT(client::connectFailure("/run/rc10d/hero.sock", EACCES),
              HasSubstr("sudo usermod -aG rc10 $USER"));
}

TEST(LinkClientConnect, ReachesAListeningRc10d) {
  TemporaryRunDir dir;
  const auto listener = dir.listen("hero");
  std::thread server([&listener] {
    const UniqueFd connection{::accept(listener.get(), nullptr, nullptr)};
    std::vector<std::byte> bytes(link::kMaxMessageSize);
    EXPECT_GT(::recv(connection.get(), bytes.data(), bytes.size(), 0), 0);
    auto welcome = heroWelcome();
    const auto sealed = link::seal(welcome);
    EXPECT_GT(::send(connection.get(), sealed.data(), sealed.size(), 0), 0);
  });
  const auto client = LinkClient::connect(dir.path() + "/hero.sock", {.name = "tester"});
  server.join();
  ASSERT_TRUE(client) << client.error().message;
  EXPECT_EQ(client->welcome().robot.view(), "hero");
}

}  // namespace
}  // namespace rc10::test::link_client_test
