#pragma once

#include <memory>
#include <stop_token>

#include "app/result.hpp"
#include "app/time_grid.hpp"
#include "daemon/exchange/tick_timing.hpp"
#include "daemon/interfaces/can_intake.hpp"
#include "daemon/threads/periodic_timer.hpp"
#include "daemon/tick/scheduler.hpp"

namespace rc10 {

/// Calls Scheduler::tick() on an absolute grid.
class SchedLoop {
 public:
  /// `intake`: drained at the start of each tick (`receive: tick`); null: the RX thread drains it.
  [[nodiscard]] static Result<std::unique_ptr<SchedLoop>> create(Scheduler& scheduler, TimeGrid grid,
                                                                 TimerKind timer, CanIntake* intake);

  /// The thread's body. When asked to stop it goes on until rest frames are on the wire.
  void run(const std::stop_token& stop) noexcept;

  [[nodiscard]] const TickTiming& timing() const noexcept { return timing_; }

 private:
  SchedLoop(Scheduler& scheduler, TimeGrid grid, PeriodicTimer timer, CanIntake* intake)
      : scheduler_(scheduler), grid_(grid), timer_(std::move(timer)), intake_(intake) {}

  Scheduler& scheduler_;
  TimeGrid grid_;
  PeriodicTimer timer_;
  CanIntake* intake_;
  TickTiming timing_;
};

}  // namespace rc10
