#include "bus/serial_format.hpp"

#include <array>
#include <cstddef>

namespace rc10 {
namespace {

constexpr std::string_view kParityLetters = "NEO";  // in the order of Parity
constexpr int kSlowestBaud = 50;
constexpr int kFastestBaud = 20'000'000;

}  // namespace

Result<SerialFormat> SerialFormat::make(int baud, std::string_view frame) {
  if (baud < kSlowestBaud || baud > kFastestBaud) {
    return fail("baud rate " + std::to_string(baud) + ": it is " + std::to_string(kSlowestBaud) + " to " +
                std::to_string(kFastestBaud) + " bit/s");
  }
  const auto parity = frame.size() == 3 ? kParityLetters.find(frame[1]) : std::string_view::npos;
  if (parity == std::string_view::npos || frame[0] < '5' || frame[0] > '8' || frame[2] < '1' ||
      frame[2] > '2') {
    return fail("serial format '" + std::string(frame) +
                "': write data bits (5 to 8), parity (N none, E even, O odd) and stop bits (1 or 2), such as "
                "8N1 or 8E2");
  }
  return SerialFormat{baud, frame[0] - '0', static_cast<Parity>(parity), frame[2] - '0'};
}

std::string SerialFormat::text() const {
  return std::to_string(baud) + " " + std::to_string(data_bits) +
         kParityLetters[static_cast<std::size_t>(parity)] + std::to_string(stop_bits);
}

Duration SerialFormat::byteTime() const noexcept {
  const int bits = 1 + data_bits + (parity == Parity::kNone ? 0 : 1) + stop_bits;
  return Duration{std::int64_t{1'000'000'000} * bits / baud};
}

}  // namespace rc10
