#pragma once

#include <span>
#include <string_view>

#include "motor/drive_faults.hpp"

namespace rc10 {

/// Everything in which one LK-Tech model differs from another.
struct LktechModel {
  std::string_view name;
  double gear_ratio = 1.0;
  double amperes_per_raw = 0.0;        ///< Size of a count in commands and replies.
  float peak_current_a = 0.0F;         ///< At the peak torque.
  float rotor_torque_nm_per_a = 0.0F;  ///< 0: unknown. Times the gear at the output.
};

[[nodiscard]] std::span<const std::string_view> lktechModelNames() noexcept;
/// nullptr if there is no such model.
[[nodiscard]] const LktechModel* findLktechModel(std::string_view name) noexcept;

/// Bits of the error byte of the reply to 0x9A, the most serious first.
[[nodiscard]] std::span<const DriveFault> lktechFaults() noexcept;

}  // namespace rc10
