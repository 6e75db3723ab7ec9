#include "guard/standstill.hpp"

#include <gtest/gtest.h>

namespace rc10::guard::test::standstill_test {
namespace {

TEST(Standstill, IsToldAfterTheLimitAndUntilTicksGoOn) {
  Standstill standstill{20};
  EXPECT_FALSE(standstill.step(7));
  for (int step = 1; step < 4; ++step) EXPECT_FALSE(standstill.step(7)) << step;
  EXPECT_TRUE(standstill.step(7));
  EXPECT_TRUE(standstill.step(7));
  EXPECT_FALSE(standstill.step(8));
}

TEST(Standstill, OneTickInTimeIsEnough) {
  Standstill standstill{20};
  std::uint64_t ticks = 1;
  for (int step = 0; step < 1000; ++step) {
    if (step % 4 == 0) ++ticks;
    EXPECT_FALSE(standstill.step(ticks)) << step;
  }
}

TEST(Standstill, BeforeTheFirstTickNoDriveHasBeenCommanded) {
  Standstill standstill{20};
  for (int step = 0; step < 1000; ++step) EXPECT_FALSE(standstill.step(0)) << step;
}

TEST(Standstill, ALimitBetweenTwoStepsIsRoundedUp) {
  Standstill standstill{21};
  EXPECT_FALSE(standstill.step(1));
  for (int step = 1; step < 5; ++step) EXPECT_FALSE(standstill.step(1)) << step;
  EXPECT_TRUE(standstill.step(1));
}

}  // namespace
}  // namespace rc10::guard::test::standstill_test
