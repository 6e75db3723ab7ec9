#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/time.hpp"
#include "bus/spi_port.hpp"
#include "daemon/devices/retry_pace.hpp"
#include "daemon/devices/spi_channel.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/exchange/note.hpp"
#include "daemon/exchange/rings.hpp"

namespace rc10 {

using SpiChannels = std::vector<std::unique_ptr<SpiChannel>>;

/// Opens SPI devices, opens them again when they come back, and sends the newest frame of each. io thread
/// only.
class SpiKeeper {
 public:
  /// openSpiPort(), or a test's.
  using Open =
      std::function<Result<std::unique_ptr<SpiPort>>(const std::string& path, std::uint32_t speed_hz)>;

  /// Turns without a new frame after which the rest frame is sent. In turns, so that
  /// a computer that stood still as a whole is no silence.
  static constexpr int kSilentTurns = 100;

  SpiKeeper(SpiChannels& channels, LinkExchange& exchange, Open open);

  /// A hundred times a second. Waits while bytes go out: 4096 of them take 10 ms.
  void turn(MonotonicTime now);
  /// At the end: the rest frame.
  void end() noexcept;

 private:
  struct Device {
    std::unique_ptr<SpiPort> port{};
    RetryPace pace{};
    std::uint32_t sent = 0;
    int silent_turns = 0;
    bool rests = false;
    bool works = false;  ///< A frame went out: opening alone shows little.
  };

  void open(std::size_t index, MonotonicTime now);
  void serve(std::size_t index, MonotonicTime now);
  void fail(std::size_t index, int error, MonotonicTime now);
  /// 0: sent; empty: nothing was to be sent; else the errno.
  [[nodiscard]] static std::optional<int> sendNewest(SpiChannel& channel, Device& device) noexcept;

  SpiChannels& channels_;
  Notes notes_;
  Open open_;
  std::vector<Device> devices_;
};

}  // namespace rc10
