#pragma once

#include "motor/motor_family.hpp"

namespace rc10 {

/// The LK-Tech MF, MHF and MG drives, protocol V2.35.
[[nodiscard]] const MotorFamily& lktechFamily() noexcept;

}  // namespace rc10
