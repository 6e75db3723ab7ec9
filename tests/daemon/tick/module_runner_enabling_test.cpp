// Modules while their motors are enabled and disabled: inputs from before, and who enables by itself.
#include <gmock/gmock.h>

#include "daemon/tick/module_runner.hpp"
#include "daemon/tick/scripted_module.hpp"

namespace rc10::test::module_runner_test {
namespace {

TEST_F(ModuleRunnerTest, InputsFromBeforeEnablingDoNotActAfterIt) {
  start({{&following_, 0}});
  signal("planner", 0, 2.0, 1000ms);
  robot_->run(300);
  enable();
  expectNothingUntilANewerMessage();
}

TEST_F(ModuleRunnerTest, InputsFromBeforeAnEstopDoNotActAfterAnotherEnabling) {
  start({{&following_, 0}});
  enable();
  signal("planner", 0, 2.0, 1000ms);
  robot_->run(300);
  ASSERT_TRUE(follows());
  (void)robot_->order(Operation::kEstop);
  Order clear;
  clear.id = 1;
  clear.operation = Operation::kClear;
  clear.whole_robot = true;
  (void)robot_->carryOut(clear);
  enable();
  expectNothingUntilANewerMessage();
}

TEST_F(ModuleRunnerTest, InputsFromBeforeOneOfItsMotorsWasEnabledMoveNoneOfThem) {
  start({{&following_, 0}});
  (void)robot_->orderFor(MotorSet{0b001}, Operation::kEnable);
  signal("planner", 0, 2.0, 1000ms);
  robot_->run(300);
  (void)robot_->orderFor(MotorSet{0b010}, Operation::kEnable);
  expectNothingUntilANewerMessage();
}

TEST_F(ModuleRunnerTest, InputsFromBeforeAGroupIsArmedAnewDoNotActAfterIt) {
  auto config = twoWheelsAndYaw();
  config.groups.push_back(leftAndRight(GroupConfig::Return::kRearmAtRest));
  start({{&following_, 0}}, nullptr, config);
  enable();
  signal("planner", 0, 2.0, 1000ms);
  robot_->run(100);
  ASSERT_TRUE(follows());
  robot_->freezeBus(0, true);
  robot_->run(50);
  ASSERT_EQ(robot_->motor(0).status, MotorStatus::kOffline);
  robot_->freezeBus(0, false);
  for (int i = 0; i < 500 && robot_->motor(0).status != MotorStatus::kActive; ++i) robot_->tick();
  expectNothingUntilANewerMessage();
}

TEST_F(ModuleRunnerTest, InputsThatAnotherModulePassesOnAreAsOldAsThoseThatItGot) {
  const ScriptedType passing{[](const Tick&, ModuleRobot& robot) {
    const double asked_rpm = robot.read({.module = 0, .signal = 0});
    if (!std::isnan(asked_rpm)) robot.send({.module = 1, .signal = 0}, asked_rpm);
  }};
  const ScriptedType driven{[](const Tick&, ModuleRobot& robot) {
    const double asked_rpm = robot.read({.module = 1, .signal = 0});
    if (!std::isnan(asked_rpm)) robot.setTarget(0, rpm(asked_rpm));
  }};
  start({{&passing, 5}, {&driven, 0}});
  signal("planner", 0, 2.0, 1000ms);
  robot_->run(300);
  enable();
  expectNothingUntilANewerMessage();
}

TEST_F(ModuleRunnerTest, WhatARemotePassesOnIsAsOldAsItsLastFrame) {
  MonotonicTime frame{};
  const ScriptedType remote{[&](const Tick&, ModuleRobot& robot) {
    robot.hearClient(frame);
    robot.send({.module = 1, .signal = 0}, 2.0);
  }};
  const ScriptedType driven{[](const Tick&, ModuleRobot& robot) { robot.setTarget(0, rpm(2.0)); }};
  start({{&remote, 5}, {&driven, 0}});
  frame = robot_->now();
  robot_->run(10);
  enable();
  robot_->run(50);
  EXPECT_FALSE(follows());
  frame = robot_->now();
  robot_->run(2);
  EXPECT_TRUE(follows());
}

TEST_F(ModuleRunnerTest, AModuleIsToldThatItsMotorDoesNotObeyInputsFromBeforeEnabling) {
  bool obeys = false;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) { obeys = robot.obeys(0); }};
  start({{&type, 0}});
  signal("planner", 0, 2.0, 200ms);
  robot_->run(50);
  enable();
  robot_->run(3);
  EXPECT_FALSE(obeys);
  signal("planner", 0, 2.0, 50ms);
  robot_->run(2);
  EXPECT_TRUE(obeys);
  robot_->run(100);
  EXPECT_TRUE(obeys) << "what it does by itself, as to hold";
}

TEST_F(ModuleRunnerTest, AModuleThatEnablesSeesADisableThatSomebodyAskedForOrThatEndedAnEnabling) {
  std::uint32_t disables = 0;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) { disables = robot.disables(); }};
  start({{&type, 0}});
  const auto none = disables;
  const auto seen = [&](Asked asked) {
    const auto before = disables;
    Order order;
    order.id = 1;
    order.operation = Operation::kDisable;
    order.motors.set(0);
    order.asked = asked;
    (void)robot_->carryOut(order);
    return disables != before;
  };
  enable();
  EXPECT_EQ(disables, none);
  EXPECT_FALSE(seen(Asked::kUnasked)) << "a program has ended";
  EXPECT_TRUE(seen(Asked::kAnew)) << "even of a motor that is not on";
  EXPECT_TRUE(seen(Asked::kAgain));
  robot_->beginEnabling(MotorSet{0b001});
  EXPECT_TRUE(seen(Asked::kUnasked)) << "it ends an enabling";
}

}  // namespace
}  // namespace rc10::test::module_runner_test
