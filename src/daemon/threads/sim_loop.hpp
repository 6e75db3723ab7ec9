#pragma once

#include <memory>
#include <stop_token>

#include "app/result.hpp"
#include "app/time_grid.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/threads/periodic_timer.hpp"

namespace rc10 {

/// Steps the simulated motors in a thread of their own, once a millisecond: to the rest of the daemon
/// they are drives at the other end of a bus.
class SimLoop {
 public:
  /// `offset`: of the scheduler's grid.
  [[nodiscard]] static Result<std::unique_ptr<SimLoop>> create(Robot& robot, Duration offset);

  /// The thread's body.
  void run(const std::stop_token& stop) noexcept;

 private:
  SimLoop(Robot& robot, TimeGrid grid, PeriodicTimer timer)
      : robot_(robot), grid_(grid), timer_(std::move(timer)) {}

  Robot& robot_;
  TimeGrid grid_;
  PeriodicTimer timer_;
};

}  // namespace rc10
