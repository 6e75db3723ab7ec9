#include "robot_client/session/silent_modules.hpp"

#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace test::silent_modules_test {
namespace {

using namespace std::chrono_literals;

constexpr MonotonicTime kStart{1000s};

TEST(SilentModules, OneOfWhichNothingIsHeardForASecondIsToldOnce) {
  SilentModules modules;
  EXPECT_FALSE(modules.sent("bsae", false, true, kStart));
  EXPECT_FALSE(modules.sent("bsae", false, true, kStart + 1s));
  EXPECT_TRUE(modules.sent("bsae", false, true, kStart + 1001ms));
  EXPECT_FALSE(modules.sent("bsae", false, true, kStart + 10s));
}

TEST(SilentModules, EachIsToldByItself) {
  SilentModules modules;
  EXPECT_FALSE(modules.sent("bsae", false, true, kStart));
  EXPECT_FALSE(modules.sent("gimabl", false, true, kStart + 900ms));
  EXPECT_TRUE(modules.sent("bsae", false, true, kStart + 1500ms));
  EXPECT_FALSE(modules.sent("gimabl", false, true, kStart + 1500ms));
  EXPECT_TRUE(modules.sent("gimabl", false, true, kStart + 2s));
}

TEST(SilentModules, OneThatIsHeardIsNotMissing) {
  SilentModules modules;
  EXPECT_FALSE(modules.sent("base", false, true, kStart));
  EXPECT_FALSE(modules.sent("base", true, true, kStart + 2s));
}

TEST(SilentModules, NoneIsMissingWhileTheRobotIsNotHeard) {
  SilentModules modules;
  EXPECT_FALSE(modules.sent("base", false, false, kStart));
  EXPECT_FALSE(modules.sent("base", false, false, kStart + 5s));
  EXPECT_FALSE(modules.sent("base", false, true, kStart + 6s)) << "the second begins with the robot's state";
  EXPECT_TRUE(modules.sent("base", false, true, kStart + 8s));
}

}  // namespace
}  // namespace test::silent_modules_test
}  // namespace robot_client
}  // namespace rc10
