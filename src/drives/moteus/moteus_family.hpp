#pragma once

#include "motor/motor_family.hpp"

namespace rc10 {

/// moteus drives, by their register protocol on CAN FD.
[[nodiscard]] const MotorFamily& moteusFamily() noexcept;

}  // namespace rc10
