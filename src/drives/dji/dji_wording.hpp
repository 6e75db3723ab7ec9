#pragma once

#include <string>
#include <string_view>

#include "drives/wording.hpp"

namespace rc10 {

/// See Wording.
[[nodiscard]] std::string wordDji(const CanFrame& frame, std::string_view model, bool sent);

}  // namespace rc10
