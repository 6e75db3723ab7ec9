// Modules whose program leaves: its last word ends what it said before, and begins nothing.
#include <gmock/gmock.h>

#include "daemon/tick/module_runner.hpp"
#include "daemon/tick/scripted_module.hpp"

namespace rc10::test::module_runner_test {
namespace {

class ModuleEndingTest : public ModuleRunnerTest {
 protected:
  void startTurning(FallbackAction on_timeout = FallbackAction::kCoast) {
    auto config = twoWheelsAndYaw();
    config.buses[0].motors[0].fallback.on_timeout = on_timeout;
    start({{&following_, 0}}, nullptr, config);
    enable();
  }
  /// "remote" turns the motors, and falls silent.
  void displace() {
    signal("remote", 10, -20.0);
    robot_->run(20);
    ASSERT_EQ(seen(), -20.0);
    robot_->run(1000);
    ASSERT_FALSE(follows());
  }
  /// Nothing but `acts`, in each tick.
  void expectNothingBegins(Acting acts) {
    for (int i = 0; i < 100; ++i) {
      robot_->tick();
      ASSERT_TRUE(std::isnan(seen())) << "after " << i << " ticks";
      ASSERT_EQ(robot_->motor(0).acting, acts) << "after " << i << " ticks";
      ASSERT_EQ(robot_->snapshot().modules[0].owner.view(), "");
    }
  }
};

TEST_F(ModuleEndingTest, TheSameInputsForAMillisecondEndThoseBefore) {
  startTurning();
  signal("planner", 0, 12.0, 1000ms);
  robot_->run(100);
  ASSERT_TRUE(follows());
  end("planner", 0, 12.0);
  robot_->run(2);
  EXPECT_TRUE(std::isnan(seen()));
  EXPECT_EQ(robot_->snapshot().modules[0].owner.view(), "");
  robot_->run(25);
  EXPECT_FALSE(follows());
}

TEST_F(ModuleEndingTest, TheyMayEndInTheTickInWhichTheyBegin) {
  startTurning();
  signal("planner", 0, 12.0, 1000ms);
  end("planner", 0, 12.0);
  robot_->tick();
  EXPECT_EQ(seen(), 12.0);
  robot_->tick();
  EXPECT_TRUE(std::isnan(seen()));
}

TEST_F(ModuleEndingTest, InputsThatWereDisplacedDoNotComeBackWhenTheirProgramLeaves) {
  for (const auto on_timeout : {FallbackAction::kCoast, FallbackAction::kHold}) {
    startTurning(on_timeout);
    signal("planner", 0, 12.0, 1000ms);
    robot_->run(20);
    displace();
    end("planner", 0, 12.0);
    expectNothingBegins(on_timeout == FallbackAction::kHold ? Acting::kHold : Acting::kNothing);
  }
}

TEST_F(ModuleEndingTest, InputsThatWereRefusedDoNotBeginWhenTheirProgramLeaves) {
  startTurning();
  signal("remote", 10, -20.0);
  robot_->run(20);
  signal("planner", 0, 12.0, 1000ms);
  displace();
  const auto refused = robot_->snapshot().refused_signals;
  end("planner", 0, 12.0);
  expectNothingBegins(Acting::kNothing);
  EXPECT_EQ(robot_->snapshot().refused_signals, refused + 1);
}

TEST_F(ModuleEndingTest, InputsThatHaveLapsedATickAgoDoNotBeginAnew) {
  startTurning();
  signal("planner", 0, 12.0, 20ms);
  robot_->run(20);
  ASSERT_TRUE(std::isnan(seen()));
  end("planner", 0, 12.0);
  robot_->tick();
  EXPECT_TRUE(std::isnan(seen()));
}

TEST_F(ModuleEndingTest, AProgramThatLeavesDisplacesNobodyWhateverItsPriority) {
  startTurning();
  signal("planner", 0, 12.0, 1000ms);
  robot_->run(20);
  end("boss", 20, -20.0);
  robot_->run(20);
  EXPECT_EQ(seen(), 12.0);
  EXPECT_EQ(robot_->snapshot().modules[0].owner.view(), "planner");
}

TEST_F(ModuleEndingTest, InputsFromBeforeEnablingEndWithoutAMove) {
  start({{&following_, 0}});
  signal("planner", 0, 12.0, 1000ms);
  robot_->run(100);
  enable();
  end("planner", 0, 12.0);
  for (int i = 0; i < 100; ++i) {
    robot_->tick();
    ASSERT_FALSE(follows()) << "after " << i << " ticks";
  }
  EXPECT_EQ(robot_->snapshot().modules[0].owner.view(), "");
}

}  // namespace
}  // namespace rc10::test::module_runner_test
