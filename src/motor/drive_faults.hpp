#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "motor/fault_code.hpp"

namespace rc10 {

/// Row of a family's table of native codes, or of bits of its error word.
struct DriveFault {
  std::uint32_t native = 0;
  FaultCode fault = FaultCode::kNone;
  std::string_view words{};
  bool needs_restart = false;  ///< The drive does not recover before.
};

/// Meaning of an error word: the first row of which it has a bit, so the most serious stands first in its
/// table. kDriveOther for bits without a row.
[[nodiscard]] constexpr FaultCode faultOfBits(std::span<const DriveFault> table,
                                              std::uint32_t errors) noexcept {
  if (errors == 0) return FaultCode::kNone;
  for (const DriveFault& row : table) {
    if ((errors & row.native) != 0) return row.fault;
  }
  return FaultCode::kDriveOther;
}
[[nodiscard]] constexpr DriveComplaint complaintOfBits(std::span<const DriveFault> table,
                                                       std::uint32_t errors) noexcept {
  return {.fault = faultOfBits(table, errors), .native_code = errors};
}

/// Meaning of a code; kDriveOther for one without a row.
[[nodiscard]] constexpr FaultCode faultOfCode(std::span<const DriveFault> table,
                                              std::uint32_t code) noexcept {
  for (const DriveFault& row : table) {
    if (row.native == code) return row.fault;
  }
  return FaultCode::kDriveOther;
}

}  // namespace rc10
