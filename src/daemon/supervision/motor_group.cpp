#include "daemon/supervision/motor_group.hpp"

#include <algorithm>

namespace rc10 {

MotorGroup::MotorGroup(const GroupConfig& config, const Robot& robot)
    : motors(config.motors), together(config.together), on_return(config.on_return) {
  for (const auto motor : motors) required.set(motor, !robot.motors()[motor].optional);
}

MotorSet MotorGroup::on(const std::vector<Axis>& axes) const noexcept {
  MotorSet on;
  for (const auto motor : motors) on.set(motor, isOn(axes[motor].status()));
  return on;
}

MotorSet MotorGroup::missing(const std::vector<Axis>& axes) const noexcept {
  MotorSet missing;
  for (const auto motor : motors) {
    const auto status = axes[motor].status();
    const bool there = status != MotorStatus::kOffline && status != MotorStatus::kFault;
    missing.set(motor, !there && required.test(motor));
  }
  return missing;
}

MotorSet MotorGroup::held(const std::vector<Axis>& axes) const noexcept {
  MotorSet held;
  for (const auto motor : motors) held.set(motor, axes[motor].holdsDisabled());
  return held;
}

MotorSet MotorGroup::withoutPlace(const std::vector<Axis>& axes) const noexcept {
  MotorSet without = without_place;
  for (const auto motor : motors) {
    const auto& axis = axes[motor];
    if (axis.status() != MotorStatus::kActive || axis.motor().feedback().zeroed) without.reset(motor);
  }
  return without;
}

bool MotorGroup::waits(const std::vector<Axis>& axes) const noexcept {
  return together && std::any_of(motors.begin(), motors.end(), [&](std::size_t motor) {
           return required.test(motor) && axes[motor].status() != MotorStatus::kActive;
         });
}

// An e-stop stops all of them anyway, and the stop of a group is no reason for another.
void MotorGroup::noteLeaving(std::size_t motor, MotorStatus before, MotorEvent event) noexcept {
  switch (event) {
    case MotorEvent::kDisable:
      left.set(motor);
      disabled.set(motor, required.test(motor));
      disabled_on_request |= required.test(motor);
      break;
    case MotorEvent::kDisableUnasked:
      left.set(motor);
      disabled.set(motor, required.test(motor));
      break;
    case MotorEvent::kEnableFailed: refused.set(motor, required.test(motor)); break;
    case MotorEvent::kFeedbackLost:
    case MotorEvent::kFault: dropped.set(motor, before == MotorStatus::kActive); break;
    default: break;
  }
}

bool MotorGroup::isFirstDisable(std::size_t motor, const Order& order) const noexcept {
  if (!together) return rests_with_it.test(motor);
  return (order.motors & rests_with_it).any() || first_disable == order.id;
}

void MotorGroup::takeDisable(std::size_t motor, const Order& order) noexcept {
  // One request lets go of all motors that move one thing, or of none.
  if (together && (order.motors & rests_with_it).any()) first_disable = order.id;
  rests_with_it.reset(motor);
}

void MotorGroup::forgetLeaving() noexcept {
  dropped.reset();
  disabled.reset();
  disabled_on_request = false;
  refused.reset();
  disable_asked = false;
  lost_place.reset();
  first_disable.reset();
  left.reset();
  let_go.reset();
}

}  // namespace rc10
