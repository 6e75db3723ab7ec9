#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "app/time.hpp"
#include "app/units.hpp"
#include "daemon/devices/robot.hpp"
#include "daemon/exchange/events.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/snapshot.hpp"
#include "daemon/exchange/stop.hpp"
#include "daemon/supervision/lease.hpp"
#include "daemon/supervision/states.hpp"
#include "motor/guarding/fallback.hpp"

namespace rc10 {

/// Supervision of one motor: its status, who commands it and until when, its limits, and its fallback while
/// nobody does. Knows nothing of other motors; the supervisor asks it in each tick and reports. Scheduler
/// thread only.
class Axis {
 public:
  /// Both outlive it.
  Axis(const Robot::MotorEntry& entry, const Robot::BusEntry& bus) noexcept;

  [[nodiscard]] Motor_Base& motor() const noexcept { return motor_; }
  [[nodiscard]] MotorStatus status() const noexcept { return status_; }
  [[nodiscard]] FaultCode fault() const noexcept { return fault_; }
  /// Reason why it does not obey.
  [[nodiscard]] const Stop& stop() const noexcept { return stop_; }
  /// Ceiling of the reduced mode; infinite outside it.
  [[nodiscard]] double speedCeilingRpm() const noexcept { return reduced_.ceilingRpm(); }
  [[nodiscard]] bool fallbackActs() const noexcept { return fallback_.acts(); }
  /// A fallback acts, and its drive can be enabled from rest alone.
  [[nodiscard]] bool mustRestFirst() const noexcept {
    return fallback_.acts() && motor_.sequenceProgress() == SequenceProgress::kFailed;
  }
  [[nodiscard]] FallbackAction timeoutAction() const noexcept { return entry_.fallback.on_timeout; }
  /// It must not be enabled: an angle could lead it a turn astray. One that is homed finds its angle itself.
  [[nodiscard]] bool turnUnclear() const noexcept { return motor_.feedback().turn_unclear && !entry_.homed; }
  void fill(MotorSnapshot& snapshot) const noexcept;

  // ---- Feedback

  /// Time since the last tick.
  struct Since {
    MonotonicTime before{};        ///< Start of the tick before the last: the RX thread may be a tick behind.
    Duration ran{};                ///< Since the last tick; a pause of this thread is two periods of it.
    bool simulation_late = false;  ///< Simulated drives had no processor to speak.
  };
  /// Once a tick, first: whether its feedback is fresh().
  bool listen(const Tick& tick, const Since& since) noexcept;
  [[nodiscard]] bool fresh(const Tick& tick) const noexcept;
  /// Not fresh, and not only because this thread did not run; or fresh again after a restart, perhaps.
  [[nodiscard]] bool lost(const Tick& tick) const noexcept;
  /// Once, some time after the first tick: its drive has not been heard yet.
  [[nodiscard]] bool missesDrive(const Tick& tick) noexcept;
  [[nodiscard]] int id() const noexcept { return entry_.id; }
  [[nodiscard]] bool standsStill() const noexcept;
  /// Time of its last sample: nothing is known of the time since.
  [[nodiscard]] MonotonicTime heardAt() const noexcept { return motor_.feedback().received; }
  /// Reason why an e-stop must not end yet: it turns, or may do so.
  [[nodiscard]] Refusal motionRefusal(const Tick& tick) const noexcept;

  // ---- Once a tick

  enum class Loss : std::uint8_t {
    kNone,
    kReference,
    kPlace,  ///< A target of an angle has ended with it.
  };
  /// Whether its angle has just lost its reference.
  [[nodiscard]] Loss losesReference(const Tick& tick) noexcept {
    const auto& feedback = motor_.feedback();
    if (feedback.zeroed == reference_known_ && feedback.losses == losses_) return Loss::kNone;
    return noteReference(tick);
  }
  /// The native code of a fault that its drive reports: fault() from now on.
  [[nodiscard]] std::optional<std::uint32_t> complains(const Tick& tick) noexcept {
    const auto complaint = motor_.complaint();
    if (complaint.fault == FaultCode::kNone) return std::nullopt;  // most often
    return noteComplaint(complaint, tick);
  }
  /// The end of an enable sequence.
  [[nodiscard]] std::optional<MotorEvent> endsEnabling(const Tick& tick) const noexcept;
  enum class Trip : std::uint8_t {
    kNone,
    kResists,  ///< Dragged too fast in reduced mode: resistance() acts in place of a fallback that could
               ///< push.
    kFault,    ///< fault() from now on.
  };
  /// Limits, derating and faults of this tick. `reduced`: the mode input asks for reduced speed and effort.
  [[nodiscard]] Trip trips(bool reduced, const Tick& tick) noexcept;
  /// Damp, or a brake that only resists: after Trip::kResists.
  [[nodiscard]] FallbackAction resistance() const noexcept {
    return fallback_.kind() == FrameKind::kBrake ? FallbackAction::kBrake : FallbackAction::kDamp;
  }
  /// Whether its drive rests, while it is told to. RestCheck::Verdict::kDriven: fault() from now on, unless
  /// it is in FAULT for another reason.
  [[nodiscard]] RestCheck::Verdict checkRest(const Tick& tick) noexcept;
  /// Another controller commands its drive: fault() from now on. False: it is not there, or in FAULT already.
  [[nodiscard]] bool yields() noexcept;
  /// A member of its group lost its reference: an angle that it follows ends as by a timeout.
  void endPlace(const Stop& why, const Tick& tick) noexcept;
  /// The command in force has lapsed: its fallback has begun.
  [[nodiscard]] bool lapses(const Tick& tick) noexcept;
  /// Tells the motor what kind of frame its drive gets, and the target as it is shaped.
  void order(RobotStatus robot, const Tick& tick) noexcept;

  // ---- Changes

  /// The status before, if it changes.
  [[nodiscard]] std::optional<MotorStatus> handle(MotorEvent event, RobotStatus robot, const Stop& stop,
                                                  const Tick& tick) noexcept;
  /// Reason for which follow() would not obey such a target now.
  [[nodiscard]] std::optional<SkipReason> whySkipped(const Target& target) const noexcept;
  /// Before MotorEvent::kEnable.
  void prepareEnabling(const Tick& tick) noexcept;
  /// The order that has just enabled it.
  void noteEnabledBy(std::uint64_t order) noexcept { enabled_by_ = order; }
  /// Before MotorEvent::kClear: the drive clears its faults.
  void clearFault(const Tick& tick) noexcept;
  void endFallback() noexcept { fallback_.end(); }
  /// A disable of a motor that rests already: it lets go.
  void disableOnceMore(const Tick& tick) noexcept;
  /// It rests, but a hold that followed its disable pushes.
  [[nodiscard]] bool holdsDisabled() const noexcept {
    return status_ == MotorStatus::kReady && fallback_.holdsAfterDisable();
  }
  /// Its group stops while it holdsDisabled().
  void stopHolding(const Tick& tick) noexcept {
    rested_ = Rested::kAsked;
    beginFallback(entry_.fallback.on_estop, Fallback::Until::kEnded, false, tick);
  }
  /// Before MotorEvent::kEstop of the robot: a fallback that acts already gives way to that of the e-stop.
  void estopFallback(const Tick& tick) noexcept {
    rested_ = Rested::kAsked;
    if (status_ != MotorStatus::kActive && fallback_.acts())
      beginFallback(entry_.fallback.on_estop, Fallback::Until::kEnded, true, tick);
  }

  /// Whether a command of `sender` would be taken.
  [[nodiscard]] bool allows(const Lease::Holder& sender, const Lease::Term& term,
                            MonotonicTime now) const noexcept {
    return lease_.allows(sender, term, now);
  }
  [[nodiscard]] bool obeys(const Lease::Holder& sender, MonotonicTime now) const noexcept {
    return status_ == MotorStatus::kActive && lease_.allows(sender, now);
  }
  /// Said before the motor was enabled: it does not act.
  [[nodiscard]] bool predatesEnabling(MonotonicTime said) const noexcept { return said < enabling_since_; }
  /// Takes a target that the lease allows, and that follows what was `said` then. The reason, if it does not
  /// act.
  [[nodiscard]] std::optional<SkipReason> follow(const Target& target, MonotonicTime said,
                                                 const Lease::Holder& sender,
                                                 const Lease::Term& term) noexcept;
  /// A command of `sender` came too late to act: what it told this motor before ends with it.
  void outdate(const Lease::Holder& sender, MonotonicTime deadline) noexcept {
    lease_.shorten(sender, deadline);
  }
  /// At most one report of a skipped setpoint in each kReportInterval.
  [[nodiscard]] bool mayReportSkip(MonotonicTime now) noexcept;
  [[nodiscard]] Refusal zero(const Order& order) noexcept;
  /// Motor_Base::zeroForFile(); NaN also where a travel of a turn or more lets no file know the turn.
  [[nodiscard]] double zeroForFile() const noexcept;
  /// It is to be homed: until it is, no soft limit acts, and no angle is followed.
  void forgetReference() noexcept;
  void retune(const CascadeConfig& loops) noexcept;

 private:
  /// Unheard in this tick. Not inlined: listen() is short without it.
  [[gnu::noinline]] void goUnheard(bool came, const Since& since) noexcept;
  /// Its drive stores settings, and may be silent meanwhile.
  [[nodiscard]] bool silenceExcused() noexcept;
  [[nodiscard]] FrameKind frameKind(RobotStatus robot) const noexcept;
  /// Its reference is another than in the last tick.
  [[nodiscard]] Loss noteReference(const Tick& tick) noexcept;
  [[nodiscard]] std::optional<std::uint32_t> noteComplaint(const DriveComplaint& complaint,
                                                           const Tick& tick) noexcept;
  /// Speed and effort of reduced mode for this tick. Trip::kFault: it is faster than it may be, and no
  /// resistance can take the place of what acts. Few motors have it.
  [[nodiscard, gnu::noinline]] Trip tripsWhenReduced(bool reduced, bool moves, const Tick& tick) noexcept;
  /// For the loops of rc10d; `stops`: the motor is braked, or led to rest along a ramp.
  [[gnu::noinline]] void boundSpeeds(bool stops, MonotonicTime now) noexcept;
  /// Whether soft limits or reduced mode bound the speed of its loops.
  [[nodiscard]] bool limitsSpeed() const noexcept { return shaper_.hasSoftLimits() || reduced_.any(); }
  /// A quarter of the speed that counts as standstill: less is noise of an angle that is held.
  void dropWindup() noexcept { motor_.dropWindup(0.25F * entry_.standstill_rpm); }
  /// Orders a hold whose place is led under the ceiling of the speed; false: there is none.
  [[nodiscard, gnu::noinline]] bool leadsHold(const Tick& tick) noexcept;
  [[nodiscard, gnu::noinline]] TargetShaper::InForce commandInForce(bool limited) const noexcept;
  [[nodiscard]] Acting acting() const noexcept;
  /// Its command is the velocity of a fallback.
  [[nodiscard]] bool ramps() const noexcept {
    return fallback_.kind() == FrameKind::kCommand && motor_.target().mode == ControlMode::kCoast;
  }
  [[nodiscard]] bool heldWhileEnabling() const noexcept;
  /// True while a hold has no measured place to begin from, or a ramp no measured speed. Sets that speed.
  [[nodiscard]] bool awaitsFeedback(FrameKind kind, const Tick& tick) noexcept {
    return (kind == FrameKind::kHold || ramp_unmeasured_) && beginsUnmeasured(kind, tick);
  }
  [[nodiscard]] bool beginsUnmeasured(FrameKind kind, const Tick& tick) noexcept;
  /// In the last tick, where it was told to: the place that is known is where it is.
  [[nodiscard]] bool stood() const noexcept;
  [[nodiscard]] std::optional<SkipReason> whyNotNow(const Target& target) const noexcept;
  void dropTarget() noexcept;
  void beginTimeoutFallback(const Stop& why, const Tick& tick) noexcept;
  void beginFallback(FallbackAction action, Fallback::Until until, bool estop, const Tick& tick) noexcept;

  const Robot::MotorEntry& entry_;
  const Robot::BusEntry& bus_;
  Motor_Base& motor_;
  MotorGuard guard_;
  RestCheck rest_;
  ReducedMotion reduced_;
  TargetShaper shaper_;
  Fallback fallback_;
  /// Reason of its rest; kStayed: nobody asked, and what held it acts on.
  enum class Rested : std::uint8_t { kAsked, kUnasked, kStayed };
  Rested rested_ = Rested::kAsked;
  Lease lease_;      ///< Whose target is in force, and until when.
  Target in_force_;  ///< Target that the motor followed in the last tick.
  double hold_goal_deg_ =
      std::numeric_limits<double>::quiet_NaN();  ///< Place of the last hold under a ceiling.
  double stop_from_rpm_ = 0.0;                   ///< Speed at which the stop began.
  bool ramp_unmeasured_ = false;                 ///< A ramp has begun without fresh feedback.
  bool stops_ = false;                           ///< Braked, or led to rest along a ramp, in the last tick.
  bool speeds_bounded_;                          ///< It stops, or limitsSpeed().
  MotorStatus status_ = MotorStatus::kOffline;
  FaultCode fault_ = FaultCode::kNone;
  Stop stop_;
  std::uint32_t limits_ = 0;      ///< Active limits, as the guard reports them.
  bool reference_known_ = false;  ///< In the last tick.
  std::uint64_t losses_ = 0;      ///< Losses of its reference, up to the last tick.
  std::uint64_t samples_ = 0;     ///< Count of its feedback in the last tick.
  std::uint64_t enabled_by_ = 0;  ///< MotorSnapshot::enabled_by
  Duration unheard_{};           ///< Time since it was heard, less what is excused; a pause of this thread is
                                 ///< two periods of it.
  bool pause_forgiven_ = false;  ///< Since it was heard.
  bool restarted_ = false;       ///< Perhaps: heard in this tick, while on, after so long a silence.
  bool on_since_heard_ = false;  ///< It was on, or a fallback acted, when it was heard or since.
  MonotonicTime enabling_since_;
  MonotonicTime enable_deadline_;
  MonotonicTime clearing_until_{};  ///< Until then the drive's complaints are old ones.
  MonotonicTime last_skip_report_{};
  MonotonicTime first_tick_{};
  bool missed_ = false;  ///< missesDrive() has said so.
};

}  // namespace rc10
