#include "module/ws2812_encoder.hpp"

#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace rc10::test::ws2812_encoder_test {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::Le;
using Rate = Ws2812Encoder::Rate;

constexpr std::array kRates{Rate::k3Bits, Rate::k4Bits};

std::vector<std::uint8_t> encoded(Rate rate, std::span<const Rgb> pixels, float scale = 1.0F,
                                  std::string_view order = "grb") {
  std::vector<std::uint8_t> bytes(Ws2812Encoder::bytesFor(rate, pixels.size()), 0xAA);
  EXPECT_EQ((Ws2812Encoder{rate, order}.encode(pixels, scale, bytes)), bytes.size());
  return bytes;
}

/// High or low, and for how long.
struct Level {
  bool high = false;
  double us = 0.0;
};

std::vector<Level> levels(Rate rate, std::span<const std::uint8_t> bytes) {
  const double bit_us = 1e6 / Ws2812Encoder::speedHz(rate);
  std::vector<Level> out;
  for (const auto byte : bytes) {
    for (unsigned i = 8; i-- > 0;) {
      const bool high = ((byte >> i) & 1U) != 0;
      if (out.empty() || out.back().high != high) out.push_back({high, 0.0});
      out.back().us += bit_us;
    }
  }
  return out;
}

/// The bytes as a strip reads them: the bits of each 1.25 us, as text.
std::string bitsSeen(Rate rate, std::span<const std::uint8_t> bytes) {
  std::string bits;
  for (const auto& level : levels(rate, bytes)) {
    if (level.high) bits += level.us > 0.55 ? '1' : '0';
  }
  return bits;
}

TEST(Ws2812Encoder, TheColoursGoOverTheWireInTheirOrderTheHighestBitFirst) {
  const std::array pixels{Rgb{1.0F, 0.0F, 129.0F / 255.0F}};
  for (const auto rate : kRates) {
    EXPECT_EQ(bitsSeen(rate, encoded(rate, pixels, 1.0F, "grb")), "000000001111111110000001");
    EXPECT_EQ(bitsSeen(rate, encoded(rate, pixels, 1.0F, "rgb")), "111111110000000010000001");
    EXPECT_EQ(bitsSeen(rate, encoded(rate, pixels, 1.0F, "brg")), "100000011111111100000000");
  }
}

TEST(Ws2812Encoder, TheBytesOfOneColourAreThoseOfTheTable) {
  const std::array pixels{Rgb{0.0F, 165.0F / 255.0F, 0.0F}};  // 0xA5 = 10100101
  const auto four = encoded(Rate::k4Bits, pixels);
  EXPECT_THAT((std::vector(four.begin() + 120, four.begin() + 124)),
              ::testing::ElementsAre(0xE8, 0xE8, 0x8E, 0x8E));
  const auto three = encoded(Rate::k3Bits, pixels);
  // 110 100 110 100 100 110 100 110
  EXPECT_THAT((std::vector(three.begin() + 90, three.begin() + 93)),
              ::testing::ElementsAre(0b11010011, 0b01001001, 0b10100110));
}

TEST(Ws2812Encoder, EveryValueOfEveryColourArrives) {
  for (const auto rate : kRates) {
    for (int value = 0; value < 256; ++value) {
      const auto part = static_cast<float>(value) / 255.0F;
      const std::array pixels{Rgb{part, part, part}};
      std::string expected;
      for (unsigned i = 24; i-- > 0;)
        expected += ((static_cast<unsigned>(value) >> (i % 8)) & 1U) != 0 ? '1' : '0';
      ASSERT_EQ(bitsSeen(rate, encoded(rate, pixels)), expected) << value;
    }
  }
}

TEST(Ws2812Encoder, LevelsLastAsLongAsTheDataSheetWants) {
  const std::array pixels{Rgb{1.0F, 0.0F, 0.7F}, Rgb{0.3F, 0.9F, 0.1F}};
  for (const auto rate : kRates) {
    const auto all = levels(rate, encoded(rate, pixels));
    ASSERT_EQ(all.size(), 2U * 48U + 1U);
    EXPECT_FALSE(all.front().high);
    EXPECT_GE(all.front().us, 280.0) << "what the line said before is no bit";
    EXPECT_GE(all.back().us, 280.0) << "the picture is taken over";
    for (std::size_t i = 1; i + 1 < all.size(); i += 2) {
      const double high_us = all[i].us;
      const double low_us = i + 2 < all.size() ? all[i + 1].us : 1.25 - high_us;
      EXPECT_NEAR(high_us + low_us, 1.25, 1e-6);
      // Timing of the WS2812B: 0.4 and 0.8 us, +-0.15 us.
      EXPECT_THAT(high_us, high_us > 0.6 ? AllOf(Ge(0.65), Le(0.95)) : AllOf(Ge(0.25), Le(0.55)));
      // Timing of the WS2812B-V5 as well.
      if (rate == Rate::k4Bits) {
        EXPECT_THAT(high_us, high_us > 0.6 ? AllOf(Ge(0.58), Le(1.0)) : AllOf(Ge(0.22), Le(0.38)));
      }
    }
  }
}

TEST(Ws2812Encoder, NothingIsBrighterThanTheScale) {
  const std::array pixels{Rgb{1.0F, 1.0F, 1.0F}};
  EXPECT_EQ(bitsSeen(Rate::k4Bits, encoded(Rate::k4Bits, pixels, 0.25F)), "010000000100000001000000");
  EXPECT_EQ(bitsSeen(Rate::k4Bits, encoded(Rate::k4Bits, pixels, 0.0F)), std::string(24, '0'));
  EXPECT_EQ(bitsSeen(Rate::k4Bits, encoded(Rate::k4Bits, pixels, 7.0F)), std::string(24, '1'));
}

TEST(Ws2812Encoder, SizesAndPixelsFitEachOther) {
  for (const auto rate : kRates) {
    const auto most = Ws2812Encoder::pixelsIn(rate, 4096);
    EXPECT_LE(Ws2812Encoder::bytesFor(rate, most), 4096U);
    EXPECT_GT(Ws2812Encoder::bytesFor(rate, most + 1), 4096U);
    EXPECT_EQ(Ws2812Encoder::pixelsIn(rate, 10), 0U);
  }
  EXPECT_EQ(Ws2812Encoder::pixelsIn(Rate::k4Bits, 4096), 321U);
  EXPECT_EQ(Ws2812Encoder::pixelsIn(Rate::k3Bits, 4096), 435U);
}

TEST(Ws2812Encoder, NothingIsWrittenWhereItDoesNotFit) {
  const std::array<Rgb, 2> pixels{};
  std::vector<std::uint8_t> small(Ws2812Encoder::bytesFor(Rate::k4Bits, 2) - 1, 0x55);
  EXPECT_EQ((Ws2812Encoder{Rate::k4Bits, "grb"}.encode(pixels, 1.0F, small)), 0U);
  EXPECT_THAT(small, ::testing::Each(0x55));
}

}  // namespace
}  // namespace rc10::test::ws2812_encoder_test
