#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "client/link_client.hpp"
#include "link/link_message.hpp"

namespace rc10::test {

/// A robot "hero" with two motors.
inline link::Welcome heroWelcome() {
  link::Welcome welcome;
  welcome.pid = 4321;
  welcome.robot = "hero";
  welcome.version = "0.1.0";
  welcome.lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  welcome.rate_hz = 1000;
  welcome.state_hz = 200;
  welcome.motor_count = 2;
  welcome.motors[0].name = "front_left";
  welcome.motors[0].model = "M3508";
  welcome.motors[0].bus = "chassis";
  welcome.motors[0].id = 1;
  welcome.motors[0].modes = 0b110;
  welcome.motors[1].name = "yaw";
  welcome.motors[1].model = "GM6020";
  welcome.motors[1].bus = "gimbal";
  welcome.motors[1].id = 5;
  welcome.motors[1].modes = 0b11010;
  return welcome;
}

/// rc10d's end of the link, without a thread: it answers before it is asked, as the socket keeps what it
/// sent until the client reads.
class FakeRc10d {
 public:
  FakeRc10d() {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    ours_ = UniqueFd{ends[0]};
    theirs_ = UniqueFd{ends[1]};
  }

  /// The client's end, once.
  UniqueFd takeClientEnd() { return std::move(theirs_); }

  /// A client that was welcomed; its Hello has been read.
  LinkClient welcomed(const link::Welcome& welcome = heroWelcome()) {
    auto copy = welcome;
    send(copy);
    auto client = LinkClient::adopt(takeClientEnd(), "/run/rc10d/hero.sock", {.name = "test"});
    EXPECT_TRUE(client.has_value());
    (void)receiveBytes();
    return std::move(*client);
  }

  template <typename Message>
  void send(Message& message) {
    sendBytes(link::seal(message));
  }
  void sendBytes(std::span<const std::byte> bytes) {
    EXPECT_EQ(::send(ours_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }

  /// Messages of the client; empty: none.
  std::vector<std::byte> receiveBytes() {
    std::vector<std::byte> bytes(link::kMaxMessageSize);
    const auto size = ::recv(ours_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return bytes;
  }
  template <typename Message>
  bool receive(Message& message) {
    return link::open(receiveBytes(), message);
  }
  /// The same, but waits up to `timeout_ms` for something to come.
  template <typename Message>
  bool await(Message& message, int timeout_ms = 30000) {
    pollfd entry{.fd = ours_.get(), .events = POLLIN, .revents = 0};
    return ::poll(&entry, 1, timeout_ms) == 1 && receive(message);
  }

  void end() { ours_.reset(); }
  /// The client can still send, but reads an end.
  void endSending() { EXPECT_EQ(::shutdown(ours_.get(), SHUT_WR), 0); }

 private:
  UniqueFd ours_;
  UniqueFd theirs_;
};

/// A folder that is gone afterwards, as RC10_RUN_DIR.
class TemporaryRunDir {
 public:
  TemporaryRunDir() {
    path_ = testing::TempDir() + "rc10-test-XXXXXX";
    EXPECT_NE(::mkdtemp(path_.data()), nullptr);
    if (const char* before = ::getenv("RC10_RUN_DIR")) before_ = before;
    ::setenv("RC10_RUN_DIR", path_.c_str(), 1);
  }
  TemporaryRunDir(const TemporaryRunDir&) = delete;
  TemporaryRunDir& operator=(const TemporaryRunDir&) = delete;
  ~TemporaryRunDir() {
    for (const auto& file : files_) ::unlink(file.c_str());
    ::rmdir(path_.c_str());
    ::setenv("RC10_RUN_DIR", before_.c_str(), 1);
  }

  [[nodiscard]] const std::string& path() const { return path_; }
  std::string file(const std::string& name) {
    files_.push_back(path_ + "/" + name);
    return files_.back();
  }

  /// A link socket of `robot`. It listens until the result is gone; then its file is left behind.
  UniqueFd listen(const std::string& robot, int backlog = 4) {
    const std::string socket_path = file(robot + ".sock");
    UniqueFd socket{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, socket_path.c_str(), socket_path.size());
    EXPECT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(::listen(socket.get(), backlog), 0);
    return socket;
  }

 private:
  std::string path_;
  std::string before_;
  std::vector<std::string> files_;
};

}  // namespace rc10::test
