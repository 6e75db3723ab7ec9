#pragma once

#include <string>

#include "app/time.hpp"
#include "doctor/finding.hpp"

namespace rc10::doctor {

/// Lateness of a thread's wake-ups, measured here or by a running rc10d.
struct LatencyFacts {
  Duration period{};  ///< Period of the ticks.
  Duration p50{};
  Duration p99{};
  Duration p999{};
  Duration max{};
  std::uint64_t wake_ups = 0;  ///< 0: not known.
  bool realtime = true;        ///< With SCHED_FIFO, as rc10d's scheduler.
  std::string refused;         ///< Reason why not with SCHED_FIFO; empty if so.
  std::string by;              ///< "the latency test" or "rc10d itself".
};

/// Up to a tenth of a tick is good: at 1 kHz 100 us, the budget of a Raspberry Pi 4 or 5 with PREEMPT_RT
/// under load. Up to half a tick is a warning, more a failure.
[[nodiscard]] Finding checkLatency(const LatencyFacts& latency);

}  // namespace rc10::doctor
