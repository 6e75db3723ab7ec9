#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "app/time.hpp"

namespace rc10::client {

/// After a pause of this program (a signal, a busy computer) what it knows is old: its motor may have been
/// stopped and enabled meanwhile. Then it commands nothing before it has read something of after the pause.
class CatchUp {
 public:
  /// In each turn, after reading. `newest_us`: CLOCK_MONOTONIC of the newest that was read from rc10d.
  [[nodiscard]] bool done(MonotonicTime now, std::int64_t newest_us) noexcept {
    if (last_ && now - *last_ > kPause) resumed_ = now;
    last_ = now;
    return MonotonicTime{std::chrono::microseconds{newest_us}} >= resumed_;
  }

 private:
  static constexpr Duration kPause = std::chrono::milliseconds{100};

  std::optional<MonotonicTime> last_;
  MonotonicTime resumed_{};
};

}  // namespace rc10::client
