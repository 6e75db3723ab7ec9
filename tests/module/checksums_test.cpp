#include "module/checksums.hpp"

#include <array>

#include <gtest/gtest.h>

namespace rc10::checksums_test {
namespace {

// The check value of a CRC is that of the digits 1 to 9 (catalogue of parametrised CRC algorithms).
constexpr std::array<std::uint8_t, 9> kDigits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};

TEST(Checksums, CrcsHaveTheirPublishedCheckValues) {
  static_assert(crc16Modbus(kDigits) == 0x4B37);
  static_assert(crc16Xmodem(kDigits) == 0x31C3);
}

TEST(Checksums, ACrcOfNothingIsItsStartValue) {
  EXPECT_EQ(crc16Modbus({}), 0xFFFF);
  EXPECT_EQ(crc16Xmodem({}), 0);
}

TEST(Checksums, ACrcGoesOnFromWhatCameBefore) {
  const std::span<const std::uint8_t> digits(kDigits);
  EXPECT_EQ(crc16Xmodem(digits.subspan(4), crc16Xmodem(digits.first(4))), 0x31C3);
}

TEST(Checksums, TheSumWraps) {
  EXPECT_EQ(sum8(std::array<std::uint8_t, 3>{0xFF, 0x02, 0x10}), 0x11);
  EXPECT_EQ(sum8({}), 0);
}

}  // namespace
}  // namespace rc10::checksums_test
