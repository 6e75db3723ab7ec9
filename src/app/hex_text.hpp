#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rc10 {

/// The last `digits` hexadecimal digits of a number, in capitals, with leading zeros: "07F".
[[nodiscard]] inline std::string hexDigits(std::uint32_t value, unsigned digits) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (unsigned shift = 4 * digits; shift > 0; shift -= 4) text += kDigits[(value >> (shift - 4)) & 0xFU];
  return text;
}

}  // namespace rc10
