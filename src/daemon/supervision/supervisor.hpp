#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "app/time.hpp"
#include "app/watched_time.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/rings.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "daemon/exchange/stop.hpp"
#include "daemon/recording/flight_recorder.hpp"
#include "daemon/supervision/axis.hpp"
#include "daemon/supervision/bus_scan.hpp"
#include "daemon/supervision/foreign_watch.hpp"
#include "daemon/supervision/lease.hpp"
#include "daemon/supervision/motor_group.hpp"
#include "daemon/supervision/pending_enables.hpp"
#include "daemon/supervision/simulation_watch.hpp"
#include "daemon/supervision/states.hpp"

namespace rc10 {

/// Decides in every tick what the motors may do: takes orders and commands from the link, asks each Axis for
/// news, stops groups, answers and reports. Rest is its answer to everything unknown. Scheduler thread only.
class Supervisor {
 public:
  Supervisor(Robot& robot, LinkExchange& link, FlightRecorder* recorder = nullptr);

  /// Takes everything the link has sent. Called after this tick's feedback was decoded.
  void receiveOrders(const Tick& tick) noexcept;
  /// The targets of a module, as a client's command. Called between receiveOrders() and decide(). False:
  /// refused, since somebody else commands one of the motors.
  bool takeModuleCommand(const Command& command, const Tick& tick) noexcept;
  /// A request of a module; it sees the outcome in the motors.
  void takeModuleOrder(const Order& order, const Tick& tick) noexcept;
  /// A module homes this motor, from this tick on.
  void forgetReference(std::size_t motor) noexcept { axes_[motor].forgetReference(); }
  /// Whether a target of `sender` for this motor would act now, if it follows what was `said` then.
  [[nodiscard]] bool wouldObey(std::size_t motor, const Lease::Holder& sender, MonotonicTime said,
                               const Tick& tick) const noexcept {
    return axes_[motor].obeys(sender, tick.now) && !axes_[motor].predatesEnabling(said) &&
           !waitsForGroup(motor);
  }

  /// Tells every motor what kind of frame its drive gets. Called before Motor_Base::update().
  void decide(const Tick& tick) noexcept;

  /// A frame of a bus, before it is decoded: a scan hears it.
  void hearOnBus(std::size_t bus, const CanFrame& frame) noexcept {
    if (scan_.runs()) scan_.hear(bus, frame);
  }
  /// The question of a scan, behind the commands of this tick: one at most.
  void askOfScan(const Tick& tick) noexcept;

  /// E-stop of the robot for a cause within this computer. A `clear` of the same tick is refused.
  void stopFor(const Stop& why, const Tick& tick) noexcept { estop(why, tick); }
  /// The end of the process begins: every motor is disabled, and its fallback acts.
  void beginStop(const Tick& tick) noexcept;
  /// Whether some motor is still being damped, braked or held.
  [[nodiscard]] bool fallbackActs() const noexcept;
  /// From now on rest frames only.
  void endFallbacks() noexcept;

  void fillSnapshot(Snapshot& snapshot) const noexcept;
  /// Not inlined, as what else is rare: watch() is short then, and has its registers for itself.
  [[gnu::noinline]] void report(Event event) noexcept;

  /// A client has said something.
  void hearClient() noexcept { client_silent_.restart(); }
  [[nodiscard]] double clientsSilentSeconds() const noexcept { return client_silent_.seconds(); }

  /// Count of ModuleRobot::disables().
  [[nodiscard]] std::uint32_t disables() const noexcept { return disables_; }

  /// A drive does not rest, and the heartbeat is to end with that, until the e-stop is cleared.
  [[nodiscard]] bool heartbeatRests() const noexcept { return heartbeat_rests_; }
  /// Begin of the e-stop in force, which the end of rc10d does not end.
  [[nodiscard]] std::optional<MonotonicTime> estopBegan() const noexcept {
    return estop_in_force_ ? std::optional{estop_began_} : std::nullopt;
  }
  [[nodiscard]] RobotStatus robotState() const noexcept { return state_; }
  [[nodiscard]] MotorStatus status(std::size_t motor) const noexcept { return axes_[motor].status(); }
  [[nodiscard]] double speedCeilingRpm(std::size_t motor) const noexcept {
    return axes_[motor].speedCeilingRpm();
  }

 private:
  static constexpr std::size_t kNoGroup = ~std::size_t{0};
  /// The one drive that is being configured.
  struct Configuring {
    std::uint64_t order_id = 0;
    std::size_t motor = 0;
    MonotonicTime deadline;
  };

  [[nodiscard]] std::uint32_t conditions() const noexcept;
  [[nodiscard]] bool mayCommand(const Command& command, const Lease::Holder& sender,
                                const Tick& tick) noexcept;
  void apply(const Command& command, const Tick& tick) noexcept;
  /// Whether it acts; one that does not is counted and told.
  [[nodiscard]] bool follow(const Command::Setpoint& setpoint, const Lease::Holder& sender,
                            const Command& command, const Tick& tick) noexcept;
  void letGo(const Command& command, const Lease::Holder& sender, const Tick& tick) noexcept;
  /// Motors of groups that act together of which this message would move only some.
  [[nodiscard]] MotorSet heldBackBy(const Command& command) const noexcept;
  [[nodiscard]] bool waits(const Command::Setpoint& setpoint) const noexcept;
  [[nodiscard]] bool followsThePast(const Command::Setpoint& setpoint, const Command& command) const noexcept;
  [[nodiscard]] std::optional<SkipReason> whySkipped(const Command::Setpoint& setpoint) const noexcept;
  void skip(const Command::Setpoint& setpoint, SkipReason reason, const Tick& tick) noexcept;
  void carryOut(const Order& order, const Tick& tick) noexcept;
  /// `asked`: all motors that the request names.
  [[nodiscard]] Refusal enable(std::size_t motor, const MotorSet& asked, const Tick& tick) noexcept;
  /// Reason why it cannot be enabled, whatever its group says.
  [[nodiscard]] Refusal ownRefusal(std::size_t motor) const noexcept;
  /// Reason why its group does not let it be enabled.
  [[nodiscard]] Refusal groupRefusal(std::size_t motor, const MotorSet& asked) const noexcept;
  [[nodiscard]] Refusal enableAlone(std::size_t motor, const Tick& tick) noexcept;
  /// The motors that keep this one from being enabled, alone or at all.
  [[nodiscard]] MotorSet inTheWay(std::size_t motor, Refusal refusal, const MotorSet& asked) const noexcept;
  [[nodiscard]] MotorSet otherMotorsOn(std::size_t motor) const noexcept;
  void disable(std::size_t motor, const Order& order, const Tick& tick) noexcept;
  void clear(std::size_t motor, const Tick& tick) noexcept;
  void answer(const OrderResult& result) noexcept;
  [[nodiscard]] Refusal setGains(std::size_t motor, const Order& order, const Tick& tick) noexcept;
  /// `why`: kNone and who cleared it for RUN.
  void setRobotState(RobotStatus state, const Stop& why, const Tick& tick) noexcept;
  /// In every state: it also vetoes a kClear of this tick.
  void estop(const Stop& why, const Tick& tick) noexcept;
  /// `why`: of an event that stops a motor; by default what the event says.
  void transition(std::size_t motor, MotorEvent event, const Tick& tick) noexcept {
    const auto status = axes_[motor].status();
    if (next(status, event) != status) change(motor, event, tick);  // in few ticks
  }
  [[gnu::noinline]] void change(std::size_t motor, MotorEvent event, const Tick& tick) noexcept;
  void transition(std::size_t motor, MotorEvent event, const Stop& why, const Tick& tick) noexcept;
  void watch(std::size_t motor, const Axis::Since& since, const Tick& tick) noexcept;
  /// Reports the fault that its Axis has just found.
  [[gnu::noinline]] void fault(std::size_t motor, std::int32_t native_code, const Tick& tick) noexcept;
  [[gnu::noinline]] void tellTrip(std::size_t motor, Axis::Trip trip, const Tick& tick) noexcept;
  [[gnu::noinline]] void tellUnrest(std::size_t motor, RestCheck::Verdict verdict, const Tick& tick) noexcept;
  void watchGroup(std::size_t index, const Tick& tick) noexcept;
  void stopGroup(std::size_t index, GroupStop reason, const Tick& tick) noexcept;
  void rearm(std::size_t index, const Tick& tick) noexcept;
  /// Null: it is in none.
  [[nodiscard]] MotorGroup* groupOf(std::size_t motor) noexcept {
    return group_of_[motor] != kNoGroup ? &groups_[group_of_[motor]] : nullptr;
  }
  [[nodiscard]] const MotorGroup* groupOf(std::size_t motor) const noexcept {
    return group_of_[motor] != kNoGroup ? &groups_[group_of_[motor]] : nullptr;
  }
  /// Its group acts together, and not all of it is ACTIVE.
  [[nodiscard]] bool waitsForGroup(std::size_t motor) const noexcept;
  /// Its group acts together, and a member of it has lost its reference.
  [[nodiscard]] bool groupLostPlace(std::size_t motor) const noexcept;
  /// A motor that followed an angle has lost its reference in this tick.
  void noteLostPlace(std::size_t motor) noexcept;
  /// Ends the angles of the others in that tick.
  void endPlacesOf(MotorGroup& group, const Tick& tick) noexcept;
  [[nodiscard]] bool clearEstop(const Order& order, OrderResult& result, const Tick& tick) noexcept;
  void settle(std::size_t motor, Refusal outcome) noexcept;
  void configure(const Order& order, const Tick& tick) noexcept;
  [[nodiscard]] Refusal mayConfigure(std::size_t motor) const noexcept;
  /// Motors of its group that are on or held, and would stop for its loss.
  [[nodiscard]] MotorSet relyOn(std::size_t motor) const noexcept;
  void watchConfiguring(const Tick& tick) noexcept;
  void scan(const Order& order, const Tick& tick) noexcept;
  void watchScan(const Tick& tick) noexcept;
  /// Reason why no question may go to the bus of this motor.
  [[nodiscard]] Refusal againstScan(std::size_t motor) const noexcept;
  [[nodiscard]] bool mayGoOn(const BusScanOrder& scan, OrderResult& result) const noexcept;

  Robot& robot_;
  LinkExchange& link_;
  FlightRecorder* recorder_;
  ForeignWatch foreign_;
  RobotStatus state_ = RobotStatus::kRun;
  Stop stop_;                ///< Reason why it is not in RUN,
  MonotonicTime stopped_{};  ///< and since when.
  std::uint32_t estops_ = 0;
  std::uint32_t disables_ = 0;
  std::vector<Axis> axes_;
  PendingEnables pending_;
  std::vector<MotorGroup> groups_;
  std::vector<std::size_t> group_of_;  ///< By motor; kNoGroup: none.
  std::optional<Configuring> configuring_;
  BusScan scan_;
  std::optional<std::size_t> alone_;  ///< ENABLING or ACTIVE, and no other motor may be.
  SimulationWatch simulation_;
  MonotonicTime decided_at_{};      ///< The last tick,
  MonotonicTime decided_before_{};  ///< and the one before it.
  bool heartbeat_rests_ = false;
  bool estop_asked_ = false;     ///< In this tick, until decide().
  bool estop_in_force_ = false;  ///< Since kRun an e-stop has come, before the end of the program or in it.
  MonotonicTime estop_began_{};  ///< Time of the tick in which one began.
  bool reduced_ = false;         ///< The mode input is open, or was a moment ago.
  MonotonicTime mode_opened_{};  ///< Time of the last tick in which it was open.
  WatchedTime client_silent_ = WatchedTime::never();
  std::uint64_t expired_commands_ = 0;
  std::uint64_t refused_commands_ = 0;
  std::uint64_t skipped_setpoints_ = 0;
  std::uint64_t events_dropped_ = 0;
  MonotonicTime last_refusal_report_{};
};

}  // namespace rc10
