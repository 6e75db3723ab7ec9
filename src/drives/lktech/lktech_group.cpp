#include "drives/lktech/lktech_group.hpp"

#include <algorithm>

namespace rc10 {
Result<void> LKTech_Group::registerMotor(LKTech_Motor& motor) {
  const std::string who = std::string{packerName()} + " refuses " + describe(motor, motor.driveId()) + ": ";
  if (motor.driveId() < 1 || motor.driveId() > lktech::kGroupSize) {
    return fail(who + "its frame has room for the ids 1 to 4 only; give it one of them, or group: false");
  }
  if (!motor.grouped()) return fail(who + "it sends its currents itself");
  LKTech_Motor*& slot = slots_[static_cast<std::size_t>(motor.driveId() - 1)];
  if (slot == &motor) return fail(who + "it is registered already");
  if (slot != nullptr) return fail(who + "its slot belongs to " + describe(*slot, slot->driveId()));
  slot = &motor;
  return {};
}

std::size_t LKTech_Group::packCommand(const Tick& /*tick*/, std::span<CanFrame> out) noexcept {
  const bool due = std::any_of(slots_.begin(), slots_.end(),
                               [](const auto* motor) { return motor != nullptr && motor->isDue(); });
  if (out.empty() || !due) return 0;
  std::array<int, lktech::kGroupSize> raw{};
  for (std::size_t slot = 0; slot < raw.size(); ++slot) {
    if (slots_[slot] != nullptr) raw[slot] = slots_[slot]->rawCurrent();
  }
  out.front() = lktech::groupCommand(raw);
  return 1;
}

void LKTech_Group::onUnsent() noexcept {
  for (auto* motor : slots_)
    if (motor != nullptr) motor->onUnsent();
}

std::size_t LKTech_Group::packRest(std::span<CanFrame> out) const noexcept {
  const bool any =
      std::any_of(slots_.begin(), slots_.end(), [](const auto* motor) { return motor != nullptr; });
  if (out.empty() || !any) return 0;
  out.front() = lktech::groupCommand({});
  return 1;
}

}  // namespace rc10
