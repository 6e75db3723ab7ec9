#pragma once

#include <optional>

#include "app/time.hpp"

namespace rc10 {

/// Tells from its CPU time that a thread does more than its periods have room for. A thread that was late
/// because others had the CPU has used little of it, and is not overloaded.
class OverloadWatch {
 public:
  /// `limit`: CPU time of consecutive ticks that each use more than `most` of it.
  constexpr OverloadWatch(Duration most, Duration limit) noexcept : most_(most), limit_(limit) {}

  [[nodiscard]] constexpr Duration most() const noexcept { return most_; }
  /// After a tick that took longer than `most`. `cpu_time`: the thread's, so far. True: overloaded.
  [[nodiscard]] constexpr bool overran(Duration cpu_time) noexcept {
    // The start of the first of several overruns is not known.
    const Duration used = last_cpu_time_ ? cpu_time - *last_cpu_time_ : Duration::zero();
    over_ = used > most_ ? over_ + used : Duration::zero();
    last_cpu_time_ = cpu_time;
    return over_ >= limit_;
  }
  /// After a tick that did not.
  constexpr void inTime() noexcept {
    last_cpu_time_.reset();
    over_ = Duration::zero();
  }

 private:
  Duration most_;
  Duration limit_;
  std::optional<Duration> last_cpu_time_;  // at the end of the tick before, if that overran
  Duration over_{};
};

}  // namespace rc10
