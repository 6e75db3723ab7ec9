#pragma once

#include <cstddef>
#include <cstdint>

#include "app/time.hpp"
#include "bus/can_frame.hpp"
#include "daemon/exchange/bus_scan_exchange.hpp"
#include "daemon/exchange/orders.hpp"

namespace rc10 {

/// A scan of one bus: hears for a while, then gives out one question after the other, and hears the answers.
/// Whether it may go on is the supervisor's decision, in each tick. Scheduler thread only.
class BusScan {
 public:
  /// Time of the last answer.
  static constexpr Duration kAnswering = std::chrono::milliseconds{200};
  /// The link thread has judged what was heard by then.
  static constexpr Duration kJudging = std::chrono::seconds{2};

  /// It outlives this.
  explicit BusScan(BusScanExchange& exchange) noexcept : exchange_(exchange) {}

  [[nodiscard]] bool runs() const noexcept { return phase_ != Phase::kIdle; }
  [[nodiscard]] const BusScanOrder& order() const noexcept { return order_; }
  [[nodiscard]] std::uint64_t id() const noexcept { return id_; }
  [[nodiscard]] std::uint32_t asked() const noexcept { return asked_; }
  [[nodiscard]] std::uint64_t errorFramesBefore() const noexcept { return error_frames_; }

  /// `error_frames`: of the bus, until now.
  void begin(const Order& order, std::uint64_t error_frames, const Tick& tick) noexcept;
  /// A frame of a bus, before it is decoded.
  void hear(std::size_t bus, const CanFrame& frame) noexcept;
  enum class Progress : std::uint8_t { kPending, kDone, kNotJudged, kGivenUp };
  /// Once a tick.
  [[nodiscard]] Progress advance(const Tick& tick) noexcept;
  /// The question of this tick; null: none is due.
  [[nodiscard]] const CanFrame* due(const Tick& tick) const noexcept;
  /// It was handed over.
  void tookQuestion(const Tick& tick) noexcept;
  void end() noexcept { phase_ = Phase::kIdle; }

 private:
  enum class Phase : std::uint8_t { kIdle, kListening, kJudging, kAsking, kAnswering };

  void enter(Phase phase, MonotonicTime until) noexcept;

  BusScanExchange& exchange_;
  BusScanOrder order_;
  std::uint64_t id_ = 0;
  Phase phase_ = Phase::kIdle;
  MonotonicTime until_{};
  MonotonicTime next_question_{};
  std::uint32_t asked_ = 0;
  std::uint64_t error_frames_ = 0;
};

}  // namespace rc10
