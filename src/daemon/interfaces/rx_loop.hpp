#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "app/result.hpp"
#include "app/unique_fd.hpp"
#include "bus/can_receiver.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/devices/serial_channel.hpp"
#include "daemon/exchange/rings.hpp"

namespace rc10 {

/// The receive side of every bus and serial port: epoll, recvmmsg and read, time stamps, one ring each. It
/// moves frames and bytes and counts; it never decodes.
class RxLoop {
 public:
  [[nodiscard]] static Result<std::unique_ptr<RxLoop>> create(Robot& robot, std::span<BusInbox> inboxes,
                                                              SerialChannels* serial = nullptr);

  /// The thread's body.
  void run(const std::stop_token& stop) noexcept;
  /// One epoll_wait of at most `timeout_ms` and one recvmmsg or read per descriptor that is readable.
  void poll(int timeout_ms) noexcept;

  /// Wake-ups so far; advances at least ten times a second also without traffic. Any thread.
  [[nodiscard]] std::uint64_t wakeUps() const noexcept { return wake_ups_.load(std::memory_order_relaxed); }

  /// Watches a bus's descriptors again after the io thread has put a new socket in their place.
  [[nodiscard]] bool watchAgain(std::size_t bus) noexcept;
  /// Watches a serial port that the io thread has opened; until it is gone. errno says why not.
  [[nodiscard]] bool watchSerial(std::size_t channel) noexcept;

 private:
  struct Source {
    std::size_t bus;
    bool echo;
    int fd;
    CanReceiver receiver;
    std::uint32_t kernel_dropped = 0;
  };

  RxLoop(Robot& robot, std::span<BusInbox> inboxes, SerialChannels* serial, UniqueFd epoll);
  [[nodiscard]] bool watch(std::size_t source) noexcept;
  void receive(Source& source, const WakeUp& wake, std::uint32_t events) noexcept;
  void receiveSerial(std::size_t channel, MonotonicTime now, std::uint32_t events) noexcept;
  [[nodiscard]] WakeUp sampleWakeUp() noexcept;

  std::span<BusInbox> inboxes_;
  SerialChannels* serial_;  // null: none
  UniqueFd epoll_;
  std::vector<Source> sources_;
  std::array<CanFrame, CanReceiver::kBatch> batch_{};
  WakeUp last_wake_{};
  std::atomic<std::uint64_t> wake_ups_{0};
};

}  // namespace rc10
