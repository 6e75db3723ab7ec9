#include "module/sbus_protocol.hpp"

#include <algorithm>

namespace rc10 {
namespace {

using SbusFrame = std::span<const std::uint8_t, SbusProtocol::kFrameBytes>;

constexpr std::uint8_t kSbusHeader = 0x0F;
constexpr std::array<std::uint8_t, 5> kEnds{0x00, 0x04, 0x14, 0x24, 0x34};  // SBUS, and the slots of SBUS2
constexpr std::size_t kFlagsAt = 23;
constexpr unsigned kSbusChannelBits = 11;

enum Flag : std::uint8_t { kChannel17 = 1, kChannel18 = 2, kFrameLost = 4, kFailsafe = 8, kUnused = 0xF0 };

[[nodiscard]] bool isPlausibleSbus(SbusFrame frame) noexcept {
  return frame[0] == kSbusHeader && (frame[kFlagsAt] & kUnused) == 0 &&
         std::find(kEnds.begin(), kEnds.end(), frame.back()) != kEnds.end();
}

[[nodiscard]] SbusInput decodeSbus(SbusFrame frame) noexcept {
  SbusInput input;
  for (std::size_t i = 0; i < SbusInput::kChannels; ++i) {
    unsigned value = 0;
    for (unsigned bit = 0; bit < kSbusChannelBits; ++bit) {
      const auto at = i * kSbusChannelBits + bit;
      value |= (static_cast<unsigned>(frame[1 + at / 8]) >> (at % 8) & 1U) << bit;
    }
    input.raw[i] = static_cast<std::uint16_t>(value);
  }
  const auto flags = frame[kFlagsAt];
  input.digital = {(flags & kChannel17) != 0, (flags & kChannel18) != 0};
  input.frame_lost = (flags & kFrameLost) != 0;
  input.failsafe = (flags & kFailsafe) != 0;
  return input;
}

}  // namespace

float SbusInput::deflection(std::size_t channel) const noexcept {
  const auto full = static_cast<float>(kFullDeflection);
  return std::clamp((static_cast<float>(raw[channel]) - static_cast<float>(kCentre)) / full, -1.0F, 1.0F);
}

void SbusProtocol::parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept {
  framer_.parse(bytes, received, counters_, isPlausibleSbus,
                [&](SbusFrame frame) { input_.set(decodeSbus(frame), received); });
}

std::size_t SbusProtocol::pack_frame(std::span<const std::uint8_t> /*payload*/,
                                     std::span<std::uint8_t> /*out*/) const noexcept {
  return 0;
}

std::array<std::uint8_t, SbusProtocol::kFrameBytes> SbusProtocol::encode(const SbusInput& input) noexcept {
  std::array<std::uint8_t, kFrameBytes> frame{};
  frame[0] = kSbusHeader;
  for (std::size_t i = 0; i < SbusInput::kChannels; ++i) {
    for (unsigned bit = 0; bit < kSbusChannelBits; ++bit) {
      const auto at = i * kSbusChannelBits + bit;
      const unsigned set = static_cast<unsigned>(input.raw[i]) >> bit & 1U;
      frame[1 + at / 8] = static_cast<std::uint8_t>(frame[1 + at / 8] | set << (at % 8));
    }
  }
  frame[kFlagsAt] =
      static_cast<std::uint8_t>((input.digital[0] ? kChannel17 : 0) | (input.digital[1] ? kChannel18 : 0) |
                                (input.frame_lost ? kFrameLost : 0) | (input.failsafe ? kFailsafe : 0));
  return frame;
}

}  // namespace rc10
