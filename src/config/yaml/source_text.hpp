#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "config/yaml/problem.hpp"

namespace rc10 {

inline constexpr std::size_t kMaxConfigBytes = std::size_t{1} << 20U;

/// The bytes of a configuration file; nothing, and an error, if it cannot be read or is too large.
[[nodiscard]] std::optional<std::string> readSource(const std::string& path, Problems& problems);

/// Whether the text is UTF-8 without control characters and not too large; reports the first byte that
/// is not.
[[nodiscard]] bool checkSource(std::string_view text, Problems& problems);

}  // namespace rc10
