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
  const auto refusal = enable(motor, tick);
  if (refusal != Refusal::kNone) return refusal;
  alone_ = motor;
  for (auto& group : groups_) group.rearm.reset();  // or it would come back when this one ends
  return Refusal::kNone;
}

MotorSet Supervisor::inTheWay(std::size_t motor, Refusal refusal) const noexcept {
  return refusal == Refusal::kAlone || refusal == Refusal::kOthersOn ? otherMotorsOn(motor) : MotorSet{};
}

}  // namespace rc10
