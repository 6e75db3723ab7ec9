#include "app/text_table.hpp"

#include <gtest/gtest.h>

#include "app/style.hpp"

namespace rc10::test::text_table_test {
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

TEST(TextTable, HasNoHeadWithoutTitlesAndIsIndented) {
  TextTable table({{""}, {""}});
  table.add({"robot", "hero"});
  table.add({"guard", "off"});
  EXPECT_EQ(table.text(2), "  robot  hero\n  guard  off\n");
}

TEST(TextTable, AStyleEndsWithItsLine) {
  TextTable table({{"NAME"}});
  table.add({"a"}, style::kBad);
  EXPECT_EQ(table.text(), "NAME\n" + std::string{style::kBad} + "a\x1b[0m\n");
}

}  // namespace
}  // namespace rc10::test::text_table_test
