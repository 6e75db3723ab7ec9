#include "config/yaml/number_text.hpp"

#include <gtest/gtest.h>

namespace rc10::test::number_text_test {
namespace {

std::string refusal(std::string_view text) {
  const auto value = parseNumber(text);
  return value ? "accepted" : value.error().message;
}

TEST(NumberText, ReadsWhatJsonCallsANumber) {
  EXPECT_EQ(parseNumber("0").value(), 0.0);
  EXPECT_EQ(parseNumber("-0").value(), 0.0);
  EXPECT_EQ(parseNumber("10").value(), 10.0);
  EXPECT_EQ(parseNumber("-12.5").value(), -12.5);
  EXPECT_EQ(parseNumber("0.018").value(), 0.018);
  EXPECT_EQ(parseNumber("1e3").value(), 1000.0);
  EXPECT_EQ(parseNumber("2.5E-3").value(), 0.0025);
  EXPECT_EQ(parseNumber("1e+2").value(), 100.0);
}

TEST(NumberText, TellsWhatToWriteInsteadOfOtherNotations) {
  EXPECT_EQ(refusal("010"), "'010' has a leading zero, which some read as octal; write 10");
  EXPECT_EQ(refusal("-007.5"), "'-007.5' has a leading zero, which some read as octal; write -7.5");
  EXPECT_EQ(refusal("0x10"), "'0x10' is not decimal; write 16");
  EXPECT_EQ(refusal("0o17"), "'0o17' is not decimal; write 15");
  EXPECT_EQ(refusal("0b101"), "'0b101' is not decimal; write 5");
  EXPECT_EQ(refusal("1_000"), "'1_000' has an underscore; write 1000");
  EXPECT_EQ(refusal("+5"), "'+5' has a plus sign; write 5");
  EXPECT_EQ(refusal(".5"), "'.5' begins with a point; write 0.5");
  EXPECT_EQ(refusal("-.5"), "'-.5' begins with a point; write -0.5");
  EXPECT_EQ(refusal("5."), "'5.' ends with a point; write 5");
  EXPECT_EQ(refusal("10A"), "'10A' has something after the number; write 10: the unit is in the key's name");
  EXPECT_EQ(refusal("10 rpm"),
            "'10 rpm' has something after the number; write 10: the unit is in the key's name");
}

TEST(NumberText, RefusesWhatIsNotFinite) {
  for (const auto* text : {".nan", "nan", "NaN", ".inf", "-.inf", "inf", "-Infinity", ".INF", "+.inf"}) {
    EXPECT_NE(refusal(text).find("is not finite; write a number"), std::string::npos) << text;
  }
  EXPECT_EQ(refusal("1e999"), "'1e999' cannot be represented; write a smaller number of digits");
}

TEST(NumberText, RefusesWhatIsNoNumberAtAll) {
  const std::string reason = " is not a number; write digits, with a point for fractions";
  for (const auto* text : {"abc", "-", "--5", "1,5", "1.2.3", "e5", ".", "+", "true", "1:30"}) {
    const auto refused = refusal(text);
    EXPECT_NE(refused, "accepted") << text;
  }
  EXPECT_EQ(refusal("abc"), "'abc'" + reason);
  EXPECT_EQ(refusal("1,5"), "'1,5'" + reason);
  EXPECT_EQ(refusal(""), "is empty; write a number");
}

TEST(NumberText, WantsWholeNumbersWithoutPointAndExponent) {
  EXPECT_EQ(parseInteger("-42").value(), -42);
  EXPECT_EQ(parseInteger("1e3").error().message, "'1e3' is to be a whole number; write 1000");
  EXPECT_EQ(parseInteger("5.0").error().message, "'5.0' is to be a whole number; write 5");
  EXPECT_EQ(parseInteger("1.5").error().message, "'1.5' is not a whole number; remove the fraction");
  EXPECT_FALSE(parseInteger("99999999999999999999"));
  EXPECT_FALSE(parseInteger("010"));
}

TEST(NumberText, WritesTheShortestTextThatReadsBack) {
  EXPECT_EQ(numberText(1e6), "1000000");
  EXPECT_EQ(numberText(0.018F), "0.018");
  EXPECT_EQ(numberText(-0.5), "-0.5");
  for (const double value : {3591.0 / 187.0, 1.0 / 3.0, 1e-9, 123456.789}) {
    EXPECT_EQ(parseNumber(numberText(value)).value(), value);
  }
}

}  // namespace
}  // namespace rc10::test::number_text_test
