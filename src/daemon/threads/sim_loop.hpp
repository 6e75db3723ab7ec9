#pragma once

#include <memory>
#include <stop_token>

#include "app/result.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/threads/periodic_timer.hpp"

namespace rc10 {

/// Steps the simulated motors in a thread of their own, once a millisecond: to the rest of the daemon
/// they are drives at the other end of a bus.
class SimLoop {
 public:
  [[nodiscard]] static Result<std::unique_ptr<SimLoop>> create(Robot& robot);

  /// The thread's body.
  void run(const std::stop_token& stop) noexcept;

 private:
  SimLoop(Robot& robot, PeriodicTimer timer) : robot_(robot), timer_(std::move(timer)) {}

  Robot& robot_;
  PeriodicTimer timer_;
};

}  // namespace rc10
