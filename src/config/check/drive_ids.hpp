#pragma once

#include <cstdint>
#include <string>

#include "bus/can_frame.hpp"
#include "drives/dji/dji_motor.hpp"

namespace rc10 {

/// The ids that a configured drive uses on its bus, before a DJI_Motor is made of it.
[[nodiscard]] inline std::uint32_t feedbackId(const DjiModel& model, int id) noexcept {
  return model.feedback_id_base + static_cast<std::uint32_t>(id);
}
[[nodiscard]] inline std::uint32_t commandId(const DjiModel& model, DjiCommand command, int id) noexcept {
  return model.command(command).command_ids[id > 4 ? 1 : 0];
}
[[nodiscard]] inline std::uint32_t feedbackId(const DjiMotorConfig& motor) noexcept {
  return feedbackId(*motor.model, motor.id);
}
[[nodiscard]] inline std::uint32_t commandId(const DjiMotorConfig& motor) noexcept {
  return commandId(*motor.model, motor.command, motor.id);
}
[[nodiscard]] inline int commandSlot(const DjiMotorConfig& motor) noexcept { return (motor.id - 1) % 4; }

/// C620 and C610 read one set of frames, GM6020 another: they never share a command frame.
[[nodiscard]] inline bool isGM6020(const DjiModel& model) noexcept { return &model == &kGM6020; }

/// "0x1FF"
[[nodiscard]] std::string idText(std::uint32_t id);
/// "0x1FF", or "0x00000901 (extended)".
[[nodiscard]] std::string idText(CanId id);

}  // namespace rc10
