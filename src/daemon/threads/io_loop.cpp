#include "daemon/threads/io_loop.hpp"

#include <thread>

#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

// The ring has room for seconds: this is for what a crash may find in the history.
constexpr Duration kDrainInterval = std::chrono::milliseconds{10};
constexpr int kDrainsPerLook = 5;

}  // namespace

void IoLoop::run(const std::stop_token& stop) {
  for (int drains = 0; !stop.stop_requested(); drains = (drains + 1) % kDrainsPerLook) {
    if (drains == 0) {
      const auto now = monotonicNow();
      keeper_.check(now, reviver_.check(now));
      if (serial_) serial_->reviver.check(monotonicNow());
    }
    if (black_box_ != nullptr) black_box_->drain();
    if (spi_) spi_->turn(monotonicNow());
    if (serial_) {
      serial_->writer.serve(kDrainInterval);
    } else {
      std::this_thread::sleep_for(kDrainInterval);
    }
  }
  if (spi_) spi_->end();
}

}  // namespace rc10
