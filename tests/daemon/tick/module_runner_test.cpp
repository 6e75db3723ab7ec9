// Modules in the tick: their inputs, their targets, what they ask for.
#include "daemon/tick/module_runner.hpp"

#include <gmock/gmock.h>

#include "blackbox/memory_box.hpp"
#include "daemon/tick/scripted_module.hpp"

namespace rc10::test::module_runner_test {
namespace {

using ::testing::Contains;
using ::testing::Field;

TEST_F(ModuleRunnerTest, AModuleTurnsMotorsAsAClientWithItsNameAndPriority) {
  const ScriptedType type{[](const Tick&, ModuleRobot& robot) { robot.setTarget(0, rpm(50.0)); }};
  start({{&type, 3}});
  enable();
  robot_->run(500);
  EXPECT_NEAR(robot_->motor(0).feedback.velocity_rpm, 50.0F, 2.0F);
  EXPECT_EQ(robot_->motor(0).owner.view(), "module0");
  EXPECT_EQ(robot_->motor(1).owner.view(), "");
}

TEST_F(ModuleRunnerTest, AClientThatGoesOnAfterAGapIsNoOther) {
  const ScriptedType type;
  start({{&type, 0}});
  const auto before = senders();
  // Each message has lapsed when the next one comes.
  const auto after = [&](const char* client) {
    signal(client, 0, 1.0);
    robot_->run(100);
    return senders() - before;
  };
  EXPECT_EQ(after("planner"), 1.0);
  EXPECT_EQ(after("planner"), 1.0);
  EXPECT_EQ(after("panel"), 2.0);
  EXPECT_EQ(after("planner"), 3.0);
}

TEST_F(ModuleRunnerTest, ATargetActsInTheTickInWhichItIsSet) {
  turns_ = false;
  start({{&turning_, 0}});
  enable();
  turns_ = true;
  robot_->tick();
  EXPECT_EQ(robot_->motor(0).target.value, 50.0);
}

TEST_F(ModuleRunnerTest, AMotorFallsBackWhenItsModuleFallsSilent) {
  start({{&turning_, 0}});
  enable();
  robot_->run(100);
  turns_ = false;
  robot_->run(25);
  EXPECT_EQ(robot_->motor(0).target.mode, ControlMode::kCoast);
}

TEST_F(ModuleRunnerTest, AClientOfAHigherPriorityTakesTheMotorOverAndTheModuleIsToldOff) {
  bool obeys = true;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    obeys = robot.obeys(0);
    robot.setTarget(0, rpm(50.0));
    robot.setTarget(1, rpm(50.0));
  }};
  start({{&type, 3}});
  enable();
  robot_->run(10);
  EXPECT_TRUE(obeys);
  (void)robot_->events();
  robot_->commandAs("planner", 4, 0, rpm(-20.0));
  robot_->run(2);
  EXPECT_FALSE(obeys);
  EXPECT_EQ(robot_->motor(0).owner.view(), "planner");
  EXPECT_EQ(robot_->motor(0).target.value, -20.0);
  EXPECT_THAT(robot_->events(), Contains(Field(&Event::code, EventCode::kModuleRefused)));
  robot_->run(60);
  EXPECT_EQ(robot_->motor(0).owner.view(), "module0") << "once the planner is silent";
}

TEST_F(ModuleRunnerTest, AClientOfTheSamePriorityIsRefused) {
  const ScriptedType type{[](const Tick&, ModuleRobot& robot) { robot.setTarget(0, rpm(50.0)); }};
  start({{&type, 3}});
  enable();
  robot_->run(10);
  robot_->commandAs("planner", 3, 0, rpm(-20.0));
  robot_->run(2);
  EXPECT_EQ(robot_->motor(0).owner.view(), "module0");
}

TEST_F(ModuleRunnerTest, InputsHoldUntilTheirValidityEnds) {
  const ScriptedType type;
  start({{&type, 0}});
  signal("planner", 0, 12.0, 10ms);
  robot_->tick();
  EXPECT_EQ(seen(), 12.0);
  EXPECT_EQ(robot_->snapshot().modules[0].owner.view(), "planner");
  robot_->run(10);
  EXPECT_TRUE(std::isnan(seen()));
  EXPECT_EQ(robot_->snapshot().modules[0].owner.view(), "");
}

TEST_F(ModuleRunnerTest, TheAgeOfAClientsInputsIsCountedAndNotThatOfTheModulesTargets) {
  const ScriptedType type{[](const Tick&, ModuleRobot& robot) { robot.setTarget(0, rpm(50.0)); }};
  start({{&type, 0}});
  enable();
  const auto& ages = robot_->exchange().ages;
  robot_->run(10);
  EXPECT_EQ(ages.command.count(), 0U);
  signal("planner", 0, 12.0);
  robot_->run(10);
  EXPECT_EQ(ages.command.count(), 1U) << "once for a message";
  EXPECT_EQ(ages.command.max(), 1ms);
  ASSERT_EQ(ages.clients.count(), 1U);
  EXPECT_EQ(ages.clients.name(0).view(), "planner");
}

// Its last target acts for some ticks more.
TEST_F(ModuleRunnerTest, TheAgeOfATargetIsNotCountedWhenItsModuleFallsSilentEither) {
  start({{&turning_, 0}});
  enable();
  robot_->run(5);
  turns_ = false;
  robot_->run(5);
  EXPECT_EQ(robot_->motor(0).owner.view(), "module0");
  EXPECT_EQ(robot_->exchange().ages.command.count(), 0U);
  EXPECT_EQ(robot_->exchange().ages.clients.count(), 0U);
}

TEST_F(ModuleRunnerTest, ARemoteBeatsAPlannerInTheNextTick) {
  const ScriptedType type;
  start({{&type, 0}});
  signal("planner", 0, 12.0);
  robot_->tick();
  signal("planner", 0, 13.0);
  signal("remote", 10, -5.0);
  robot_->tick();
  EXPECT_EQ(seen(), -5.0);
  signal("planner", 0, 14.0);
  robot_->tick();
  EXPECT_EQ(seen(), -5.0);
  EXPECT_EQ(robot_->snapshot().refused_signals, 1U);
}

TEST_F(ModuleRunnerTest, AMessageThatIsTooOldIsRefused) {
  const ScriptedType type;
  start({{&type, 0}});
  signal("planner", 0, 12.0, 0ms);
  robot_->tick();
  EXPECT_TRUE(std::isnan(seen()));
  EXPECT_EQ(robot_->snapshot().refused_signals, 1U);
}

TEST_F(ModuleRunnerTest, AMessageThatIsTooOldEndsWhatItsClientSaidBefore) {
  const ScriptedType type;
  startFor("planner", type);
  signal("keyboard", 0, 3.0, 0ms);
  robot_->tick();
  EXPECT_EQ(seen(), 12.0) << "another client's";
  signal("planner", 0, 0.0, 0ms);
  robot_->tick();
  EXPECT_TRUE(std::isnan(seen()));
  EXPECT_EQ(robot_->snapshot().modules[0].owner.view(), "");
}

TEST_F(ModuleRunnerTest, AModuleGivesALaterOneItsInputInTheSameTick) {
  double value = kNoSignal;
  const ScriptedType remote{[&](const Tick&, ModuleRobot& robot) {
    if (!std::isnan(value)) robot.send({.module = 1, .signal = 0}, value);
  }};
  const ScriptedType chassis;
  start({{&remote, 10}, {&chassis, 0}});
  signal("planner", 0, 1.0);
  value = 30.0;
  robot_->tick();
  EXPECT_EQ(seen(1), 30.0);
  EXPECT_EQ(robot_->snapshot().modules[1].owner.view(), "module0");
  value = kNoSignal;
  robot_->run(25);
  EXPECT_TRUE(std::isnan(seen(1)));
}

// Its driver's last frame may be as old as lost_ms.
TEST_F(ModuleRunnerTest, AModuleReadsWhatAnEarlierOneGivesInTheSameTick) {
  double read = kNoSignal;
  const ScriptedType imu;
  const ScriptedType gimbal{
      [&](const Tick&, ModuleRobot& robot) { read = robot.read({.module = 0, .signal = 0}); }};
  start({{&imu, 0}, {&gimbal, 0}});
  signal("planner", 0, 45.0);
  robot_->tick();
  EXPECT_EQ(read, 45.0);
}

TEST_F(ModuleRunnerTest, AModuleEnablesAndDisablesTheRobot) {
  bool enable_now = false;
  bool disable_now = false;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    if (std::exchange(enable_now, false)) robot.askAll(RobotRequest::kEnable);
    if (std::exchange(disable_now, false)) robot.ask(RobotRequest::kDisable, 1);
  }};
  start({{&type, 0}});
  enable_now = true;
  robot_->run(3);
  EXPECT_EQ(robot_->motor(0).status, MotorStatus::kActive);
  EXPECT_EQ(robot_->motor(1).status, MotorStatus::kActive);
  disable_now = true;
  robot_->run(3);
  EXPECT_EQ(robot_->motor(0).status, MotorStatus::kActive);
  EXPECT_EQ(robot_->motor(1).status, MotorStatus::kReady);
  OrderResult result;
  EXPECT_FALSE(robot_->exchange().results.pop(result)) << "nobody else is told";
}

TEST_F(ModuleRunnerTest, AllItsTargetsActOrNoneWhateverOneIsSkippedFor) {
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    robot.setTarget(0, {.mode = ControlMode::kTotalAngle, .value = 90.0});
    robot.setTarget(1, {.mode = ControlMode::kTotalAngle, .value = 90.0});
  }};
  auto config = twoWheelsAndYaw();
  for (auto& motor : config.buses[0].motors) motor.settings.zero_at_power_on = true;
  config.buses[0].motors[0].shaping.max_first_step_deg = 10.0;
  start({{&type, 0}}, nullptr, config);
  enable();
  robot_->run(50);
  EXPECT_EQ(robot_->motor(0).acting, Acting::kNothing);
  EXPECT_EQ(robot_->motor(1).acting, Acting::kNothing) << "one half of a lift alone would rack it";
  EXPECT_GT(robot_->snapshot().skipped_setpoints, 0U);
}

TEST_F(ModuleRunnerTest, LettingGoIsNotWithheldWithTheOtherTargets) {
  bool lets_go = false;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    robot.setTarget(0, lets_go ? Target{} : rpm(60.0));
    if (lets_go) robot.setTarget(1, {.mode = ControlMode::kTotalAngle, .value = 90.0});
  }};
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[0].fallback.on_timeout = FallbackAction::kHold;
  start({{&type, 0}}, nullptr, config);
  enable();
  robot_->run(100);
  ASSERT_EQ(robot_->motor(0).acting, Acting::kTarget);
  (void)robot_->orderFor(MotorSet{}.set(1), Operation::kDisable);
  const auto skipped = robot_->snapshot().skipped_setpoints;
  lets_go = true;
  robot_->run(100);
  EXPECT_EQ(robot_->motor(0).acting, Acting::kNothing);
  EXPECT_GE(robot_->snapshot().skipped_setpoints, skipped + 100);
}

TEST_F(ModuleRunnerTest, OnlyADisableThatSomebodyAskedForLetsGoOfWhatAnEstopBrakes) {
  std::optional<RobotRequest> asks;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    if (asks) robot.askAll(*asks);
    asks.reset();
  }};
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[0].fallback.on_estop = FallbackAction::kHold;
  start({{&type, 0}}, nullptr, config);
  enable();
  asks = RobotRequest::kEstop;
  robot_->run(10);
  ASSERT_EQ(robot_->motor(0).acting, Acting::kHold);
  asks = RobotRequest::kDisableUnasked;
  robot_->run(10);
  EXPECT_EQ(robot_->motor(0).acting, Acting::kHold);
  asks = RobotRequest::kDisable;
  robot_->run(10);
  EXPECT_EQ(robot_->motor(0).acting, Acting::kNothing);
}

TEST_F(ModuleRunnerTest, MotorsThatAreEnabledTogetherAreAskedForInOneRequest) {
  bool enable_now = false;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    constexpr std::array<std::size_t, 2> kPair{0, 1};
    if (std::exchange(enable_now, false)) robot.ask(RobotRequest::kEnable, kPair);
  }};
  auto config = twoWheelsAndYaw();
  config.groups.push_back({.place = {}, .name = "lift", .motors = {0, 1}, .together = true});
  start({{&type, 0}}, nullptr, config);
  enable_now = true;
  robot_->run(5);
  EXPECT_EQ(robot_->motor(0).status, MotorStatus::kActive);
  EXPECT_EQ(robot_->motor(1).status, MotorStatus::kActive);
  EXPECT_EQ(robot_->motor(2).status, MotorStatus::kReady);
}

TEST_F(ModuleRunnerTest, AModuleKnowsHowLongNoClientWasHeard) {
  double silent_s = 0.0;
  bool remote = false;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    if (remote) robot.hearClient(robot_->now());
    silent_s = robot.clientsSilentSeconds();
  }};
  start({{&type, 0}});
  enable();
  robot_->run(100);
  EXPECT_GE(silent_s, 0.0999) << "a request";
  EXPECT_LT(silent_s, 0.11);
  robot_->command(0, rpm(10.0));
  robot_->run(3);
  EXPECT_NEAR(silent_s, 0.002, 1e-6) << "a command";
  robot_->run(50);
  signal("planner", 0, 45.0);
  robot_->run(3);
  EXPECT_NEAR(silent_s, 0.002, 1e-6) << "inputs";
  robot_->tick(900);
  EXPECT_LT(silent_s, 0.06) << "a pause, in which nobody could be heard";
  remote = true;
  robot_->run(50);
  EXPECT_EQ(silent_s, 0.0) << "a person at a remote";
}

TEST_F(ModuleRunnerTest, AModuleEnablesNothingBesideAMotorThatIsEnabledAlone) {
  bool enable_now = false;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    if (std::exchange(enable_now, false)) robot.askAll(RobotRequest::kEnable);
  }};
  start({{&type, 0}});
  (void)robot_->orderFor(MotorSet{0b001}, Operation::kEnableAlone);
  enable_now = true;
  robot_->run(5);
  EXPECT_EQ(robot_->motor(0).status, MotorStatus::kActive);
  EXPECT_EQ(robot_->motor(1).status, MotorStatus::kReady);
}

TEST_F(ModuleRunnerTest, AnEstopOfAModuleIsForTheWholeRobotAndLatches) {
  bool stop = false;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    robot.setTarget(0, rpm(50.0));
    if (stop) robot.ask(RobotRequest::kEstop, 1);
  }};
  start({{&type, 0}});
  enable();
  robot_->run(100);
  stop = true;
  robot_->tick();
  EXPECT_EQ(robot_->snapshot().state, RobotStatus::kEstop);
  EXPECT_EQ(robot_->motor(0).status, MotorStatus::kReady);
}

TEST_F(ModuleRunnerTest, AModuleMayZeroAMotorThatTurnsButNotOneThatFollowsAnAngle) {
  Target target = rpm(50.0);
  bool zero = false;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    robot.setTarget(0, target);
    if (std::exchange(zero, false)) robot.ask(RobotRequest::kZero, 0, 1000.0);
  }};
  start({{&type, 0}});
  enable();
  robot_->run(200);
  zero = true;
  robot_->run(2);
  EXPECT_NEAR(robot_->motor(0).feedback.total_angle_deg, 1000.0, 5.0);
  target = {.mode = ControlMode::kTotalAngle, .value = robot_->motor(0).feedback.total_angle_deg};
  robot_->run(100);
  zero = true;
  const double before_deg = robot_->motor(0).feedback.total_angle_deg;
  robot_->run(2);
  EXPECT_NEAR(robot_->motor(0).feedback.total_angle_deg, before_deg, 5.0);
  target.value = 5000.0;
  robot_->run(2000);
  zero = true;
  robot_->run(2);
  EXPECT_GT(robot_->motor(0).feedback.total_angle_deg, 1100.0);
}

TEST_F(ModuleRunnerTest, WhatAModuleReportsBecomesAnEvent) {
  bool report = false;
  const ScriptedType type{[&](const Tick&, ModuleRobot& robot) {
    if (std::exchange(report, false)) robot.report(1);
  }};
  start({{&type, 0}});
  (void)robot_->events();
  report = true;
  robot_->run(2);
  const auto events = robot_->events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, EventCode::kModule);
  EXPECT_EQ(events[0].severity, Severity::kInfo);
  EXPECT_EQ(events[0].source, 0);
  EXPECT_EQ(events[0].value, 1);
}

TEST_F(ModuleRunnerTest, ModulesRestWhileTheProcessStops) {
  int updates = 0;
  const ScriptedType type{[&](const Tick&, ModuleRobot&) { ++updates; }};
  start({{&type, 0}});
  robot_->scheduler().beginStop();
  robot_->tick();
  const int before = updates;
  robot_->run(5);
  EXPECT_EQ(updates, before);
}

TEST_F(ModuleRunnerTest, InputsAreRecordedWithWhatBecameOfThem) {
  MemoryBox box;
  FlightRecorder recorder{box.handOff()};
  const ScriptedType type;
  start({{&type, 0}, {&type, 0}}, &recorder);
  signal("planner", 3, 30.0);
  robot_->tick();
  signal("other", 3, 40.0);
  robot_->tick();
  signal("late", 9, 50.0, -1ms);
  robot_->tick();
  const auto recorded = all<blackbox::Signals>(box.recording());
  ASSERT_EQ(recorded.size(), 3U);
  EXPECT_EQ(recorded[0].client.view(), "planner");
  EXPECT_EQ(recorded[0].header.source, 0);
  EXPECT_EQ(recorded[0].header.id, 0b01U);
  EXPECT_EQ(recorded[0].values[0], 30.0);
  EXPECT_EQ(recorded[0].session, 7U);
  EXPECT_EQ(recorded[0].priority, 3);
  EXPECT_EQ(recorded[0].header.flags, static_cast<int>(blackbox::Verdict::kApplied));
  EXPECT_EQ(recorded[1].header.flags, static_cast<int>(blackbox::Verdict::kNotOwner));
  EXPECT_EQ(recorded[2].header.flags, static_cast<int>(blackbox::Verdict::kExpired));
}

TEST_F(ModuleRunnerTest, WhatAModuleTellsAnotherInEveryTickIsRecordedWhenItChangesAndAsASample) {
  MemoryBox box;
  FlightRecorder recorder{box.handOff()};
  double value = 1.0;
  const ScriptedType sending{[&](const Tick&, ModuleRobot& robot) { robot.send({1, 0}, value); }};
  const ScriptedType taking;
  start({{&sending, 0}, {&taking, 0}}, &recorder);
  const auto recorded = [&] { return all<blackbox::Signals>(box.recording()); };
  const auto at_start = recorded().size();
  EXPECT_EQ(at_start, 1U) << "ten ticks";
  value = 2.0;
  robot_->run(1000);
  EXPECT_EQ(recorded().size(), at_start + 20);
  EXPECT_EQ(recorded().back().client.view(), "module0");
  EXPECT_EQ(recorded().back().header.source, 1);
  EXPECT_EQ(recorded().back().values[0], 2.0);
}

}  // namespace
}  // namespace rc10::test::module_runner_test
