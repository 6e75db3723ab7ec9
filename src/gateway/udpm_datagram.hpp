#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace rc10::gateway {

inline constexpr std::uint32_t kMagicShort = 0x4C433032;  // "LC02": the whole message
inline constexpr std::uint32_t kMagicLong = 0x4C433033;   // "LC03": a fragment of one
inline constexpr std::size_t kShortHeaderSize = 8;        // magic, sequence number
inline constexpr std::size_t kLongHeaderSize = 20;        // and size, offset, fragment, fragments

inline constexpr std::size_t kMaxChannelLength = 63;
/// Channel, its terminator and the message, as liblcm limits them in one datagram.
inline constexpr std::size_t kMaxPayload = 65499;

/// Room in a receive buffer besides the message.
inline constexpr std::size_t kMaxOverhead = kLongHeaderSize + kMaxChannelLength + 1;

/// One UDP datagram of LCM, taken apart.
struct UdpmDatagram {
  enum class Kind : std::uint8_t {
    kForeign,  ///< Not LCM, or broken.
    kMessage,
    kFragment,  ///< The first part of a message in several datagrams.
  };
  Kind kind = Kind::kForeign;
  std::string_view channel;
  std::span<const std::byte> message;
};

/// `datagram` is from strangers. The result points into it.
[[nodiscard]] UdpmDatagram parseDatagram(std::span<const std::byte> datagram) noexcept;

/// The header of a message in one datagram; the channel, a 0 and the message follow it.
[[nodiscard]] std::array<std::byte, kShortHeaderSize> shortHeader(std::uint32_t sequence) noexcept;

}  // namespace rc10::gateway
