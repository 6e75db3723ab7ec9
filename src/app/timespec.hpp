#pragma once

#include <time.h>

#include "app/time.hpp"

namespace rc10 {

/// A duration, or a time since the epoch of a clock, for the kernel. Range: 0 and above.
[[nodiscard]] constexpr timespec toTimespec(Duration duration) noexcept {
  constexpr Duration kSecond = std::chrono::seconds{1};
  return {.tv_sec = duration / kSecond, .tv_nsec = (duration % kSecond).count()};
}

}  // namespace rc10
