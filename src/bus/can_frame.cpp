#include "bus/can_frame.hpp"

#include <algorithm>
#include <cstdio>

namespace rc10 {

std::string describe(CanId id) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), id.extended ? "extended id 0x%08X" : "standard id 0x%03X",
                static_cast<unsigned>(id.value));
  return text.data();
}

CanFrame makeClassicFrame(CanId id, std::span<const std::uint8_t> payload) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(std::min<std::size_t>(payload.size(), 8));
  std::copy_n(payload.begin(), frame.length, frame.data.begin());
  return frame;
}

CanFrame makeFdFrame(CanId id, std::span<const std::uint8_t> payload, bool bit_rate_switch,
                     std::uint8_t padding) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.fd = true;
  frame.bit_rate_switch = bit_rate_switch;
  frame.length = roundUpFdLength(payload.size());
  const std::size_t used = std::min<std::size_t>(payload.size(), frame.length);
  std::copy_n(payload.begin(), used, frame.data.begin());
  std::fill(frame.data.begin() + used, frame.data.begin() + frame.length, padding);
  return frame;
}

}  // namespace rc10
