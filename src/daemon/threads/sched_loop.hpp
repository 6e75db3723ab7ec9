#pragma once

#include <memory>
#include <stop_token>

#include "app/result.hpp"
#include "app/time_grid.hpp"
#include "daemon/exchange/clock.hpp"
#include "daemon/exchange/tick_timing.hpp"
#include "daemon/interfaces/can_intake.hpp"
#include "daemon/threads/overload_watch.hpp"
#include "daemon/threads/periodic_timer.hpp"
#include "daemon/tick/scheduler.hpp"

namespace rc10 {

/// Calls Scheduler::tick() on an absolute grid.
class SchedLoop {
 public:
  struct Settings {
    TimeGrid grid;
    TimerKind timer = TimerKind::kTimerfd;
    Duration
        overload;  ///< Range: above 0. The robot stops after ticks of so much CPU time, see OverloadWatch.
    int realtime_percent = 95;  ///< Range: 1 to 100. CPU time that the kernel leaves to real-time threads.
    Duration (*cpu_time)() noexcept = threadCpuTime;  ///< The calling thread's.
  };

  /// `intake`: drained at the start of each tick (`receive: tick`); null: the RX thread drains it.
  [[nodiscard]] static Result<std::unique_ptr<SchedLoop>> create(Scheduler& scheduler,
                                                                 const Settings& settings, CanIntake* intake);

  /// The thread's body. When asked to stop it goes on until rest frames are on the wire.
  void run(const std::stop_token& stop) noexcept;

  [[nodiscard]] const TickTiming& timing() const noexcept { return timing_; }

 private:
  SchedLoop(Scheduler& scheduler, const Settings& settings, PeriodicTimer timer, CanIntake* intake);
  /// `woken`: cycleCount() then. `duration`: from then to the end of the tick.
  void countLongTick(std::uint64_t woken, Duration duration) noexcept;
  /// After a tick that stands for so many periods.
  void watchLoad(std::uint64_t periods, Duration before_next) noexcept;

  Scheduler& scheduler_;
  TimeGrid grid_;
  PeriodicTimer timer_;
  CanIntake* intake_;
  OverloadWatch overload_;
  Duration (*cpu_time_)() noexcept;
  TickTiming timing_;
};

}  // namespace rc10
