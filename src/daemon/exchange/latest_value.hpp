#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace rc10 {

/// Hands the newest value from one writer thread to one reader thread: a triple buffer. Neither side
/// ever waits or retries, so the writer may be a real-time thread. Values in between are lost.
template <typename T>
class LatestValue {
 public:
  LatestValue() = default;
  LatestValue(const LatestValue&) = delete;
  LatestValue& operator=(const LatestValue&) = delete;

  /// Writer: the slot to fill in. It holds an old value: write every field.
  [[nodiscard]] T& slot() noexcept { return slots_[write_]; }
  /// Writer: makes the filled slot the newest value.
  void publish() noexcept {
    const auto previous = middle_.exchange(write_ | kFresh, std::memory_order_acq_rel);
    write_ = previous & kIndex;
  }

  /// Reader: whether there is a value yet. Without one, read() returns a default T.
  [[nodiscard]] bool everPublished() const noexcept {
    return seen_ || (middle_.load(std::memory_order_relaxed) & kFresh) != 0;
  }

  /// Reader: the newest value; it stays as it is until the next read().
  [[nodiscard]] const T& read() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      const auto previous = middle_.exchange(read_, std::memory_order_acq_rel);
      read_ = previous & kIndex;
      seen_ = true;
    }
    return slots_[read_];
  }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;  // set by the writer, cleared by the reader

  std::array<T, 3> slots_{};
  std::uint8_t write_ = 0;  // writer's own
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t read_ = 2;  // reader's own
  bool seen_ = false;                  // reader's own
};

}  // namespace rc10
