#pragma once

#include <cstdint>
#include <optional>

#include "app/time.hpp"

namespace rc10::gateway {

/// Lets one report a second pass and counts the rest.
class Throttle {
 public:
  /// Number of reports held back since the last that passed; empty: hold this one back too.
  [[nodiscard]] std::optional<std::uint64_t> pass(MonotonicTime now) noexcept {
    if (passed_once_ && now - last_ < kInterval) {
      ++held_back_;
      return std::nullopt;
    }
    passed_once_ = true;
    last_ = now;
    const auto count = held_back_;
    held_back_ = 0;
    return count;
  }

 private:
  static constexpr Duration kInterval = std::chrono::seconds{1};
  MonotonicTime last_{};
  std::uint64_t held_back_ = 0;
  bool passed_once_ = false;
};

}  // namespace rc10::gateway
