#pragma once

#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/stderr_lines.hpp"
#include "client/link_client.hpp"
#include "gateway/clock_sample.hpp"
#include "gateway/inlet.hpp"
#include "gateway/outlet.hpp"
#include "gateway/own_addresses.hpp"
#include "gateway/udpm_socket.hpp"

namespace rc10::gateway {

/// The loop of rc10-lcm: one thread between rc10d's link socket and LCM. Nothing in it waits but poll().
class Gateway : private LcmPublisher {
 public:
  Gateway(LinkClient rc10d, const UdpmUrl& url, StderrLines lines = StderrLines{});

  /// Until rc10d ends or `stop` is set. While LCM cannot be reached it tries again and says why on stderr.
  void run(const volatile std::sig_atomic_t& stop);

 private:
  static constexpr int kMaxSleepMs = 20;

  void publish(std::string_view channel, std::span<const std::byte> message) noexcept override;

  void waitForWork() noexcept;
  /// False: rc10d has ended.
  [[nodiscard]] bool receiveLcm(const ClockSample& now);
  [[nodiscard]] bool receiveLink();

  /// Opens LCM, or opens it anew after the route has moved to another interface.
  void watchTransport(const ClockSample& now);
  [[nodiscard]] Result<void> openTransport(const ClockSample& now);
  void logOnce(const std::string& text);

  LinkClient rc10d_;
  UdpmUrl url_;
  Outlet outlet_;
  Inlet inlet_;
  std::optional<UdpmSocket> lcm_;
  int interface_index_ = 0;
  bool loopback_ = false;
  OwnAddresses origins_;
  ClockSample empty_;  // see wakeUp()
  MonotonicTime next_check_{};
  Duration pause_ = std::chrono::seconds{1};  // before the next attempt
  StderrLines lines_;
  std::string last_log_;
  std::array<std::byte, kMaxIncoming + kMaxOverhead + 1> datagram_{};
  std::vector<std::byte> link_buffer_;
};

}  // namespace rc10::gateway
