#pragma once

#include "drives/vesc/vesc_model.hpp"
#include "motor/motor_family.hpp"

namespace rc10 {

/// VESC drives.
[[nodiscard]] const MotorFamily& vescFamily() noexcept;

[[nodiscard]] MotorTraits vescTraits(const VescSettings& own);

}  // namespace rc10
