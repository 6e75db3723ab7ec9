#pragma once

#include <cstdint>

#include "daemon/exchange/clock.hpp"

namespace rc10 {

/// A count that rises with time at an unknown rate, to compare spans of one thread with each other: one
/// instruction, where reading a clock takes a hundred, or a system call. A thread that changes the processor
/// may see it step. Elsewhere than on x86-64 and ARM64 it is the clock.
[[nodiscard]] inline std::uint64_t cycleCount() noexcept {
#if defined(__x86_64__)
  return __builtin_ia32_rdtsc();
#elif defined(__aarch64__)
  std::uint64_t count = 0;
  asm volatile("mrs %0, cntvct_el0" : "=r"(count));
  return count;
#else
  return static_cast<std::uint64_t>(monotonicNow().time_since_epoch().count());
#endif
}

}  // namespace rc10
