#include "config/check/drive_ids.hpp"

#include <string_view>

namespace rc10 {

namespace {

std::string hex(std::uint32_t value, unsigned digits) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text = "0x";
  for (unsigned shift = 4 * digits; shift > 0; shift -= 4) text += kDigits[(value >> (shift - 4)) & 0xFU];
  return text;
}

}  // namespace

std::string idText(std::uint32_t id) { return hex(id, 3); }

std::string idText(CanId id) { return id.extended ? hex(id.value, 8) + " (extended)" : hex(id.value, 3); }

}  // namespace rc10
