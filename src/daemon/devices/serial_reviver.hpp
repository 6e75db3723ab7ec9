#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "app/time.hpp"
#include "app/unique_fd.hpp"
#include "daemon/devices/retry_pace.hpp"
#include "daemon/devices/serial_channel.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/exchange/note.hpp"
#include "daemon/exchange/rings.hpp"

namespace rc10 {

/// Opens the serial ports, and opens them again when they come back. A port takes its place under the number
/// that its channel has from the start (dup3), so that the real-time threads need not know. io thread only,
/// and the main thread before there is one.
class SerialReviver {
 public:
  /// Has an opened port read until it is gone: RxLoop::watchSerial(). errno says why not.
  using Watch = std::function<bool(std::size_t channel)>;

  SerialReviver(SerialChannels& channels, Watch watch, LinkExchange& exchange)
      : channels_(channels),
        watch_(std::move(watch)),
        notes_(exchange.notes, EventCode::kSerialPort),
        ports_(channels.size()) {}

  /// Looks at every port once. To be called some 20 times a second, and once before the first tick.
  void check(MonotonicTime now);

 private:
  struct Port {
    bool open = false;
    RetryPace pace{};
  };

  void release(std::size_t index, MonotonicTime now);
  void tryToOpen(std::size_t index, MonotonicTime now);
  [[nodiscard]] Result<void> open(SerialChannel& channel, std::size_t index);

  SerialChannels& channels_;
  Watch watch_;
  Notes notes_;
  std::vector<Port> ports_;
};

}  // namespace rc10
