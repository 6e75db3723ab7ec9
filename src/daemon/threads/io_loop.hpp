#pragma once

#include <memory>
#include <optional>
#include <stop_token>

#include "daemon/devices/serial_reviver.hpp"
#include "daemon/devices/serial_writer.hpp"
#include "daemon/devices/spi_keeper.hpp"
#include "daemon/interfaces/bus_reviver.hpp"
#include "daemon/interfaces/can_link_keeper.hpp"
#include "daemon/recording/black_box.hpp"
#include "daemon/threads/phase_watch.hpp"

namespace rc10 {

/// Serial ports of the io thread.
struct SerialIo {
  SerialReviver reviver;
  SerialWriter writer;
};

/// Work of the io thread: a hundred times a second it moves the recording from its ring to the history,
/// twenty times a second it looks at the interfaces, the links and the serial ports, and in between it writes
/// what the scheduler sends to serial ports and SPI devices.
class IoLoop {
 public:
  /// `black_box`: null if nothing is recorded. `serial`, `spi`: null if there are no such devices. `phase`:
  /// none if the ticks do not lie on the wall clock.
  IoLoop(BusReviver reviver, CanLinkKeeper keeper, BlackBox* black_box,
         std::unique_ptr<SerialIo> serial = nullptr, std::unique_ptr<SpiKeeper> spi = nullptr,
         std::optional<PhaseWatch> phase = std::nullopt)
      : reviver_(std::move(reviver)),
        keeper_(std::move(keeper)),
        black_box_(black_box),
        serial_(std::move(serial)),
        spi_(std::move(spi)),
        phase_(phase) {}

  void run(const std::stop_token& stop);

 private:
  BusReviver reviver_;
  CanLinkKeeper keeper_;
  BlackBox* black_box_;
  std::unique_ptr<SerialIo> serial_;
  std::unique_ptr<SpiKeeper> spi_;
  std::optional<PhaseWatch> phase_;
};

}  // namespace rc10
