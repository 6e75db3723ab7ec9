#include "daemon/threads/sim_loop.hpp"

#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

// All simulated drives send once a millisecond, as the real ones do.
constexpr Duration kPeriod = std::chrono::milliseconds{1};

}  // namespace

Result<std::unique_ptr<SimLoop>> SimLoop::create(Robot& robot, Duration offset) {
  auto timer = PeriodicTimer::create();
  if (!timer) return tl::unexpected(timer.error());
  // Half a period off the scheduler's grid, so that feedback does not race with the tick.
  return std::unique_ptr<SimLoop>(new SimLoop(robot, {kPeriod, offset + kPeriod / 2}, std::move(*timer)));
}

void SimLoop::run(const std::stop_token& stop) noexcept {
  timer_.start(grid_.next(monotonicNow()), grid_.period);
  while (!stop.stop_requested()) {
    if (timer_.wait() == 0) continue;
    for (auto& port : robot_.simPorts()) {
      port->step(monotonicNow());
      port->sentAt(monotonicNow());
    }
    robot_.simulationSteps().fetch_add(1, std::memory_order_relaxed);
  }
}

}  // namespace rc10
