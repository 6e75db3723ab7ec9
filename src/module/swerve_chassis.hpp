#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// Four steered and driven wheels: drives in every direction.
[[nodiscard]] const ModuleType& swerveChassisType() noexcept;

}  // namespace rc10
