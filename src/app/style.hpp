#pragma once

#include <string>
#include <string_view>

/// Escape sequences, for terminals with colours only.
namespace rc10::style {

inline constexpr std::string_view kGood = "\x1b[32m";
inline constexpr std::string_view kDoubtful = "\x1b[33m";
inline constexpr std::string_view kBad = "\x1b[1;31m";

/// The text in a style, up to the end of its line; without a style as it is.
[[nodiscard]] inline std::string styled(std::string text, std::string_view style) {
  if (style.empty()) return text;
  const bool line = text.ends_with('\n');
  if (line) text.pop_back();
  text = std::string(style) + text + "\x1b[0m";
  return line ? text + '\n' : text;
}

}  // namespace rc10::style
