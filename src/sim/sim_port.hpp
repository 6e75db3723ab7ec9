#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "app/result.hpp"
#include "app/time.hpp"
#include "app/unique_fd.hpp"
#include "bus/can_frame.hpp"
#include "bus/can_receiver.hpp"
#include "sim/sim_bus.hpp"

namespace rc10::sim {

/// Time stamps of frames for the other end.
enum class Stamps : unsigned char {
  kKernel,  ///< By the kernel's stamp: SocketCAN. After a late step each drive speaks once.
  kOwn,     ///< It stands behind each frame, as StampedFrame: a late step is made up for.
};

/// Connects simulated drives to a descriptor that carries CAN frames: one end of a socket pair, or a
/// SocketCAN socket. One thread steps it; in the daemon its own, off the scheduler's grid by half a
/// period, so that feedback does not race with the tick. Never blocks; nothing allocates after
/// construction.
class SimPort {
 public:
  /// A step longer than this simulates only this much: after a stop (a debugger, a suspended machine) the
  /// motors go on from where they were.
  static constexpr Duration kLongestStep{std::chrono::seconds{1}};
  /// The same with Stamps::kOwn: the ring of frames of a bus with eight motors has room for it.
  static constexpr Duration kLongestMadeUpFor{std::chrono::milliseconds{100}};
  /// Frames that leave later than this after their step began carry stamps that are too late, by more than a
  /// drive's encoder counting allows for: the motors stand still for that time instead.
  static constexpr Duration kLongestSending{std::chrono::milliseconds{2}};

  struct Counters {
    std::uint64_t commands = 0;   ///< Frames read.
    std::uint64_t malformed = 0;  ///< Messages read that are no frames.
    std::uint64_t sent = 0;       ///< Feedback frames the kernel took.
    std::uint64_t refused =
        0;               ///< Feedback frames it did not take: the reader is late, or the interface down.
    Duration skipped{};  ///< Time that was not simulated.
    int error = 0;       ///< errno of the last read that failed; 0 since one succeeded.
  };

  /// Two connected descriptors, one message a frame, both non-blocking and with the kernel's receive stamps,
  /// if it has them, as on SocketCAN: one for fdCANbus::adopt(), one for the port.
  [[nodiscard]] static Result<std::pair<UniqueFd, UniqueFd>> makeSocketPair();

  /// `config` has passed SimBus::check().
  SimPort(UniqueFd fd, const SimBusConfig& config, Stamps stamps);
  SimPort(const SimPort&) = delete;
  SimPort& operator=(const SimPort&) = delete;
  ~SimPort();

  /// Takes every command that has arrived, advances the motors to `now`, and writes their feedback with one
  /// system call for 64 frames. The first step only sets the clock. All commands count from the step's begin;
  /// what came in between is not known better than that. With Stamps::kOwn a step that is late (a busy
  /// computer) is divided: real drives go on talking while nobody looks, and the kernel keeps what they say.
  void step(MonotonicTime now) noexcept;
  /// When the step's frames had left: `now` read again. A thread that was held in between (a busy laptop)
  /// makes the kernel stamp late what was measured early. Own stamps are not late.
  void sentAt(MonotonicTime sent) noexcept;

  [[nodiscard]] SimBus& bus() noexcept { return bus_; }
  [[nodiscard]] const SimBus& bus() const noexcept { return bus_; }
  [[nodiscard]] int descriptor() const noexcept { return fd_.get(); }
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

 private:
  struct Outbox;  // messages and their headers: set up once, they point into each other

  void readCommands(MonotonicTime now) noexcept;
  void advance(MonotonicTime now, Duration dt) noexcept;
  void writeFeedback(std::span<const CanFrame> frames) noexcept;

  UniqueFd fd_;
  Stamps stamps_;
  SimBus bus_;
  CanReceiver receiver_;
  std::unique_ptr<Outbox> outbox_;
  std::vector<CanFrame> commands_;
  std::vector<CanFrame> feedback_;
  std::optional<MonotonicTime> last_step_;
  Counters counters_;
};

}  // namespace rc10::sim
