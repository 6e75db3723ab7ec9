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
#include "daemon/interfaces/can_intake.hpp"

namespace rc10 {

/// The RX thread: reads serial ports when they have bytes and, with `receive: thread`, the CAN buses once a
/// period.
class RxLoop {
 public:
  /// The CAN intake, and the times to drain it.
  struct Drain {
    CanIntake& intake;
    TimeGrid grid;
  };

  /// `serial`: null if there are no ports. Without `drain` the scheduler drains the buses itself.
  [[nodiscard]] static Result<std::unique_ptr<RxLoop>> create(SerialChannels* serial,
                                                              std::optional<Drain> drain = std::nullopt);

  /// The thread's body.
  void run(const std::stop_token& stop) noexcept;
  /// Drains the buses if that is due. Returns the time of the next turn.
  [[nodiscard]] MonotonicTime turn(MonotonicTime now) noexcept;
  /// One wait of at most `patience` for the serial ports, and one read of each that has bytes.
  void poll(Duration patience) noexcept;

  /// Wake-ups so far; advances at least ten times a second also without traffic. Any thread.
  [[nodiscard]] std::uint64_t wakeUps() const noexcept { return wake_ups_.load(std::memory_order_relaxed); }

  /// Watches a serial port that the io thread has opened; until it is gone. errno says why not.
  [[nodiscard]] bool watchSerial(std::size_t channel) noexcept;

 private:
  RxLoop(SerialChannels* serial, std::optional<Drain> drain, UniqueFd epoll)
      : serial_(serial), drain_(drain), epoll_(std::move(epoll)) {}
  void receiveSerial(std::size_t channel, MonotonicTime now, std::uint32_t events) noexcept;

  SerialChannels* serial_;  // null: none
  std::optional<Drain> drain_;
  MonotonicTime next_drain_{};
  UniqueFd epoll_;
  std::atomic<std::uint64_t> wake_ups_{0};
};

}  // namespace rc10
