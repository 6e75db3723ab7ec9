// Gains that change while the motor runs.
#include <bit>
#include <span>

#include "daemon/supervision/supervisor.hpp"
#include "motor/loop_gain.hpp"

namespace rc10 {

// No lease stops it, as no other request: a person tunes the motor that a program commands. The limits of the
// configuration stay, and the loops take new gains without a bump.
Refusal Supervisor::setGains(std::size_t motor, const Order& order, const Tick& tick) noexcept {
  if (state_ == RobotStatus::kStopping) return Refusal::kStopping;
  auto& axis = axes_[motor];
  const auto* in_force = axis.motor().hostLoops();
  if (in_force == nullptr || order.gains.count > order.gains.values.size()) return Refusal::kNoGains;
  CascadeConfig loops = *in_force;
  const auto changes = std::span(order.gains.values).first(order.gains.count);
  for (const auto& change : changes) {
    if (gainIn(loops, change.gain) == nullptr) return Refusal::kNoGains;
  }
  const std::int32_t volts = axis.motor().commandUnit() == CommandUnit::kVolt ? kGainInVolts : 0;
  for (const auto& change : changes) {
    float& gain = *gainIn(loops, change.gain);
    if (gain == change.value) continue;
    gain = change.value;
    report({EventCode::kGainChanged, Severity::kInfo, static_cast<std::int16_t>(motor),
            static_cast<std::int32_t>(change.gain) + volts, std::bit_cast<std::int32_t>(change.value),
            tick.now, order.client});
  }
  axis.retune(loops);
  return Refusal::kNone;
}

}  // namespace rc10
