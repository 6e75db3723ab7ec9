#pragma once

#include <optional>

#include "app/time.hpp"

namespace rc10 {
inline namespace robot_client {

/// This program's clock.
[[nodiscard]] inline MonotonicTime timeNow() { return std::chrono::steady_clock::now(); }

/// Places rc10d's CLOCK_MONOTONIC on this program's clock. The time at which a message is handled says little
/// about its age, since it may have waited in a queue. The quickest message so far gives the distance of the
/// two clocks, and then every message tells its own age, from this computer or from another. The distance is
/// taken anew some seconds after rc10d's clock has fallen behind (its computer slept, its time is corrected).
class HostClock {
 public:
  /// Takes in a message stamped `host` and handled at `local`; returns its time on the local clock. `last`:
  /// no other one waits behind it. Of one in a queue, how late it is says nothing about the clocks.
  MonotonicTime observe(Duration host, MonotonicTime local, bool last = true) noexcept;

 private:
  std::optional<Duration> distance_;
  Duration last_host_{};
  MonotonicTime last_local_{};
  std::optional<MonotonicTime> late_since_;  ///< Since then every message has been late, without a gap.
  Duration least_{};                         ///< The smallest distance since then.
};

}  // namespace robot_client
}  // namespace rc10
