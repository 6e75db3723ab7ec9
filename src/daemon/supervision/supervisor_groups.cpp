// Motors that stop together.
#include <algorithm>
#include <utility>

#include "daemon/supervision/supervisor.hpp"

namespace rc10 {
namespace {

// Standstill after which motors are at rest.
constexpr Duration kAtRest = std::chrono::milliseconds{300};
// Drives start anew within this after a dip of their supply. After a longer loss somebody may have his hands
// there.
constexpr Duration kShortLoss = std::chrono::seconds{3};
// Time for all of a return: of a robot that rolls, or is pushed, for longer nobody expects it.
constexpr Duration kLongestReturn = std::chrono::seconds{10};

[[nodiscard]] std::int16_t firstOf(const MotorSet& motors) noexcept {
  std::int16_t first = 0;
  while (static_cast<std::size_t>(first) < motors.size() && !motors.test(static_cast<std::size_t>(first)))
    ++first;
  return first;
}

}  // namespace

// A motor that is enabled alone needs no group.
Refusal Supervisor::groupRefusal(std::size_t motor, const MotorSet& asked) const noexcept {
  const auto* group = groupOf(motor);
  if (group == nullptr) return Refusal::kNone;
  if (configuring_ && group->required.test(configuring_->motor)) return Refusal::kConfiguring;
  if (alone_ == motor) return Refusal::kNone;
  if (group->missing(axes_).any()) return Refusal::kGroup;
  if (!group->together) return Refusal::kNone;
  const auto others = group->required & ~group->on(axes_);
  if ((others & ~asked).any()) return Refusal::kTogether;
  const bool all = std::all_of(group->motors.begin(), group->motors.end(), [&](std::size_t other) {
    return !others.test(other) || ownRefusal(other) == Refusal::kNone;
  });
  return all ? Refusal::kNone : Refusal::kGroup;
}

MotorSet Supervisor::inTheWay(std::size_t motor, Refusal refusal, const MotorSet& asked) const noexcept {
  const auto* group = groupOf(motor);
  switch (refusal) {
    case Refusal::kAlone:
    case Refusal::kOthersOn: return otherMotorsOn(motor);
    case Refusal::kGroup: return group != nullptr ? group->missing(axes_) : MotorSet{};
    case Refusal::kTogether:
      return group != nullptr ? group->required & ~asked & ~group->on(axes_) : MotorSet{};
    default: return {};
  }
}

bool Supervisor::waitsForGroup(std::size_t motor) const noexcept {
  const auto* group = groupOf(motor);
  return group != nullptr && alone_ != motor && group->waits(axes_);
}

bool Supervisor::groupLostPlace(std::size_t motor) const noexcept {
  const auto* group = groupOf(motor);
  return group != nullptr && group->together && alone_ != motor && group->without_place.any();
}

// The other motors of the load would drive on to a place that this one does not know any more.
void Supervisor::noteLostPlace(std::size_t motor) noexcept {
  auto* group = groupOf(motor);
  if (group == nullptr || !group->together || alone_ == motor || !group->required.test(motor)) return;
  group->lost_place.set(motor);
}

void Supervisor::endPlacesOf(MotorGroup& group, const Tick& tick) noexcept {
  group.without_place = group.withoutPlace(axes_) | group.lost_place;
  if (group.lost_place.none()) return;
  const auto source = static_cast<std::size_t>(firstOf(group.lost_place));
  for (const auto motor : group.motors) {
    if (motor != alone_ && !group.lost_place.test(motor))
      axes_[motor].endPlace({StopCause::kGroup, link::Name{robot_.motors()[source].motor->name()}}, tick);
  }
}

void Supervisor::watchGroup(std::size_t index, const Tick& tick) noexcept {
  auto& group = groups_[index];
  endPlacesOf(group, tick);
  const auto gone = group.missing(axes_);
  const bool alone = alone_ && groupOf(*alone_) == &group;
  // A hold after a disable ends with a member that is lost now, not with one that was missing already.
  const bool lost_while_held = (gone & ~std::exchange(group.gone, gone)).any() && group.held(axes_).any();
  if ((!alone && (group.on(axes_) | group.dropped).any()) || lost_while_held) {
    if (gone.any()) {
      stopGroup(index, GroupStop::kLost, tick);
    } else if (group.refused.any()) {
      stopGroup(index, GroupStop::kRefused, tick);
    } else if (group.disabled.any()) {
      stopGroup(index, GroupStop::kDisabled, tick);
    }
  }
  group.forgetLeaving();
  if (group.rearm.any()) rearm(index, tick);
}

void Supervisor::stopGroup(std::size_t index, GroupStop reason, const Tick& tick) noexcept {
  auto& group = groups_[index];
  const auto gone = group.missing(axes_);
  const auto& culprits = reason == GroupStop::kLost      ? gone
                         : reason == GroupStop::kRefused ? group.refused
                                                         : group.disabled;
  const auto source = firstOf(culprits);
  const bool asked = reason == GroupStop::kDisabled;
  const auto event = !asked                      ? MotorEvent::kGroupStop
                     : group.disabled_on_request ? MotorEvent::kDisable
                                                 : MotorEvent::kDisableUnasked;
  const Stop why{StopCause::kGroup,
                 link::Name{robot_.motors()[static_cast<std::size_t>(source)].motor->name()}};
  group.rearm = group.dropped;
  for (const auto motor : group.motors) {
    if (motor == alone_) continue;  // the others' loss is no news to who tries it
    if (axes_[motor].status() == MotorStatus::kActive) group.rearm.set(motor);
    if (event == MotorEvent::kDisable && isOn(axes_[motor].status())) group.rests_with_it.set(motor);
    if (reason == GroupStop::kLost && axes_[motor].holdsDisabled()) axes_[motor].stopHolding(tick);
    transition(motor, event, why, tick);
  }
  const bool returns = reason == GroupStop::kLost && !group.disable_asked &&
                       group.on_return == GroupConfig::Return::kRearmAtRest;
  if (!returns) group.rearm.reset();
  group.moved = tick.now;
  group.stopped = tick.now;
  report({EventCode::kGroupStopped, asked ? Severity::kInfo : Severity::kError, source,
          static_cast<std::int32_t>(index), static_cast<std::int32_t>(reason), tick.now});
}

void Supervisor::rearm(std::size_t index, const Tick& tick) noexcept {
  auto& group = groups_[index];
  if (tick.now - group.stopped > kLongestReturn) {
    group.rearm.reset();
    return;
  }
  const auto needed = group.required | group.rearm;
  auto seen = tick.now;
  for (const auto motor : group.motors) {
    if (!needed.test(motor)) continue;
    const bool optional = !group.required.test(motor);
    const auto status = axes_[motor].status();
    if (state_ != RobotStatus::kRun || (status == MotorStatus::kFault && !optional)) {
      group.rearm.reset();  // only a request brings it back now
      return;
    }
    const bool waited_for = status == MotorStatus::kOffline && !optional;
    if (waited_for && tick.now - group.stopped > kShortLoss) {
      group.rearm.reset();
      return;
    }
    const bool heard = status != MotorStatus::kOffline;
    if (heard) seen = std::min(seen, axes_[motor].heardAt());
    if (waited_for || (heard && !axes_[motor].standsStill())) group.moved = tick.now;
  }
  if (configuring_ && group.required.test(configuring_->motor)) group.moved = tick.now;
  if (seen - group.moved < kAtRest) return;
  // Somebody may have enabled them meanwhile. A group that acts together and was not whole is refused.
  const auto asked = std::exchange(group.rearm, {}) & ~group.on(axes_);
  MotorSet rearmed;
  for (const auto motor : group.motors)
    if (asked.test(motor)) rearmed.set(motor, enable(motor, asked, tick) == Refusal::kNone);
  if (rearmed.none()) return;
  report({EventCode::kGroupRearmed, Severity::kInfo, firstOf(rearmed), static_cast<std::int32_t>(index), 0,
          tick.now});
}

}  // namespace rc10
