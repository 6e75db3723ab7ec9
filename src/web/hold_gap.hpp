#pragma once

#include <chrono>
#include <cstdint>

#include "app/time.hpp"

namespace rc10::web {

/// Silence in a hold of a page (DriveMotor), after which the hold is over: its motor has stood meanwhile, and
/// would start again by itself.
class HoldGap {
 public:
  static constexpr std::chrono::milliseconds kMost{500};

  /// Whether a renewal that arrives now goes on with the hold of this number, or begins it.
  [[nodiscard]] bool goesOn(std::int64_t hold, MonotonicTime now) noexcept {
    if (hold != hold_) over_ = false;
    if (hold == hold_ && now - last_ > kMost) over_ = true;
    hold_ = hold;
    last_ = now;
    return !over_;
  }

  /// A renewal was sent, and acts until then.
  void sent(MonotonicTime until) noexcept { acts_until_ = until; }
  /// Whether the end of the hold has anything to end: later, what holds the motor is not the page's.
  [[nodiscard]] bool acts(std::int64_t hold, MonotonicTime now) const noexcept {
    return hold == hold_ && now < acts_until_;
  }

 private:
  std::int64_t hold_ = -1;
  MonotonicTime last_{};
  MonotonicTime acts_until_{};
  bool over_ = false;
};

}  // namespace rc10::web
