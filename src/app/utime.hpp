#pragma once

#include <chrono>
#include <cstdint>

namespace rc10 {

/// For `utime` fields: microseconds since 1970.
[[nodiscard]] constexpr std::int64_t utimeOf(std::chrono::system_clock::time_point time) noexcept {
  return std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
}

}  // namespace rc10
