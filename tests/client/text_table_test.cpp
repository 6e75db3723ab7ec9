#include "client/text_table.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "client/quantity_text.hpp"

namespace rc10::client::test::text_table_test {
namespace {

using Align = TextTable::Align;

TEST(TextTable, AlignsColumns) {
  TextTable table({{"NAME"}, {"N", Align::kRight}});
  table.add({"a", "1"});
  table.add({"longer", "1000"});
  EXPECT_EQ(table.text(),
            "NAME       N\n"
            "a          1\n"
            "longer  1000\n");
}

TEST(TextTable, LeavesEmptyColumnsOut) {
  TextTable table({{"NAME"}, {"OWNER"}, {"N"}});
  table.add({"a", "", "1"});
  EXPECT_EQ(table.text(), "NAME  N\na     1\n");
}

TEST(TextTable, HasNoTrailingSpaces) {
  TextTable table({{"NAME"}, {"NOTE"}});
  table.add({"a", ""});
  table.add({"b", "hot"});
  EXPECT_EQ(table.text(), "NAME  NOTE\na\nb     hot\n");
}

TEST(TextTable, CountsCharactersNotBytes) {
  TextTable table({{"NAME"}, {"N"}});
  table.add({"\u00e9t\u00e9\u00e9", "1"});
  EXPECT_EQ(table.text(), "NAME  N\n\u00e9t\u00e9\u00e9  1\n");
}

TEST(TextTable, FillsShortRows) {
  TextTable table({{"A"}, {"B"}});
  table.add({"1"});
  table.add({"1", "2"});
  EXPECT_EQ(table.text(), "A  B\n1\n1  2\n");
}

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
}  // namespace rc10::client::test::text_table_test
