#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "drives/odrive/odrive_frames.hpp"
#include "motor/drive_faults.hpp"

namespace rc10 {

/// Messages 0x03 to 0x06, 0x15, 0x19, 0x1C, 0x1D and the error bits differ between them.
enum class OdriveFirmware : std::uint8_t { k05, k06 };

struct OdriveModel {
  std::string_view name;
  OdriveFirmware firmware;
  float peak_current_a;
};

[[nodiscard]] std::span<const std::string_view> odriveModelNames() noexcept;
/// Null: no such model.
[[nodiscard]] const OdriveModel* findOdriveModel(std::string_view name) noexcept;

/// Bits of the heartbeat's axis error. The most telling first: where several bits are set, the first of this
/// table is the fault.
[[nodiscard]] std::span<const DriveFault> odriveFaults(OdriveFirmware firmware) noexcept;

/// All that a heartbeat says is wrong, as bits of the axis error.
[[nodiscard]] std::uint32_t odriveErrors(OdriveFirmware firmware,
                                         const odrive::Heartbeat& heartbeat) noexcept;

/// The drive is still starting: it was switched on or restarted a moment ago.
[[nodiscard]] bool odriveStarting(OdriveFirmware firmware, const odrive::Heartbeat& heartbeat) noexcept;

}  // namespace rc10
