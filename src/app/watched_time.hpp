#pragma once

#include <limits>

#include "app/time.hpp"

namespace rc10 {

/// Time since the last restart() in which the scheduler ran: of a pause, in which nobody could be heard, five
/// periods count at most.
class WatchedTime {
 public:
  /// Longer than any: it was never restarted.
  [[nodiscard]] static constexpr WatchedTime never() noexcept {
    WatchedTime time;
    time.seconds_ = std::numeric_limits<double>::infinity();
    return time;
  }
  constexpr void restart() noexcept { seconds_ = 0.0; }
  /// Once a tick.
  constexpr void step(const Tick& tick) noexcept { seconds_ += static_cast<double>(tick.dt_s); }
  [[nodiscard]] constexpr double seconds() const noexcept { return seconds_; }

 private:
  double seconds_ = 0.0;
};

}  // namespace rc10
