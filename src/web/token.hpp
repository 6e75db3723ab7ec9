#pragma once

#include <string>

#include "app/result.hpp"

namespace rc10::web {

/// The token of this robot's pages on other computers: read from the file, or drawn and written to it for its
/// owner alone (mode 0600). 160 random bits as 32 letters and digits.
[[nodiscard]] Result<std::string> readOrMakeToken(const std::string& path);

}  // namespace rc10::web
