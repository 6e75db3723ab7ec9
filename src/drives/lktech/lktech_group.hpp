#pragma once

#include <array>
#include <string>

#include "app/result.hpp"
#include "bus/command_packer.hpp"
#include "drives/lktech/lktech_motor.hpp"

namespace rc10 {

/// Packs the currents of LK-Tech drives with the ids 1 to 4 into the one frame 0x280. Never computes. A slot
/// without a motor is zero; so is the slot of a member that is at rest. Each member answers on an id of its
/// own.
class LKTech_Group final : public CommandPacker {
 public:
  LKTech_Group() = default;

  /// Adds a motor that outlives the group. Refused, naming both, if its slot is taken or it has none.
  [[nodiscard]] Result<void> registerMotor(LKTech_Motor& motor);

  [[nodiscard]] std::string_view packerName() const noexcept override { return "LK-Tech group 0x280"; }
  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return ids_; }
  /// Nothing in a tick in which no member is to be told anything.
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;
  void onUnsent() noexcept override;

 private:
  std::array<CanId, 1> ids_{CanId{lktech::kGroupId, false}};
  std::array<LKTech_Motor*, lktech::kGroupSize> slots_{};
};

}  // namespace rc10
