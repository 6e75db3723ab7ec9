#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// An inertial sensor on a serial port, or one whose values another program gives.
[[nodiscard]] const ModuleType& imuType() noexcept;

}  // namespace rc10
