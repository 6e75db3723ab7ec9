#include "bus/serial_format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10::serial_format_test {
namespace {

using ::testing::HasSubstr;

TEST(SerialFormat, IsReadFromTheUsualThreeCharacters) {
  EXPECT_EQ(SerialFormat::make(115200, "8N1").value(), SerialFormat{});
  EXPECT_EQ(SerialFormat::make(100000, "8E2").value(), (SerialFormat{100000, 8, Parity::kEven, 2}));
  EXPECT_EQ(SerialFormat::make(9600, "7O1").value(), (SerialFormat{9600, 7, Parity::kOdd, 1}));
}

TEST(SerialFormat, SaysWhatIsWrong) {
  for (const char* wrong : {"", "8", "8N", "8N11", "9N1", "4N1", "8X1", "8n1", "8N0", "8N3"}) {
    const auto made = SerialFormat::make(115200, wrong);
    ASSERT_FALSE(made) << wrong;
    EXPECT_THAT(made.error().message, HasSubstr("8N1"));
    EXPECT_THAT(made.error().message, HasSubstr("'" + std::string(wrong) + "'"));
  }
  for (const int wrong : {-1, 0, 49, 20'000'001}) {
    const auto made = SerialFormat::make(wrong, "8N1");
    ASSERT_FALSE(made) << wrong;
    EXPECT_THAT(made.error().message, HasSubstr("baud rate " + std::to_string(wrong)));
  }
}

TEST(SerialFormat, IsWrittenAsItIsRead) {
  EXPECT_EQ(SerialFormat{}.text(), "115200 8N1");
  EXPECT_EQ(SerialFormat::make(100000, "8E2").value().text(), "100000 8E2");
}

TEST(SerialFormat, KnowsHowLongAByteTakes) {
  using std::chrono::microseconds;
  EXPECT_EQ(SerialFormat::make(100000, "8N1").value().byteTime(), microseconds{100});
  EXPECT_EQ(SerialFormat::make(100000, "8E1").value().byteTime(), microseconds{110});
  EXPECT_EQ(SerialFormat::make(100000, "8E2").value().byteTime(), microseconds{120});
}

}  // namespace
}  // namespace rc10::serial_format_test
