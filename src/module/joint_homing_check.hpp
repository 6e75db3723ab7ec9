#pragma once

#include "module/module_type.hpp"

namespace rc10 {

/// Combinations of values of a joint with which no end can be found, though each is in its range: the error
/// begins with the key.
[[nodiscard]] Result<void> checkHoming(const OwnValues& own, const RobotOutline::Motor& motor);

}  // namespace rc10
