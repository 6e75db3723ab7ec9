#pragma once

#include <algorithm>
#include <optional>

#include "app/time.hpp"

namespace rc10 {

/// Percent of a CPU from which a thread is overloaded, where the kernel leaves so much of it to real-time
/// threads (100: all): before it throttles them, or before ticks are missed.
[[nodiscard]] constexpr int overloadPercent(int realtime_percent) noexcept {
  constexpr int kMargin = 5;
  constexpr int kMost = 97;
  return realtime_percent >= 100 ? kMost : std::max(realtime_percent - kMargin, kMargin);
}

/// Tells from its CPU time that a thread does more than its periods have room for. A thread that was late
/// because others had the CPU has used little of it, and is not overloaded.
class OverloadWatch {
 public:
  /// `limit`: CPU time of ticks, one after the other without a pause, that use more than `percent` of theirs.
  constexpr OverloadWatch(Duration period, int percent, Duration limit) noexcept
      : pause_(period * (100 - percent) / 100), percent_(percent), limit_(limit) {}

  /// True: a tick that ended with so much time before the next one leaves room enough, and nobody asks for
  /// its CPU time.
  [[nodiscard]] constexpr bool pauses(Duration before_next) const noexcept { return before_next >= pause_; }

  /// After a tick without such a pause, which ended `now`. `cpu_time`: the thread's, so far. True:
  /// overloaded.
  [[nodiscard]] constexpr bool overran(Duration cpu_time, MonotonicTime now) noexcept {
    // The start of the first of several such ticks is not known.
    if (!begin_) begin_ = {cpu_time, now};
    const Duration used = cpu_time - begin_->cpu_time;
    if (100 * used < percent_ * (now - begin_->time)) begin_ = {cpu_time, now};  // others had the CPU
    return used >= limit_ && begin_->time != now;
  }
  /// After a tick with one.
  constexpr void inTime() noexcept { begin_.reset(); }

 private:
  struct Instant {
    Duration cpu_time;
    MonotonicTime time;
  };

  Duration pause_;
  int percent_;
  Duration limit_;
  std::optional<Instant> begin_;  // of ticks without a pause
};

}  // namespace rc10
