#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "app/time.hpp"

namespace rc10 {

/// Tells from the beats of rc10-guard that it stands still: a SIGSTOP, a debugger, a frozen cgroup, a hang.
class GuardBeats {
 public:
  /// The guard beats every 5 ms; without real-time priority a busy computer holds it up.
  static constexpr Duration kPatience = std::chrono::seconds{1};
  /// A longer time between two looks was a pause of this process, and may be one of the computer.
  static constexpr Duration kLongestLook = std::chrono::milliseconds{100};

  enum class News : std::uint8_t { kNone, kStandsStill, kGoesOn };

  /// 0 beats: no judgement; the guard has just begun, or is of a version without beats.
  [[nodiscard]] News look(std::uint32_t beats, MonotonicTime now) noexcept {
    silence_ += std::min<Duration>(now - looked_, kLongestLook);
    looked_ = now;
    if (beats == 0 || beats != beats_) silence_ = Duration::zero();
    beats_ = beats;
    const bool still = silence_ >= kPatience;
    if (still == still_) return News::kNone;
    still_ = still;
    return still ? News::kStandsStill : News::kGoesOn;
  }

 private:
  Duration silence_{};
  MonotonicTime looked_{};
  std::uint32_t beats_ = 0;
  bool still_ = false;
};

}  // namespace rc10
