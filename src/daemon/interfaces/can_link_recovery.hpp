#pragma once

#include <chrono>

#include "app/time.hpp"
#include "bus/bus_health.hpp"

namespace rc10 {

/// Decides when the link of one bus is to be taken down and up: 50 ms after its trouble began, then at twice
/// the distance each time, at most 2 s. Once the bus has been well for 5 s it starts with 50 ms again. Pure:
/// time is an argument.
class CanLinkRecovery {
 public:
  static constexpr Duration kFirst = std::chrono::milliseconds{50};
  static constexpr Duration kLongest = std::chrono::seconds{2};
  static constexpr Duration kWellAfter = std::chrono::seconds{5};

  struct Step {
    bool due = false;    ///< Do it now.
    bool first = false;  ///< For the first time since this trouble began.
  };

  /// Bus-off, stalled and down are trouble. Gone is not: there is nothing to restart, and what comes back is
  /// new.
  [[nodiscard]] Step update(MonotonicTime now, BusState state) noexcept;

  /// The link was taken down and up for another reason: that is an attempt, too.
  void tried(MonotonicTime now) noexcept;

  /// Attempts since the bus was well.
  [[nodiscard]] int attempts() const noexcept { return attempts_; }

 private:
  bool in_trouble_ = false;
  bool tried_ = false;       // since this trouble began
  MonotonicTime changed_{};  // when trouble began or ended
  MonotonicTime last_try_{};
  Duration wait_ = kFirst;
  int attempts_ = 0;
};

}  // namespace rc10
