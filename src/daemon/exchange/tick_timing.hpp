#pragma once

#include "daemon/exchange/histogram.hpp"

namespace rc10 {

/// How late ticks start and how long they take.
struct TickTiming {
  DurationHistogram wake_latency;
  DurationHistogram duration;
};

}  // namespace rc10
