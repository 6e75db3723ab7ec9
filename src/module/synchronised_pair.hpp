#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// Two motors that move one thing, left and right of a lift: one target for both, and a correction that keeps
/// them together. Comes to rest when they have come apart.
[[nodiscard]] const ModuleType& synchronisedPairType() noexcept;

}  // namespace rc10
