#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace rc10 {

// Numbers in payloads. `at` + sizeof(T) within the span is the caller's duty: lengths are checked before.

/// Least significant byte first. T: an integer, or a float as IEEE 754.
template <typename T>
[[nodiscard]] inline T readLittleEndian(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  if constexpr (std::is_floating_point_v<T>) {
    static_assert(sizeof(T) == 4);
    const auto bits = readLittleEndian<std::uint32_t>(bytes, at);
    T value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  } else {
    std::make_unsigned_t<T> value = 0;
    for (std::size_t i = sizeof(T); i-- > 0;) {
      value = static_cast<std::make_unsigned_t<T>>(static_cast<std::uint64_t>(value) << 8U | bytes[at + i]);
    }
    return static_cast<T>(value);
  }
}

/// Most significant byte first.
template <typename T>
[[nodiscard]] inline T readBigEndian(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  static_assert(std::is_integral_v<T>);
  std::make_unsigned_t<T> value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value = static_cast<std::make_unsigned_t<T>>(static_cast<std::uint64_t>(value) << 8U | bytes[at + i]);
  }
  return static_cast<T>(value);
}

template <typename T>
inline void writeLittleEndian(std::span<std::uint8_t> bytes, std::size_t at, T value) noexcept {
  if constexpr (std::is_floating_point_v<T>) {
    static_assert(sizeof(T) == 4);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    writeLittleEndian(bytes, at, bits);
  } else {
    const auto bits = static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<T>>(value));
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes[at + i] = static_cast<std::uint8_t>(bits >> (8 * i));
  }
}

template <typename T>
inline void writeBigEndian(std::span<std::uint8_t> bytes, std::size_t at, T value) noexcept {
  static_assert(std::is_integral_v<T>);
  const auto bits = static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<T>>(value));
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes[at + i] = static_cast<std::uint8_t>(bits >> (8 * (sizeof(T) - 1 - i)));
  }
}

}  // namespace rc10
