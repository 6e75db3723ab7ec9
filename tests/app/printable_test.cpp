#include "app/printable.hpp"

#include <gtest/gtest.h>

namespace rc10::test::printable_test {
namespace {

TEST(Printable, LeavesTextAlone) {
  EXPECT_EQ(printable("left_wheel: 12.5 rpm"), "left_wheel: 12.5 rpm");
  EXPECT_EQ(printable("café 电机 🤖"), "café 电机 🤖");
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, NoEscapeSequenceReachesTheTerminal) {
  EXPECT_EQ(printable("\x1b[31mred\r\n\x7f\t"), "?[31mred????");
  EXPECT_EQ(printable("\u009b31m"), "?31m") << "CSI of C1";
}

TEST(Printable, NothingTurnsTheDirectionOrBreaksTheLine) {
  EXPECT_EQ(printable("a\u202eb\u2066c\u2028d\u200fe"), "a?b?c?d?e");
}

TEST(Printable, BytesThatAreNoUtf8AreShownAsSuch) {
  EXPECT_EQ(printable("\xff\xfe"), "??");
  EXPECT_EQ(printable("\xc3"), "?") << "cut off";
  EXPECT_EQ(printable("\xc3("), "?(");
  EXPECT_EQ(printable("\xc0\x80"), "??") << "not the shortest form";
  EXPECT_EQ(printable("\xe0\x80\x80"), "???");
  EXPECT_EQ(printable("\xed\xa0\x80"), "???") << "a surrogate";
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "????") << "beyond U+10FFFF";
}

}  // namespace
}  // namespace rc10::test::printable_test
