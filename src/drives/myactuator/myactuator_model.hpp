#pragma once

#include <array>
#include <span>
#include <string_view>

#include "motor/drive_faults.hpp"

namespace rc10 {

/// Everything in which one RMD-X model differs from another. At the output of its own gear.
struct MyactuatorModel {
  std::string_view name;
  double gear_ratio = 1.0;
  float peak_current_a = 0.0F;   ///< Peak current of a phase, at the peak torque.
  float torque_nm_per_a = 0.0F;  ///< 0: unknown.
  float rated_rpm = 0.0F;        ///< 0: unknown.
  float nominal_v = 48.0F;
};

[[nodiscard]] std::span<const std::string_view> myactuatorModelNames() noexcept;
/// nullptr if there is no such model.
[[nodiscard]] const MyactuatorModel* findMyactuatorModel(std::string_view name) noexcept;

/// Bits of the error word of the reply to 0x9A, the most serious first; "level 1" needs a restart.
[[nodiscard]] std::span<const DriveFault> myactuatorFaults() noexcept;
/// Whether only a restart of the drive clears all of these.
[[nodiscard]] bool myactuatorNeedsReset(std::uint16_t errors) noexcept;

}  // namespace rc10
