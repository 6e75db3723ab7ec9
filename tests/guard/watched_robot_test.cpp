// Tests without a CAN interface; with one: tests/kernel/test_guard.py.
#include "guard/watched_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "link/guard_hello.hpp"

namespace rc10::guard::test::watched_robot_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StrEq;

/// A process that stands for rc10d, and the page that it would write.
class WatchedRobotTest : public testing::Test {
 protected:
  WatchedRobotTest() : child(::fork()), page(*link::SharedGuardPage::create()) {
    if (child == 0) {
      for (;;) ::pause();
    }
  }
  ~WatchedRobotTest() override { kill(); }

  void kill() {
    if (child <= 0) return;
    EXPECT_EQ(::kill(child, SIGKILL), 0);
    EXPECT_EQ(::waitpid(child, nullptr, 0), child);
    child = 0;
    dead = true;
  }
  [[nodiscard]] Result<WatchedRobot> watch(const std::string& text) const {
    link::DescriptorMessage message;
    message.text = text;
    message.descriptors.emplace_back(::dup(page.descriptor()));
    message.descriptors.emplace_back(static_cast<int>(::syscall(SYS_pidfd_open, child, 0)));
    return WatchedRobot::from(std::move(message));
  }
  [[nodiscard]] WatchedRobot watched() const {
    return std::move(
        *watch(link::guardHelloText({.robot = "hero", .standstill_ms = 20, .rest_frames = "# none\n"})));
  }

  pid_t child;
  bool dead = false;
  link::SharedGuardPage page;
};

TEST_F(WatchedRobotTest, EachStepIsABeatForRc10d) {
  auto robot = watched();
  EXPECT_THAT(robot.step(dead), IsEmpty());
  EXPECT_EQ(page->beats.load(), 1U);
  EXPECT_THAT(robot.step(dead), IsEmpty());
  EXPECT_EQ(page->beats.load(), 2U);
}

TEST_F(WatchedRobotTest, ADeathAmongTicksIsAnsweredInTheSameStep) {
  auto robot = watched();
  page->ticks.store(1);
  EXPECT_THAT(robot.step(dead), IsEmpty());
  kill();
  EXPECT_THAT(robot.step(dead), HasSubstr("robot 'hero': rc10d has died"));
  EXPECT_TRUE(page->acted.load());
}

TEST_F(WatchedRobotTest, ADeathAfterAnOrderlyEndIsNone) {
  auto robot = watched();
  page->ticks.store(1);
  page->ended.store(true);
  kill();
  EXPECT_THAT(robot.step(dead), IsEmpty());
  EXPECT_TRUE(robot.over());
  EXPECT_FALSE(page->acted.load());
}

TEST_F(WatchedRobotTest, OneThatGoesOnAndEndsInOrderWithinAStepIsOver) {
  auto robot = watched();
  page->ticks.store(1);
  for (int step = 0; step < 6; ++step) (void)robot.step(dead);
  ASSERT_TRUE(robot.rests());
  page->ticks.store(5);
  page->ended.store(true);
  EXPECT_THAT(robot.step(dead), IsEmpty());
  EXPECT_FALSE(robot.rests());
  kill();
  EXPECT_THAT(robot.step(dead), IsEmpty());
  EXPECT_TRUE(robot.over());
}

TEST_F(WatchedRobotTest, ADeathBeforeTheFirstTickFindsNothingToRest) {
  auto robot = watched();
  kill();
  EXPECT_THAT(robot.step(dead), IsEmpty());
  EXPECT_TRUE(robot.over());
  EXPECT_FALSE(page->acted.load());
}

TEST_F(WatchedRobotTest, AfterAnOrderlyEndTicksMayStandStill) {
  auto robot = watched();
  page->ticks.store(1);
  page->ended.store(true);
  for (int step = 0; step < 100; ++step) EXPECT_THAT(robot.step(dead), IsEmpty());
  EXPECT_FALSE(page->acted.load());
}

TEST_F(WatchedRobotTest, AStandstillIsActedUponOnceAndWatchedOn) {
  auto robot = watched();
  page->ticks.store(5);
  for (int step = 0; step < 4; ++step) EXPECT_THAT(robot.step(dead), IsEmpty());
  EXPECT_THAT(robot.step(dead), HasSubstr("the ticks of rc10d stand still"));
  EXPECT_TRUE(page->acted.load());
  EXPECT_THAT(robot.step(dead), HasSubstr("the rest frames are on the wire"));
  EXPECT_THAT(robot.step(dead), IsEmpty());
  page->ticks.store(6);
  EXPECT_THAT(robot.step(dead), HasSubstr("ticks again"));
  page->acted.store(false);
  for (int step = 0; step < 3; ++step) EXPECT_THAT(robot.step(dead), IsEmpty());
  EXPECT_THAT(robot.step(dead), HasSubstr("stand still")) << "a second time";
  EXPECT_TRUE(page->acted.load());
}

TEST_F(WatchedRobotTest, DeathEndsTheWatchWhenEveryBusHasCarriedTheFrames) {
  auto robot = watched();
  page->ticks.store(5);
  kill();
  EXPECT_THAT(robot.step(dead), HasSubstr("has died"));
  EXPECT_FALSE(robot.over());
  EXPECT_THAT(robot.step(dead), HasSubstr("on the wire"));
  EXPECT_TRUE(robot.over());
}

TEST_F(WatchedRobotTest, AHelloOfAnotherVersionIsRefusedWithTheRemedy) {
  const auto robot = watch("rc10-guard 2 hero 20\n");
  ASSERT_FALSE(robot);
  EXPECT_THAT(robot.error().message,
              StrEq("rc10d speaks version 2 and rc10-guard version 1: restart rc10-guard"));
}

TEST_F(WatchedRobotTest, AnInterfaceThatIsMissingIsNamed) {
  const auto robot = watch("rc10-guard 1 hero 20\ncan_none 200#00\n");
  ASSERT_FALSE(robot);
  EXPECT_THAT(robot.error().message, HasSubstr("'can_none'"));
}

TEST_F(WatchedRobotTest, AMalformedHelloIsRefused) {
  for (const auto* text :
       {"", "hello\n", "rc10-guard 1 hero 20", "rc10-guard 1 ../x 20\n", "rc10-guard 1 hero 0\n",
        "rc10-guard 1 hero -1\n", "rc10-guard 1 hero 20\nvcan0 nonsense\n"}) {
    EXPECT_FALSE(watch(text)) << text;
  }
}

}  // namespace
}  // namespace rc10::guard::test::watched_robot_test
