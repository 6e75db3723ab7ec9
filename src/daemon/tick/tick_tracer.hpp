#pragma once

#include "daemon/exchange/snapshot.hpp"
#include "daemon/exchange/tick_trace.hpp"

namespace rc10 {

/// Writes what clients have chosen of a finished tick into the trace. Scheduler thread.
void trace(const Snapshot& snapshot, TickTrace& out) noexcept;

}  // namespace rc10
