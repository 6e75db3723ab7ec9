#include "daemon/threads/sched_loop.hpp"

#include "daemon/exchange/cycle_count.hpp"

namespace rc10 {

SchedLoop::SchedLoop(Scheduler& scheduler, const Settings& settings, PeriodicTimer timer, CanIntake* intake)
    : scheduler_(scheduler),
      grid_(settings.grid),
      timer_(std::move(timer)),
      intake_(intake),
      overload_(settings.grid.period, overloadPercent(settings.realtime_percent), settings.overload),
      cpu_time_(settings.cpu_time) {}

Result<std::unique_ptr<SchedLoop>> SchedLoop::create(Scheduler& scheduler, const Settings& settings,
                                                     CanIntake* intake) {
  auto timer = PeriodicTimer::create(settings.timer);
  if (!timer) return tl::unexpected(timer.error());
  return std::unique_ptr<SchedLoop>(new SchedLoop(scheduler, settings, std::move(*timer), intake));
}

void SchedLoop::run(const std::stop_token& stop) noexcept {
  const MonotonicTime first = grid_.next(monotonicNow());
  timer_.start(first, grid_.period);
  MonotonicTime planned = first - grid_.period;
  MonotonicTime ended{};  // the tick before
  while (!scheduler_.stopped()) {
    const std::uint64_t periods = timer_.wait();  // above 1, ticks were missed
    if (periods == 0) continue;
    const std::uint64_t woken = cycleCount();
    const MonotonicTime now = timer_.woken();
    if (intake_ != nullptr) intake_->drain(now);  // first: it reads the wall clock that belongs to `now`
    // Against the first grid point that waits: a wake-up that missed ten ticks is ten periods late.
    const MonotonicTime due = planned + grid_.period;
    timing_.wake_latency.record(now - due);
    const Duration slept_in = latenessOfWake(due, ended, now);
    if (beginsLate(slept_in, grid_.period)) timing_.late.record(TickStep::kWake, slept_in);
    planned += grid_.period * static_cast<std::int64_t>(periods);
    if (stop.stop_requested()) scheduler_.beginStop();
    scheduler_.tick(now, periods);
    ended = monotonicNow();
    countLongTick(woken, ended - now);
    watchLoad(periods, planned + grid_.period - ended);
  }
}

void SchedLoop::countLongTick(std::uint64_t woken, Duration duration) noexcept {
  timing_.duration.record(duration);
  if (!takesLong(duration, grid_.period)) return;
  TickMarks marks = scheduler_.marks();
  marks.woken = woken;
  marks.done = cycleCount();
  timing_.late.record(marks.longest(), duration);
}

void SchedLoop::watchLoad(std::uint64_t periods, Duration before_next) noexcept {
  // RT throttling by the kernel would leave no ticks for the rest of each second: a stop is safer.
  if (overload_.ended(periods, before_next) && overload_.overran(cpu_time_()))
    scheduler_.stopFor({StopCause::kOverload});
}

}  // namespace rc10
