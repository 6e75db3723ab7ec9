#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/time.hpp"

namespace rc10 {

/// Numbers in the frames of a serial link.
enum class WireType : std::uint8_t { kU8, kI8, kU16, kI16, kU32, kI32, kF32 };
inline constexpr std::array<std::string_view, 7> kWireTypes{"u8", "i8", "u16", "i16", "u32", "i32", "f32"};

[[nodiscard]] constexpr std::size_t bytesOf(WireType type) noexcept {
  constexpr std::array<std::uint8_t, 7> kBytes{1, 1, 2, 2, 4, 4, 4};
  return kBytes[static_cast<std::size_t>(type)];
}

struct WireRange {
  double low;
  double high;
};
[[nodiscard]] WireRange wireRange(WireType type) noexcept;

/// Numbers of a text line: -999999999.9999
inline constexpr double kMostInText = 999'999'999.0;
inline constexpr std::size_t kLongestNumberInText = 15;

/// Reads a number from its bytes, lowest first.
[[nodiscard]] double readWire(WireType type, std::span<const std::uint8_t> bytes) noexcept;
/// Writes it, rounded and cut off at the ends of its type; NaN: 0.
void writeWire(WireType type, double value, std::span<std::uint8_t> bytes) noexcept;

/// One field of a serial link, received or sent, as configured. Only the places of its
/// protocol are used.
struct SerialLinkField {
  std::string name;
  std::string message;    ///< text, cobs: the message that it is part of.
  std::size_t place = 0;  ///< text: from 0.
  std::uint16_t reg = 0;  ///< modbus: its first register.
  bool input_register = false;
  WireType type = WireType::kF32;
  double scale = 1.0;  ///< Value of the signal for 1 on the wire.
};

/// Received fields with their latest values.
struct ReceivedFields {
  struct Reading {
    double value = 0.0;
    std::optional<MonotonicTime> received;
  };
  explicit ReceivedFields(std::vector<SerialLinkField> configured)
      : fields(std::move(configured)), readings(fields.size()) {}

  void set(std::size_t field, double on_wire, MonotonicTime received) noexcept {
    readings[field] = {on_wire * fields[field].scale, received};
  }

  const std::vector<SerialLinkField> fields;
  std::vector<Reading> readings;
};

}  // namespace rc10
