#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "app/result.hpp"

namespace rc10::client {

/// Letters and digits of a token: of rc10-web's pages on other computers, or of an entry of `clients`.
inline constexpr std::size_t kPageTokenLength = 32;

/// Without --token-file: <runDir>/web-token.
[[nodiscard]] std::string pageTokenPath();

/// 160 random bits as letters and digits.
[[nodiscard]] Result<std::string> makePageToken();

/// None: there is no such file. The error names the remedy; others than the owner may not read the file.
[[nodiscard]] Result<std::optional<std::string>> readPageToken(const std::string& path);

}  // namespace rc10::client
