#include "app/printable.hpp"

#include <cstddef>
#include <cstdint>

namespace rc10 {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t size = 0;  // in bytes; 0: no UTF-8
};

// The first character (RFC 3629: shortest form, no surrogates, up to U+10FFFF).
Character firstOf(std::string_view text) noexcept {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80U) return {lead, 1};
  const std::size_t size = lead >= 0xF0U ? 4 : lead >= 0xE0U ? 3 : 2;
  if (lead < 0xC2U || lead > 0xF4U || text.size() < size) return {};
  std::uint32_t code = lead & (0x7FU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return {};
    code = code << 6U | (byte(i) & 0x3FU);
  }
  const bool shortest = size == 2 || (size == 3 ? code >= 0x800U : code >= 0x10000U);
  const bool surrogate = code >= 0xD800U && code <= 0xDFFFU;
  return shortest && !surrogate && code <= 0x10FFFFU ? Character{code, size} : Character{};
}

bool acts(std::uint32_t code) noexcept {
  const auto within = [code](std::uint32_t first, std::uint32_t last) {
    return code >= first && code <= last;
  };
  return code < 0x20U || within(0x7FU, 0x9FU) ||        // C0, DEL, C1: escape sequences
         within(0x200EU, 0x200FU) || code == 0x61CU ||  // marks of direction
         within(0x2028U, 0x202EU) ||                    // line separators, embeddings, overrides
         within(0x2066U, 0x2069U);                      // isolates
}

}  // namespace

std::string printable(std::string_view text) {
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    const Character next = firstOf(text);
    if (next.size == 0 || acts(next.code)) {
      clean += '?';
    } else {
      clean += text.substr(0, next.size);
    }
    text.remove_prefix(next.size == 0 ? 1 : next.size);
  }
  return clean;
}

}  // namespace rc10
