#include "config/check/drive_ids.hpp"

#include "app/hex_text.hpp"

namespace rc10 {

std::string idText(std::uint32_t id) { return "0x" + hexDigits(id, 3); }

std::string idText(CanId id) {
  return id.extended ? "0x" + hexDigits(id.value, 8) + " (extended)" : idText(id.value);
}

}  // namespace rc10
