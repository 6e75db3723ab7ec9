#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include <boost/lockfree/spsc_queue.hpp>

#include "daemon/exchange/latest_value.hpp"
#include "link/trace_signal.hpp"

namespace rc10 {

/// The signals that the clients want of each tick. Link thread to scheduler.
struct TraceChoice {
  std::uint32_t generation = 0;  ///< Rows of another choice are not this one's.
  std::uint32_t count = 0;
  std::array<link::TraceSignal, link::kMaxTraceSignals> signals{};
};

struct TracedTick {
  std::uint32_t generation = 0;
  link::TraceRow row;
};

/// Chosen signals of each tick, from the scheduler to the link thread. Nothing chosen costs one look a tick.
struct TickTrace {
  // A tenth of a second at 4 kHz; the link thread takes them a hundred times a second.
  static constexpr std::size_t kTicks = 512;

  LatestValue<TraceChoice> choice;
  boost::lockfree::spsc_queue<TracedTick, boost::lockfree::capacity<kTicks>> ticks;
  std::atomic<std::uint64_t> dropped{0};  ///< Written by the scheduler: ticks for which there was no room.
};

}  // namespace rc10
