#pragma once

#include "drives/cubemars/cubemars_model.hpp"
#include "motor/motor_family.hpp"

namespace rc10 {

/// The family "CubeMars": AK drives in servo mode, MIT mode, and MIT mode of V3 drives.
[[nodiscard]] const MotorFamily& cubemarsFamily() noexcept;

[[nodiscard]] MotorTraits cubemarsTraits(const CubemarsSettings& own);

}  // namespace rc10
