#include "daemon/exit_limit.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

namespace rc10::test::exit_limit_test {
namespace {

using namespace std::chrono_literals;

TEST(ExitLimitDeathTest, AProcessThatHangsEndsWithItsStatus) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        limitExit(10ms, 3);
        for (;;) ::pause();
      },
      ::testing::ExitedWithCode(3), "");
}

}  // namespace
}  // namespace rc10::test::exit_limit_test
