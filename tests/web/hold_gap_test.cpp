#include "web/hold_gap.hpp"

#include <gtest/gtest.h>

namespace rc10::web::test::hold_gap_test {
namespace {

using namespace std::chrono_literals;

TEST(HoldGap, AHoldThatIsRenewedGoesOn) {
  HoldGap gap;
  MonotonicTime now{1000s};
  for (int i = 0; i < 100; ++i, now += 500ms) EXPECT_TRUE(gap.goesOn(7, now));
}

TEST(HoldGap, OneThatWasSilentIsOverHoweverOftenItIsRenewedThen) {
  HoldGap gap;
  MonotonicTime now{1000s};
  EXPECT_TRUE(gap.goesOn(7, now));
  now += 501ms;
  for (int i = 0; i < 100; ++i, now += 50ms) EXPECT_FALSE(gap.goesOn(7, now));
}

TEST(HoldGap, TheEndOfAHoldEndsWhatStillActs) {
  HoldGap gap;
  const MonotonicTime now{1000s};
  EXPECT_TRUE(gap.goesOn(7, now));
  EXPECT_FALSE(gap.acts(7, now)) << "nothing was sent";
  gap.sent(now + 150ms);
  EXPECT_TRUE(gap.acts(7, now + 149ms));
  EXPECT_FALSE(gap.acts(7, now + 150ms)) << "its on_timeout acts by now";
  EXPECT_FALSE(gap.acts(8, now));
}

TEST(HoldGap, AnotherHoldBegins) {
  HoldGap gap;
  EXPECT_TRUE(gap.goesOn(7, MonotonicTime{1000s}));
  EXPECT_FALSE(gap.goesOn(7, MonotonicTime{1001s}));
  EXPECT_TRUE(gap.goesOn(8, MonotonicTime{1001s}));
}

}  // namespace
}  // namespace rc10::web::test::hold_gap_test
