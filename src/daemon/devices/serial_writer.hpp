#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <poll.h>

#include "app/time.hpp"
#include "daemon/devices/serial_channel.hpp"

namespace rc10 {

/// Writes what the scheduler sends to the serial ports. A port that is absent gets nothing, now or later: an
/// old command must not act when it is plugged in again. io thread only.
class SerialWriter {
 public:
  explicit SerialWriter(SerialChannels& channels);

  /// Writes as it comes for about `duration`.
  void serve(Duration duration);
  /// Writes what is there and can be written without waiting.
  void flush() noexcept;

 private:
  struct Pending {
    std::array<std::uint8_t, 256> bytes{};
    std::size_t begin = 0;
    std::size_t end = 0;
  };

  [[nodiscard]] bool write(SerialChannel& channel, Pending& pending) noexcept;

  SerialChannels& channels_;
  std::vector<Pending> pending_;
  std::vector<pollfd> waits_;  // one for each channel, and the eventfd
};

}  // namespace rc10
