#include "daemon/watchdog.hpp"

#include <gtest/gtest.h>

namespace rc10::test::watchdog_test {
namespace {

TEST(Watchdog, IsFedWhileBothThreadsAdvance) {
  Watchdog watchdog;
  EXPECT_TRUE(watchdog.progressed(1, 1));
  EXPECT_TRUE(watchdog.progressed(101, 2));
}

TEST(Watchdog, IsNotFedBeforeTheFirstTick) {
  Watchdog watchdog;
  EXPECT_FALSE(watchdog.progressed(0, 5));
}

TEST(Watchdog, IsNotFedWhenTheSchedulerHangs) {
  Watchdog watchdog;
  (void)watchdog.progressed(100, 100);
  EXPECT_FALSE(watchdog.progressed(100, 200));
}

TEST(Watchdog, IsNotFedWhenTheRxLoopHangs) {
  Watchdog watchdog;
  (void)watchdog.progressed(100, 100);
  EXPECT_FALSE(watchdog.progressed(200, 100));
}

TEST(Watchdog, ProgressOfOneDoesNotMakeUpForTheOtherLater) {
  Watchdog watchdog;
  (void)watchdog.progressed(100, 100);
  EXPECT_FALSE(watchdog.progressed(200, 100));
  EXPECT_FALSE(watchdog.progressed(200, 200));
  EXPECT_TRUE(watchdog.progressed(201, 201));
}

}  // namespace
}  // namespace rc10::test::watchdog_test
