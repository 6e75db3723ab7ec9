#include "client/duration_text.hpp"

#include <gtest/gtest.h>

namespace rc10::client::test::duration_text_test {
namespace {

using namespace std::chrono_literals;

TEST(ParseDuration, UnderstandsUnits) {
  EXPECT_EQ(parseDuration("2s"), 2s);
  EXPECT_EQ(parseDuration("500ms"), 500ms);
  EXPECT_EQ(parseDuration("1.5 s"), 1500ms);
  EXPECT_EQ(parseDuration("2min"), 120s);
  EXPECT_EQ(parseDuration("3"), 3s);
}

TEST(ParseDuration, RefusesWhatIsNoDuration) {
  for (const char* text :
       {"", "s", "-1s", "0", "0.1ms", "2h", "2 seconds", "nan", "inf", "1e9", "2s2", "1d"}) {
    EXPECT_FALSE(parseDuration(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace rc10::client::test::duration_text_test
