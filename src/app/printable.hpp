#pragma once

#include <string>
#include <string_view>

namespace rc10 {

/// Text of a stranger for a terminal, a log or a message: '?' stands for each control character, each sign
/// that changes the direction of writing, and each byte that is no UTF-8. One line stays one line.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace rc10
