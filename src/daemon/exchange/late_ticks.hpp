#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "app/time.hpp"

namespace rc10 {

/// Part of a period, in order: waiting for the timer, frames and bytes in, orders and modules, motors, frames
/// out, snapshot and recordings.
enum class TickStep : std::uint8_t { kWake, kReceive, kModules, kControl, kSend, kPublish };
inline constexpr std::size_t kTickSteps = 6;

/// Lateness of a tick that was due then and began `now`, for which a timer or others' threads answer: while
/// the tick before went on, until `ended`, it could not begin.
[[nodiscard]] constexpr Duration latenessOfWake(MonotonicTime due, MonotonicTime ended,
                                                MonotonicTime now) noexcept {
  return now - std::max(due, ended);
}

/// Worth a reason: a tick that begins a fifth of a period late, or takes half of one.
[[nodiscard]] constexpr bool beginsLate(Duration late, Duration period) noexcept { return late > period / 5; }
[[nodiscard]] constexpr bool takesLong(Duration tick, Duration period) noexcept { return tick > period / 2; }

/// cycleCount() when the steps of a tick were over.
struct TickMarks {
  std::uint64_t woken = 0;
  std::uint64_t received = 0;
  std::uint64_t moved = 0;
  std::uint64_t packed = 0;
  std::uint64_t sent = 0;
  std::uint64_t done = 0;

  /// The step of the tick that took longest; never kWake.
  [[nodiscard]] constexpr TickStep longest() const noexcept {
    const auto span = [](std::uint64_t begin, std::uint64_t end) {
      return static_cast<std::int64_t>(end - begin);
    };
    const std::array<std::int64_t, kTickSteps - 1> steps{span(woken, received), span(received, moved),
                                                         span(moved, packed), span(packed, sent),
                                                         span(sent, done)};
    std::size_t longest = 0;
    for (std::size_t i = 1; i < steps.size(); ++i)
      if (steps[i] > steps[longest]) longest = i;
    return static_cast<TickStep>(longest + 1);
  }
};

/// Ticks that began late or took long, by the step in which the time went. The scheduler thread writes, any
/// thread reads.
class LateTicks {
 public:
  struct Sum {
    std::uint64_t ticks = 0;
    Duration time{};  ///< Sum of their lateness or durations.
  };

  void record(TickStep step, Duration time) noexcept {
    // One writer: a plain load and store is enough.
    auto& cell = cells_[static_cast<std::size_t>(step)];
    cell.ns.store(cell.ns.load(std::memory_order_relaxed) + time.count(), std::memory_order_relaxed);
    cell.ticks.store(cell.ticks.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }
  [[nodiscard]] Sum of(TickStep step) const noexcept {
    const auto& cell = cells_[static_cast<std::size_t>(step)];
    const auto ticks = cell.ticks.load(std::memory_order_acquire);
    return {ticks, Duration{cell.ns.load(std::memory_order_relaxed)}};
  }

 private:
  struct Cell {
    std::atomic<std::uint64_t> ticks{0};
    std::atomic<std::int64_t> ns{0};
  };
  std::array<Cell, kTickSteps> cells_{};
};

}  // namespace rc10
