#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// Yaw and pitch that look in one direction of the world, whatever the chassis does; or of the chassis, while
/// no inertial sensor is heard.
[[nodiscard]] const ModuleType& gimbalType() noexcept;

}  // namespace rc10
