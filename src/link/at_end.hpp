#pragma once

#include <string_view>

namespace rc10::link {

/// Value of `disable`: it comes of itself as its client ends, and what is held or braked already stays so.
inline constexpr std::string_view kAtEnd = "at_end";

}  // namespace rc10::link
