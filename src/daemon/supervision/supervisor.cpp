#include "daemon/supervision/supervisor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/saturated.hpp"

namespace rc10 {
namespace {

// Periods between two ticks that are a late tick; beyond, this thread had no processor: a pause.
constexpr int kLatePeriods = 2;

}  // namespace

Supervisor::Supervisor(Robot& robot, LinkExchange& link, FlightRecorder* recorder)
    : robot_(robot), link_(link), recorder_(recorder), foreign_(robot), scan_(link.scan) {
  axes_.reserve(robot.motors().size());
  for (const auto& entry : robot.motors()) axes_.emplace_back(entry, robot.buses()[entry.bus]);
  group_of_.assign(axes_.size(), kNoGroup);
  for (const auto& config : robot.groups()) {
    for (const auto motor : config.motors) group_of_[motor] = groups_.size();
    groups_.emplace_back(config, robot);
  }
}

void Supervisor::decide(const Tick& tick) noexcept {
  estop_asked_ = false;
  simulation_.look(robot_.simulationSteps().load(std::memory_order_relaxed), tick.now);
  const Axis::Since since{.before = decided_before_,
                          .ran = std::min(tick.now - decided_at_, kLatePeriods * robot_.period()),
                          .simulation_late = simulation_.late()};
  decided_before_ = std::exchange(decided_at_, tick.now);
  for (std::size_t motor = 0, count = axes_.size(); motor < count; ++motor) watch(motor, since, tick);
  for (std::size_t group = 0; group < groups_.size(); ++group) watchGroup(group, tick);
  watchConfiguring(tick);
  watchScan(tick);
  for (auto& axis : axes_) axis.order(state_, tick);
}

void Supervisor::watch(std::size_t motor, const Axis::Since& since, const Tick& tick) noexcept {
  auto& axis = axes_[motor];
  const auto who = static_cast<std::int16_t>(motor);
  const bool fresh = axis.listen(tick, since);
  if (fresh) {
    transition(motor, MotorEvent::kFeedbackFresh, tick);
  } else {
    if (axis.missesDrive(tick))
      report({EventCode::kNeverHeard, Severity::kWarning, who, axis.id(), 0, tick.now});
    if (axis.lost(tick)) transition(motor, MotorEvent::kFeedbackLost, tick);
  }
  if (const auto loss = axis.losesReference(tick); loss != Axis::Loss::kNone) {
    report({EventCode::kReferenceLost, Severity::kWarning, who, 0, 0, tick.now});
    if (loss == Axis::Loss::kPlace) noteLostPlace(motor);
  }
  if (const auto native_code = axis.complains(tick))
    fault(motor, static_cast<std::int32_t>(*native_code), tick);
  if (axis.status() == MotorStatus::kEnabling) {
    if (const auto end = axis.endsEnabling(tick)) transition(motor, *end, tick);
  }
  if (const auto trip = axis.trips(reduced_, tick); trip != Axis::Trip::kNone) tellTrip(motor, trip, tick);
  if (foreign_.tookOver(motor)) {
    if (const auto by = foreign_.takeover(motor); by && axis.yields()) fault(motor, *by, tick);
  }
  if (const auto rest = axis.checkRest(tick); rest != RestCheck::Verdict::kRests)
    tellUnrest(motor, rest, tick);
  if (axis.lapses(tick)) {
    report({EventCode::kCommandTimeout, Severity::kWarning, who,
            static_cast<std::int32_t>(axis.timeoutAction()), 0, tick.now});
  }
}

void Supervisor::tellTrip(std::size_t motor, Axis::Trip trip, const Tick& tick) noexcept {
  if (trip == Axis::Trip::kFault) return fault(motor, 0, tick);
  report({EventCode::kFallbackReplaced, Severity::kWarning, static_cast<std::int16_t>(motor),
          static_cast<std::int32_t>(axes_[motor].resistance()), 0, tick.now});
}

void Supervisor::fault(std::size_t motor, std::int32_t native_code, const Tick& tick) noexcept {
  report({EventCode::kMotorFault, Severity::kError, static_cast<std::int16_t>(motor),
          static_cast<std::int32_t>(axes_[motor].fault()), native_code, tick.now});
  transition(motor, MotorEvent::kFault, tick);
}

// A motor that is in FAULT stays there for its first reason; what its drive does is told all the same.
void Supervisor::tellUnrest(std::size_t motor, RestCheck::Verdict verdict, const Tick& tick) noexcept {
  auto& axis = axes_[motor];
  const auto who = static_cast<std::int16_t>(motor);
  if (verdict == RestCheck::Verdict::kGainsSpeed) {
    const double rpm = std::round(static_cast<double>(axis.motor().feedback().velocity_rpm));
    return report(
        {EventCode::kMovesAtRest, Severity::kInfo, who, saturatedRound<std::int32_t>(rpm), 0, tick.now});
  }
  report({EventCode::kMotorFault, Severity::kError, who, static_cast<std::int32_t>(FaultCode::kNotAtRest), 0,
          tick.now});
  transition(motor, MotorEvent::kFault, tick);
  if (robot_.unrestPolicy() == UnrestPolicy::kGroup) return;
  estop({StopCause::kFault, link::Name{axis.motor().name()}}, tick);
  heartbeat_rests_ = robot_.unrestPolicy() == UnrestPolicy::kHeartbeat;
}

void Supervisor::change(std::size_t motor, MotorEvent event, const Tick& tick) noexcept {
  transition(motor, event, {causeOf(event, state_)}, tick);
}

void Supervisor::transition(std::size_t motor, MotorEvent event, const Stop& why, const Tick& tick) noexcept {
  auto& axis = axes_[motor];
  const auto changed = axis.handle(event, state_, why, tick);
  if (!changed) return;
  const auto before = *changed;
  const auto after = axis.status();
  // The group of one that was enabled alone rests already, and does not come back by itself.
  if (auto* group = groupOf(motor); group != nullptr && alone_ != motor && isOn(before) && !isOn(after))
    group->noteLeaving(motor, before, event);
  if (alone_ == motor && !isOn(after)) alone_.reset();
  if (before == MotorStatus::kEnabling) {
    settle(motor, after == MotorStatus::kActive     ? Refusal::kNone
                  : after == MotorStatus::kOffline  ? Refusal::kOffline
                  : after == MotorStatus::kFault    ? Refusal::kFaulted
                  : event == MotorEvent::kEstop     ? Refusal::kEstop
                  : event == MotorEvent::kGroupStop ? Refusal::kGroup
                  : isDisable(event)                ? Refusal::kDisabled
                  : axis.turnUnclear()              ? Refusal::kTurnUnclear
                  : axis.fallbackActs()             ? Refusal::kRestFirst
                                                    : Refusal::kDriveRefused);
  }
  const bool stopped = after == MotorStatus::kFault || (isOn(before) && !isOn(after));
  const auto stop = stopped ? axis.stop() : Stop{};
  const bool worrying =
      after == MotorStatus::kFault || (after == MotorStatus::kOffline && before == MotorStatus::kActive);
  report({EventCode::kMotorStatus, worrying ? Severity::kError : Severity::kInfo,
          static_cast<std::int16_t>(motor), static_cast<std::int32_t>(after),
          ExtraPair{before, stop.cause}.extra(), tick.now, stop.by});
}

void Supervisor::settle(std::size_t motor, Refusal outcome) noexcept {
  pending_.settle(motor, outcome, [this](const OrderResult& result) { answer(result); });
}

void Supervisor::setRobotState(RobotStatus state, const Stop& why, const Tick& tick) noexcept {
  const auto before = state_;
  state_ = state;
  stop_ = state == RobotStatus::kRun ? Stop{} : why;
  stopped_ = state == RobotStatus::kRun ? MonotonicTime{} : tick.now;
  if (state == RobotStatus::kEstop) {
    ++estops_;
    estop_began_ = tick.now;
  }
  estop_in_force_ = state == RobotStatus::kEstop || (state == RobotStatus::kStopping && estop_in_force_);
  if (state == RobotStatus::kRun) heartbeat_rests_ = false;
  if (state != RobotStatus::kRun) {
    for (auto& group : groups_) group.rearm.reset();  // even if it is cleared within this tick
    const Stop stop{causeOf(MotorEvent::kEstop, state), why.by};
    for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
      if (state == RobotStatus::kEstop) axes_[motor].estopFallback(tick);
      transition(motor, MotorEvent::kEstop, stop, tick);
    }
  }
  report({EventCode::kRobotState, state == RobotStatus::kEstop ? Severity::kError : Severity::kInfo, -1,
          static_cast<std::int32_t>(state), ExtraPair{before, why.cause}.extra(), tick.now, why.by});
}

void Supervisor::beginStop(const Tick& tick) noexcept {
  if (state_ != RobotStatus::kStopping) setRobotState(RobotStatus::kStopping, {StopCause::kShutdown}, tick);
}

bool Supervisor::fallbackActs() const noexcept {
  return std::any_of(axes_.begin(), axes_.end(), [](const Axis& axis) { return axis.fallbackActs(); });
}

void Supervisor::endFallbacks() noexcept {
  for (auto& axis : axes_) axis.endFallback();
}

void Supervisor::report(Event event) noexcept {
  if (recorder_ != nullptr) recorder_->event(event);
  if (!link_.events.push(event)) ++events_dropped_;
}

std::uint32_t Supervisor::conditions() const noexcept {
  return (link_.estop_contact.open() ? kConditionInputOpen : 0U) | (reduced_ ? kConditionReduced : 0U);
}

void Supervisor::fillSnapshot(Snapshot& snapshot) const noexcept {
  snapshot.state = state_;
  snapshot.stop = stop_;
  snapshot.stopped = stopped_;
  snapshot.estops = estops_;
  snapshot.conditions = conditions();
  snapshot.expired_commands = expired_commands_;
  snapshot.refused_commands = refused_commands_;
  snapshot.skipped_setpoints = skipped_setpoints_;
  snapshot.events_dropped = events_dropped_;
  snapshot.motor_count = axes_.size();
  auto* motor = snapshot.motors.data();
  for (const auto& axis : axes_) axis.fill(*motor++);
}

}  // namespace rc10
