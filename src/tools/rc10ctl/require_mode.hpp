#pragma once

#include <cstdint>

#include "app/result.hpp"
#include "link/link_protocol.hpp"

namespace rc10::ctl {

/// Whether the motor has the mode; the error lists those that it has, and says how it gets this one.
[[nodiscard]] Result<void> requireMode(const link::MotorInfo& motor, ControlMode mode);

}  // namespace rc10::ctl
