#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/time.hpp"
#include "daemon/clients/cpu_rivals.hpp"
#include "daemon/exchange/late_ticks.hpp"
#include "link/late_causes.hpp"

namespace rc10 {

/// Knowledge of the kernel about a thread, since that began.
struct ThreadFacts {
  /// Ready to run while others had the CPU. None: the kernel does not say.
  std::function<std::optional<Duration>()> waited;
  std::function<std::uint64_t()> page_faults;
  CpuRivals* rivals = nullptr;  ///< Threads that may take its CPU. None: nobody is named.
};

/// Counts late ticks by cause, from what the scheduler thread and the kernel have counted since the last
/// call, its window: twenty ticks at 1 kHz, unless the caller was late. A thread waits a few microseconds
/// before each tick; what it waits in windows without late ticks takes nothing. A window has one sum for each
/// step: of two late ticks with the same step both have one cause. Link thread only.
class LateTickCauses {
 public:
  /// `ticks`: of the scheduler, so far.
  void update(const LateTicks& late, std::uint64_t ticks, const ThreadFacts& thread);

  [[nodiscard]] std::uint64_t count(LateCause cause) const noexcept {
    return counts_[static_cast<std::size_t>(cause)];
  }

  /// Late ticks whose CPU a thread is known to have taken; they are not among kCpuTaken.
  struct Taker {
    std::string name;
    std::uint64_t count = 0;
  };
  static constexpr std::size_t kMaxTakers = 4;
  [[nodiscard]] const std::vector<Taker>& takers() const noexcept { return takers_; }

 private:
  [[nodiscard]] Duration waitedUnusually(const ThreadFacts& thread, std::uint64_t ticks, bool any);
  [[nodiscard]] std::string takerOf(bool taken, Duration waited, CpuRivals* rivals);
  void countTaken(const std::string& taker, std::uint64_t ticks);

  std::array<LateTicks::Sum, kTickSteps> seen_{};
  std::optional<Duration> waited_;
  std::optional<std::uint64_t> page_faults_;
  int fault_windows_ = 0;          ///< Windows until they are asked for although no tick is late.
  Duration waited_before_{};       ///< In the window before: a wait may be counted before its tick.
  std::optional<Duration> usual_;  ///< Wait before a tick, in windows without late ones.
  std::uint64_t ticks_ = 0;
  std::array<std::uint64_t, kLateCauses> counts_{};
  int watched_windows_ = 0;  ///< Windows for which the rivals are still watched.
  std::vector<Taker> takers_;
};

}  // namespace rc10
