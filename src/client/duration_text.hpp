#pragma once

#include <optional>
#include <string_view>

#include "app/time.hpp"

namespace rc10::client {

/// "2s", "500ms", "1.5 s", "2min"; a bare number is seconds. Empty: not a positive duration.
[[nodiscard]] std::optional<Duration> parseDuration(std::string_view text);

}  // namespace rc10::client
