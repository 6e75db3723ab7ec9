#pragma once

#include <string>
#include <string_view>

#include "drives/wording.hpp"

namespace rc10 {

/// See Wording.
[[nodiscard]] std::string wordCubemars(const CanFrame& frame, std::string_view model, bool sent);

}  // namespace rc10
