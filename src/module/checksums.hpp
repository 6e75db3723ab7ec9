#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace rc10 {

/// CRC-16/MODBUS: polynomial 0x8005 reflected, start 0xFFFF. Sent low byte first.
[[nodiscard]] constexpr std::uint16_t crc16Modbus(std::span<const std::uint8_t> bytes) noexcept {
  constexpr auto kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      auto crc = static_cast<unsigned>(i);
      for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1U ^ 0xA001U : crc >> 1U;
      table[i] = static_cast<std::uint16_t>(crc);
    }
    return table;
  }();
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) crc = crc >> 8U ^ kTable[(crc ^ byte) & 0xFFU];
  return static_cast<std::uint16_t>(crc);
}

/// CRC-16/XMODEM: polynomial 0x1021, start 0. `crc` goes on from bytes that came before.
[[nodiscard]] constexpr std::uint16_t crc16Xmodem(std::span<const std::uint8_t> bytes,
                                                  std::uint16_t crc = 0) noexcept {
  constexpr auto kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      auto remainder = static_cast<unsigned>(i << 8U);
      for (int bit = 0; bit < 8; ++bit) {
        remainder = (remainder & 0x8000U) != 0 ? remainder << 1U ^ 0x1021U : remainder << 1U;
      }
      table[i] = static_cast<std::uint16_t>(remainder);
    }
    return table;
  }();
  unsigned value = crc;
  for (const std::uint8_t byte : bytes) {
    value = (value << 8U ^ kTable[(value >> 8U ^ byte) & 0xFFU]) & 0xFFFFU;
  }
  return static_cast<std::uint16_t>(value);
}

/// The sum of the bytes, modulo 256.
[[nodiscard]] constexpr std::uint8_t sum8(std::span<const std::uint8_t> bytes) noexcept {
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  return static_cast<std::uint8_t>(sum);
}

}  // namespace rc10
