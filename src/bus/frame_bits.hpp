#pragma once

#include <cstddef>
#include <cstdint>

#include "app/time.hpp"
#include "bus/can_frame.hpp"

namespace rc10 {

/// Bits of one frame on the wire with the 3 bits of interframe space. Sources: ISO 11898-1; Davis et al.,
/// Real-Time Systems 35 (2007) 239-272 for the worst case of stuffing.
struct FrameBits {
  std::uint32_t nominal = 0;  ///< At the nominal bit rate.
  std::uint32_t data = 0;     ///< At the data bit rate: FD with bit rate switch only.

  [[nodiscard]] constexpr std::uint32_t total() const noexcept { return nominal + data; }
  friend constexpr bool operator==(FrameBits, FrameBits) = default;
};

/// Properties that determine the length of a frame on the wire.
struct FrameShape {
  bool extended = false;
  bool fd = false;
  bool bit_rate_switch = false;
  std::size_t length = 8;  ///< Payload bytes; 0 for a remote frame.
};

struct BitRates {
  std::uint32_t nominal_bps = 1'000'000;
  std::uint32_t data_bps = 0;  ///< 0: the bus has no data bit rate of its own.
};

namespace detail {

/// One stuff bit after 5 equal bits, and then after every 4 more: the stuff bit begins the next run.
[[nodiscard]] constexpr std::uint32_t worstStuffing(std::uint32_t stuffable) noexcept {
  return (stuffable - 1) / 4;
}

[[nodiscard]] constexpr FrameBits frameBits(FrameShape shape, bool worst) noexcept {
  const auto payload = static_cast<std::uint32_t>(8 * shape.length);
  const auto stuffed = [worst](std::uint32_t bits) { return bits + (worst ? worstStuffing(bits) : 0); };
  if (!shape.fd) {
    // Start to CRC; then CRC delimiter, ACK slot and delimiter, 7 end of frame, 3 interframe space.
    return {stuffed((shape.extended ? 54U : 34U) + payload) + 13U, 0};
  }
  // The CRC field: 4 stuff count, CRC-17 or CRC-21, 6 or 7 fixed stuff bits, delimiter. Its stuff bits
  // have fixed places, so they are in both figures.
  const std::uint32_t crc_field = shape.length > 16 ? 33U : 28U;
  constexpr std::uint32_t kTail = 12;  // ACK slot and delimiter, end of frame, interframe space
  const std::uint32_t total = stuffed((shape.extended ? 41U : 22U) + payload) + crc_field + kTail;
  if (!shape.bit_rate_switch) return {total, 0};
  // Start of frame up to and with the BRS bit.
  const std::uint32_t nominal = stuffed(shape.extended ? 36U : 17U) + kTail;
  return {nominal, total - nominal};
}

}  // namespace detail

/// The shortest the frame can be: no stuff bit.
[[nodiscard]] constexpr FrameBits unstuffedBits(FrameShape shape) noexcept {
  return detail::frameBits(shape, false);
}

/// The longest it can be.
[[nodiscard]] constexpr FrameBits worstCaseBits(FrameShape shape) noexcept {
  return detail::frameBits(shape, true);
}

[[nodiscard]] constexpr FrameShape shapeOf(const CanFrame& frame) noexcept {
  const std::size_t payload = frame.type == FrameType::kData ? frame.length : 0;
  return {frame.id.extended, frame.fd, frame.bit_rate_switch, payload};
}

/// Time for which the bits occupy the bus, rounded up to a nanosecond.
[[nodiscard]] Duration frameTime(FrameBits bits, BitRates rates) noexcept;

}  // namespace rc10
