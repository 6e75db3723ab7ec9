#include "daemon/threads/sched_loop.hpp"

#include "daemon/exchange/clock.hpp"

namespace rc10 {

Result<std::unique_ptr<SchedLoop>> SchedLoop::create(Scheduler& scheduler, TimeGrid grid, TimerKind timer,
                                                     CanIntake* intake) {
  auto created = PeriodicTimer::create(timer);
  if (!created) return tl::unexpected(created.error());
  return std::unique_ptr<SchedLoop>(new SchedLoop(scheduler, grid, std::move(*created), intake));
}

void SchedLoop::run(const std::stop_token& stop) noexcept {
  const MonotonicTime first = grid_.next(monotonicNow());
  timer_.start(first, grid_.period);
  MonotonicTime planned = first - grid_.period;
  while (!scheduler_.stopped()) {
    const std::uint64_t periods = timer_.wait();  // above 1, ticks were missed
    if (periods == 0) continue;
    const MonotonicTime now = monotonicNow();
    // Against the first grid point that waits: a wake-up that missed ten ticks is ten periods late.
    timing_.wake_latency.record(now - (planned + grid_.period));
    planned += grid_.period * static_cast<std::int64_t>(periods);
    if (stop.stop_requested()) scheduler_.beginStop();
    if (intake_ != nullptr) intake_->drain(now);
    scheduler_.tick(now, periods);
    timing_.duration.record(monotonicNow() - now);
  }
}

}  // namespace rc10
