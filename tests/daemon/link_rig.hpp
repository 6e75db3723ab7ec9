#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/clients/link_server.hpp"
#include "daemon/link_messages.hpp"
#include "daemon/temp_dir.hpp"
#include "link/link_message.hpp"

namespace rc10::test {

/// A program at the other end of the link, without any of librc10-client.
class TestClient {
 public:
  explicit TestClient(const std::string& path) : fd_(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    connected_ = ::connect(fd_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }

  [[nodiscard]] bool connected() const { return connected_; }
  void leave() { fd_.reset(); }

  bool sendBytes(const void* bytes, std::size_t size) const {
    return ::send(fd_.get(), bytes, size, MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(size);
  }
  template <typename Message>
  bool send(Message message) const {
    const auto bytes = link::seal(message);
    return sendBytes(bytes.data(), bytes.size());
  }

  /// The next message of this type that is already there; others before it are thrown away.
  template <typename Message>
  std::optional<Message> take() {
    auto message = std::make_unique<Message>();
    for (;;) {
      const auto size = ::recv(fd_.get(), buffer_->data(), buffer_->size(), MSG_DONTWAIT);
      // Reset: rc10d closed before it had read everything.
      if (size == 0 || (size < 0 && errno == ECONNRESET)) sent_away_ = true;
      if (size <= 0) return std::nullopt;
      if (link::open({buffer_->data(), static_cast<std::size_t>(size)}, *message)) return *message;
    }
  }
  /// Whether rc10d has closed the connection.
  bool sentAway() {
    (void)take<link::Response>();
    return sent_away_;
  }

 private:
  UniqueFd fd_;
  bool connected_ = false;
  bool sent_away_ = false;
  std::unique_ptr<std::array<std::byte, link::kMaxMessageSize>> buffer_ =
      std::make_unique<std::array<std::byte, link::kMaxMessageSize>>();
};

/// A link server on a real socket, without its thread: the test pumps it, and plays the scheduler.
class LinkRig : public ::testing::Test {
 protected:
  LinkRig() {
    robot.robot = "hero";
    robot.lcm_url = "udpm://239.255.76.67:7667?ttl=0";
    robot.state_hz = 1000;
    robot.buses = {{"chassis", "can0", 1e6, 0.5F, 0.6F}};
    robot.motors = {{"left", "M3508", 0, 1, ModeSet{ControlMode::kVelocity, ControlMode::kCurrent}},
                    {"right", "M3508", 0, 2, ModeSet{ControlMode::kVelocity}}};
    serve();
  }

  /// A server for `robot` as it is now.
  void serve() {
    server.reset();
    auto socket = LinkSocket::listen(dir.path(), "hero");
    EXPECT_TRUE(socket);
    path = socket->path();
    server =
        LinkServer::create(std::move(*socket), {.exchange = exchange,
                                                .inboxes = inboxes,
                                                .timing = timing,
                                                .robot = robot,
                                                .page_faults = [] { return 17U; },
                                                .log = [this](const link::Event& e) { logged.push_back(e); },
                                                .housekeeping = [this] { ++housekeeping; }})
            .value();
  }

  /// Everything that has arrived is handled after this; time plays no part.
  void pump() const {
    for (int i = 0; i < 40; ++i) server->poll(0);
  }
  /// A client that has said hello and taken its welcome.
  std::unique_ptr<TestClient> join(std::uint32_t subscriptions = 0, std::string_view name = "pilot") {
    auto client = std::make_unique<TestClient>(path);
    EXPECT_TRUE(client->connected());
    link::Hello hello;
    hello.client = name;
    hello.subscriptions = subscriptions;
    EXPECT_TRUE(client->send(hello));
    pump();
    EXPECT_TRUE(client->take<link::Welcome>());
    return client;
  }
  /// Turns the server until this client gets such a message. Waits for the server's own timers only.
  template <typename Message>
  std::optional<Message> await(TestClient& client) const {
    for (int i = 0; i < 3000; ++i) {
      if (auto message = client.take<Message>()) return message;
      server->poll(100);
    }
    return std::nullopt;
  }
  /// The scheduler's snapshot after a tick.
  void publishSnapshot(std::uint64_t tick) {
    auto& slot = exchange.snapshot.slot();
    slot.tick = tick;
    slot.motor_count = robot.motors.size();
    slot.bus_count = robot.buses.size();
    exchange.snapshot.publish();
  }
  static link::Command velocityCommand(std::int64_t seq) {
    return linkCommand(seq, MonotonicTime::max(), {setpoint("left", ControlMode::kVelocity, 120.0)});
  }
  /// The order that the scheduler would find, or a failure.
  Order takeOrder() {
    Order order;
    EXPECT_TRUE(exchange.orders.pop(order));
    return order;
  }
  void finish(const Order& order) {
    OrderResult result;
    result.id = order.id;
    if (order.operation == Operation::kEnable) result.switched_on = order.motors;
    EXPECT_TRUE(exchange.results.push(result));
  }

  TempDir dir;
  std::string path;
  LinkExchange exchange;
  std::array<BusInbox, kMaxBuses> inboxes;
  TickTiming timing;
  RobotDescription robot;
  std::vector<link::Event> logged;
  int housekeeping = 0;
  std::unique_ptr<LinkServer> server;
};

}  // namespace rc10::test
