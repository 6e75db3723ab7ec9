#pragma once

#include <cstdint>

namespace rc10::guard {

/// Finds from a counter of ticks that rc10d stands still. Time is counted in the guard's own wake-ups, so
/// that a pause of the whole computer does not count.
class Standstill {
 public:
  /// The guard wakes up this often.
  static constexpr std::uint32_t kStepMs = 5;

  explicit Standstill(std::uint32_t limit_ms) noexcept : limit_steps_((limit_ms + kStepMs - 1) / kStepMs) {}

  /// Once per wake-up. True while the counter has not moved for the limit. Before the first tick there is
  /// none.
  [[nodiscard]] bool step(std::uint64_t ticks) noexcept {
    steps_ = ticks == 0 || ticks != ticks_ ? 0 : steps_ + 1;
    ticks_ = ticks;
    return steps_ >= limit_steps_;
  }

 private:
  std::uint32_t limit_steps_;
  std::uint32_t steps_ = 0;
  std::uint64_t ticks_ = 0;
};

}  // namespace rc10::guard
