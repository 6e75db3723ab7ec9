#include "client/quantity_text.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace rc10::client::test::quantity_text_test {
namespace {

TEST(Quantity, IsShort) {
  EXPECT_EQ(quantity(12.345, 1, "rpm"), "12.3 rpm");
  EXPECT_EQ(quantity(12.345, 1, ""), "12.3");
  EXPECT_EQ(number(-0.04, 1), "0.0");
  EXPECT_EQ(number(-0.06, 1), "-0.1");
  EXPECT_EQ(percent(0.614), "61 %");
}

TEST(Quantity, ThatIsNotReportedIsADash) {
  EXPECT_EQ(quantity(std::nan(""), 1, "rpm"), "-");
  EXPECT_EQ(percent(std::nan("")), "-");
}

TEST(Quantity, OfAnySizeIsText) {
  EXPECT_EQ(number(1e300, 1), "1e+300");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity(), 1), "inf");
  EXPECT_EQ(number(-std::numeric_limits<double>::infinity(), 1), "-inf");
}

TEST(Age, ChoosesItsUnit) {
  EXPECT_EQ(age(-1), "-");
  EXPECT_EQ(age(0), "0.0 ms");
  EXPECT_EQ(age(420), "0.4 ms");
  EXPECT_EQ(age(83'200), "83 ms");
  EXPECT_EQ(age(12'400'000), "12 s");
}

}  // namespace
}  // namespace rc10::client::test::quantity_text_test
