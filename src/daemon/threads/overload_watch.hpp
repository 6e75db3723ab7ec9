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

/// Overload of a thread: CPU time above the permitted percentage of its periods. A thread that was preempted
/// is late, too, but has used little CPU time, and is not overloaded.
class OverloadWatch {
 public:
  /// `limit`: CPU time of a run of ticks from which on it is an overload, if that is more than `percent` of
  /// their periods. Utilisation is that of the whole run: neither one short tick nor one long one decides.
  constexpr OverloadWatch(Duration period, int percent, Duration limit) noexcept
      : room_(period * percent / 100), pause_(period - room_), limit_(limit) {}

  /// After each tick. `periods`: 1, and one more for each tick that was missed. `before_next`: time from its
  /// end until the next one is due. True: the pause is too short, and overran() must be asked.
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
    // A run begins here: the first ever, or after one below the percentage.
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
