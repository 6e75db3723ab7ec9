#pragma once

#include "app/time_grid.hpp"
#include "config/robot_config.hpp"

namespace rc10 {

/// Times of the loops.
struct LoopGrids {
  TimeGrid ticks;
  TimeGrid drains;  ///< The RX thread's, with ReceivePolicy::kThread.
};

/// `realtime_ahead`: CLOCK_REALTIME - CLOCK_MONOTONIC.
[[nodiscard]] inline LoopGrids loopGrids(const RobotConfig& config, Duration realtime_ahead) noexcept {
  const bool realtime = config.phase_clock == PhaseClock::kRealtime;
  const auto ticks =
      TimeGrid::onClock(config.period(), config.phase(), realtime ? realtime_ahead : Duration{});
  return {ticks, ticks.shifted(-config.rx_lead)};
}

}  // namespace rc10
