#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/robot_config.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/snapshot.hpp"

namespace rc10::test {

/// Something that docs/safety.md promises was not so.
class Violation : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// How often each state was seen: what the chaos has reached.
struct Visits {
  std::uint64_t ticks = 0;
  std::array<std::uint64_t, 3> robot{};                   ///< Ticks by RobotState.
  std::array<std::uint64_t, kMotorStatusCount> status{};  ///< Ticks of motors.
  std::array<std::uint64_t, 8> faults{};                  ///< How often each began.
  std::array<std::uint64_t, 4> fallbacks{};               ///< Ticks in which one gave torque.
  std::uint64_t driven = 0;                               ///< And ticks in which a target did.
  std::uint64_t alone = 0;                                ///< Ticks in which one motor was enabled alone.
  std::uint64_t rearmed = 0;
  std::uint64_t stops = 0;
  std::uint64_t slewed = 0;   ///< Ticks in which a slew limit was judged,
  std::uint64_t bounded = 0;  ///< and beyond a soft limit.
  std::uint64_t stalls = 0;   ///< Buses whose echoes stayed away,
  std::uint64_t probes = 0;   ///< and the rest frames that looked for them, as far as they were read.
  std::uint64_t unread_after_pauses = 0;  ///< Ticks of motors whose feedback was stale by the clock alone.
  void add(const Visits& other);
  [[nodiscard]] std::string text() const;
};

/// Judges every tick by what was sent to the robot and what came out on its buses. Knows the configuration
/// and the documents, and nothing of the supervisor's code; of the snapshot it trusts nothing that the
/// frames could contradict.
class Oracle {
 public:
  explicit Oracle(const RobotConfig& config);

  // What was put in, before the tick that sees it.
  void heard(std::size_t bus, const CanFrame& frame);
  void commanded(const Command& command);
  void ordered(const Order& order);
  void estopped() { estop_asked_ = true; }
  /// The interface of this bus is up or not. Known to the tick after the next one.
  void linked(std::size_t bus, bool up) { down_.set(bus, !up); }
  /// A controller has said that it is bus-off, or that it is not. Known to this tick.
  void controllerOff(std::size_t bus, bool off) {
    off_.set(bus, off);
    held_ = known_down_ | off_ | stalled_;
  }
  /// Echoes of frames of these buses have come: the frames reach the wire. Known to the end of this tick.
  void echoed(std::bitset<kMaxBuses> buses) { echoed_ |= buses; }
  /// What the e-stop input shows in this tick.
  void contact(bool open) {
    contact_open_ = open;
    if (open) estop_asked_ = true;
  }
  void stopBegun() { stop_asked_ = true; }
  /// What came out.
  void answered(const OrderResult& result);
  /// A frame on a bus.
  void sent(std::size_t bus, const CanFrame& frame);

  /// After the tick and its frames. `read`: whose frames were read, and all of them.
  void judge(const Snapshot& snapshot, std::uint64_t periods, std::bitset<kMaxBuses> read, bool stopped);

  /// Of the motor's last frame, as it was reported; NaN: none.
  [[nodiscard]] float velocityRpm(std::size_t motor) const { return motors_[motor].velocity_rpm; }
  /// Orders without an answer so far.
  [[nodiscard]] std::size_t open() const noexcept { return unanswered_.size(); }
  [[nodiscard]] const Visits& visits() const noexcept { return visits_; }

 private:
  static constexpr std::size_t kNoGroup = ~std::size_t{0};
  /// The actions that a motor without a target may be doing.
  using Actions = std::bitset<4>;

  struct Motor {
    const MotorConfig* config = nullptr;
    std::size_t bus = 0;
    std::size_t group = kNoGroup;
    CanId command_id;
    std::size_t slot = 0;
    CanId feedback_id;
    double raw_per_effort = 0.0;  ///< Direction included.
    int raw_limit = 0;
    float rpm_per_raw = 0.0F;
    double damping_per_rpm = 0.0;

    // What it has reported.
    bool reported = false;
    MonotonicTime reported_at;
    std::uint64_t unheard_ticks = 0;  ///< Ticks that ran since its last sample of then.
    float velocity_rpm = 0.0F;
    float temperature_c = 0.0F;
    // What it was told.
    MonotonicTime driven_until{};  ///< The latest deadline of a command that moves.
    MonotonicTime owned_until{};   ///< Of any command.
    bool coast_asked = false;      ///< Since the last tick, as are the next four.
    bool enable_asked = false;     ///< Alone or not.
    bool alone_asked = false;      ///< And not the other way as well.
    int disables_asked = 0;
    bool clear_asked = false;
    // What it does.
    int raw = 0;
    int raw_before = 0;            ///< In the tick before, if it was read.
    bool followed_effort = false;  ///< And then it followed a current or a voltage.
    MotorStatus status = MotorStatus::kOffline;
    FaultCode fault = FaultCode::kNone;
    ControlMode mode = ControlMode::kCoast;
    Actions actions{1};
    MonotonicTime acts_since{};
    bool ends_at_standstill = false;
    bool new_sample = false;
    bool was_hot = false;  ///< Its limit may still be reduced.
    bool cooled = false;   ///< And that ended in this tick.
    int unbraked_ticks = 0;
  };
  struct Group {
    MotorSet members;
    bool rearms = false;
    bool stops_now = false;
    MotorSet may_rearm;  ///< Were ACTIVE when it stopped, and nothing has forbidden it since.
  };

  void judgeSnapshot(const Snapshot& snapshot, std::uint64_t periods);
  void judgeRobotState(const Snapshot& snapshot);
  void judgeProbe(std::size_t bus);
  void followEchoes(const Snapshot& snapshot);
  void judgeFrames(std::bitset<kMaxBuses> read);
  void judgeStatus(std::size_t index, const MotorSnapshot& seen, RobotState robot);
  void judgeAlone(const Snapshot& snapshot);
  void judgeGroups(const Snapshot& snapshot);
  void followActions(std::size_t index, const MotorSnapshot& seen);
  void judgeCommand(std::size_t index, const MotorSnapshot& seen);
  void judgeFallback(std::size_t index);
  void judgeSlew(std::size_t index, const MotorSnapshot& seen);
  void judgeSoftLimits(std::size_t index, const MotorSnapshot& seen);
  void judgeStop(std::bitset<kMaxBuses> read, bool stopped);
  void judgeAnswers();
  void count(const Snapshot& snapshot);
  void setActions(Motor& motor, Actions actions);
  [[nodiscard]] static Actions only(FallbackAction action);
  void followFeedback();
  [[nodiscard]] bool fresh(const Motor& motor) const;
  [[nodiscard]] bool overdue(const Motor& motor) const;
  [[nodiscard]] bool matchesDamp(const Motor& motor) const;
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail(std::size_t motor, const std::string& what) const;
  void require(std::size_t motor, bool condition, const char* what) const {
    if (!condition) fail(motor, what);
  }

  RobotConfig config_;
  std::vector<Motor> motors_;
  std::vector<Group> groups_;
  struct Expected {
    CanId id;
    int seen = 0;
    std::uint8_t used_slots = 0;
  };
  std::array<std::vector<Expected>, kMaxBuses> frames_;
  std::map<std::uint64_t, std::uint64_t> unanswered_;  ///< Orders, and the tick in which they were sent.

  std::optional<std::size_t> alone_;  ///< The motor that was enabled alone.
  bool was_alone_ = false;            ///< In this tick some motor was.
  MonotonicTime now_{};
  std::uint64_t tick_ = 0;
  bool begun_ = false;
  std::uint64_t missed_ = 0;
  RobotState state_ = RobotState::kRun;
  bool estop_asked_ = false;
  bool clear_all_asked_ = false;
  bool stop_asked_ = false;
  MonotonicTime stopping_since_{};
  std::uint64_t ticks_stopping_ = 0;
  bool rested_ = false;
  bool contact_open_ = false;
  std::uint64_t periods_ = 1;  ///< Of this tick.
  std::bitset<kMaxBuses> down_;
  std::bitset<kMaxBuses> known_down_;  ///< As of the end of the last tick.
  std::bitset<kMaxBuses> off_;         ///< Its controller is bus-off.
  /// Since frames were sent and no echo came.
  struct Echoes {
    bool awaited = false;
    std::uint64_t ticks = 0;
    MonotonicTime next_probe{};
  };
  std::array<Echoes, kMaxBuses> echoes_{};
  std::bitset<kMaxBuses> echoed_;   ///< In this tick.
  std::bitset<kMaxBuses> stalled_;  ///< As of the end of the last tick.
  std::bitset<kMaxBuses> held_;     ///< Nothing but a probe of a stalled bus may be sent there in this tick.
  Visits visits_;
};

}  // namespace rc10::test
