#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "drives/odrive/odrive_frames.hpp"
#include "motor/fault_code.hpp"

namespace rc10 {

/// Messages 0x03 to 0x06, 0x15, 0x19, 0x1C, 0x1D and the error bits differ between them.
enum class OdriveFirmware : std::uint8_t { k05, k06 };

struct OdriveModel {
  std::string_view name;
  OdriveFirmware firmware;
  float peak_current_a;
};

/// One bit of the heartbeat's axis error.
struct OdriveFault {
  std::uint32_t bit;
  FaultCode fault;
  std::string_view words;
};

[[nodiscard]] std::span<const OdriveModel> odriveModels() noexcept;
/// Null: no such model.
[[nodiscard]] const OdriveModel* findOdriveModel(std::string_view name) noexcept;

/// The most telling first: where several bits are set, the first of this table is the fault.
[[nodiscard]] std::span<const OdriveFault> odriveFaults(OdriveFirmware firmware) noexcept;

/// All that a heartbeat says is wrong, as bits of the axis error.
[[nodiscard]] std::uint32_t odriveErrors(OdriveFirmware firmware, const OdriveHeartbeat& heartbeat) noexcept;
[[nodiscard]] DriveComplaint odriveComplaint(OdriveFirmware firmware, std::uint32_t errors) noexcept;

/// The drive is still starting: it was switched on or restarted a moment ago.
[[nodiscard]] bool odriveStarting(OdriveFirmware firmware, const OdriveHeartbeat& heartbeat) noexcept;

}  // namespace rc10
