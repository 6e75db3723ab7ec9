#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "app/time.hpp"

namespace rc10 {

/// Shares out what the scheduler applies in a tick among the clients that send, so that one that floods keeps
/// nobody else's commands out. A token bucket for each. Link thread only.
class CommandBudget {
 public:
  /// Setpoints of all clients together in a tick, or in a millisecond where ticks are shorter.
  static constexpr double kSetpoints = 1024.0;
  /// Least cost of a message, in setpoints; its own if those are more: 32 messages a tick, half the ring.
  static constexpr std::size_t kLeastCost = 32;

  explicit CommandBudget(Duration period) noexcept
      : per_ms_(kSetpoints * std::min(1.0, Duration{std::chrono::milliseconds{1}} / (period * 1.0))) {}

  /// Whether the client may send this number of setpoints now; if so, they are taken.
  [[nodiscard]] bool spend(std::string_view client, std::size_t setpoints, MonotonicTime now);

 private:
  struct Account {
    double tokens;
    MonotonicTime last;
  };

  [[nodiscard]] std::size_t sending(MonotonicTime now) const noexcept;

  double per_ms_;
  std::map<std::string, Account, std::less<>> accounts_;  // bounded
};

}  // namespace rc10
