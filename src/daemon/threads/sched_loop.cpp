#include "daemon/threads/sched_loop.hpp"

#include "daemon/exchange/clock.hpp"

namespace rc10 {

Result<std::unique_ptr<SchedLoop>> SchedLoop::create(Scheduler& scheduler, Duration period) {
  auto timer = PeriodicTimer::create();
  if (!timer) return tl::unexpected(timer.error());
  return std::unique_ptr<SchedLoop>(new SchedLoop(scheduler, period, std::move(*timer)));
}

void SchedLoop::run(const std::stop_token& stop) noexcept {
  const MonotonicTime first = nextOnGrid(monotonicNow(), period_);
  timer_.start(first, period_);
  MonotonicTime planned = first - period_;
  while (!scheduler_.stopped()) {
    const std::uint64_t periods = timer_.wait();  // above 1, ticks were missed
    if (periods == 0) continue;
    const MonotonicTime now = monotonicNow();
    // Against the first grid point that waits: a wake-up that missed ten ticks is ten periods late.
    timing_.wake_latency.record(now - (planned + period_));
    planned += period_ * static_cast<std::int64_t>(periods);
    if (stop.stop_requested()) scheduler_.beginStop();
    scheduler_.tick(now, periods);
    timing_.duration.record(monotonicNow() - now);
  }
}

}  // namespace rc10
