#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "app/result.hpp"
#include "app/time.hpp"

namespace rc10 {

enum class Parity : std::uint8_t { kNone, kEven, kOdd };

/// Form of bytes on the wire.
struct SerialFormat {
  int baud = 115200;  ///< bit/s; any, not only those of the list in termios.
  int data_bits = 8;  ///< 5 to 8
  Parity parity = Parity::kNone;
  int stop_bits = 1;  ///< 1 or 2

  /// From a baud rate and the usual three characters: data bits, parity (N, E, O), stop bits: "8N1". The
  /// error says what is wrong with them.
  [[nodiscard]] static Result<SerialFormat> make(int baud, std::string_view frame);

  /// "115200 8N1"
  [[nodiscard]] std::string text() const;
  /// Time of one byte with its start, parity and stop bits.
  [[nodiscard]] Duration byteTime() const noexcept;

  friend bool operator==(const SerialFormat&, const SerialFormat&) = default;
};

}  // namespace rc10
