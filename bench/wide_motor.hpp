#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string>

#include "bus/command_packer.hpp"
#include "drives/dji/dji_motor.hpp"

namespace rc10::bench {

/// An M3508 under a feedback id of its own. DJI's ids end at 11 motors on one bus; a fleet of 32 needs a
/// family that no vendor makes. Decoding and loops are DJI_Motor's, so that figures compare.
class WideMotor : public DJI_Motor {
 public:
  WideMotor(const MotorSettings& settings, CanId feedback_id)
      : DJI_Motor(settings), filters_{FrameFilter{.id = feedback_id, .mask = kStandardIdMask}} {}

  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override {
    return frame.id == filters_[0].id && !frame.fd && frame.type != FrameType::kError;
  }

 private:
  std::array<FrameFilter, 1> filters_;
};

/// Four WideMotors in one frame, laid out as DJI_Group does it.
class WideGroup : public CommandPacker {
 public:
  WideGroup(CanId command_id, std::span<WideMotor* const> motors)
      : ids_{command_id}, name_("wide group " + std::to_string(command_id.value)) {
    std::copy_n(motors.begin(), std::min(motors.size(), slots_.size()), slots_.begin());
  }

  [[nodiscard]] std::string_view packerName() const noexcept override { return name_; }
  [[nodiscard]] std::span<const CanId> commandIds() const noexcept override { return ids_; }

  [[nodiscard]] std::size_t packCommand(const Tick& /*tick*/, std::span<CanFrame> out) noexcept override {
    CanFrame& frame = out.front();
    frame = CanFrame{};
    frame.id = ids_[0];
    frame.length = 8;
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
      if (slots_[slot] == nullptr) continue;
      const auto raw = static_cast<std::uint16_t>(slots_[slot]->rawCommand());
      frame.data[2 * slot] = static_cast<std::uint8_t>(raw >> 8U);
      frame.data[2 * slot + 1] = static_cast<std::uint8_t>(raw & 0xFFU);
    }
    return 1;
  }
  [[nodiscard]] std::size_t packRest(std::span<CanFrame> out) const noexcept override {
    out.front() = CanFrame{};
    out.front().id = ids_[0];
    out.front().length = 8;
    return 1;
  }

 private:
  std::array<CanId, 1> ids_;
  std::string name_;
  std::array<WideMotor*, 4> slots_{};
};

}  // namespace rc10::bench
