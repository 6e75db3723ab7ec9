#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include <pthread.h>

#include "app/result.hpp"
#include "app/time.hpp"

namespace rc10 {
inline namespace robot_client {

enum class SchedPolicy {
  kOther,  ///< The ordinary one of Linux; the priority is ignored.
  kFifo,   ///< SCHED_FIFO
  kRoundRobin,
};

struct TaskOptions {
  std::string name{};  ///< As `ps -T` shows it, at most 15 characters.
  SchedPolicy policy = SchedPolicy::kOther;
  /// 1 (low) to 99. rc10d's own threads have 50 to 65: stay below, or the motors wait for you.
  int priority = 0;
  std::optional<int> cpu = std::nullopt;  ///< Pinned to this CPU.
  /// Without it a task that is not given its policy, priority or CPU runs all the same, and problem() says
  /// why.
  bool required = false;
  std::size_t stack_bytes = 0;  ///< 0: the system's default, 8 MiB of address space.
};

/// Waits on an absolute grid of CLOCK_MONOTONIC: what a body takes does not add up. For one thread.
class Rate {
 public:
  /// The first grid point is one period from now.
  explicit Rate(Duration period);

  /// Waits for the next grid point; returns how many were missed before it, which are not made up for.
  std::uint64_t wait();

  /// The same as a function: the first grid point after `due` that is not past at `now`, and how many lie
  /// between.
  struct Next {
    MonotonicTime due;
    std::uint64_t missed = 0;
  };
  [[nodiscard]] static Next next(MonotonicTime due, Duration period, MonotonicTime now) noexcept;

 private:
  Duration period_;
  MonotonicTime due_;
};

/// A named thread with a policy, a priority and a CPU, as in the STM32 library: derive from it and override
/// loop() for a periodic task, or run() for one that waits for events; or give it a function.
///
/// start(), stop() and the destructor belong to the thread that owns the task; the counters may be read from
/// any. A derived class calls stop() in its destructor: before that of this class its members are gone
/// already.
class RtosTask {
 public:
  explicit RtosTask(TaskOptions options) : options_(std::move(options)) {}
  RtosTask(const RtosTask&) = delete;
  RtosTask& operator=(const RtosTask&) = delete;
  virtual ~RtosTask() { stop(); }

  /// Starts loop() on a grid of `period`, or run() without one. The error is why there is no thread; with
  /// TaskOptions::required also why it is not real-time.
  Result<void> start(std::optional<Duration> period = std::nullopt);
  /// The same with a function instead of loop().
  Result<void> startLoop(Duration period, std::function<void()> loop);
  /// The same with a function instead of run(); it has to return soon after the token says stop.
  Result<void> startRun(std::function<void(std::stop_token)> run);

  /// Asks it to end and waits for that. Not from within the task: that is requestStop().
  void stop() noexcept;
  void requestStop() noexcept { stop_.request_stop(); }
  [[nodiscard]] bool running() const noexcept { return running_.load(); }

  /// Options that the system did not grant, and the remedy; empty: everything was granted.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
  /// Times loop() was called.
  [[nodiscard]] std::uint64_t cycles() const noexcept { return cycles_.load(); }
  /// Grid points that loop() missed by taking, or starting, too long.
  [[nodiscard]] std::uint64_t overruns() const noexcept { return overruns_.load(); }

 protected:
  /// One step of a periodic task. An exception that leaves it ends the program.
  virtual void loop() {}
  /// The whole of a task without a period.
  // NOLINTNEXTLINE(performance-unnecessary-value-param): by value, as std::jthread hands it over
  virtual void run(std::stop_token /*stop*/) {}

 private:
  struct Start;
  static void* entry(void* start);
  Result<void> launch(std::function<void(std::stop_token)> body);
  void repeat(Duration period, const std::function<void()>& loop, const std::stop_token& stop);

  TaskOptions options_;
  pthread_t thread_{};
  bool joinable_ = false;
  std::stop_source stop_;
  std::string problem_;
  std::atomic<bool> running_{false};
  std::atomic<std::uint64_t> cycles_{0};
  std::atomic<std::uint64_t> overruns_{0};
};

}  // namespace robot_client
}  // namespace rc10
