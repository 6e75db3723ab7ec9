#pragma once

#include <cstdint>

namespace rc10 {

/// Feeds systemd's watchdog only while the real-time threads make progress: ticks, and the RX loop's
/// own counter. Link thread only.
class Watchdog {
 public:
  /// Both counters as they are now. True if both have advanced since the last call: feed.
  [[nodiscard]] bool progressed(std::uint64_t ticks, std::uint64_t rx_wake_ups) noexcept {
    const bool advanced = ticks != ticks_ && rx_wake_ups != rx_wake_ups_;
    ticks_ = ticks;
    rx_wake_ups_ = rx_wake_ups;
    return advanced;
  }

 private:
  std::uint64_t ticks_ = 0;
  std::uint64_t rx_wake_ups_ = 0;
};

}  // namespace rc10
