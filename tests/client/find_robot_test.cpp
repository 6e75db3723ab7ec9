#include "client/find_robot.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_rc10d.hpp"

namespace rc10::test::find_robot_test {
namespace {

using testing::HasSubstr;

TEST(FindRobot, TakesTheNamedOneWithoutAsking) {
  TemporaryRunDir dir;
  (void)dir.listen("hero");
  const auto found = findRobot("hero");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->robot, "hero");
  EXPECT_EQ(found->path, dir.path() + "/hero.sock");
}

TEST(FindRobot, SuggestsTheRobotThatRunsForANameThatNoneHas) {
  TemporaryRunDir dir;
  const auto sentry = dir.listen("sentry");
  const auto hero = dir.listen("hero");
  (void)dir.listen("infantry");
  const auto found = findRobot("heor");
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message, HasSubstr("rc10d is not running for robot 'heor' (no socket "));
  EXPECT_THAT(found.error().message,
              testing::EndsWith("; robots that run here: hero, sentry; did you mean hero?"));
}

TEST(FindRobot, RefusesANameThatIsAPath) {
  EXPECT_FALSE(findRobot("../hero"));
  EXPECT_FALSE(findRobot(""));
}

TEST(FindRobot, TakesTheOnlyOne) {
  TemporaryRunDir dir;
  const auto listener = dir.listen("hero");
  std::ofstream(dir.file("notes.sock")) << "not a socket";
  std::ofstream(dir.file("hero.lock")) << "1";
  const auto found = findRobot(std::nullopt);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->robot, "hero");
  EXPECT_EQ(found->path, dir.path() + "/hero.sock");
}

TEST(FindRobot, ListsSeveral) {
  TemporaryRunDir dir;
  const auto sentry = dir.listen("sentry");
  const auto hero = dir.listen("hero");
  const auto found = findRobot(std::nullopt);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().message, "several robots run here: hero, sentry; choose one with --robot NAME");
}

TEST(FindRobot, DoesNotCountTheSocketsOfTheDead) {
  TemporaryRunDir dir;
  const auto sentry = dir.listen("sentry");
  (void)dir.listen("hero");
  const auto found = findRobot(std::nullopt);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->robot, "sentry");
}

TEST(FindRobot, SaysHowToStartWhereNoneRuns) {
  TemporaryRunDir dir;
  const auto found = findRobot(std::nullopt);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message, HasSubstr("rc10d is not running (no socket in " + dir.path() + ")"));
  EXPECT_THAT(found.error().message, HasSubstr("systemctl start rc10d"));
}

TEST(FindRobot, SaysTheSameWhereThereIsNoFolder) {
  TemporaryRunDir dir;
  ::setenv("RC10_RUN_DIR", (dir.path() + "/none").c_str(), 1);
  EXPECT_THAT(findRobot(std::nullopt).error().message, HasSubstr("rc10d is not running"));
}

}  // namespace
}  // namespace rc10::test::find_robot_test
