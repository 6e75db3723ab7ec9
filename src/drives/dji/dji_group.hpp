#pragma once

#include <array>
#include <string>

#include "app/result.hpp"
#include "bus/command_packer.hpp"
#include "drives/dji/dji_frames.hpp"
#include "drives/dji/dji_motor.hpp"

namespace rc10 {

/// Packs up to four DJI motors into the one frame that their command id shares. Never computes.
/// A slot without a motor is zero; so is the slot of a member that is at rest.
class DJI_Group : public CommandPacker {
 public:
  /// One of 0x200, 0x1FF, 0x2FF, 0x1FE, 0x2FE.
  explicit DJI_Group(CanId command_id);

  /// Adds a motor that outlives the group. Refused, naming both, if its slot is taken, if its
  /// command id is not this group's, or if C6xx and GM6020 would share the frame.
  [[nodiscard]] Result<void> registerMotor(DJI_Motor& motor);

  [[nodiscard]] std::string_view packerName() const noexcept override { return name_; }
  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return ids_; }
  [[nodiscard]] std::size_t packCommand(const Tick& tick, std::span<CanFrame> out) noexcept override;
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override;

 private:
  std::array<CanId, 1> ids_;
  std::string name_;
  std::array<DJI_Motor*, dji::kGroupSize> slots_{};
};

}  // namespace rc10
