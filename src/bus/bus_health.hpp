#pragma once

#include <cstdint>

#include "app/time.hpp"
#include "app/vocabulary.hpp"
#include "bus/can_frame.hpp"

namespace rc10 {

/// Whether frames may leave in this state. In the others a frame that is handed to the kernel is lost or,
/// worse, sent late, when it no longer holds.
[[nodiscard]] constexpr bool carriesFrames(BusState state) noexcept {
  return state != BusState::kBusOff && state != BusState::kDown && state != BusState::kGone &&
         state != BusState::kStalled;
}

/// State of the interface, as its socket tells it.
enum class CanLinkState : std::uint8_t { kUp, kDown, kGone };

/// Turns error frames, link states, silence and missing echoes into one state. Scheduler thread only.
class BusHealth {
 public:
  struct Config {
    Duration silent_after{std::chrono::milliseconds{100}};
    /// At 1 kHz five ticks, whatever their jitter.
    Duration stalled_after{std::chrono::microseconds{4500}};
    /// Ticks without an echo. Only ticks before which the echoes were read count: after a pause of the
    /// computer, or of the thread that reads, one may wait.
    int stalled_ticks = 5;
  };

  /// Events since the last update(), counted by the threads that saw them.
  struct Traffic {
    std::uint64_t rx_frames = 0;     ///< Since start.
    std::uint64_t tx_frames = 0;     ///< Accepted by the kernel, since start.
    std::uint64_t tx_watched = 0;    ///< Those of the watched ids.
    std::uint64_t tx_refused = 0;    ///< Frames of the watched ids that the kernel refused.
    std::uint64_t tx_confirmed = 0;  ///< Their echoes, since start.
    std::uint64_t echo_reads = 0;    ///< Times that all echoes were read; 0: no echo socket, no stall.
    bool feedback_expected = true;   ///< Motors on this bus talk without being asked.
  };

  BusHealth() = default;
  explicit BusHealth(const Config& config) : config_(config) {}

  void onErrorFrame(const CanFrame& frame) noexcept;
  void onLink(CanLinkState link) noexcept;
  /// The driver says that the controller is not bus-off: the message about its restart was lost.
  void onControllerRunning() noexcept;
  void update(MonotonicTime now, const Traffic& traffic) noexcept;

  /// The most serious of what is true: gone, down, bus-off, stalled, silent, passive, warning, active.
  [[nodiscard]] BusState state() const noexcept;
  [[nodiscard]] int transmitErrors() const noexcept { return tec_; }  ///< TEC, -1: unknown.
  [[nodiscard]] int receiveErrors() const noexcept { return rec_; }   ///< REC, -1: unknown.
  [[nodiscard]] std::uint64_t errorFrames() const noexcept { return error_frames_; }
  /// Times the bus came back from bus-off, down or gone.
  [[nodiscard]] std::uint64_t restarts() const noexcept { return restarts_; }

 private:
  Config config_{};
  BusState controller_ = BusState::kActive;  // from error frames only
  CanLinkState link_ = CanLinkState::kUp;
  bool silent_ = false;
  bool stalled_ = false;
  int tec_ = -1;
  int rec_ = -1;
  std::uint64_t error_frames_ = 0;
  std::uint64_t restarts_ = 0;
  Traffic seen_{};
  MonotonicTime last_rx_{};
  bool echo_pending_ = false;  // a watched frame was sent or refused, and no echo has come since
  bool only_refused_ = false;  // of what is pending
  MonotonicTime echo_pending_since_{};
  int echo_pending_ticks_ = 0;
  bool started_ = false;
};

}  // namespace rc10
