#include "app/hex_text.hpp"

#include <gtest/gtest.h>

namespace rc10::test::hex_text_test {
namespace {

TEST(HexText, HasItsDigitsInCapitalsWithLeadingZeros) {
  EXPECT_EQ(hexDigits(0x7F, 3), "07F");
  EXPECT_EQ(hexDigits(0x1ABCDEF9, 8), "1ABCDEF9");
  EXPECT_EQ(hexDigits(0, 1), "0");
}

TEST(HexText, HasTheLastDigitsOfALongerNumber) { EXPECT_EQ(hexDigits(0x12345, 3), "345"); }

}  // namespace
}  // namespace rc10::test::hex_text_test
