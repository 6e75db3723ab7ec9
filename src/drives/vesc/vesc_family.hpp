#pragma once

#include "motor/motor_family.hpp"

namespace rc10 {

/// VESC drives.
[[nodiscard]] const MotorFamily& vescFamily() noexcept;

}  // namespace rc10
