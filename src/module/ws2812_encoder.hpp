#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "module/led_effect.hpp"

namespace rc10 {

/// Pictures for strips of WS2812 and WS2812B as bytes for the data line of an SPI bus: each bit of a colour
/// becomes several SPI bits, high and then low. Pure.
class Ws2812Encoder {
 public:
  /// SPI bits for one bit of a colour, and their rate.
  enum class Rate : std::uint8_t {
    k3Bits,  ///< 2.4 MHz.
    k4Bits,  ///< 3.2 MHz: also right for the newer chips.
  };
  [[nodiscard]] static constexpr std::uint32_t speedHz(Rate rate) noexcept {
    return rate == Rate::k3Bits ? 2'400'000 : 3'200'000;
  }

  /// `order`: the colours as they go over the wire, "grb".
  Ws2812Encoder(Rate rate, std::string_view order) noexcept;

  [[nodiscard]] static std::size_t bytesFor(Rate rate, std::size_t pixels) noexcept;
  /// The most pixels that fit into this number of bytes.
  [[nodiscard]] static std::size_t pixelsIn(Rate rate, std::size_t bytes) noexcept;

  /// `scale`: of the brightness, 0 to 1. `out` has bytesFor() the pixels; returns that, or 0 and writes
  /// nothing.
  std::size_t encode(std::span<const Rgb> pixels, float scale, std::span<std::uint8_t> out) const noexcept;

 private:
  Rate rate_;
  std::array<float Rgb::*, 3> order_;
};

}  // namespace rc10
