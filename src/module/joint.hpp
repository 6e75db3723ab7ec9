#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// One axis that moves between positions: finds its reference at a stop or a switch, moves on a profile
/// within its limits, and says whether a move is done, or why it is not.
[[nodiscard]] const ModuleType& jointType() noexcept;

}  // namespace rc10
