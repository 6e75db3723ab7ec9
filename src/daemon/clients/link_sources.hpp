#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "daemon/clients/late_tick_causes.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/exchange/robot_description.hpp"
#include "daemon/exchange/tick_timing.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Parts of the daemon that the link thread reads. All outlive it.
struct LinkSources {
  LinkExchange& exchange;
  std::span<const BusInbox> inboxes;
  const TickTiming& timing;
  const RobotDescription& robot;
  std::function<std::uint64_t()> page_faults;   ///< Page faults of the real-time threads, after start.
  ThreadFacts tick_thread{};                    ///< Facts of the scheduler thread.
  std::function<void(const link::Event&)> log;  ///< Every event, for the log.
  std::function<void()> housekeeping;           ///< Called ten times a second: the watchdog.
};

}  // namespace rc10
