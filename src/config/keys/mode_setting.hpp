#pragma once

#include <string>
#include <string_view>

#include "motor/target.hpp"

namespace rc10 {

/// What gives such a model this mode, as a motor's line has it: "control: mit". Empty: no single key does.
[[nodiscard]] std::string settingForMode(std::string_view model, ControlMode mode);

}  // namespace rc10
