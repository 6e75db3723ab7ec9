#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <utility>

#include "app/time.hpp"
#include "daemon/recording/flight_recorder.hpp"

namespace rc10 {

/// When to copy the recording: a little after its cause, so that what followed is in it too, and not too
/// often. Causes that come in between share a copy.
class CopyPlan {
 public:
  static constexpr Duration kAftermath = std::chrono::seconds{1};
  static constexpr Duration kInterval = std::chrono::seconds{10};

  /// `causes`: bits of CopyCause that came up just now; 0: none.
  void note(std::uint32_t causes, MonotonicTime now) noexcept {
    if (causes == 0 || cause_ != nullptr) return;
    cause_ = (causes & static_cast<std::uint32_t>(CopyCause::kFault)) != 0 ? "fault" : "estop";
    due_ = std::max(now + kAftermath, next_);
  }
  /// The cause of the copy that is to be made now, nullptr if none is.
  [[nodiscard]] const char* due(MonotonicTime now) noexcept {
    return cause_ != nullptr && now >= due_ ? take(now) : nullptr;
  }
  /// The same, but without waiting any longer: for the end.
  [[nodiscard]] const char* last(MonotonicTime now) noexcept { return take(now); }

 private:
  const char* take(MonotonicTime now) noexcept {
    next_ = now + kInterval;
    return std::exchange(cause_, nullptr);
  }

  const char* cause_ = nullptr;
  MonotonicTime due_{};
  MonotonicTime next_{};
};

}  // namespace rc10
