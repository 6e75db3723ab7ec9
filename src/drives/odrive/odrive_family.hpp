#pragma once

#include "motor/motor_family.hpp"

namespace rc10 {

/// ODrive S1, Pro and v3. Constant, usable from any thread.
[[nodiscard]] const MotorFamily& odriveFamily() noexcept;

}  // namespace rc10
