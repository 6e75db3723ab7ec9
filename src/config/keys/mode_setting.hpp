#pragma once

#include <string>
#include <string_view>

#include "app/target.hpp"

namespace rc10 {

/// Setting that gives a model this mode, as in a motor's line: "control: mit". Empty: no single key does.
[[nodiscard]] std::string settingForMode(std::string_view model, ControlMode mode);

}  // namespace rc10
