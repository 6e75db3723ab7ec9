// Motors that stop together.
#include <algorithm>
#include <utility>

#include "daemon/supervision/supervisor.hpp"

namespace rc10 {
namespace {

// Motors that stood still for so long are at rest.
constexpr Duration kAtRest = std::chrono::milliseconds{300};

}  // namespace

Supervisor::Group* Supervisor::groupOf(std::size_t motor) noexcept {
  const auto found = std::find_if(groups_.begin(), groups_.end(),
                                  [motor](const Group& group) { return group.members.test(motor); });
  return found == groups_.end() ? nullptr : &*found;
}

// Every member must be there for one to be enabled.
bool Supervisor::groupWhole(std::size_t motor) noexcept {
  const auto* group = groupOf(motor);
  if (group == nullptr) return true;
  for (std::size_t other = 0; other < axes_.size(); ++other) {
    const auto status = axes_[other].status();
    const bool there = status != MotorStatus::kOffline && status != MotorStatus::kFault;
    if (group->members.test(other) && !there) return false;
  }
  return true;
}

void Supervisor::watchGroup(std::size_t index, const Tick& tick) noexcept {
  auto& group = groups_[index];
  if (group.lost.any()) {
    const auto lost = std::exchange(group.lost, {});  // all of one bus, perhaps
    bool returns = group.on_return == GroupConfig::Return::kRearmAtRest;
    std::size_t first = axes_.size();
    group.rearm = lost;
    for (std::size_t motor = axes_.size(); motor-- > 0;) {
      if (!group.members.test(motor)) continue;
      if (lost.test(motor)) first = motor;
      // A motor that stopped for a fault waits for a person.
      if (axes_[motor].status() == MotorStatus::kFault) returns = false;
      if (axes_[motor].status() == MotorStatus::kActive) group.rearm.set(motor);
      transition(motor, MotorEvent::kGroupStop, tick);
    }
    if (!returns) group.rearm.reset();
    group.moved = tick.now;
    report({EventCode::kGroupStopped, Severity::kError, static_cast<std::int16_t>(first),
            static_cast<std::int32_t>(index), 0, tick.now});
  }
  if (group.rearm.any()) rearm(index, tick);
}

void Supervisor::rearm(std::size_t index, const Tick& tick) noexcept {
  auto& group = groups_[index];
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    if (!group.members.test(motor)) continue;
    if (axes_[motor].status() == MotorStatus::kFault || state_ != RobotStatus::kRun) {
      group.rearm.reset();  // only a request brings it back now
      return;
    }
    if (axes_[motor].status() == MotorStatus::kOffline || !axes_[motor].standsStill()) group.moved = tick.now;
  }
  if (tick.now - group.moved < kAtRest) return;
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    if (group.rearm.test(motor)) (void)enable(motor, tick);
  }
  group.rearm.reset();
  const auto first = static_cast<std::int16_t>(robot_.groups()[index].motors.front());
  report({EventCode::kGroupRearmed, Severity::kInfo, first, static_cast<std::int32_t>(index), 0, tick.now});
}

}  // namespace rc10
