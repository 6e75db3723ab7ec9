#include "daemon/threads/io_loop.hpp"

#include <thread>

#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

// The ring has room for seconds: this is for what a crash may find in the history.
constexpr Duration kDrainInterval = std::chrono::milliseconds{20};
// SPI devices have theirs.
constexpr Duration kShortInterval = std::chrono::milliseconds{10};
constexpr Duration kReviveInterval = std::chrono::milliseconds{50};

}  // namespace

void IoLoop::run(const std::stop_token& stop) {
  const Duration interval = spi_ ? kShortInterval : kDrainInterval;
  for (MonotonicTime looked{}; !stop.stop_requested();) {
    if (const auto now = monotonicNow(); now - looked >= kReviveInterval) {
      looked = now;
      keeper_.check(now, reviver_.check(now));
      if (serial_) serial_->reviver.check(monotonicNow());
      if (phase_) phase_->check(measureRealtimeOffset(), monotonicNow());
    }
    if (black_box_ != nullptr) black_box_->drain();
    if (spi_) spi_->turn(monotonicNow());
    if (serial_) {
      serial_->writer.serve(interval);
    } else {
      std::this_thread::sleep_for(interval);
    }
  }
  if (spi_) spi_->end();
}

}  // namespace rc10
