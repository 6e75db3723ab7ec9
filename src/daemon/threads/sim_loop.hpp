#pragma once

#include <memory>
#include <stop_token>

#include "app/result.hpp"
#include "app/time_grid.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/threads/periodic_timer.hpp"

namespace rc10 {

/// Steps the simulated motors in a thread of their own, once a millisecond or tick, whichever is shorter: to
/// the rest of the daemon they are drives at the other end of a bus.
class SimLoop {
 public:
  /// Steps for a scheduler's grid: a drive answers each tick before the next, and half a period off, so that
  /// its feedback does not race with the tick.
  [[nodiscard]] static TimeGrid gridBeside(const TimeGrid& scheduler) noexcept;
  /// `shafts`: orders for its drives. Outlives it.
  [[nodiscard]] static Result<std::unique_ptr<SimLoop>> create(Robot& robot, const TimeGrid& scheduler,
                                                               ShaftRing& shafts);

  /// The thread's body.
  void run(const std::stop_token& stop) noexcept;

 private:
  SimLoop(Robot& robot, TimeGrid grid, PeriodicTimer timer, ShaftRing& shafts)
      : robot_(robot), grid_(grid), timer_(std::move(timer)), shafts_(shafts) {}

  void act(const ShaftOrder& order) noexcept;

  Robot& robot_;
  TimeGrid grid_;
  PeriodicTimer timer_;
  ShaftRing& shafts_;
};

}  // namespace rc10
