#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/time.hpp"
#include "client/catch_up.hpp"
#include "link/link_protocol.hpp"

namespace rc10::client {

/// The same command, sent again and again: when the next one is due, and what ends it for good. Nothing that
/// was stopped, or that stood while its program was held up, may begin anew by it.
class CommandStream {
 public:
  /// After a longer pause (Ctrl-Z, a terminal that is held) nobody expects that it goes on.
  static constexpr Duration kLongestPause = std::chrono::seconds{2};

  /// `motors`: names of those that the command moves.
  CommandStream(std::vector<std::string> motors, Duration period)
      : motors_(std::move(motors)), period_(period) {}

  /// Every event that comes, in its order. What was before the first sending ends nothing.
  void hear(const link::Event& event);

  /// In each turn, after reading; true: to be sent now. After a pause it waits for something younger.
  /// `newest_us`: CLOCK_MONOTONIC of the newest state that was read.
  [[nodiscard]] bool due(MonotonicTime now, std::int64_t newest_us) noexcept;
  void sent(MonotonicTime now) noexcept;
  [[nodiscard]] std::optional<MonotonicTime> sentAt() const noexcept { return sent_; }
  /// It is not due before that.
  [[nodiscard]] MonotonicTime next() const noexcept { return next_; }

  /// Reason why it is over; empty: it goes on.
  [[nodiscard]] std::string ended(MonotonicTime now) const;

 private:
  std::vector<std::string> motors_;
  Duration period_;
  CatchUp catch_up_;
  MonotonicTime next_{};
  std::optional<MonotonicTime> sent_;
  std::string stopped_;  // the first event that ended it, in words
};

}  // namespace rc10::client
