#pragma once

#include <lcm/lcm.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "client/fake_rc10d.hpp"
#include "gateway/gateway.hpp"
#include "lcm_messages.hpp"

namespace rc10::gateway::test {

using rc10::test::Bytes;
using rc10::test::FakeRc10d;

inline constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";
inline constexpr const char* kCommand = "hero.v1.command";

inline std::int64_t nowNs() { return Duration{std::chrono::steady_clock::now().time_since_epoch()}.count(); }

/// A client as users write it.
class LcmClient {
 public:
  LcmClient() : lcm_(::lcm_create(kUrl)) { EXPECT_NE(lcm_, nullptr); }
  LcmClient(const LcmClient&) = delete;
  LcmClient& operator=(const LcmClient&) = delete;
  ~LcmClient() { ::lcm_destroy(lcm_); }

  void subscribe(const char* channel) {
    ::lcm_subscribe(
        lcm_, channel,
        [](const lcm_recv_buf_t* message, const char* name, void* self) {
          const auto* data = static_cast<const std::byte*>(message->data);
          static_cast<LcmClient*>(self)->received_[name].emplace_back(data, data + message->data_size);
        },
        this);
  }

  void publish(const char* channel, const Bytes& bytes) {
    EXPECT_EQ(::lcm_publish(lcm_, channel, bytes.data(), static_cast<unsigned>(bytes.size())), 0);
  }
  void command(std::int64_t seq) {
    auto message = rc10::test::commandWith(1);
    message.seq = seq;
    publish(kCommand, rc10::test::encoded(message));
  }

  /// The next message on a channel, decoded; false: none within half a minute.
  template <typename Message>
  bool await(const std::string& channel, Message& message) {
    for (const auto end = nowNs() + 30'000'000'000; received_[channel].empty() && nowNs() < end;) {
      ::lcm_handle_timeout(lcm_, 50);
    }
    auto& queue = received_[channel];
    if (queue.empty()) return false;
    const auto bytes = queue.front();
    queue.erase(queue.begin());
    return message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) >= 0;
  }

 private:
  lcm_t* lcm_;
  std::map<std::string, std::vector<Bytes>> received_;
};

/// The gateway as a process, so that it can be stopped.
class GatewayProcess {
 public:
  GatewayProcess() {
    auto client = rc10d_.welcomed();
    pid_ = ::fork();
    if (pid_ != 0) return;
    rc10d_.end();  // the parent's end
    static const volatile std::sig_atomic_t never = 0;
    const auto gateway = std::make_unique<Gateway>(std::move(client), *parseUdpmUrl(kUrl));
    gateway->run(never);
    ::_exit(0);
  }
  GatewayProcess(const GatewayProcess&) = delete;
  GatewayProcess& operator=(const GatewayProcess&) = delete;
  ~GatewayProcess() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }

  FakeRc10d& rc10d() { return rc10d_; }

  /// Waits until commands get through.
  void awaitReady(LcmClient& client) {
    link::Command command;
    for (int attempt = 0; attempt < 200; ++attempt) {
      client.command(0);
      if (!rc10d_.await(command, 50)) continue;
      // Some attempts may be on their way still; this one comes behind them.
      client.command(kLastAttempt);
      while (command.seq != kLastAttempt && rc10d_.await(command)) {
      }
      EXPECT_EQ(command.seq, kLastAttempt);
      return;
    }
    ADD_FAILURE() << "the gateway does not pass commands on";
  }

  void stop() {
    ::kill(pid_, SIGSTOP);
    int status = 0;
    EXPECT_EQ(::waitpid(pid_, &status, WUNTRACED), pid_);
    EXPECT_TRUE(WIFSTOPPED(status));
  }
  void resume() { ::kill(pid_, SIGCONT); }

  /// Waits for its end; its exit status, -1 if it does not end.
  int awaitEnd() {
    for (int i = 0; i < 3000; ++i) {
      int status = 0;
      if (::waitpid(pid_, &status, WNOHANG) == pid_) {
        pid_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -2;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
    return -1;
  }

 private:
  static constexpr std::int64_t kLastAttempt = -1;

  FakeRc10d rc10d_;
  pid_t pid_ = -1;
};

}  // namespace rc10::gateway::test
