#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "app/time.hpp"

namespace rc10 {

/// When to open a device again that is not there: at growing distances, so that one that never comes costs
/// nothing, and one that comes and goes is not chased.
class RetryPace {
 public:
  static constexpr Duration kFirstWait = std::chrono::milliseconds{50};
  static constexpr Duration kLongestWait = std::chrono::seconds{1};
  /// Time open after which a device is well: if it goes, it is tried again at once.
  static constexpr Duration kWellAfter = std::chrono::seconds{5};

  [[nodiscard]] bool due(MonotonicTime now) const noexcept { return now >= next_; }

  /// An attempt begins.
  void begin(MonotonicTime now) noexcept {
    wait_ = std::min(wait_ * 2, kLongestWait);
    next_ = now + wait_;
  }
  /// It failed. Whether that is to be told: again and again the same is told once.
  [[nodiscard]] bool failed(const std::string& why) {
    if (why == last_error_) return false;
    last_error_ = why;
    return true;
  }
  void opened(MonotonicTime now) noexcept {
    opened_ = now;
    last_error_.clear();
  }
  /// The open device is gone.
  void lost(MonotonicTime now) noexcept {
    if (now - opened_ >= kWellAfter) wait_ = kFirstWait;
    next_ = now + wait_;
  }

 private:
  Duration wait_ = kFirstWait;
  MonotonicTime next_;
  MonotonicTime opened_;
  std::string last_error_{};
};

}  // namespace rc10
