#pragma once

#include <string_view>

namespace rc10 {

/// A configuration to begin with: one simulated motor, and in comments the lines of a real one.
[[nodiscard]] std::string_view configTemplate() noexcept;

}  // namespace rc10
