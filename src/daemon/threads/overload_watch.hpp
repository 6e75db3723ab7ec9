#pragma once

#include <algorithm>
#include <cstdint>
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
  /// `limit`: CPU time of ticks, one after the other without a pause, that use more than `percent` of a
  /// period on average.
  constexpr OverloadWatch(Duration period, int percent, Duration limit) noexcept
      : room_(period * percent / 100), pause_(period - room_), limit_(limit) {}

  /// True: a tick that ended with so much time before the next one leaves room enough, and nobody asks for
  /// its CPU time.
  [[nodiscard]] constexpr bool pauses(Duration before_next) const noexcept { return before_next >= pause_; }

  /// After a tick without such a pause. `cpu_time`: the thread's, so far. True: overloaded.
  [[nodiscard]] constexpr bool overran(Duration cpu_time) noexcept {
    if (begin_) {
      const Duration used = cpu_time - *begin_;
      if (used >= ++ticks_ * room_) return used >= limit_;
    }
    // The first, whose begin is not known, or others had the CPU.
    begin_ = cpu_time;
    ticks_ = 0;
    return false;
  }
  /// After a tick with one.
  constexpr void inTime() noexcept { begin_.reset(); }

 private:
  Duration room_;
  Duration pause_;
  Duration limit_;
  std::optional<Duration> begin_;  // CPU time at the end of the first of the ticks without a pause
  std::int64_t ticks_ = 0;         // after it
};

}  // namespace rc10
