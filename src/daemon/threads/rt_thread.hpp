#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include <pthread.h>

#include "app/result.hpp"

namespace rc10 {

/// Scheduling of a thread.
struct RtSettings {
  std::string name;        ///< As `ps -T` shows it, at most 15 characters.
  int priority = 0;        ///< SCHED_FIFO; 0: SCHED_OTHER.
  std::optional<int> cpu;  ///< Pinned to this CPU.
};

/// Gives the calling thread its name, policy, priority and CPU, touches its stack, flushes subnormals, and
/// reads each setting back. The error says which right is missing and how to give it.
[[nodiscard]] Result<void> applyRtSettings(const RtSettings& settings);

/// CPU time that the kernel leaves to real-time threads, in percent (sched_rt_runtime_us); 100: all of it.
[[nodiscard]] int realtimePercent();

/// A thread with a small fixed stack (locked memory counts whole stacks). start() returns when the
/// body's set-up has succeeded or failed.
class RtThread {
 public:
  RtThread() = default;
  RtThread(const RtThread&) = delete;
  RtThread& operator=(const RtThread&) = delete;
  ~RtThread() { join(); }

  /// Runs `body(stop)` in a new thread. The settings are applied there first; what went wrong with
  /// them is returned, and the body runs all the same: whether that is good enough is the caller's
  /// decision.
  [[nodiscard]] Result<void> start(RtSettings settings, std::function<void(std::stop_token)> body);

  void requestStop() noexcept { stop_.request_stop(); }
  void join() noexcept;
  [[nodiscard]] bool joinable() const noexcept { return running_; }
  /// Kernel thread id, for statistics.
  [[nodiscard]] int tid() const noexcept { return tid_.load(); }

 private:
  struct Start;
  static void* entry(void* start);

  pthread_t thread_{};
  bool running_ = false;
  std::stop_source stop_;
  std::atomic<int> tid_{0};
};

}  // namespace rc10
