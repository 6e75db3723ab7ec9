// Requests that write to a drive's own memory.
#include "daemon/supervision/supervisor.hpp"
#include "motor/drive_configuring.hpp"

namespace rc10 {
namespace {

// Eight settings, each written five times, and stored three times.
constexpr Duration kConfigureTimeout = std::chrono::seconds{8};

}  // namespace

Refusal Supervisor::mayConfigure(std::size_t motor) const noexcept {
  if (state_ == RobotStatus::kStopping) return Refusal::kStopping;
  if (configuring_) return Refusal::kConfiguring;
  switch (axes_[motor].status()) {
    case MotorStatus::kOffline: return Refusal::kOffline;
    case MotorStatus::kEnabling:
    case MotorStatus::kActive: return Refusal::kActive;
    case MotorStatus::kReady:
    case MotorStatus::kFault: break;
  }
  if (axes_[motor].fallbackActs()) return Refusal::kStillActs;
  return relyOn(motor).any() ? Refusal::kOthersOn : Refusal::kNone;
}

// It may be silent while it stores: a loss that its group would stop for is not seen then.
MotorSet Supervisor::relyOn(std::size_t motor) const noexcept {
  const auto* group = groupOf(motor);
  const bool needed = group != nullptr && group->required.test(motor);
  return needed ? group->on(axes_) | group->held(axes_) : MotorSet{};
}

void Supervisor::configure(const Order& order, const Tick& tick) noexcept {
  OrderResult result;
  result.id = order.id;
  std::size_t motor = 0;
  while (motor < axes_.size() && !order.motors.test(motor)) ++motor;
  auto* drive = motor < axes_.size() ? axes_[motor].motor().driveConfiguring() : nullptr;
  if (drive == nullptr || order.drive.count > DriveWrite::kMaxValues) {
    result.refused = true;
    link_.results.push(result);
    return;
  }
  result.motors[motor] = mayConfigure(motor);
  if (result.motors[motor] != Refusal::kNone) {
    if (result.motors[motor] == Refusal::kOthersOn) result.in_the_way = relyOn(motor);
    link_.results.push(result);
    return;
  }
  drive->begin(order.drive);
  configuring_ = Configuring{order.id, motor, tick.now + kConfigureTimeout};
}

void Supervisor::watchConfiguring(const Tick& tick) noexcept {
  using Progress = DriveConfiguring::Progress;
  if (!configuring_) return;
  const auto motor = configuring_->motor;
  auto& drive = *axes_[motor].motor().driveConfiguring();
  OrderResult result;
  result.id = configuring_->order_id;
  result.drive_value = drive.index();
  switch (drive.progress()) {
    case Progress::kDone: break;
    case Progress::kNotSaved: result.motors[motor] = Refusal::kNotSaved; break;
    case Progress::kPending:
      if (tick.now < configuring_->deadline) return;
      drive.cancel();
      [[fallthrough]];
    case Progress::kNone:
    case Progress::kNotConfirmed: result.motors[motor] = Refusal::kNotConfirmed; break;
  }
  configuring_.reset();
  link_.results.push(result);
}

}  // namespace rc10
