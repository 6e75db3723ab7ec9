#pragma once

#include <string>
#include <string_view>

namespace rc10::web {

/// A robot's file for somebody who may look.
struct ShownConfig {
  std::string text;
  int hidden = 0;   ///< Tokens, or hashes of tokens, in whose place kHiddenWords stand.
  std::string why;  ///< Nothing is shown, and why.
};

/// Stands in the place of a hash, as long as one; rc10d refuses it. The first two zeros are its number.
inline constexpr std::string_view kHiddenWords =
    "hidden-00-write-the-sha256-of-this-token-here-before-rc10d-reads";

/// The file without tokens and their hashes, unless `token` is that of an entry of `clients` that may
/// `configure`.
[[nodiscard]] ShownConfig showConfig(std::string_view text, std::string_view token);

/// Whether a page with this token may have the file replaced: it has no `clients`, or that token's entry may
/// `configure`. `text`: the file that rc10d accepted last.
[[nodiscard]] bool mayReplace(std::string_view text, std::string_view token);

/// The same text for the checker: hashes, of no token, in the place of hidden ones.
[[nodiscard]] std::string withHashes(std::string text);

}  // namespace rc10::web
