#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// `gpio`: switches and valves on lines of a GPIO chip.
[[nodiscard]] const ModuleType& gpioModuleType() noexcept;

}  // namespace rc10
