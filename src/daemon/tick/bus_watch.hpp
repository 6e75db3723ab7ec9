#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "app/time.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/supervision/supervisor.hpp"

namespace rc10 {

/// Watches every bus and decides whether its frames may leave. A bus that does not carry frames (down, gone,
/// bus-off, stalled) is held: its motors are OFFLINE and nothing is handed to the kernel, where it would wait
/// and act when it is no longer meant. So what leaves first when the bus is back is rest. Scheduler thread
/// only.
class BusWatch {
 public:
  BusWatch(Robot& robot, std::span<BusInbox> inboxes, Supervisor& supervisor)
      : robot_(robot), inboxes_(inboxes), supervisor_(supervisor) {}

  /// Marks the buses that are held. After this tick's frames were received, before anything is decided.
  void decide(const Tick& tick) noexcept;
  /// Sends what the buses have packed, or holds it back. `stopping`: only rest frames are packed any more,
  /// and they are sent whatever the state.
  void send(const Tick& tick, bool stopping) noexcept;
  /// Brings the states up to date and reports changes and foreign senders. After sending.
  void update(const Tick& tick) noexcept;

 private:
  struct Watched {
    BusState state = BusState::kActive;
    MonotonicTime next_probe;
    std::uint32_t running_seen = 0;
    std::uint64_t foreign_reported = 0;
    MonotonicTime next_foreign_report;
  };

  void probe(std::size_t bus, const Tick& tick) noexcept;
  void updateHealth(std::size_t bus, const Tick& tick) noexcept;
  void reportState(std::size_t bus, const Tick& tick) noexcept;
  [[gnu::noinline]] void changeState(std::size_t bus, BusState state, const Tick& tick) noexcept;
  void reportForeign(std::size_t bus, const Tick& tick) noexcept;

  Robot& robot_;
  std::span<BusInbox> inboxes_;
  Supervisor& supervisor_;
  std::array<Watched, kMaxBuses> watched_{};
};

}  // namespace rc10
