#pragma once

#include <vector>

#include "daemon/exchange/histogram.hpp"

namespace rc10 {

/// Age of what a tick acts on, when its frames leave. The scheduler writes, the link thread reads.
struct TickAges {
  std::vector<DurationHistogram> feedback;  ///< By motor: in each tick in which it follows a target.
  DurationHistogram command;                ///< From receipt by this host: once for each motor and command.
};

}  // namespace rc10
