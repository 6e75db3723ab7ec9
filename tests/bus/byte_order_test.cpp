#include "bus/byte_order.hpp"

#include <gtest/gtest.h>

#include <array>

namespace rc10::byte_order_test {
namespace {

TEST(ByteOrder, ReadsBothWays) {
  const std::array<std::uint8_t, 4> bytes{0xFF, 0x02, 0x03, 0x84};
  EXPECT_EQ(readLittleEndian<std::uint32_t>(bytes, 0), 0x840302FFU);
  EXPECT_EQ(readBigEndian<std::uint32_t>(bytes, 0), 0xFF020384U);
  EXPECT_EQ(readLittleEndian<std::int16_t>(bytes, 2), static_cast<std::int16_t>(0x8403));
  EXPECT_EQ(readBigEndian<std::int16_t>(bytes, 0), -254);
  EXPECT_EQ(readBigEndian<std::int8_t>(bytes, 0), -1);
}

TEST(ByteOrder, WritesWhatItReads) {
  std::array<std::uint8_t, 8> bytes{};
  writeLittleEndian<std::int16_t>(bytes, 0, -2);
  writeBigEndian<std::int32_t>(bytes, 2, -70'000);
  EXPECT_EQ(bytes[0], 0xFE);
  EXPECT_EQ(readLittleEndian<std::int16_t>(bytes, 0), -2);
  EXPECT_EQ(readBigEndian<std::int32_t>(bytes, 2), -70'000);
  writeLittleEndian(bytes, 4, 1.5F);
  EXPECT_EQ(readLittleEndian<float>(bytes, 4), 1.5F);
  EXPECT_EQ(bytes[7], 0x3F);
}

}  // namespace
}  // namespace rc10::byte_order_test
