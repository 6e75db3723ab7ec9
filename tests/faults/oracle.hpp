#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/robot_config.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "faults/slewed_field.hpp"
#include "faults/visits.hpp"
#include "faults/wire.hpp"

namespace rc10::test {

/// Time of fallbacks in a stop (docs/safety.md); then rest.
inline constexpr Duration kLongestFallback = std::chrono::seconds{1};

/// Standstill that ends a fallback after a disable, less a tick or two.
inline constexpr Duration kSettled = std::chrono::milliseconds{290};

[[nodiscard]] constexpr bool lost(MotorStatus status) noexcept {
  return status == MotorStatus::kOffline || status == MotorStatus::kFault;
}

/// This fallback of the motor is a loop of rc10d, which may give nothing where nothing is to be opposed.
[[nodiscard]] bool ofHost(const MotorConfig& config, FallbackAction action);

/// Judges every tick by what was sent to the robot and what came out on its buses. Knows the configuration
/// and the documents, and nothing of the supervisor's code; of the snapshot it trusts nothing that the
/// frames could contradict.
class Oracle {
 public:
  explicit Oracle(const RobotConfig& config);

  // Inputs, before the tick that sees them.
  void heard(std::size_t bus, const CanFrame& frame);
  /// A frame of somebody else, heard on this bus.
  void foreign(std::size_t bus, const CanFrame& frame);
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
  /// A frame was sent there whose echo shows that the bus carries frames.
  void watched(std::size_t bus) { watched_.set(bus); }
  /// A watched frame that the kernel refused, and any frame that it took.
  void refused(std::size_t bus) { refused_.set(bus); }
  void taken(std::size_t bus) { taken_.set(bus); }
  /// Echoes of frames of these buses have come: the frames reach the wire. Known to the end of this tick.
  void echoed(std::bitset<kMaxBuses> buses) { echoed_ |= buses; }
  /// The e-stop input in this tick.
  void contact(bool open) {
    contact_open_ = open;
    if (open) estop_asked_ = true;
  }
  /// The mode input in this tick.
  void modeInput(bool open) {
    // One that flutters counts as open (docs/gpio.md); half a second, less some ticks.
    const bool was_open = now_ - mode_last_open_ < std::chrono::milliseconds{490};
    if (open && !was_open) mode_open_since_ = now_;
    mode_open_ = open || was_open;
    if (open) mode_last_open_ = now_;
  }
  void stopBegun() { stop_asked_ = true; }
  /// A message to a module, before the tick that sees it.
  void signalled(const SignalMessage& message);
  /// The client that waits for this scan has left.
  void scanLeft(std::uint64_t order) { left_scan_ = order; }
  /// For tests of the oracle itself: after a frame for this motor that is not rest, it takes no other frame
  /// for it into account.
  void deafen(std::size_t motor) { deaf_ = motor; }
  /// Its zeros count as asked for a degree higher.
  void misreadZeros(std::size_t motor) { misread_ = motor; }
  /// Targets are valid for a quarter of their time.
  void hasten() { hasty_ = true; }
  /// One foreign command is enough for it.
  void suspect(std::size_t motor) { suspicious_ = motor; }
  /// It was held a quarter of a turn farther on.
  void misplaceHold(std::size_t motor) { misplaced_ = motor; }
  /// Outputs.
  void answered(const OrderResult& result);
  /// A frame on a bus.
  void sent(std::size_t bus, const CanFrame& frame);

  /// After the tick and its frames. `read`: whose frames were read, and all of them.
  void judge(const Snapshot& snapshot, std::uint64_t periods, std::bitset<kMaxBuses> read, bool stopped);

  /// Orders without an answer so far.
  [[nodiscard]] std::size_t open() const noexcept { return unanswered_.size(); }
  [[nodiscard]] const Visits& visits() const noexcept { return visits_; }

 private:
  static constexpr std::size_t kNoGroup = ~std::size_t{0};
  /// The actions that a motor without a target may be doing.
  using Actions = std::bitset<kFallbackWords.size()>;

  struct Motor {
    const MotorConfig* config = nullptr;
    MotorVisits* visits = nullptr;
    std::size_t bus = 0;
    std::size_t group = kNoGroup;
    std::unique_ptr<Wire> wire;
    std::unique_ptr<Wire> strangers_wire;  ///< Reads what somebody else sends to its drive.
    double limit = 0.0;                    ///< Limit of its effort.
    bool of_module = false;                ///< A module commands it, too, while no client does.
    bool host_holds = false;               ///< Its hold is a loop of rc10d, of any effort,
    bool host_brakes = false;              ///< and so is its brake.

    // Its reports.
    bool heard = false;  ///< A report that could be a sample.
    MonotonicTime heard_at;
    bool reported = false;  ///< A sample.
    MonotonicTime reported_at;
    std::uint64_t samples = 0;
    Duration unheard{};           ///< Since its last sample, each tick with two periods at most.
    bool pause_forgiven = false;  ///< Only the first of several pauses may hide it.
    // Its commands.
    MonotonicTime driven_until{};  ///< The latest deadline of a command that moves.
    MonotonicTime owned_until{};   ///< Deadline of any command.
    bool coast_asked = false;      ///< Since the last tick, as are the next four.
    bool enable_asked = false;     ///< Alone or not.
    bool alone_asked = false;      ///< And not the other way as well.
    bool perhaps_alone = false;    ///< Since it was asked for, as long as it is on.
    int disables_asked = 0;
    bool clear_asked = false;
    bool zero_asked = false;
    // Its action.
    Told told;
    int frames = 0;                                            ///< For it, in this tick.
    std::array<std::pair<std::uint64_t, CanFrame>, 6> last{};  ///< And in which tick, for the report.
    std::size_t last_count = 0;
    double effort_before = 0.0;        ///< In its last frame.
    bool followed_effort = false;      ///< Since then it follows a current or a voltage, and all was read.
    std::uint64_t periods_untold = 0;  ///< Since then.
    std::uint64_t lost_ticks = 0;      ///< Since it is OFFLINE or FAULT.
    std::uint64_t carried_ticks = 0;   ///< Since its bus carries what is sent, and all of it was read.
    MotorStatus status = MotorStatus::kOffline;
    FaultCode fault = FaultCode::kNone;
    ControlMode mode = ControlMode::kCoast;
    Actions actions{1};
    MonotonicTime acts_since{};
    double rpm_when_it_began = 0.0;
    bool began_unmeasured =
        false;  ///< Its feedback was not fresh then: the speed is that of the next sample.
    std::uint64_t acts_since_tick = 0;
    bool ends_at_standstill = false;
    MonotonicTime fast_at{};        ///< It was seen to turn then.
    bool stood = false;             ///< For kSettled, by what was seen, since the fallback began,
    bool of_estop = false;          ///< of the robot.
    double held_deg = kUnsaid;      ///< Where a hold of a loop of rc10d began.
    bool held = false;              ///< It holds, by what was seen.
    MonotonicTime held_at{};        ///< Its last sample since,
    double last_deg = 0.0;          ///< and where it was then.
    std::uint64_t held_losses = 0;  ///< Losses of its place, up to then.
    int unheld_ticks = 0;
    bool rests_with_group = false;  ///< Disabled since another member was.
    bool new_sample = false;
    std::uint64_t cool_periods = 0;  ///< Below what derates it.
    bool was_hot = false;            ///< Its limit may still be reduced.
    bool cooled = false;             ///< And that ended in this tick.
    int unbraked_ticks = 0;
    MonotonicTime active_since{};  ///< Without a break.
    int fast_samples = 0;          ///< In a row, in reduced mode after its time.
    // Somebody else's commands: frames that may be some, and those that are.
    std::deque<MonotonicTime> perhaps_foreign;
    std::deque<MonotonicTime> foreign;
    // Reports of torque while it is to rest.
    bool rests = false;        ///< As of the last tick.
    double torque_sign = 0.0;  ///< 0: there is no evidence.
    MonotonicTime torque_since{};
    MonotonicTime torque_counts_since{};  ///< And since the last clear.
    int torque_samples = 0;
    TargetTrack track;
    /// Answers to orders of this tick that set its zero.
    struct Zero {
      double value_deg = 0.0;
      bool accepted = false;
    };
    std::vector<Zero> zeros;
  };
  /// A field of a target as a frame tells it.
  struct FieldSeen {
    double value = kUnsaid;
    double slack = 0.0;
    double turn = 0.0;                                      ///< It goes round; 0: it does not.
    double per_s = 0.0;                                     ///< Its slew limit; 0: none.
    double most = std::numeric_limits<double>::infinity();  ///< Limit of its magnitude.
    Span towards{};        ///< Limits may have taken it towards these at once.
    bool brakes = false;   ///< Limits may brake by it at once.
    bool limited = false;  ///< Limits have perhaps moved it.
  };
  struct Group {
    MotorSet members;
    MotorSet required;
    bool together = false;
    bool rearms = false;
    bool stops_now = false;  ///< Perhaps: since one is lost or was refused.
    bool rests_now = false;  ///< Perhaps: since one was.
    bool disable_asked = false;
    bool first_disable = false;  ///< One that rests with it: none that acts together is let go.
    MotorSet may_rearm;   ///< Were ACTIVE, or about to be, when it stopped, and nothing forbids it since.
    MotorSet must_rearm;  ///< Those of them that were ACTIVE.
  };

  /// A joint that homes at a stop.
  struct Joint {
    std::size_t module = 0;
    std::size_t motor = 0;
    double velocity_rpm = 0.0;  ///< Without its sign.
    double current_a = 0.0;
    double way_deg = 0.0;  ///< Most that lies between a place where it began and one to which it is pushed.
    // Messages to it.
    bool told = false;  ///< One came for this tick.
    bool high = false;  ///< The last one asks for a homing.
    bool rises = false;
    MonotonicTime valid_until{};
    MonotonicTime heard_at{};
    int high_ticks = 0;  ///< Since it may begin.
    // Its action.
    bool homes = false;
    bool zeroed = false;
    double from_deg = 0.0;  ///< Between these it began: anew within a homing, too.
    double to_deg = 0.0;
    int ticks = 0;         ///< Since it began.
    int others_ticks = 0;  ///< While another client has its motor.
  };
  /// A module that goes on for some time when nobody commands it.
  struct Holder {
    std::size_t module = 0;
    std::vector<std::size_t> motors;
    Duration silence_max{};
    bool any_client = false;  ///< As long as some client of the robot is heard.
    MonotonicTime valid_until{};
  };
  /// A scan that goes on.
  struct Scan {
    std::uint64_t id = 0;
    BusScanOrder order;
    MonotonicTime since{};
    MonotonicTime last_question{};
    std::uint32_t questions = 0;
    bool all_read = true;  ///< Every frame of its bus was.
  };

  void judgeSnapshot(const Snapshot& snapshot, std::uint64_t periods);
  [[nodiscard]] bool mayTurn(std::size_t index, const MotorFeedback& feedback) const;
  void judgeRobotState(const Snapshot& snapshot);
  void judgeProbe(std::size_t bus);
  void followEchoes(const Snapshot& snapshot);
  void judgeFrames(std::bitset<kMaxBuses> read);
  void judgeStatus(std::size_t index, const MotorSnapshot& seen, RobotStatus robot);
  void judgeForeign(std::size_t index, const MotorSnapshot& seen);
  void judgeRest(std::size_t index, const MotorSnapshot& seen);
  void judgeAlone(const Snapshot& snapshot);
  void judgeGroups(const Snapshot& snapshot);
  void judgeTogether(const Group& group, const Snapshot& snapshot);
  void followActions(std::size_t index, const MotorSnapshot& seen);
  void judgeCommand(std::size_t index, const MotorSnapshot& seen);
  void judgeFallback(std::size_t index, const MotorSnapshot& seen);
  void judgeLettingGo(std::size_t index, Actions actions);
  void judgeBrake(std::size_t index, Actions actions);
  void judgeHold(std::size_t index, const MotorSnapshot& seen, Actions actions);
  void judgeLimits(std::size_t index);
  void judgeTold(std::size_t index, const MotorSnapshot& seen);
  void judgeSlew(std::size_t index, const MotorSnapshot& seen);
  void judgeFeedForward(std::size_t index, double outwards);
  [[nodiscard]] double effortOf(const Motor& motor, double output_nm) const;
  void followTargets(std::size_t index, const MotorSnapshot& seen);
  [[nodiscard]] static std::array<Span, TargetTrack::kFields> beginnings(const Motor& motor,
                                                                         const MotorSnapshot& seen);
  void followAsked(Motor& motor, const MotorSnapshot& seen) const;
  static void followHold(TargetTrack& track, const MotorSnapshot& seen);
  [[nodiscard]] static double followPlace(TargetTrack& track, const MotorSnapshot& seen);
  void judgeFirstAngle(std::size_t index, const MotorSnapshot& seen);
  void judgeField(std::size_t index, TargetTrack::Field which, const FieldSeen& seen);
  void judgeTargets(std::size_t index, const MotorSnapshot& seen);
  void judgeSpeed(std::size_t index, const MotorSnapshot& seen);
  void judgePlace(std::size_t index, const MotorSnapshot& seen);
  void judgeEfforts(std::size_t index, const MotorSnapshot& seen);
  void judgeTurn(std::size_t index, const MotorSnapshot& seen);
  void judgeZero(std::size_t index, const MotorSnapshot& seen);
  [[nodiscard]] bool isBounded(const Motor& motor, const MotorSnapshot& seen) const;
  void judgeSoftLimits(std::size_t index, const MotorSnapshot& seen);
  void judgeLimitedPlace(std::size_t index, const MotorSnapshot& seen);
  void judgeReduced(std::size_t index, const MotorSnapshot& seen);
  void judgeReducedEffort(std::size_t index);
  void judgeStop(std::bitset<kMaxBuses> read, bool stopped);
  void judgeAnswers();
  void count(const Snapshot& snapshot);
  void setActions(Motor& motor, Actions actions);
  [[nodiscard]] static bool saidLately(const Motor& motor, const CanFrame& frame);
  [[nodiscard]] static Actions only(FallbackAction action);
  void followFeedback(const Snapshot& snapshot);
  void followModules(const Snapshot& snapshot);
  void judgeJoints(const Snapshot& snapshot);
  void judgeHolders(const Snapshot& snapshot);
  void judgeJoint(Joint& joint, const Snapshot& snapshot);
  void followMessages(Joint& joint, bool homes);
  void judgeHoming(Joint& joint, const Snapshot& snapshot);
  void judgeScans(const Snapshot& snapshot, std::bitset<kMaxBuses> read);
  void beginScan(const Order& order, const Snapshot& snapshot);
  void judgeQuestions(const Snapshot& snapshot, std::bitset<kMaxBuses> read);
  void judgeEnd(const OrderResult& result);
  [[nodiscard]] bool scanRests(std::size_t index, const Snapshot& snapshot) const;
  [[nodiscard]] bool fresh(const Motor& motor) const;
  [[nodiscard]] bool overdue(const Motor& motor) const;
  [[nodiscard]] bool damps(const Motor& motor) const;
  [[nodiscard]] bool isReduced(const Motor& motor) const;
  [[nodiscard]] static bool mayLag(const Motor& motor, std::uint64_t ticks);
  [[nodiscard]] bool fits(const Motor& motor, FallbackAction action) const;
  [[nodiscard]] bool ramps(const Motor& motor) const;
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail(std::size_t motor, const std::string& what) const;
  void require(std::size_t motor, bool condition, const char* what) const {
    if (!condition) fail(motor, what);
  }

  RobotConfig config_;
  std::vector<Motor> motors_;
  std::vector<Group> groups_;
  std::vector<Joint> joints_;
  std::vector<Holder> holders_;
  std::map<std::uint64_t, std::uint64_t> unanswered_;  ///< Orders, and the tick in which they were sent.
  std::map<std::uint64_t, Order> zeros_asked_;         ///< Without an answer so far.
  std::optional<Scan> scan_;
  std::vector<Order> scans_asked_;  ///< In this tick, as are the next two.
  std::vector<OrderResult> scan_results_;
  std::vector<std::pair<std::size_t, CanFrame>> questions_;  ///< And their buses.
  std::optional<std::uint64_t> left_scan_;

  std::optional<std::size_t> alone_;  ///< The motor that was enabled alone.
  bool was_alone_ = false;            ///< In this tick some motor was.
  MonotonicTime now_{};
  MonotonicTime before_{};       ///< The last tick,
  MonotonicTime before_last_{};  ///< and the one before it.
  std::uint64_t tick_ = 0;
  bool begun_ = false;
  bool client_heard_ = false;  ///< Since the last tick.
  std::uint64_t missed_ = 0;
  RobotStatus state_ = RobotStatus::kRun;
  bool estop_asked_ = false;
  bool estop_in_force_ = false;  ///< Since RUN one has come.
  bool clear_all_asked_ = false;
  bool stop_asked_ = false;
  MonotonicTime stopping_since_{};
  std::uint64_t ticks_stopping_ = 0;
  std::uint64_t ticks_over_ = 0;  ///< Those of them after the fallbacks.
  bool rested_ = false;
  bool contact_open_ = false;
  bool mode_open_ = false;
  MonotonicTime mode_open_since_{};
  MonotonicTime mode_last_open_{};
  std::uint64_t periods_ = 1;  ///< Periods of this tick.
  std::bitset<kMaxBuses> down_;
  std::bitset<kMaxBuses> known_down_;  ///< As of the end of the last tick.
  std::bitset<kMaxBuses> off_;         ///< Its controller is bus-off.
  /// Since frames were sent and no echo came.
  struct Echoes {
    bool awaited = false;
    bool of_a_full_queue = false;  ///< Nothing that the kernel took is awaited.
    std::uint64_t ticks = 0;
    MonotonicTime next_probe{};
  };
  std::array<Echoes, kMaxBuses> echoes_{};
  std::bitset<kMaxBuses> watched_;  ///< In this tick, as is the next.
  std::bitset<kMaxBuses> refused_;
  std::bitset<kMaxBuses> taken_;
  std::bitset<kMaxBuses> echoed_;
  std::bitset<kMaxBuses> stalled_;  ///< As of the end of the last tick.
  std::bitset<kMaxBuses> held_;     ///< Nothing but a probe of a stalled bus may be sent there in this tick.
  std::optional<std::size_t> deaf_;
  std::optional<std::size_t> misread_;
  bool hasty_ = false;
  std::optional<std::size_t> suspicious_;
  std::optional<std::size_t> misplaced_;
  Visits visits_;
};

}  // namespace rc10::test
