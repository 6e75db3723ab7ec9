// A scan of one bus, which gives way to everything else.
#include "daemon/supervision/supervisor.hpp"

namespace rc10 {

Refusal Supervisor::againstScan(std::size_t motor) const noexcept {
  const auto& axis = axes_[motor];
  if (isOn(axis.status())) return Refusal::kActive;
  if (axis.status() == MotorStatus::kFault) return Refusal::kFaulted;
  if (configuring_ && configuring_->motor == motor) return Refusal::kConfiguring;
  return axis.fallbackActs() ? Refusal::kStillActs : Refusal::kNone;
}

// Motors of its bus, and reasons that are no motor's.
bool Supervisor::mayGoOn(const BusScanOrder& scan, OrderResult& result) const noexcept {
  if (state_ == RobotStatus::kStopping) result.scan = Refusal::kStopping;
  if (robot_.buses()[scan.bus].held) result.scan = Refusal::kBusHeld;
  bool may = result.scan == Refusal::kNone;
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    if (robot_.motors()[motor].bus != scan.bus) continue;
    result.motors[motor] = againstScan(motor);
    may = may && result.motors[motor] == Refusal::kNone;
  }
  return may;
}

void Supervisor::scan(const Order& order, const Tick& tick) noexcept {
  OrderResult result;
  result.id = order.id;
  result.refused = true;
  if (order.scan.bus >= robot_.buses().size() || scan_.runs()) {
    result.scan = Refusal::kScanning;
    return answer(result);
  }
  bool may = mayGoOn(order.scan, result);
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    if (robot_.motors()[motor].bus != order.scan.bus || result.motors[motor] != Refusal::kNone) continue;
    result.motors[motor] = axes_[motor].motionRefusal(tick);
    may = may && result.motors[motor] == Refusal::kNone;
  }
  if (!may) return answer(result);
  scan_.begin(order, robot_.buses()[order.scan.bus].bus->health().errorFrames(), tick);
}

void Supervisor::watchScan(const Tick& tick) noexcept {
  if (!scan_.runs()) return;
  OrderResult result;
  result.id = scan_.id();
  if (mayGoOn(scan_.order(), result)) {
    switch (scan_.advance(tick)) {
      case BusScan::Progress::kPending: return;
      case BusScan::Progress::kDone: break;
      case BusScan::Progress::kNotJudged: result.scan = Refusal::kTooBusy; break;
      case BusScan::Progress::kGivenUp: result.scan = Refusal::kClientGone; break;
    }
  }
  const auto error_frames = robot_.buses()[scan_.order().bus].bus->health().errorFrames();
  result.error_frames = error_frames - scan_.errorFramesBefore();
  result.asked = scan_.asked();
  scan_.end();
  answer(result);
}

void Supervisor::askOfScan(const Tick& tick) noexcept {
  const auto* question = scan_.due(tick);
  if (question == nullptr) return;
  auto& bus = *robot_.buses()[scan_.order().bus].bus;
  if (bus.hasRoom() && bus.sendFrame(*question)) scan_.tookQuestion(tick);
}

}  // namespace rc10
