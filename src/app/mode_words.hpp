#pragma once

#include <string>
#include <string_view>

#include "app/target.hpp"

namespace rc10 {

/// "velocity, angle and total_angle"; empty without any.
[[nodiscard]] std::string modeWords(ModeSet modes, std::string_view last_joint = " and ");

}  // namespace rc10
