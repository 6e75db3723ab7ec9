#include "module/serial_link_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/saturated.hpp"
#include "bus/byte_order.hpp"

namespace rc10 {
namespace {

template <typename Int>
[[nodiscard]] double readInt(std::span<const std::uint8_t> bytes) noexcept {
  return static_cast<double>(readLittleEndian<Int>(bytes, 0));
}

template <typename Int>
void writeInt(double value, std::span<std::uint8_t> bytes) noexcept {
  writeLittleEndian(bytes, 0, saturatedRound<Int>(value));
}

}  // namespace

WireRange wireRange(WireType type) noexcept {
  const auto of = []<typename T>(T) {
    return WireRange{static_cast<double>(std::numeric_limits<T>::lowest()),
                     static_cast<double>(std::numeric_limits<T>::max())};
  };
  switch (type) {
    case WireType::kU8: return of(std::uint8_t{});
    case WireType::kI8: return of(std::int8_t{});
    case WireType::kU16: return of(std::uint16_t{});
    case WireType::kI16: return of(std::int16_t{});
    case WireType::kU32: return of(std::uint32_t{});
    case WireType::kI32: return of(std::int32_t{});
    case WireType::kF32: break;
  }
  return of(float{});
}

double readWire(WireType type, std::span<const std::uint8_t> bytes) noexcept {
  switch (type) {
    case WireType::kU8: return readInt<std::uint8_t>(bytes);
    case WireType::kI8: return readInt<std::int8_t>(bytes);
    case WireType::kU16: return readInt<std::uint16_t>(bytes);
    case WireType::kI16: return readInt<std::int16_t>(bytes);
    case WireType::kU32: return readInt<std::uint32_t>(bytes);
    case WireType::kI32: return readInt<std::int32_t>(bytes);
    case WireType::kF32: return static_cast<double>(readLittleEndian<float>(bytes, 0));
  }
  return 0.0;
}

void writeWire(WireType type, double value, std::span<std::uint8_t> bytes) noexcept {
  if (!std::isfinite(value)) value = 0.0;
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  switch (type) {
    case WireType::kU8: writeInt<std::uint8_t>(value, bytes); break;
    case WireType::kI8: writeInt<std::int8_t>(value, bytes); break;
    case WireType::kU16: writeInt<std::uint16_t>(value, bytes); break;
    case WireType::kI16: writeInt<std::int16_t>(value, bytes); break;
    case WireType::kU32: writeInt<std::uint32_t>(value, bytes); break;
    case WireType::kI32: writeInt<std::int32_t>(value, bytes); break;
    case WireType::kF32:
      writeLittleEndian(bytes, 0, static_cast<float>(std::clamp(value, -kMost, kMost)));
      break;
  }
}

}  // namespace rc10
