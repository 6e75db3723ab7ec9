#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "app/time.hpp"

namespace rc10 {

/// Percent of a CPU from which a thread is overloaded, where the kernel leaves so much of it to real-time
/// threads (100: all): before it throttles them, or before ticks are missed.
[[nodiscard]] constexpr int overloadPercent(int realtime_percent) noexcept {
  constexpr int kMargin = 2;
  constexpr int kMost = 97;
  if (realtime_percent >= 100) return kMost;
  return std::max({realtime_percent - kMargin, realtime_percent / 2, 1});
}

/// Tells from its CPU time that a thread does more than its periods have room for. A thread that was late
/// because others had the CPU has used little of it, and is not overloaded.
class OverloadWatch {
 public:
  /// `limit`: CPU time of ticks, among them long ones, that use more than `percent` of their periods
  /// together. A short tick now and then, or a long one, is room or load as any other.
  constexpr OverloadWatch(Duration period, int percent, Duration limit) noexcept
      : room_(period * percent / 100), pause_(period - room_), limit_(limit) {}

  /// After each tick. `periods`: that it stands for, above 1 if some were missed. `before_next`: time from
  /// its end until the next one is due. True: it leaves no pause, and overran() must be asked.
  [[nodiscard]] constexpr bool ended(std::uint64_t periods, Duration before_next) noexcept {
    periods_ += static_cast<std::int64_t>(periods);
    return before_next < pause_;
  }

  /// After a tick without a pause: a reading of the thread's CPU time costs a system call. True: overloaded.
  [[nodiscard]] constexpr bool overran(Duration cpu_time) noexcept {
    if (begin_) {
      const Duration used = cpu_time - *begin_;
      if (used >= periods_ * room_) {
        if (used < limit_) return false;
        begin_.reset();  // after the next limit it is told anew
        return true;
      }
    }
    // The first, whose begin is not known, or there was room enough since.
    begin_ = cpu_time;
    periods_ = 0;
    return false;
  }

 private:
  Duration room_;
  Duration pause_;
  Duration limit_;
  std::optional<Duration> begin_;  // CPU time at the end of a tick without a pause
  std::int64_t periods_ = 0;       // since then
};

}  // namespace rc10
