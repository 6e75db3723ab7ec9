#pragma once

#include "drives/dji/dji_model.hpp"
#include "motor/motor_family.hpp"

namespace rc10 {

/// M3508, M2006 and GM6020.
[[nodiscard]] const MotorFamily& djiFamily() noexcept;

/// The settings of one of them, as DJI_Motor wants them.
[[nodiscard]] DjiMotorConfig djiConfig(const MotorSettings& settings);

}  // namespace rc10
