#pragma once

#include <cstdint>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"

namespace rc10 {

enum class TimerKind : std::uint8_t {
  kTimerfd,
  /// clock_nanosleep(TIMER_ABSTIME). On PREEMPT_RT its timer expires in interrupt context for a real-time
  /// thread; a timerfd's waits for ktimers (FIFO 1), so that any FIFO thread on the CPU delays it.
  kNanosleep,
};

/// Wakes one thread on an absolute grid of CLOCK_MONOTONIC.
class PeriodicTimer {
 public:
  [[nodiscard]] static Result<PeriodicTimer> create(TimerKind kind = TimerKind::kTimerfd);

  /// Expires at `first` and then every `period`.
  void start(MonotonicTime first, Duration period) noexcept;

  /// Waits for the next expiration. Returns how many came since the last wait: above 1, some were
  /// missed. 0: interrupted.
  [[nodiscard]] std::uint64_t wait() noexcept;
  /// When the last wait() that was not interrupted returned.
  [[nodiscard]] MonotonicTime woken() const noexcept { return woken_; }

 private:
  explicit PeriodicTimer(UniqueFd fd) : fd_(std::move(fd)) {}
  [[nodiscard]] std::uint64_t sleep() noexcept;

  UniqueFd fd_;  // none: nanosleep
  MonotonicTime next_{};
  MonotonicTime woken_{};
  Duration period_{};
};

}  // namespace rc10
