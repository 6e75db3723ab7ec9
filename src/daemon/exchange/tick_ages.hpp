#pragma once

#include <vector>

#include "daemon/exchange/client_ages.hpp"
#include "daemon/exchange/histogram.hpp"

namespace rc10 {

/// Age of what a tick acts on, when its frames leave. The scheduler writes, the link thread reads.
struct TickAges {
  std::vector<DurationHistogram> feedback;  ///< By motor: in each tick in which it follows a target.
  /// From receipt by this host to the first frames that carry it: once for each motor and command, and for
  /// each message to a module.
  DurationHistogram command;
  ClientAges clients;  ///< The same by client.
};

}  // namespace rc10
