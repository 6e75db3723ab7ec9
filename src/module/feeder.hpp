#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// Pushes balls or discs forward, continuously or a number of them. When it is jammed it goes back a little
/// and tries again, a few times; then it gives up until nobody asks any more.
[[nodiscard]] const ModuleType& feederType() noexcept;

}  // namespace rc10
