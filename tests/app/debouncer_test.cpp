#include "app/debouncer.hpp"

#include <gtest/gtest.h>

namespace rc10::test::debouncer_test {
namespace {

using namespace std::chrono_literals;

class DebouncerTest : public ::testing::Test {
 protected:
  bool look(bool level) {
    now += 1ms;
    return debouncer.step(level, now);
  }

  MonotonicTime now{1000s};
  Debouncer debouncer{5ms};
};

TEST_F(DebouncerTest, TheFirstLookCountsAtOnce) {
  EXPECT_TRUE(look(true));
  EXPECT_FALSE((Debouncer{5ms}.step(false, now)));
}

TEST_F(DebouncerTest, ANewLevelCountsOnceItHasLasted) {
  EXPECT_FALSE(look(false));
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(look(true)) << i;
  EXPECT_TRUE(look(true));
}

TEST_F(DebouncerTest, BouncesDoNotCountAndStartTheTimeAnew) {
  EXPECT_FALSE(look(false));
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(look(i % 4 != 0)) << i;
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(look(true));
  bool counted = false;
  for (int i = 0; i < 3; ++i) counted = look(true);
  EXPECT_TRUE(counted);
}

TEST_F(DebouncerTest, WithoutATimeEveryLookCounts) {
  Debouncer direct{0ms};
  EXPECT_FALSE(direct.step(false, now));
  EXPECT_TRUE(direct.step(true, now));
  EXPECT_FALSE(direct.step(false, now));
}

TEST_F(DebouncerTest, AfterARestartTheNextLookIsTheFirst) {
  EXPECT_FALSE(look(false));
  debouncer.restart();
  EXPECT_TRUE(look(true));
}

}  // namespace
}  // namespace rc10::test::debouncer_test
