#pragma once

#include "module/module_type.hpp"

namespace rc10 {

[[nodiscard]] const ModuleType& mecanumChassisType() noexcept;
[[nodiscard]] const ModuleType& omni3ChassisType() noexcept;
[[nodiscard]] const ModuleType& omni4ChassisType() noexcept;
[[nodiscard]] const ModuleType& differentialChassisType() noexcept;

}  // namespace rc10
