#include "drives/dji/dji_group.hpp"

#include <algorithm>

#include "app/hex_text.hpp"

namespace rc10 {
namespace {

constexpr std::array<std::uint32_t, 5> kCommandIds{0x200, 0x1FF, 0x2FF, 0x1FE, 0x2FE};

/// C620 and C610 drives share a protocol; GM6020 has one of its own.
bool isGM6020(const DJI_Motor& motor) noexcept { return motor.model().absolute_output; }

}  // namespace

DJI_Group::DJI_Group(CanId command_id)
    : ids_{command_id}, name_("DJI group 0x" + hexDigits(command_id.value, 3)) {}

Result<void> DJI_Group::registerMotor(DJI_Motor& motor) {
  const CanId id = ids_[0];
  const std::string who = name_ + " refuses " + describe(motor, motor.driveId()) + ": ";
  if (id.extended || std::find(kCommandIds.begin(), kCommandIds.end(), id.value) == kCommandIds.end()) {
    return fail(who + "no DJI drive listens to this id; they do to 0x200, 0x1FF, 0x2FF, 0x1FE and 0x2FE");
  }
  if (motor.commandId() != id) return fail(who + "it listens to 0x" + hexDigits(motor.commandId().value, 3));
  for (const DJI_Motor* member : slots_) {
    if (member == nullptr) continue;
    if (member == &motor) return fail(who + "it is registered already");
    if (isGM6020(*member) != isGM6020(motor)) {
      return fail(
          who + "it would share the frame with " + describe(*member, member->driveId()) +
          ", but one frame carries either currents for C620 and C610 or voltages for GM6020; give the "
          "GM6020 an id of 5-7, or command: current");
    }
  }
  DJI_Motor*& slot = slots_[static_cast<std::size_t>(motor.slot())];
  if (slot != nullptr) return fail(who + "its slot belongs to " + describe(*slot, slot->driveId()));
  slot = &motor;
  return {};
}

std::size_t DJI_Group::packCommand(const Tick& /*tick*/, std::span<CanFrame> out) noexcept {
  if (out.empty()) return 0;
  std::array<std::int16_t, dji::kGroupSize> raw{};
  bool any = false;
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    if (slots_[slot] == nullptr) continue;
    any = true;
    raw[slot] = slots_[slot]->rawCommand();
  }
  dji::writeGroupCommand(ids_[0], raw, out.front());
  return any ? 1 : 0;
}

std::size_t DJI_Group::packRest(std::span<CanFrame> out) const noexcept {
  const bool any =
      std::any_of(slots_.begin(), slots_.end(), [](const auto* motor) { return motor != nullptr; });
  if (out.empty() || !any) return 0;
  out.front() = CanFrame{};
  dji::writeGroupCommand(ids_[0], {}, out.front());
  return 1;
}

}  // namespace rc10
