// One motor that is enabled alone: for its first spin, nothing else of the robot may move.
#include "daemon/supervision/supervisor.hpp"

namespace rc10 {

MotorSet Supervisor::otherMotorsOn(std::size_t motor) const noexcept {
  MotorSet on;
  for (std::size_t other = 0; other < axes_.size(); ++other)
    on.set(other, other != motor && isOn(axes_[other].status()));
  return on;
}

// From here on enable() refuses every other motor, until transition() sees this one leave ENABLING and
// ACTIVE.
Refusal Supervisor::enableAlone(std::size_t motor, const Tick& tick) noexcept {
  if (otherMotorsOn(motor).any()) return Refusal::kOthersOn;
  alone_ = motor;
  const auto refusal = enable(motor, {}, tick);
  if (!isOn(axes_[motor].status())) alone_.reset();
  if (refusal != Refusal::kNone) return refusal;
  for (auto& group : groups_) group.rearm.reset();  // or it would come back when this one ends
  return Refusal::kNone;
}

}  // namespace rc10
