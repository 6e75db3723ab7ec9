#include "daemon/threads/sim_loop.hpp"

#include <algorithm>
#include <variant>

#include "daemon/exchange/clock.hpp"

namespace rc10 {
namespace {

// Drives that talk unasked send once a millisecond.
constexpr Duration kPeriod = std::chrono::milliseconds{1};

}  // namespace

TimeGrid SimLoop::gridBeside(const TimeGrid& scheduler) noexcept {
  const Duration period = std::min(kPeriod, scheduler.period);
  return {period, scheduler.offset + period / 2};
}

Result<std::unique_ptr<SimLoop>> SimLoop::create(Robot& robot, const TimeGrid& scheduler, ShaftRing& shafts) {
  auto timer = PeriodicTimer::create();
  if (!timer) return tl::unexpected(timer.error());
  return std::unique_ptr<SimLoop>(new SimLoop(robot, gridBeside(scheduler), std::move(*timer), shafts));
}

void SimLoop::act(const ShaftOrder& order) noexcept {
  auto& bus = robot_.simPorts()[order.of.port]->bus();
  if (const auto* hand = std::get_if<sim::Hand>(&order.act)) bus.turnByHand(order.of.drive, *hand);
  if (const auto* change = std::get_if<sim::LoadChange>(&order.act)) bus.changeLoad(order.of.drive, *change);
}

void SimLoop::run(const std::stop_token& stop) noexcept {
  timer_.start(grid_.next(monotonicNow()), grid_.period);
  while (!stop.stop_requested()) {
    if (timer_.wait() == 0) continue;
    ShaftOrder order;
    while (shafts_.pop(order)) act(order);
    for (auto& port : robot_.simPorts()) {
      port->step(monotonicNow());
      port->sentAt(monotonicNow());
    }
    robot_.simulationSteps().fetch_add(1, std::memory_order_relaxed);
  }
}

}  // namespace rc10
