#include "daemon/clients/disable_at_end.hpp"

#include <algorithm>

#include "daemon/clients/until_its_end.hpp"
#include "link/until_its_end.hpp"

namespace rc10 {
namespace {

[[nodiscard]] bool isSwitchedOn(const MotorSnapshot& motor) noexcept {
  return motor.status == MotorStatus::kEnabling || motor.status == MotorStatus::kActive;
}

// Off for a loss, of its own or of its group, which may bring it back by itself.
[[nodiscard]] bool mayReturn(const MotorSnapshot& motor) noexcept {
  return motor.stop.cause == StopCause::kSilence || motor.stop.cause == StopCause::kGroup;
}

enum class Now : std::uint8_t { kWait, kDisable, kLeave };

[[nodiscard]] Now whatToDoWith(const MotorSnapshot& motor, const link::Name& client) noexcept {
  if (!motor.owner.view().empty()) return motor.owner.view() == client.view() ? Now::kWait : Now::kLeave;
  switch (motor.acting) {
    case Acting::kNothing:
    case Acting::kDamp: return Now::kDisable;
    case Acting::kTarget:
    case Acting::kRamp: return Now::kWait;
    case Acting::kHold:
    case Acting::kBrake: break;
  }
  return Now::kLeave;
}

}  // namespace

Result<bool> DisableAtEnd::askedBy(const link::Request& request, Operation operation,
                                   const Speaker& speaker) {
  if (operation != Operation::kEnable && operation != Operation::kEnableAlone) return false;
  return isAskedFor({.value = link::kDisableAtEnd,
                     .lasting = "an enable that lasts",
                     .instead = "disable the motor before you end"},
                    request, speaker);
}

void DisableAtEnd::add(const Order& order, std::uint64_t connection) {
  entries_.push_back(
      {.order = order.id, .connection = connection, .client = order.client, .motors = order.motors});
}

void DisableAtEnd::finish(const OrderResult& result, const Snapshot& now) {
  // The scheduler knows them: a snapshot may be older than the order, or show what the order has done.
  auto enabled = result.switched_on;
  for (std::size_t i = 0; i < result.motors.size(); ++i) {
    if (result.refused || result.motors[i] != Refusal::kNone) enabled.reset(i);
  }
  const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& one) {
    return !one.enabled_at && one.order == result.id;
  });
  if (entry == entries_.end()) return;
  entry->motors = enabled;
  entry->enabled_at = now.tick;
}

std::optional<Order> DisableAtEnd::due(const Snapshot& now,
                                       const std::function<bool(std::uint64_t)>& is_open) {
  Order order{
      .id = Order::kOfLinkThread, .operation = Operation::kDisable, .motors = {}, .asked = Asked::kUnasked};
  for (auto& entry : entries_) {
    // The snapshot may be of the tick before the result.
    if (!entry.enabled_at || now.tick < *entry.enabled_at + 2) continue;
    const bool ended = !is_open(entry.connection);
    MotorSet due;
    for (std::size_t i = 0; i < now.motor_count; ++i) {
      if (!entry.motors.test(i)) continue;
      const auto& motor = now.motors[i];
      const bool off = !isSwitchedOn(motor);
      // The disable of one that is off lets go of nothing, and ends the return of its group.
      const auto what = !ended ? Now::kWait : off ? Now::kDisable : whatToDoWith(motor, entry.client);
      // Off for another reason, it is nobody's: what enables it next is another request.
      const bool another_has = motor.enabled_by != entry.order;
      if (another_has || (off && !mayReturn(motor)) || what == Now::kLeave) {
        entry.motors.reset(i);
      } else if (what == Now::kDisable) {
        due.set(i);
      }
    }
    if (due.none() || order.motors.any()) continue;
    order.motors = due;
    order.client = entry.client;
  }
  std::erase_if(entries_, [](const Entry& entry) { return entry.enabled_at && entry.motors.none(); });
  return order.motors.any() ? std::optional{order} : std::nullopt;
}

void DisableAtEnd::taken(const Order& order) {
  for (auto& entry : entries_) entry.motors &= ~order.motors;
}

}  // namespace rc10
