#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// A TFmini rangefinder on a serial port.
[[nodiscard]] const ModuleType& rangefinderType() noexcept;

}  // namespace rc10
