#pragma once

#include "motor/motor_family.hpp"

namespace rc10 {

/// M3508, M2006 and GM6020.
[[nodiscard]] const MotorFamily& djiFamily() noexcept;

}  // namespace rc10
