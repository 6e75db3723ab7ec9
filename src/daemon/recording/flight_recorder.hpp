#pragma once

#include <array>
#include <atomic>
#include <bitset>
#include <cstdint>

#include "app/time.hpp"
#include "blackbox/hand_off.hpp"
#include "bus/frame_tap.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "daemon/recording/sample_turns.hpp"

namespace rc10 {

class Robot;

/// Reason why the recording is worth keeping.
enum class CopyCause : std::uint32_t { kFault = 1, kEstop = 2 };

/// Writes down what happens in each tick: frames, commands, requests, events and states. Scheduler thread
/// only, except takeCauses().
class FlightRecorder {
 public:
  explicit FlightRecorder(blackbox::HandOff out) noexcept : out_(out) {}

  /// Records the frames of its buses from now on. Before the first tick.
  void listenTo(Robot& robot) noexcept;

  void beginTick(MonotonicTime now) noexcept { now_ = now; }
  /// `skipped`: setpoints, by their place in the command, that did not act.
  void command(const Command& command, blackbox::Verdict verdict,
               const std::bitset<kMaxMotors>& skipped = {}) noexcept;
  /// Inputs of a module. Modules send to each other in every tick: of that only changes are written
  /// down, and a sample 20 times a second.
  void signals(const SignalMessage& message, blackbox::Verdict verdict) noexcept;
  void order(const Order& order) noexcept;
  void event(const Event& event) noexcept;
  /// A sample of each motor and bus and of the robot 20 times a second, one after the other; also when its
  /// state changes.
  void states(const Snapshot& snapshot) noexcept;

  /// Reasons since the last call to keep the recording: bits of CopyCause. Any
  /// one thread.
  [[nodiscard]] std::uint32_t takeCauses() noexcept { return causes_.exchange(0, std::memory_order_relaxed); }

 private:
  static constexpr Duration kSampleInterval = std::chrono::milliseconds{50};

  class Tap : public FrameTap {
   public:
    void connect(FlightRecorder& recorder, std::uint8_t bus) noexcept;
    void onReceived(const CanFrame& frame) noexcept override;
    void onSent(const CanFrame& frame, bool accepted) noexcept override;

   private:
    FlightRecorder* recorder_ = nullptr;
    std::uint8_t bus_ = 0;
  };

  /// Last inputs of a module from another one.
  struct LastSignals {
    link::Name client;
    std::array<double, kMaxSignals> values{};
    MonotonicTime until{};  ///< The same again is not written down before.
  };

  [[nodiscard]] bool isNew(const SignalMessage& message, LastSignals& last) const noexcept;
  void frame(const CanFrame& frame, std::uint8_t bus, std::uint8_t flags, MonotonicTime time) noexcept;
  void motor(const MotorSnapshot& motor, MonotonicTime sent, std::uint8_t index) noexcept;
  void bus(const BusSnapshot& bus, std::uint8_t index) noexcept;
  [[nodiscard]] std::int64_t nowNs() const noexcept { return now_.time_since_epoch().count(); }

  blackbox::HandOff out_;
  MonotonicTime now_{};
  SampleTurns turns_{kSampleInterval};
  std::array<Tap, kMaxBuses> taps_;
  std::array<MotorStatus, kMaxMotors> statuses_{};
  std::array<BusState, kMaxBuses> bus_states_{};
  RobotStatus robot_state_ = RobotStatus::kRun;
  // By module: what was applied, and what was refused.
  std::array<std::array<LastSignals, 2>, kMaxModules> last_signals_{};
  // Written by the scheduler, taken by the thread that makes copies. Relaxed: it carries nothing else.
  std::atomic<std::uint32_t> causes_{0};
};

}  // namespace rc10
