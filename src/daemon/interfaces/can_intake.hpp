#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "app/receive_clock.hpp"
#include "bus/can_receiver.hpp"
#include "bus/echo_counter.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/rings.hpp"

namespace rc10 {

/// The receive side of every CAN bus: recvmmsg, time stamps, one ring each, and the echoes. It moves frames
/// and counts; it never decodes. One thread drains it: the scheduler's (`receive: tick`) or the RX thread.
/// Nothing that arrives wakes anybody, so that no flood takes the CPU from the tick.
class CanIntake {
 public:
  /// Full reads of one socket in one drain. 512 frames are more than a wire carries in 10 ms, so that a
  /// backlog shrinks; what a flood sends beyond that stays with the kernel, which drops and counts.
  static constexpr int kMaxReads = 8;

  /// `now`: no earlier than that were the sockets opened.
  CanIntake(Robot& robot, std::span<BusInbox> inboxes, MonotonicTime now);

  /// Takes what has come by `now`, which was read just before. No allocation; one system call for each socket
  /// whose frames fit into one read.
  void drain(MonotonicTime now) noexcept;

 private:
  struct Source {
    std::size_t bus;
    CanReceiver receiver;
  };
  struct Echoes {
    std::size_t bus;
    EchoCounter counter;
  };

  void drain(Source& source, const WakeUp& wake) noexcept;
  void drain(Echoes& echoes) noexcept;
  void take(const Source& source, const Reception& reception) noexcept;

  std::span<BusInbox> inboxes_;
  std::vector<Source> sources_;
  std::vector<Echoes> echoes_;
  std::array<CanFrame, CanReceiver::kBatch> batch_{};
  WakeUp last_wake_{};
};

}  // namespace rc10
