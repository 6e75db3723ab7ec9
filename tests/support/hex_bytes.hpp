#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rc10::test {

/// From "0F AD A0" or "0FADA0".
inline std::vector<std::uint8_t> hexBytes(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += text[i] == ' ' ? 1U : 2U) {
    if (text[i] != ' ')
      bytes.push_back(static_cast<std::uint8_t>(std::stoul(std::string(text.substr(i, 2)), nullptr, 16)));
  }
  return bytes;
}

}  // namespace rc10::test
