#pragma once

#include <optional>

#include "app/time.hpp"
#include "app/time_grid.hpp"
#include "doctor/latency_check.hpp"
#include "doctor/latency_histogram.hpp"

namespace rc10::ctl {

struct LatencyTest {
  Duration time{};
  TimeGrid grid;     ///< Grid of the ticks.
  int priority = 0;  ///< SCHED_FIFO
  std::optional<int> cpu;
};

/// Sleeps until each point of the grid, as rc10d's scheduler does, and records how late it wakes up. The
/// calling thread is real-time meanwhile, if it may be. Ends early on Ctrl-C.
[[nodiscard]] doctor::LatencyFacts measureLatency(const LatencyTest& test,
                                                  doctor::LatencyHistogram& histogram);

}  // namespace rc10::ctl
