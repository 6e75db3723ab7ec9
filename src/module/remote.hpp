#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// The remote control of the driver: its channels become inputs of other modules, and one switch enables the
/// robot.
[[nodiscard]] const ModuleType& remoteType() noexcept;

}  // namespace rc10
