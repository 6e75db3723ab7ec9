#include "module/ws2812_encoder.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

using Rate = Ws2812Encoder::Rate;

// Worldsemi, WS2812B data sheet:  0: 0.4 us high, 0.85 us low;   1: 0.8 us high, 0.45 us low; each +-0.15 us.
//   its version 5 (WS2812B-V5):   0: 0.22-0.38 us high, 0.58-1 us low;   1: 0.58-1 us high, 0.22-0.42 us low.
//   3 bits at 2.4 MHz:            0: 0.42 us high, 0.83 us low;  1: 0.83 us high, 0.42 us low. Too long a 0
//   for V5. 4 bits at 3.2 MHz:            0: 0.31 us high, 0.94 us low;  1: 0.94 us high, 0.31 us low. Right
//   for both.
constexpr std::uint32_t kZero3 = 0b100;
constexpr std::uint32_t kOne3 = 0b110;
constexpr std::uint32_t kZero4 = 0b1000;
constexpr std::uint32_t kOne4 = 0b1110;

// The picture is taken over when the line was low for more than 50 us, or 280 us (WS2812B-V5, from 2017 on).
// Before the picture as well: a controller whose data line rests high would begin with half a bit.
constexpr std::size_t kResetUs = 300;

constexpr std::size_t bitsPerBit(Rate rate) noexcept { return rate == Rate::k3Bits ? 3 : 4; }

constexpr std::size_t resetBytes(Rate rate) noexcept {
  return (Ws2812Encoder::speedHz(rate) / 1000 * kResetUs / 1000 + 7) / 8;
}

constexpr std::size_t pixelBytes(Rate rate) noexcept { return 3 * bitsPerBit(rate); }

/// The SPI bits of one colour's eight bits, the highest first.
constexpr std::uint32_t stretched(std::uint32_t value, Rate rate) noexcept {
  std::uint32_t bits = 0;
  for (unsigned i = 8; i-- > 0;) {
    const bool one = ((value >> i) & 1U) != 0;
    const std::uint32_t symbol = rate == Rate::k3Bits ? (one ? kOne3 : kZero3) : (one ? kOne4 : kZero4);
    bits = bits << bitsPerBit(rate) | symbol;
  }
  return bits;
}

constexpr std::array<std::uint32_t, 256> tableFor(Rate rate) noexcept {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t value = 0; value < table.size(); ++value) table[value] = stretched(value, rate);
  return table;
}

constexpr auto kTable3 = tableFor(Rate::k3Bits);
constexpr auto kTable4 = tableFor(Rate::k4Bits);

constexpr float Rgb::*part(char letter) noexcept {
  if (letter == 'r') return &Rgb::red;
  return letter == 'g' ? &Rgb::green : &Rgb::blue;
}

}  // namespace

Ws2812Encoder::Ws2812Encoder(Rate rate, std::string_view order) noexcept
    : rate_(rate), order_{part(order[0]), part(order[1]), part(order[2])} {}

std::size_t Ws2812Encoder::bytesFor(Rate rate, std::size_t pixels) noexcept {
  return 2 * resetBytes(rate) + pixels * pixelBytes(rate);
}

std::size_t Ws2812Encoder::pixelsIn(Rate rate, std::size_t bytes) noexcept {
  const std::size_t resets = 2 * resetBytes(rate);
  return bytes > resets ? (bytes - resets) / pixelBytes(rate) : 0;
}

std::size_t Ws2812Encoder::encode(std::span<const Rgb> pixels, float scale,
                                  std::span<std::uint8_t> out) const noexcept {
  const std::size_t size = bytesFor(rate_, pixels.size());
  if (out.size() < size) return 0;
  std::fill(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size), std::uint8_t{0});
  const auto& table = rate_ == Rate::k3Bits ? kTable3 : kTable4;
  const std::size_t bytes = bitsPerBit(rate_);
  std::size_t at = resetBytes(rate_);
  for (const Rgb& pixel : pixels) {
    for (const auto colour : order_) {
      const float light = std::clamp(pixel.*colour * scale, 0.0F, 1.0F);
      const auto bits = table[static_cast<std::size_t>(std::lround(255.0F * light))];
      for (std::size_t i = bytes; i-- > 0;) out[at++] = static_cast<std::uint8_t>(bits >> (8 * i));
    }
  }
  return size;
}

}  // namespace rc10
