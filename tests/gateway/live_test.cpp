// The whole gateway between a fake rc10d and real liblcm clients, on a network of its own.

#include <arpa/inet.h>

#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/sample_messages.hpp"
#include "gateway/udpm_datagram.hpp"
#include "live_gateway.hpp"
#include "private_network.hpp"

namespace rc10::gateway::test::live_test {
namespace {

using namespace std::chrono_literals;
using rc10::test::addLcmRoute;
using rc10::test::commandWith;
using rc10::test::encoded;
using rc10::test::inPrivateNetwork;
using rc10::test::requestWith;
using testing::HasSubstr;

// CLOCK_REALTIME and CLOCK_MONOTONIC are read one after the other: between them, a busy machine may pause.
constexpr std::int64_t kPlayNs = 20'000'000;

TEST(LiveGateway, PassesCommandsOnWithTheKernelsReceiveTime) {
  inPrivateNetwork([] {
    ASSERT_TRUE(addLcmRoute());
    GatewayProcess gateway;
    LcmClient client;
    gateway.awaitReady(client);
    for (std::int64_t seq = 1; seq <= 20; ++seq) {
      const auto before = nowNs();
      client.command(seq);
      const auto after = nowNs();
      link::Command command;
      ASSERT_TRUE(gateway.rc10d().await(command));
      EXPECT_EQ(command.seq, seq);
      EXPECT_GE(command.received_ns, before - kPlayNs);
      EXPECT_LE(command.received_ns, after + kPlayNs);
    }
  });
}

// A defect of liblcm: its stamp of a datagram that follows one of another channel, or of any after the
// first 2000, is the time of reading.
TEST(LiveGateway, CommandsThatWaitedWhileItWasStoppedKeepTheirAge) {
  inPrivateNetwork([] {
    ASSERT_TRUE(addLcmRoute());
    GatewayProcess gateway;
    LcmClient client;
    gateway.awaitReady(client);
    gateway.stop();
    const auto before = nowNs();
    for (std::int64_t seq = 1; seq <= 3; ++seq) {
      client.publish("hero.v1.state", Bytes(200));
      client.publish("CAMERA", Bytes(60'000));
      client.command(seq);
    }
    const auto after = nowNs();
    while (nowNs() <= after + 2 * kPlayNs)
      std::this_thread::sleep_for(1ms);  // so the time of reading is another
    gateway.resume();
    for (std::int64_t seq = 1; seq <= 3; ++seq) {
      link::Command command;
      ASSERT_TRUE(gateway.rc10d().await(command));
      EXPECT_EQ(command.seq, seq);
      EXPECT_GE(command.received_ns, before - kPlayNs);
      EXPECT_LE(command.received_ns, after + kPlayNs);
    }
    // The next is fresh again.
    const auto later = nowNs();
    client.command(4);
    link::Command command;
    ASSERT_TRUE(gateway.rc10d().await(command));
    EXPECT_GE(command.received_ns, later - kPlayNs);
  });
}

TEST(LiveGateway, PublishesToLiblcmClients) {
  inPrivateNetwork([] {
    ASSERT_TRUE(addLcmRoute());
    GatewayProcess gateway;
    LcmClient client;
    client.subscribe("hero\\.v1\\..*");
    gateway.awaitReady(client);
    auto state = rc10::test::heroState();
    auto diagnostics = rc10::test::heroDiagnostics();
    link::Event event;
    event.text = "hello";
    gateway.rc10d().send(state);
    gateway.rc10d().send(diagnostics);
    gateway.rc10d().send(event);
    robot_state_t lcm_state{};
    ASSERT_TRUE(client.await("hero.v1.state", lcm_state));
    ASSERT_EQ(lcm_state.motor_count, 2);
    EXPECT_EQ(lcm_state.motors[0].name, "front_left");
    EXPECT_EQ(lcm_state.motors[0].velocity_rpm, 118.26F);
    diagnostics_t lcm_diagnostics{};
    ASSERT_TRUE(client.await("hero.v1.diagnostics", lcm_diagnostics));
    EXPECT_EQ(lcm_diagnostics.buses[0].interface_name, "can0");
    event_t lcm_event{};
    ASSERT_TRUE(client.await("hero.v1.event", lcm_event));
    EXPECT_EQ(lcm_event.text, "hello");
  });
}

TEST(LiveGateway, AnswersRequests) {
  inPrivateNetwork([] {
    ASSERT_TRUE(addLcmRoute());
    GatewayProcess gateway;
    LcmClient client;
    client.subscribe("hero.v1.response");
    gateway.awaitReady(client);
    client.publish("hero.v1.request", encoded(requestWith(1)));
    link::Request request;
    ASSERT_TRUE(gateway.rc10d().await(request));
    EXPECT_EQ(request.target.view(), "yaw,pitch");
    link::Response response;
    response.client = request.client;
    response.session = request.session;
    response.seq = request.seq;
    response.message = "done";
    gateway.rc10d().send(response);
    response_t answer{};
    ASSERT_TRUE(client.await("hero.v1.response", answer));
    EXPECT_EQ(answer.client, "teleop");
    EXPECT_EQ(answer.session, 77);
    EXPECT_EQ(answer.seq, 5);
    EXPECT_EQ(answer.message, "done");
  });
}

void expectAnswer(const Bytes& command, const char* words) {
  inPrivateNetwork([&] {
    ASSERT_TRUE(addLcmRoute());
    GatewayProcess gateway;
    LcmClient client;
    client.subscribe("hero.v1.event");
    gateway.awaitReady(client);
    client.publish(kCommand, command);
    event_t event{};
    ASSERT_TRUE(client.await("hero.v1.event", event));
    EXPECT_THAT(event.text, HasSubstr(words));
  });
}

TEST(LiveGateway, TellsClientsWithOtherDefinitions) {
  expectAnswer(encoded(requestWith(0)), "uses other definitions of command_t");
}

TEST(LiveGateway, SaysThatAMessageInSeveralDatagramsIsTooLarge) {
  expectAnswer(Bytes(100'000), "larger than any valid one");
}

TEST(LiveGateway, IsNotDisturbedByAFloodOfOtherChannels) {
  inPrivateNetwork([] {
    ASSERT_TRUE(addLcmRoute());
    GatewayProcess gateway;
    LcmClient client;
    gateway.awaitReady(client);
    // While it cannot read, its socket keeps what the filter lets in. The others would fill it.
    gateway.stop();
    for (int i = 0; i < 200; ++i) client.publish(("CAMERA_" + std::to_string(i)).c_str(), Bytes(60'000));
    for (int i = 0; i < 3000; ++i) client.publish("IMU", Bytes(50));
    client.command(1);
    gateway.resume();
    link::Command command;
    ASSERT_TRUE(gateway.rc10d().await(command));
    EXPECT_EQ(command.seq, 1);
  });
}

TEST(LiveGateway, TakesNoUnicast) {
  inPrivateNetwork([] {
    ASSERT_TRUE(addLcmRoute());
    GatewayProcess gateway;
    LcmClient client;
    gateway.awaitReady(client);
    const auto header = shortHeader(1);
    Bytes datagram(header.begin(), header.end());
    for (const char* c = kCommand; *c != '\0'; ++c) datagram.push_back(static_cast<std::byte>(*c));
    datagram.push_back(std::byte{0});
    auto message = commandWith(1);
    message.seq = 1;
    const auto bytes = encoded(message);
    datagram.insert(datagram.end(), bytes.begin(), bytes.end());
    const UniqueFd socket{::socket(AF_INET, SOCK_DGRAM, 0)};
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(7667);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_GT(::sendto(socket.get(), datagram.data(), datagram.size(), 0,
                       reinterpret_cast<const sockaddr*>(&address), sizeof(address)),
              0);
    client.command(2);
    link::Command command;
    ASSERT_TRUE(gateway.rc10d().await(command));
    EXPECT_EQ(command.seq, 2);
  });
}

TEST(LiveGateway, WaitsForTheRoute) {
  inPrivateNetwork([] {
    GatewayProcess gateway;
    // Meanwhile rc10d goes on sending, and is read.
    auto state = rc10::test::heroState();
    for (int i = 0; i < 100; ++i) {
      gateway.rc10d().send(state);
      std::this_thread::sleep_for(1ms);
    }
    ASSERT_TRUE(addLcmRoute());
    LcmClient client;
    gateway.awaitReady(client);
  });
}

TEST(LiveGateway, EndsWithRc10d) {
  inPrivateNetwork([] {
    ASSERT_TRUE(addLcmRoute());
    GatewayProcess gateway;
    LcmClient client;
    gateway.awaitReady(client);
    gateway.rc10d().end();
    EXPECT_EQ(gateway.awaitEnd(), 0);
  });
}

}  // namespace
}  // namespace rc10::gateway::test::live_test
