#pragma once

#include <string>
#include <string_view>

namespace rc10 {

/// SHA-256 in lower-case hexadecimal digits, as sha256sum prints it.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace rc10
