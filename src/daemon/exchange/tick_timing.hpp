#pragma once

#include "daemon/exchange/histogram.hpp"
#include "daemon/exchange/late_ticks.hpp"

namespace rc10 {

/// Lateness and duration of ticks.
struct TickTiming {
  DurationHistogram wake_latency;
  DurationHistogram duration;
  LateTicks late;
};

}  // namespace rc10
