#pragma once

#include <cstdint>
#include <optional>

#include "app/time.hpp"

namespace rc10 {
inline namespace robot_client {

/// Emergency stop that is sent again, under its number, until the state shows it. Pure.
class EstopRepetition {
 public:
  /// Number of the one that is under way.
  [[nodiscard]] std::optional<std::int64_t> number() const noexcept { return number_; }

  void sent(std::int64_t number, MonotonicTime now) noexcept {
    if (number_ != number) first_ = now;
    number_ = number;
    next_ = now + kRepeat;
  }
  /// A state that shows ESTOP. One from before the first sending proves nothing: that one may have been
  /// cleared.
  void shown(MonotonicTime taken) noexcept {
    if (taken >= first_) number_.reset();
  }

  /// Number of the one that is to be sent again now.
  [[nodiscard]] std::optional<std::int64_t> due(MonotonicTime now) const noexcept {
    return now >= next_ ? number_ : std::nullopt;
  }
  [[nodiscard]] std::optional<MonotonicTime> nextDue() const noexcept {
    return number_ ? std::optional(next_) : std::nullopt;
  }

 private:
  // An emergency stop is worth the traffic.
  static constexpr Duration kRepeat = std::chrono::milliseconds{20};

  std::optional<std::int64_t> number_;
  MonotonicTime first_{};
  MonotonicTime next_{};
};

}  // namespace robot_client
}  // namespace rc10
