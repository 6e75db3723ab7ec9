#pragma once

#include "motor/motor_family.hpp"

namespace rc10 {

/// The MyActuator RMD-X drives, protocol V3 and V4.
[[nodiscard]] const MotorFamily& myactuatorFamily() noexcept;

}  // namespace rc10
