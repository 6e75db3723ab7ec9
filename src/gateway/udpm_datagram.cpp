#include "gateway/udpm_datagram.hpp"

#include "gateway/wire_reader.hpp"

namespace rc10::gateway {
namespace {

// The channel's name ends with a 0; the message follows.
UdpmDatagram split(UdpmDatagram::Kind kind, std::span<const std::byte> bytes) noexcept {
  const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  const auto end = text.find('\0');
  if (end > kMaxChannelLength) return {};  // or none at all: npos
  return {kind, text.substr(0, end), bytes.subspan(end + 1)};
}

}  // namespace

UdpmDatagram parseDatagram(std::span<const std::byte> datagram) noexcept {
  WireReader header(datagram);
  const auto magic = header.number<std::uint32_t>();
  if (magic == kMagicShort && datagram.size() > kShortHeaderSize) {
    return split(UdpmDatagram::Kind::kMessage, datagram.subspan(kShortHeaderSize));
  }
  if (magic == kMagicLong && datagram.size() > kLongHeaderSize) {
    (void)header.number<std::uint32_t>();  // sequence
    (void)header.number<std::uint32_t>();  // size of the message
    (void)header.number<std::uint32_t>();  // offset
    const bool first = header.number<std::uint16_t>() == 0;
    if (first) return split(UdpmDatagram::Kind::kFragment, datagram.subspan(kLongHeaderSize));
  }
  return {};
}

std::array<std::byte, kShortHeaderSize> shortHeader(std::uint32_t sequence) noexcept {
  std::array<std::byte, kShortHeaderSize> header{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto shift = 24U - 8U * static_cast<unsigned>(i);
    header[i] = static_cast<std::byte>(kMagicShort >> shift);
    header[4 + i] = static_cast<std::byte>(sequence >> shift);
  }
  return header;
}

}  // namespace rc10::gateway
