#pragma once

#include <cstdint>

#include "app/time.hpp"

namespace rc10 {

/// The latest value of a stream.
template <typename T>
struct Stamped {
  T value{};
  MonotonicTime received;     ///< When the frame that brought it ended.
  std::uint64_t samples = 0;  ///< Values so far; 0: nothing is known yet.

  void set(const T& newest, MonotonicTime time) noexcept {
    value = newest;
    received = time;
    ++samples;
  }
  /// Duration::max() before the first value.
  [[nodiscard]] Duration age(MonotonicTime now) const noexcept {
    return samples == 0 ? Duration::max() : now - received;
  }
};

}  // namespace rc10
