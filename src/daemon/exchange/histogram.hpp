#pragma once

#include <atomic>
#include <cstdint>

#include "app/duration_histogram.hpp"

namespace rc10 {

/// Counter with one writer, which never waits; any thread may read while it writes. A plain load and store is
/// enough, and cheaper than a locked add.
class SharedCount {
 public:
  [[nodiscard]] std::uint64_t get() const noexcept { return value_.load(std::memory_order_relaxed); }
  void set(std::uint64_t value) noexcept { value_.store(value, std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

using DurationHistogram = BasicDurationHistogram<SharedCount>;

}  // namespace rc10
