#pragma once

#include <cstdint>

#include "app/fault_code.hpp"

namespace rc10 {

/// Fault that a drive reports.
struct DriveComplaint {
  FaultCode fault = FaultCode::kNone;
  std::uint32_t native_code = 0;  ///< As the drive sent it.
};

}  // namespace rc10
