#pragma once

#include "daemon/exchange/histogram.hpp"
#include "daemon/exchange/late_ticks.hpp"

namespace rc10 {

/// How late ticks start and how long they take.
struct TickTiming {
  DurationHistogram wake_latency;
  DurationHistogram duration;
  LateTicks late;
};

}  // namespace rc10
