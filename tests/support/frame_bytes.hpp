#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "bus/byte_order.hpp"
#include "bus/can_frame.hpp"
#include "support/hex_bytes.hpp"

namespace rc10::test {

/// A classic frame with these bytes: "9A320001E5010400".
inline CanFrame frameOf(CanId id, std::string_view hex) {
  CanFrame frame;
  frame.id = id;
  const auto bytes = hexBytes(hex);
  frame.length = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  return frame;
}

/// A classic frame from candump text without blanks: "241#9A320001E5010400"; more than three digits of the id
/// are an extended one.
inline CanFrame frameOf(const std::string& text) {
  const auto hash = text.find('#');
  const auto id = static_cast<std::uint32_t>(std::stoul(text.substr(0, hash), nullptr, 16));
  return frameOf(CanId{id, hash > 3}, std::string_view(text).substr(hash + 1));
}

/// A frame with a little-endian number from that byte on.
template <class Number>
CanFrame frameOf(const std::string& text, std::size_t at, Number number) {
  CanFrame frame = frameOf(text);
  writeLittleEndian(frame.data, at, number);
  return frame;
}

/// The other way round, of a standard frame.
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
