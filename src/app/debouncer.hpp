#pragma once

#include "app/time.hpp"

namespace rc10 {

/// A level that counts once it has lasted: contacts bounce for some milliseconds. Pure.
class Debouncer {
 public:
  /// 0: every look counts.
  explicit Debouncer(Duration lasting) noexcept : lasting_(lasting) {}

  /// One look at the level; the first one counts at once. Returns the level that counts.
  bool step(bool level, MonotonicTime now) noexcept {
    if (!known_) value_ = latest_ = level;
    known_ = true;
    if (level != latest_) since_ = now;
    latest_ = level;
    if (level != value_ && now - since_ >= lasting_) value_ = level;
    return value_;
  }
  /// Forgets the level: the next look is the first.
  void restart() noexcept { known_ = false; }

 private:
  Duration lasting_;
  MonotonicTime since_{};  ///< Time since which it is `latest_`.
  bool known_ = false;
  bool latest_ = false;
  bool value_ = false;
};

}  // namespace rc10
