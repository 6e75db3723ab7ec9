#pragma once

#include <array>
#include <atomic>
#include <bitset>
#include <cstdint>
#include <optional>
#include <span>

#include "app/time.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/late_ticks.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/recording/flight_recorder.hpp"
#include "daemon/supervision/supervisor.hpp"
#include "daemon/tick/bus_watch.hpp"
#include "daemon/tick/module_runner.hpp"
#include "link/guard_page.hpp"

namespace rc10 {

/// One tick: receive, command, update, pack, send, snapshot. Owns nothing that runs: the
/// scheduler thread, or a test, calls tick().
class Scheduler {
 public:
  /// The time at any moment of a tick.
  using Clock = MonotonicTime (*)() noexcept;

  /// `recorder`: writes down what happens, if there is one; outlives this. `clock`: when the frames of a tick
  /// have left; without one, a tick takes no time.
  Scheduler(Robot& robot, std::span<BusInbox> inboxes, LinkExchange& link, Duration period,
            FlightRecorder* recorder = nullptr, Clock clock = nullptr);

  /// `periods`: distance on the grid since the last executed tick; above 1, ticks were missed. They
  /// are counted and skipped, never replayed.
  void tick(MonotonicTime now, std::uint64_t periods = 1) noexcept;

  /// From the next tick on no motor obeys; fallbacks act, then only rest frames are sent. Scheduler thread.
  void beginStop() noexcept { stop_requested_ = true; }
  /// The rest frames of the stop have reached the wire, as far as that can be known, or it took too long.
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }
  /// False: it took too long. Any thread, after the last tick.
  [[nodiscard]] bool restEchoed() const noexcept { return rest_echoed_; }

  /// Time from the beginning of an e-stop to the end of the heartbeat, until that is cleared. Before the
  /// first tick.
  void restHeartbeatAfter(std::optional<Duration> estop) noexcept { heartbeat_rests_after_ = estop; }
  /// Before the first tick. The page, which rc10-guard reads and writes, outlives this.
  void watchedBy(link::GuardPage& page) noexcept { guard_ = &page; }
  /// From the next tick on an e-stop, for the first of the causes until then. Scheduler thread.
  void stopFor(const Stop& why) noexcept {
    if (stop_asked_.cause == StopCause::kNone) stop_asked_ = why;
  }

  /// Ticks in which the heartbeat goes on. Any thread.
  [[nodiscard]] std::uint64_t beats() const noexcept { return beats_.load(std::memory_order_relaxed); }

  [[nodiscard]] const Supervisor& supervisor() const noexcept { return supervisor_; }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t missedTicks() const noexcept { return missed_ticks_; }
  /// Marks of the last tick; `woken` and `done` are its caller's. Its own thread only.
  [[nodiscard]] const TickMarks& marks() const noexcept { return marks_; }

 private:
  void receive() noexcept;
  void driveDevices() noexcept;
  void update(const Tick& tick) noexcept;
  void pack(const Tick& tick, bool only_rest) noexcept;
  void reportMissedTicks(const Tick& tick) noexcept;
  void beginStop(const Tick& tick) noexcept;
  void watchStop() noexcept;
  void snapshot(const Tick& tick, MonotonicTime sent) noexcept;
  void recordAges(const Snapshot& snapshot, const Tick& tick) noexcept;
  [[nodiscard]] std::bitset<kMaxBuses> keptFrames(const Snapshot& snapshot) noexcept;
  void recordCommandAge(const link::Name& client, Duration age) noexcept;
  [[nodiscard]] MonotonicTime clockOr(MonotonicTime now) const noexcept {
    return clock_ != nullptr ? clock_() : now;
  }
  void beat(const Tick& tick) noexcept;
  void stopForTheComputer(const Tick& tick) noexcept;

  Robot& robot_;
  std::span<BusInbox> inboxes_;
  LinkExchange& link_;
  Duration period_;
  FlightRecorder* recorder_;
  Clock clock_;
  TickMarks marks_;
  Supervisor supervisor_;
  ModuleRunner modules_;
  BusWatch bus_watch_;
  std::array<MonotonicTime, kMaxMotors> commands_{};  ///< By motor: receipt of the last that was sent.
  std::array<std::uint64_t, kMaxBuses> kept_{};       ///< By bus: frames that did not leave, so far.
  std::array<MonotonicTime, kMaxModules> inputs_{};   ///< By module: receipt of its last inputs.
  std::atomic<std::uint64_t> ticks_{0};               // read by the link thread, for the watchdog
  std::atomic<std::uint64_t> beats_{0};               // read by the gpio thread
  std::optional<Duration> heartbeat_rests_after_;
  link::GuardPage* guard_ = nullptr;  ///< None: nobody watches.
  Stop stop_asked_{};
  std::uint64_t missed_ticks_ = 0;
  std::uint64_t unreported_missed_ticks_ = 0;
  MonotonicTime next_missed_report_{};
  bool stop_requested_ = false;
  bool stopped_ = false;
  bool rest_echoed_ = true;
  MonotonicTime stop_deadline_{};
  int rest_ticks_ = 0;
  std::array<std::uint64_t, kMaxBuses> confirmed_at_stop_{};
};

}  // namespace rc10
