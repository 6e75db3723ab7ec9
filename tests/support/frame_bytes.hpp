#pragma once

#include <cstdint>
#include <string>

#include "bus/can_frame.hpp"

namespace rc10::test {

/// A classic standard frame from candump text without blanks: "241#9A320001E5010400".
inline CanFrame frameOf(const std::string& text) {
  CanFrame frame;
  const auto hash = text.find('#');
  frame.id.value = static_cast<std::uint32_t>(std::stoul(text.substr(0, hash), nullptr, 16));
  frame.length = static_cast<std::uint8_t>((text.size() - hash - 1) / 2);
  for (std::size_t i = 0; i < frame.length; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(std::stoul(text.substr(hash + 1 + 2 * i, 2), nullptr, 16));
  }
  return frame;
}

/// The other way round.
inline std::string textOf(const CanFrame& frame) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string text;
  for (int shift = 8; shift >= 0; shift -= 4) text += kDigits[frame.id.value >> shift & 0xFU];
  text += '#';
  for (const std::uint8_t byte : frame.payload()) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xFU];
  }
  return text;
}

}  // namespace rc10::test
