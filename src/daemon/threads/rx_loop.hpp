#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>

#include "app/result.hpp"
#include "app/time_grid.hpp"
#include "app/unique_fd.hpp"
#include "daemon/devices/serial_channel.hpp"
#include "daemon/exchange/estop_datagrams.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/interfaces/can_intake.hpp"

namespace rc10 {

/// The RX thread: takes bytes of serial ports and datagrams of e-stops when they come, in looks that are
/// kRest apart, and with `receive: thread` drains the CAN buses once a period.
class RxLoop {
 public:
  /// Least time between two looks that found something. This thread is above the tick: a port that floods
  /// (a USB adapter, a pseudo terminal) must not take the CPU from it. 240 bytes in each 250 us are 960 kB/s,
  /// more than any UART of ours carries.
  static constexpr Duration kRest = std::chrono::microseconds{250};

  /// The CAN intake, and the times to drain it.
  struct Drain {
    CanIntake& intake;
    TimeGrid grid;
  };
  /// The socket of e-stops, and what the scheduler looks at in each tick.
  struct Estops {
    EstopDatagrams datagrams;
    LinkExchange& exchange;
  };

  /// `serial`: null if there are no ports. Without `drain` the scheduler drains the buses itself. An e-stop
  /// socket that cannot be watched is an error.
  [[nodiscard]] static Result<std::unique_ptr<RxLoop>> create(SerialChannels* serial,
                                                              std::optional<Drain> drain = std::nullopt,
                                                              std::optional<Estops> estops = std::nullopt);

  /// The thread's body.
  void run(const std::stop_token& stop) noexcept;
  /// Drains the buses if that is due. Returns the time of the next turn.
  [[nodiscard]] MonotonicTime turn(MonotonicTime now) noexcept;
  /// One wait of at most `patience`: for the end of the rest, or else for something to look at.
  void poll(Duration patience) noexcept;
  /// One read of each serial port that has bytes, and of the e-stops, unless it rests. Never waits.
  void look(MonotonicTime now) noexcept;

  /// Wake-ups so far; advances at least ten times a second also without traffic. Any thread.
  [[nodiscard]] std::uint64_t wakeUps() const noexcept { return wake_ups_.load(std::memory_order_relaxed); }

  /// Watches a serial port that the io thread has opened; until it is gone. errno says why not.
  [[nodiscard]] bool watchSerial(std::size_t channel) noexcept;

 private:
  RxLoop(SerialChannels* serial, std::optional<Drain> drain, std::optional<Estops> estops, UniqueFd epoll)
      : serial_(serial), drain_(drain), estops_(estops), epoll_(std::move(epoll)) {}
  [[nodiscard]] bool watch(int descriptor, std::uint64_t tag) noexcept;
  static void receiveEstops(const Estops& estops) noexcept;
  void receiveSerial(std::size_t channel, MonotonicTime now, std::uint32_t events) noexcept;

  SerialChannels* serial_;  // null: none
  std::optional<Drain> drain_;
  std::optional<Estops> estops_;
  MonotonicTime next_drain_{};
  MonotonicTime rests_until_{};
  UniqueFd epoll_;
  std::atomic<std::uint64_t> wake_ups_{0};
};

}  // namespace rc10
