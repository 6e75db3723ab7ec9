#pragma once

#include <atomic>
#include <memory>
#include <stop_token>

#include "app/result.hpp"
#include "daemon/exchange/tick_timing.hpp"
#include "daemon/threads/periodic_timer.hpp"
#include "daemon/tick/scheduler.hpp"

namespace rc10 {

/// Calls Scheduler::tick() on an absolute grid, by timerfd.
class SchedLoop {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SchedLoop>> create(Scheduler& scheduler, Duration period);

  /// The thread's body. When asked to stop it goes on until rest frames are on the wire.
  void run(const std::stop_token& stop) noexcept;

  [[nodiscard]] const TickTiming& timing() const noexcept { return timing_; }

 private:
  SchedLoop(Scheduler& scheduler, Duration period, PeriodicTimer timer)
      : scheduler_(scheduler), period_(period), timer_(std::move(timer)) {}

  Scheduler& scheduler_;
  Duration period_;
  PeriodicTimer timer_;
  TickTiming timing_;
};

}  // namespace rc10
