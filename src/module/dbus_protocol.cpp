#include "module/dbus_protocol.hpp"

#include <algorithm>

#include "bus/byte_order.hpp"

namespace rc10 {
namespace {

using DbusFrame = std::span<const std::uint8_t, DbusProtocol::kFrameBytes>;

constexpr int kCentre = 1024;
constexpr int kLow = kCentre - Dr16Input::kFullDeflection;
constexpr int kHigh = kCentre + Dr16Input::kFullDeflection;
constexpr unsigned kDbusChannelBits = 11;
constexpr unsigned kRightSwitchBit = 44;  // as RMCS reads it; comments of the C board's example say left
constexpr unsigned kLeftSwitchBit = 46;

// Four channels of 11 bits and two switches of 2, least significant bit first.
[[nodiscard]] std::uint64_t sticks(DbusFrame frame) noexcept {
  return readLittleEndian<std::uint32_t>(frame, 0) |
         static_cast<std::uint64_t>(readLittleEndian<std::uint16_t>(frame, 4)) << 32U;
}

[[nodiscard]] int channel(std::uint64_t sticks, unsigned index) noexcept {
  return static_cast<int>(sticks >> (kDbusChannelBits * index) & 0x7FFU);
}

[[nodiscard]] unsigned switchAt(std::uint64_t sticks, unsigned bit) noexcept {
  return static_cast<unsigned>(sticks >> bit & 3U);
}

[[nodiscard]] bool inRange(int channel) noexcept { return channel >= kLow && channel <= kHigh; }

[[nodiscard]] bool isPlausibleDbus(DbusFrame frame) noexcept {
  const auto bits = sticks(frame);
  for (unsigned i = 0; i < 4; ++i) {
    if (!inRange(channel(bits, i))) return false;
  }
  // Old remotes have no wheel: "reserved", seen as 0.
  const auto wheel = readLittleEndian<std::uint16_t>(frame, 16);
  return switchAt(bits, kRightSwitchBit) != 0 && switchAt(bits, kLeftSwitchBit) != 0 && frame[12] <= 1 &&
         frame[13] <= 1 && (wheel == 0 || inRange(wheel));
}

[[nodiscard]] std::int16_t deflection(int channel) noexcept {
  return static_cast<std::int16_t>(channel - kCentre);
}

[[nodiscard]] Dr16Input decodeDbus(DbusFrame frame) noexcept {
  const auto bits = sticks(frame);
  const auto wheel = readLittleEndian<std::uint16_t>(frame, 16);
  return {.right_horizontal = deflection(channel(bits, 0)),
          .right_vertical = deflection(channel(bits, 1)),
          .left_horizontal = deflection(channel(bits, 2)),
          .left_vertical = deflection(channel(bits, 3)),
          .wheel = wheel == 0 ? std::int16_t{0} : deflection(wheel),
          .right_switch = static_cast<Dr16Input::Switch>(switchAt(bits, kRightSwitchBit)),
          .left_switch = static_cast<Dr16Input::Switch>(switchAt(bits, kLeftSwitchBit)),
          .mouse_x = readLittleEndian<std::int16_t>(frame, 6),
          .mouse_y = readLittleEndian<std::int16_t>(frame, 8),
          .mouse_z = readLittleEndian<std::int16_t>(frame, 10),
          .mouse_left = frame[12] != 0,
          .mouse_right = frame[13] != 0,
          .keys = readLittleEndian<std::uint16_t>(frame, 14)};
}

[[nodiscard]] unsigned rawChannel(std::int16_t deflection) noexcept {
  return static_cast<unsigned>(std::clamp(deflection + kCentre, kLow, kHigh));
}

}  // namespace

void DbusProtocol::parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept {
  framer_.parse(bytes, received, counters_, isPlausibleDbus,
                [&](DbusFrame frame) { input_.set(decodeDbus(frame), received); });
}

std::size_t DbusProtocol::pack_frame(std::span<const std::uint8_t> /*payload*/,
                                     std::span<std::uint8_t> /*out*/) const noexcept {
  return 0;
}

std::array<std::uint8_t, DbusProtocol::kFrameBytes> DbusProtocol::encode(const Dr16Input& input) noexcept {
  std::uint64_t bits = 0;
  unsigned at = 0;
  for (const auto deflected :
       {input.right_horizontal, input.right_vertical, input.left_horizontal, input.left_vertical}) {
    bits |= static_cast<std::uint64_t>(rawChannel(deflected)) << at;
    at += kDbusChannelBits;
  }
  bits |= static_cast<std::uint64_t>(input.right_switch) << kRightSwitchBit;
  bits |= static_cast<std::uint64_t>(input.left_switch) << kLeftSwitchBit;
  std::array<std::uint8_t, kFrameBytes> frame{};
  writeLittleEndian(frame, 0, static_cast<std::uint32_t>(bits));
  writeLittleEndian(frame, 4, static_cast<std::uint16_t>(bits >> 32U));
  writeLittleEndian(frame, 6, input.mouse_x);
  writeLittleEndian(frame, 8, input.mouse_y);
  writeLittleEndian(frame, 10, input.mouse_z);
  frame[12] = input.mouse_left ? 1 : 0;
  frame[13] = input.mouse_right ? 1 : 0;
  writeLittleEndian(frame, 14, input.keys);
  writeLittleEndian(frame, 16, static_cast<std::uint16_t>(rawChannel(input.wheel)));
  return frame;
}

}  // namespace rc10
