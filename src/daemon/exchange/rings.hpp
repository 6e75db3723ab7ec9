#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include <boost/lockfree/spsc_queue.hpp>

#include "bus/bus_health.hpp"
#include "bus/can_frame.hpp"
#include "daemon/exchange/bus_scan_exchange.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/exchange/latest_value.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/safety_contact.hpp"
#include "daemon/exchange/shaft_order.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "daemon/exchange/tick_ages.hpp"
#include "daemon/exchange/tick_trace.hpp"

namespace rc10 {

template <typename T, std::size_t Capacity>
using Ring = boost::lockfree::spsc_queue<T, boost::lockfree::capacity<Capacity>>;

/// Between the RX, io and scheduler threads, for one bus: frames, and what each saw of it. Each counter has
/// one writer.
struct BusInbox {
  // A classic 1 Mbit/s bus carries at most 21 frames a millisecond: room for 50 late ticks.
  static constexpr std::size_t kFrames = 1024;

  Ring<CanFrame, kFrames> frames;
  std::atomic<std::uint64_t> dropped{0};    ///< By the kernel or because the ring was full.
  std::atomic<std::uint64_t> malformed{0};  ///< Datagrams that are no frame.
  std::atomic<std::uint64_t> confirmed{0};  ///< Echoes of the watched command id.
  std::atomic<CanLinkState> link{CanLinkState::kUp};
  std::atomic<std::uint64_t> echo_reads{0};  ///< Times that all echoes were read; 0: no echo socket.
  /// Verdict of the scheduler, for the io thread.
  std::atomic<BusState> state{BusState::kActive};
  /// The io thread counts here when the driver says that a bus-off controller runs again.
  std::atomic<std::uint32_t> controller_running{0};
};

/// Events in words, for the link thread.
using NoteRing = Ring<link::Event, 32>;

using ShaftRing = Ring<ShaftOrder, 16>;

/// Everything that crosses to and from the link thread.
struct LinkExchange {
  static constexpr std::size_t kOrders = 64;

  Ring<Command, 64> commands;       // link -> scheduler
  Ring<Order, kOrders> orders;      // link -> scheduler
  Ring<SignalMessage, 64> signals;  // link -> scheduler
  ShaftRing shafts;                 // link -> sim
  Ring<Event, 16> refusals;         // link -> scheduler, for the black box: commands that admission refused
  /// Answers of one tick, at the most: an e-stop settles all that wait, and orders come with it.
  Ring<OrderResult, kMaxOpenRequests + kOrders> results;  // scheduler -> link
  Ring<Event, 1024> events;                               // scheduler -> link
  NoteRing notes;                                         // io -> link, in words already
  NoteRing line_notes;                                    // lines -> link, the same
  LatestValue<Snapshot> snapshot;                         // scheduler -> link
  TickAges ages;                                          // scheduler -> link
  TickTrace trace;                                        // choice: link -> scheduler; rows back
  BusScanExchange scan;                                   // questions: link -> scheduler; frames back
  /// Beside the ring, so that an e-stop gets through when the ring is full.
  std::atomic<bool> estop{false};
  LatestValue<link::Name> estop_client;  ///< The one that asked for it; published before.
  /// The same of datagrams, rx -> scheduler: each flag has one writer.
  std::atomic<bool> estop_datagram{false};
  LatestValue<link::Name> estop_datagram_client;
  SafetyContact estop_contact;          // gpio -> scheduler
  SafetyContact mode_contact;           // gpio -> scheduler
  std::atomic<bool> guard_lost{false};  // main -> scheduler: rc10-guard has ended
};

}  // namespace rc10
