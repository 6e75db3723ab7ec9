// Loops that sleep to a grid, of rc10d's priority, and how late they wake.
#pragma once

#include <sched.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

namespace rc10::peers {

constexpr std::int64_t kMs_ns = 1'000'000;
constexpr std::int64_t kSecond_ns = 1000 * kMs_ns;
/// As rc10d's scheduler.
constexpr int kPriority = 60;

inline std::int64_t now_ns(clockid_t clock = CLOCK_MONOTONIC) {
  timespec time{};
  clock_gettime(clock, &time);
  return time.tv_sec * kSecond_ns + time.tv_nsec;
}

inline void sleepUntil(std::int64_t time_ns) {
  const timespec until{.tv_sec = time_ns / kSecond_ns, .tv_nsec = time_ns % kSecond_ns};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

/// Ends the program if it may not.
inline void schedule(int policy, int priority) {
  const sched_param parameter{.sched_priority = priority};
  if (sched_setscheduler(0, policy, &parameter) == 0) return;
  std::perror("sched_setscheduler");
  std::_Exit(1);
}

/// The loop of a contender: a millisecond from one sleep's end to the next, until SIGTERM.
class Grid {
 public:
  explicit Grid(std::int64_t first_ns = now_ns()) : due_ns_(first_ns), late_ns_(kMostCycles) {
    std::signal(SIGTERM, [](int) { ended = 1; });
  }
  /// False: SIGTERM has come.
  bool sleep() {
    due_ns_ += kMs_ns;
    sleepUntil(due_ns_);
    if (ended != 0) return false;
    if (cycles_ < kMostCycles) late_ns_[cycles_++] = now_ns() - due_ns_;
    return true;
  }
  /// As a JSON object.
  void printLateness() {
    if (cycles_ == 0) return;
    late_ns_.resize(cycles_);
    std::sort(late_ns_.begin(), late_ns_.end());
    std::printf("{\"p50_us\": %.3f, \"p99_us\": %.3f}\n", static_cast<double>(late_ns_[cycles_ / 2]) * 1e-3,
                static_cast<double>(late_ns_[cycles_ * 99 / 100]) * 1e-3);
  }

 private:
  static constexpr std::size_t kMostCycles = 100'000;
  static inline volatile std::sig_atomic_t ended = 0;

  std::int64_t due_ns_;
  std::vector<std::int64_t> late_ns_;  // in memory already
  std::size_t cycles_ = 0;
};

}  // namespace rc10::peers
