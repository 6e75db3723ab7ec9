#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

#include "app/time.hpp"

namespace rc10 {

/// An arbitration id. Standard and extended ids are different ids, also when the number is the same.
struct CanId {
  std::uint32_t value = 0;
  bool extended = false;
  friend constexpr bool operator==(CanId, CanId) = default;
};

inline constexpr std::uint32_t kStandardIdMask = 0x7FFU;
inline constexpr std::uint32_t kExtendedIdMask = 0x1FFF'FFFFU;
inline constexpr std::size_t kMaxPayload = 64;

enum class FrameType : std::uint8_t {
  kData,
  kRemote,
  kError,  ///< SocketCAN error message: `id` holds the class bits of linux/can/error.h.
};

/// One frame on a bus, classic or FD. Plain data: it is copied through the rings.
struct CanFrame {
  CanId id;
  FrameType type = FrameType::kData;
  bool fd = false;               ///< CAN FD format.
  bool bit_rate_switch = false;  ///< FD only: the data phase runs at the data bit rate.
  std::uint8_t length = 0;       ///< Payload bytes: 0-8, FD also 12, 16, 20, 24, 32, 48, 64.
  bool sent_here = false;        ///< Received frames only: a program on this computer sent it.
  MonotonicTime received;        ///< When the kernel received it; meaningless on frames to send.
  std::array<std::uint8_t, kMaxPayload> data{};

  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept { return {data.data(), length}; }
};
static_assert(std::is_trivially_copyable_v<CanFrame>);

/// The smallest valid CAN FD payload length that holds `bytes` (ISO 11898-1); 64 above 64.
[[nodiscard]] constexpr std::uint8_t roundUpFdLength(std::size_t bytes) noexcept {
  constexpr std::array<std::uint8_t, 7> kLong{12, 16, 20, 24, 32, 48, 64};
  if (bytes <= 8) return static_cast<std::uint8_t>(bytes);
  for (const auto length : kLong) {
    if (bytes <= length) return length;
  }
  return 64;
}

/// Is this a payload length that a frame of this format can have?
[[nodiscard]] constexpr bool isValidLength(bool fd, std::size_t length) noexcept {
  return fd ? length <= kMaxPayload && roundUpFdLength(length) == length : length <= 8;
}

/// The highest id of the format, and the mask of its bits.
[[nodiscard]] constexpr std::uint32_t idMask(bool extended) noexcept {
  return extended ? kExtendedIdMask : kStandardIdMask;
}

/// "standard id 0x201" or "extended id 0x00000901", for messages. Allocates.
[[nodiscard]] std::string describe(CanId id);

/// Builds a classic frame. More than 8 bytes are a programming error: the rest is cut off.
[[nodiscard]] CanFrame makeClassicFrame(CanId id, std::span<const std::uint8_t> payload) noexcept;

/// Builds an FD frame; the payload is padded to the next valid length with `padding`.
[[nodiscard]] CanFrame makeFdFrame(CanId id, std::span<const std::uint8_t> payload, bool bit_rate_switch,
                                   std::uint8_t padding = 0) noexcept;

}  // namespace rc10
