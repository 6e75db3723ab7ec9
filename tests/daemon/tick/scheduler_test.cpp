#include "daemon/tick/scheduler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/alloc_guard.hpp"

#include "drives/dji/dji_simulated.hpp"

namespace rc10::test::scheduler_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr std::size_t kYaw = 2;

const Target kVelocity120{.mode = ControlMode::kVelocity, .value = 120.0};

class SchedulerTest : public ::testing::Test {
 protected:
  /// It ends, watched, and waits for echoes of its rest frames.
  void stopWatchedBy(link::GuardPage& page) {
    robot.scheduler().watchedBy(page);
    robot.run(5);
    robot.inboxes()[0].echo_reads.store(1);
    robot.scheduler().beginStop();
  }
  void enableAll() {
    robot.run(5);
    const auto result = robot.order(Operation::kEnable);
    for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(result.motors[i], Refusal::kNone);
  }
  bool reported(EventCode code, std::int16_t source) {
    const auto events = robot.events();
    return std::any_of(events.begin(), events.end(),
                       [&](const Event& e) { return e.code == code && e.source == source; });
  }

  VirtualRobot robot{twoWheelsAndYaw()};
};

TEST_F(SchedulerTest, NothingIsActiveAtStart) {
  robot.tick();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(robot.motor(i).status, MotorStatus::kOffline);
  robot.run(10);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(robot.motor(i).status, MotorStatus::kReady);
    EXPECT_EQ(robot.motor(i).command_value, 0.0F);
  }
}

TEST_F(SchedulerTest, AnEnabledMotorFollowsItsVelocity) {
  enableAll();
  robot.hold(kLeft, kVelocity120, 1500);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
  EXPECT_NEAR(robot.motor(kLeft).feedback.velocity_rpm, 120.0F, 2.0F);
  EXPECT_NEAR(robot.motor(kRight).feedback.velocity_rpm, 0.0F, 0.5F);
}

TEST_F(SchedulerTest, SkipsASetpointForAMotorThatIsNotActiveAndSaysSo) {
  robot.run(5);
  robot.command(kLeft, kVelocity120);
  robot.tick();
  EXPECT_EQ(robot.snapshot().skipped_setpoints, 1U);
  EXPECT_EQ(robot.motor(kLeft).target.mode, ControlMode::kCoast);
  const auto events = robot.events();
  const auto found = std::find_if(events.begin(), events.end(),
                                  [](const Event& e) { return e.code == EventCode::kSetpointSkipped; });
  ASSERT_NE(found, events.end());
  EXPECT_EQ(found->source, static_cast<std::int16_t>(kLeft));
  // As docs/lcm.md says: the mode, plus 256 times the status.
  EXPECT_EQ(found->extra,
            static_cast<int>(ControlMode::kVelocity) + 256 * static_cast<int>(MotorStatus::kReady));
}

TEST_F(SchedulerTest, ReportsSkippedSetpointsAtMostOnceASecond) {
  robot.run(5);
  (void)robot.events();
  for (int i = 0; i < 2500; ++i) {
    robot.command(kLeft, kVelocity120);
    robot.tick();
  }
  const auto events = robot.events();
  EXPECT_EQ(std::count_if(events.begin(), events.end(),
                          [](const Event& e) { return e.code == EventCode::kSetpointSkipped; }),
            3);
}

TEST_F(SchedulerTest, CoastsInTheFirstTickAfterTheDeadline) {
  enableAll();
  robot.command(kLeft, {.mode = ControlMode::kCurrent, .value = 2.0}, 50ms);
  // The deadline lies 50 ms after the tick before the command: 49 whole ticks obey.
  for (int i = 0; i < 49; ++i) {
    robot.tick();
    ASSERT_EQ(robot.motor(kLeft).command_value, 2.0F) << "tick " << i;
  }
  robot.tick();
  EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
  EXPECT_TRUE(reported(EventCode::kCommandTimeout, kLeft));
}

TEST_F(SchedulerTest, RefusesACommandThatExpiredInTheRing) {
  enableAll();
  robot.command(kLeft, kVelocity120, 1ms);
  robot.tick();
  EXPECT_EQ(robot.motor(kLeft).target.mode, ControlMode::kCoast);
  EXPECT_EQ(robot.snapshot().expired_commands, 1U);
}

TEST_F(SchedulerTest, ACommandThatComesTooLateEndsWhatItsSenderToldTheMotorBefore) {
  enableAll();
  const Target current{.mode = ControlMode::kCurrent, .value = 2.0};
  robot.command(kLeft, current, 900ms);
  robot.command(kRight, current, 900ms);
  robot.run(20);
  ASSERT_EQ(robot.motor(kLeft).command_value, 2.0F);
  (void)robot.events();
  // The last word of a client that lets go, on a busy computer.
  robot.command(kLeft, current, 1ms);
  robot.tick();
  EXPECT_EQ(robot.snapshot().expired_commands, 1U);
  EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
  EXPECT_TRUE(reported(EventCode::kCommandTimeout, kLeft));
  EXPECT_EQ(robot.motor(kRight).command_value, 2.0F) << "it does not name this one";
}

TEST_F(SchedulerTest, ACommandThatComesTooLateEndsNothingOfAnotherSender) {
  enableAll();
  robot.command(kLeft, {.mode = ControlMode::kCurrent, .value = 2.0}, 900ms);
  robot.run(20);
  ASSERT_EQ(robot.motor(kLeft).command_value, 2.0F);
  auto& commands = robot.exchange().commands;
  Command late;
  late.client = "test";
  late.session = ~std::uint64_t{0};
  late.priority = 1000;
  late.count = 1;
  late.setpoints[0] = {.motor = kLeft, .target = {.mode = ControlMode::kCurrent, .value = -2.0}};
  ASSERT_TRUE(commands.push(late));
  robot.tick();
  EXPECT_EQ(robot.motor(kLeft).command_value, 2.0F);
}

TEST_F(SchedulerTest, ATargetFromBeforeEnablingDoesNotActAfterIt) {
  enableAll();
  robot.command(kLeft, {.mode = ControlMode::kCurrent, .value = 2.0}, 900ms);
  robot.tick();
  ASSERT_EQ(robot.motor(kLeft).command_value, 2.0F);
  robot.order(Operation::kDisable);
  EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
  robot.order(Operation::kEnable);
  robot.run(3);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
  EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
}

TEST_F(SchedulerTest, CoastLetsGoOfTheMotor) {
  enableAll();
  robot.hold(kLeft, kVelocity120, 50);
  EXPECT_EQ(robot.motor(kLeft).owner.view(), "test");
  robot.command(kLeft, {.mode = ControlMode::kCoast});
  robot.tick();
  EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
  EXPECT_EQ(robot.motor(kLeft).owner.view(), "test");  // while the COAST is valid
  (void)robot.events();
  robot.run(50);
  EXPECT_EQ(robot.motor(kLeft).owner.view(), "");
  EXPECT_TRUE(robot.events().empty());
}

TEST_F(SchedulerTest, CoastForAMotorThatIsNotActiveIsNoMistake) {
  robot.run(5);
  robot.command(kLeft, {.mode = ControlMode::kCoast});
  robot.tick();
  EXPECT_EQ(robot.snapshot().skipped_setpoints, 0U);
}

TEST_F(SchedulerTest, EstopRestsEveryMotorInTheNextTickAndLatches) {
  enableAll();
  robot.hold(kLeft, kVelocity120, 100);
  robot.exchange().estop.store(true);
  robot.tick();
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
  EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
  robot.hold(kLeft, kVelocity120, 20);
  EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
  EXPECT_EQ(robot.order(Operation::kEnable).motors[kLeft], Refusal::kEstop);
  // Not while it still turns.
  EXPECT_EQ(robot.order(Operation::kClear).motors[kLeft], Refusal::kMoving);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
  robot.run(5000);
  EXPECT_EQ(robot.order(Operation::kClear).motors[kLeft], Refusal::kNone);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kReady);
}

TEST_F(SchedulerTest, AnEstopAskedForInTheTickOfAClearWins) {
  robot.run(5);
  robot.exchange().estop.store(true);
  robot.tick();
  robot.exchange().estop.store(true);
  EXPECT_EQ(robot.order(Operation::kClear).motors[kLeft], Refusal::kEstopAsked);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
  EXPECT_EQ(robot.order(Operation::kClear).motors[kLeft], Refusal::kNone);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun);
}

TEST_F(SchedulerTest, AnEstopRequestBeforeAClearOfTheSameTickWins) {
  robot.run(5);
  const auto ask = [&](std::uint64_t id, Operation operation) {
    Order order;
    order.id = id;
    order.operation = operation;
    order.whole_robot = true;
    robot.exchange().orders.push(order);
  };
  ask(100, Operation::kEstop);
  ask(101, Operation::kClear);
  robot.tick();
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
  ask(102, Operation::kClear);
  ask(103, Operation::kEstop);
  robot.tick();
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
}

TEST_F(SchedulerTest, ClearingTheFaultsOfAllMotorsByNameLeavesTheEstop) {
  robot.run(5);
  robot.exchange().estop.store(true);
  robot.tick();
  MotorSet all;
  for (std::size_t i = 0; i < robot.robot().motors().size(); ++i) all.set(i);
  const auto cleared = robot.orderFor(all, Operation::kClear);
  EXPECT_EQ(cleared.motors[kLeft], Refusal::kNone);
  EXPECT_TRUE(cleared.estop_stays);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
  EXPECT_FALSE(robot.order(Operation::kClear).estop_stays);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun);
}

TEST_F(SchedulerTest, AnEstopIsNotClearedWhileAMotorThatWasLostInMotionMayStillTurn) {
  enableAll();
  robot.hold(kLeft, kVelocity120, 100);
  robot.freezeSimulation(true);
  robot.exchange().estop.store(true);
  robot.run(2000);
  EXPECT_EQ(robot.order(Operation::kClear).motors[kLeft], Refusal::kMayTurn);
  robot.run(2500);
  EXPECT_EQ(robot.order(Operation::kClear).motors[kLeft], Refusal::kMayTurn);
  robot.run(600);
  EXPECT_EQ(robot.order(Operation::kClear).motors[kLeft], Refusal::kNone);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kRun);
}

TEST_F(SchedulerTest, NorWhileOneMayTurnThatWasEnabledAfterItWasLastHeard) {
  robot.run(50);
  robot.freezeSimulation(true);
  (void)robot.order(Operation::kEnable);
  ASSERT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
  robot.hold(kLeft, {.mode = ControlMode::kCurrent, .value = 2.0}, 5);
  ASSERT_EQ(robot.motor(kLeft).command_value, 2.0F);
  robot.exchange().estop.store(true);
  robot.run(100);
  EXPECT_EQ(robot.order(Operation::kClear).motors[kLeft], Refusal::kMayTurn);
}

TEST_F(SchedulerTest, AMotorThatWasLostAtRestKeepsNoEstop) {
  robot.run(50);
  robot.freezeSimulation(true);
  robot.exchange().estop.store(true);
  robot.run(100);
  EXPECT_EQ(robot.order(Operation::kClear).motors[kLeft], Refusal::kNone);
}

TEST_F(SchedulerTest, EstopGetsThroughWhenEveryRingIsFull) {
  enableAll();
  const Order disable_nobody{99, Operation::kDisable, MotorSet{}, 0.0};
  while (robot.exchange().orders.push(disable_nobody)) {
  }
  robot.exchange().estop.store(true);
  robot.tick();
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kEstop);
}

TEST_F(SchedulerTest, ATickAppliesABoundedNumberOfSetpoints) {
  Command command;
  command.count = kMaxMotors;
  command.deadline = robot.now() + 1h;
  auto& ring = robot.exchange().commands;
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(ring.push(command));
  robot.tick();
  EXPECT_EQ(ring.read_available(), 20 - kSetpointsPerTick / kMaxMotors);
  robot.tick();
  robot.tick();
  EXPECT_EQ(ring.read_available(), 0U) << "nothing is lost";
}

TEST_F(SchedulerTest, ASilentMotorGoesOfflineAndMustBeEnabledAgain) {
  enableAll();
  robot.hold(kLeft, kVelocity120, 100);
  robot.simBus().silence(kLeft, true);
  robot.hold(kLeft, kVelocity120, 25);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kOffline);
  EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
  EXPECT_EQ(robot.motor(kRight).status, MotorStatus::kActive);
  robot.simBus().silence(kLeft, false);
  robot.hold(kLeft, kVelocity120, 25);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kReady);
  EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
}

TEST_F(SchedulerTest, RefusesToEnableAnOfflineMotorAndNamesTheReason) {
  robot.simBus().silence(kRight, true);
  robot.run(30);
  const auto result = robot.order(Operation::kEnable);
  EXPECT_EQ(result.motors[kLeft], Refusal::kNone);
  EXPECT_EQ(result.motors[kRight], Refusal::kOffline);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
}

TEST_F(SchedulerTest, SetsAZeroOnlyWhileAMotorIsNotActive) {
  enableAll();
  EXPECT_EQ(robot.order(Operation::kZero, 90.0).motors[kLeft], Refusal::kActive);
  robot.order(Operation::kDisable);
  EXPECT_EQ(robot.order(Operation::kZero, 90.0).motors[kLeft], Refusal::kNone);
  robot.tick();
  EXPECT_NEAR(robot.motor(kLeft).feedback.total_angle_deg, 90.0, 0.1);
}

TEST(SchedulerReference, RefusesAnglesUntilTheMotorIsZeroed) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[0].settings.zero_at_power_on = false;
  VirtualRobot robot(config);
  robot.run(5);
  robot.order(Operation::kEnable);
  const Target angle{.mode = ControlMode::kTotalAngle, .value = 10.0};
  robot.hold(kLeft, angle, 5);
  EXPECT_EQ(robot.motor(kLeft).target.mode, ControlMode::kCoast);
  robot.order(Operation::kDisable);
  robot.order(Operation::kZero);
  robot.order(Operation::kEnable);
  robot.hold(kLeft, angle, 1000);
  EXPECT_NEAR(robot.motor(kLeft).feedback.total_angle_deg, 10.0, 0.5);
}

TEST_F(SchedulerTest, CountsMissedTicksAndNeverReplaysThem) {
  robot.run(10);
  const auto before = robot.scheduler().ticks();
  robot.tick(4);
  EXPECT_EQ(robot.scheduler().ticks(), before + 1);
  EXPECT_EQ(robot.snapshot().missed_ticks, 3U);
  EXPECT_TRUE(reported(EventCode::kTicksMissed, -1));
}

TEST_F(SchedulerTest, StoppingSendsRestUntilItIsDone) {
  enableAll();
  robot.hold(kLeft, kVelocity120, 200);
  ASSERT_NE(robot.motor(kLeft).command_value, 0.0F);
  robot.scheduler().beginStop();
  int ticks = 0;
  while (!robot.scheduler().stopped() && ticks < 100) {
    robot.command(kLeft, kVelocity120);
    robot.tick();
    EXPECT_EQ(robot.motor(kLeft).command_value, 0.0F);
    ++ticks;
  }
  EXPECT_TRUE(robot.scheduler().stopped());
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kStopping);
  EXPECT_EQ(dynamic_cast<sim::DjiDrive&>(robot.simBus().drive(kLeft)).rawCommand(), 0);
}

TEST_F(SchedulerTest, AStopIsNoEstopAndEndsAsAStopWhateverIsAskedMeanwhile) {
  robot.run(5);
  robot.inboxes()[0].echo_reads.store(1);  // it waits for echoes
  robot.scheduler().beginStop();
  robot.tick();
  (void)robot.events();
  robot.exchange().estop.store(true);
  robot.tick();
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kStopping);
  EXPECT_FALSE(reported(EventCode::kRobotState, -1));
  EXPECT_EQ(robot.order(Operation::kEnable).motors[kLeft], Refusal::kStopping);
  EXPECT_EQ(robot.motor(kLeft).status, MotorStatus::kReady);
  (void)robot.order(Operation::kClear);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kStopping);
}

TEST_F(SchedulerTest, StoppingWaitsForEchoesOfTheRestFrames) {
  robot.run(5);
  robot.inboxes()[0].echo_reads.store(1);
  robot.inboxes()[0].confirmed.store(1000);  // of frames before the stop
  robot.scheduler().beginStop();
  robot.run(10);
  EXPECT_FALSE(robot.scheduler().stopped());
  robot.inboxes()[0].confirmed.fetch_add(10);
  robot.tick();
  EXPECT_TRUE(robot.scheduler().stopped());
}

TEST(SchedulerStop, DoesNotWaitForTheTurnOfADriveThatIsToldSeldom) {
  const auto outcome = parseRobotConfig(
      "robot: kart\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    motors:\n"
      "      - {name: wheel, model: VESC, id: 10, pole_pairs: 7, command_divider: 100}\n",
      "kart.yaml");
  ASSERT_TRUE(outcome.config) << outcome.errorText();
  VirtualRobot robot{*outcome.config};
  robot.run(20);
  robot.inboxes()[0].echo_reads = 1;
  const auto echo = [&] { robot.inboxes()[0].confirmed = robot.snapshot().buses[0].counters.tx_watched; };
  echo();
  robot.scheduler().beginStop();
  for (int i = 0; i < 10 && !robot.scheduler().stopped(); ++i) {
    robot.tick();
    echo();
  }
  EXPECT_TRUE(robot.scheduler().stopped());
  EXPECT_TRUE(robot.scheduler().restEchoed());
}

TEST_F(SchedulerTest, TheLastTickTellsTheGuardThatTheEndIsInOrder) {
  link::GuardPage page;
  stopWatchedBy(page);
  robot.run(10);
  ASSERT_FALSE(robot.scheduler().stopped());
  EXPECT_FALSE(page.ended) << "rest frames are still on their way";
  robot.inboxes()[0].confirmed.fetch_add(10);
  robot.tick();
  ASSERT_TRUE(robot.scheduler().stopped());
  EXPECT_TRUE(page.ended);
}

TEST_F(SchedulerTest, AnEndWhoseRestFramesNoBusHasCarriedLeavesTheGuardItsWork) {
  link::GuardPage page;
  stopWatchedBy(page);
  robot.run(500);
  ASSERT_TRUE(robot.scheduler().stopped()) << "it does not wait for ever";
  EXPECT_FALSE(robot.scheduler().restEchoed());
  EXPECT_FALSE(page.ended) << "torque frames may wait in a queue";
}

TEST_F(SchedulerTest, EveryCommandIdLeavesInEveryTick) {
  robot.run(100);
  // M3508 1 and 2 share 0x200; GM6020 5 has 0x2FE.
  EXPECT_EQ(robot.snapshot().buses[0].counters.tx_frames, 200U);
  EXPECT_EQ(robot.snapshot().buses[0].counters.tx_dropped, 0U);
}

TEST_F(SchedulerTest, ShowsAnAngleTargetOfAnAbsoluteMotorAtOnce) {
  enableAll();
  EXPECT_TRUE(robot.motor(kYaw).feedback.zeroed);
  robot.hold(kYaw, {.mode = ControlMode::kAngle, .value = 45.0}, 1500);
  EXPECT_NEAR(robot.motor(kYaw).feedback.angle_deg, 45.0F, 0.5F);
}

TEST_F(SchedulerTest, TheHeartbeatRestsSoLongAfterAnEstop) {
  robot.scheduler().restHeartbeatAfter(20ms);
  enableAll();
  EXPECT_EQ(robot.scheduler().beats(), robot.scheduler().ticks());
  (void)robot.order(Operation::kEstop);  // acts in its first tick
  const auto before = robot.scheduler().beats();
  robot.run(19);
  EXPECT_EQ(robot.scheduler().beats(), before + 19);
  robot.run(100);
  EXPECT_EQ(robot.scheduler().beats(), before + 19);
  (void)robot.order(Operation::kClear);
  EXPECT_GT(robot.scheduler().beats(), before + 19) << "cleared";
}

TEST_F(SchedulerTest, TheHeartbeatThatRestsInAnEstopRestsToTheEndOfTheProcess) {
  robot.scheduler().restHeartbeatAfter(20ms);
  enableAll();
  (void)robot.order(Operation::kEstop);
  robot.run(30);
  const auto before = robot.scheduler().beats();
  robot.scheduler().beginStop();
  robot.run(20);
  EXPECT_EQ(robot.snapshot().state, RobotStatus::kStopping);
  EXPECT_EQ(robot.scheduler().beats(), before);
}

TEST_F(SchedulerTest, TheHeartbeatRestsInTimeWhateverComesFirstAnEstopOrTheEndOfTheProcess) {
  for (const bool estop_first : {true, false}) {
    SCOPED_TRACE(estop_first);
    VirtualRobot stopping(twoWheelsAndYaw());
    stopping.scheduler().restHeartbeatAfter(20ms);
    stopping.run(5);
    if (!estop_first) stopping.scheduler().beginStop();
    (void)stopping.order(Operation::kEstop);
    if (estop_first) stopping.scheduler().beginStop();
    const auto before = stopping.scheduler().beats();
    stopping.run(100);
    EXPECT_EQ(stopping.snapshot().state, RobotStatus::kStopping);
    EXPECT_EQ(stopping.scheduler().beats(), before + 19);
  }
}

TEST_F(SchedulerTest, TheHeartbeatGoesOnInAnEstopUnlessItIsToldToRest) {
  enableAll();
  (void)robot.order(Operation::kEstop);
  robot.run(1000);
  EXPECT_EQ(robot.scheduler().beats(), robot.scheduler().ticks());
}

TEST_F(SchedulerTest, EnablingIntoARunningStreamStartsSoftly) {
  const auto mostCurrentA = [](float soft_start_s) {
    auto config = twoWheelsAndYaw();
    config.buses[0].motors[kLeft].shaping.soft_start_s = soft_start_s;
    VirtualRobot softly(config);
    softly.run(5);
    Order order;
    order.id = 77;
    order.operation = Operation::kEnable;
    order.motors = MotorSet{}.set(kLeft);
    EXPECT_TRUE(softly.exchange().orders.push(order));
    float most_a = 0.0F;
    for (int i = 0; i < 20; ++i) {
      softly.command(kLeft, {.mode = ControlMode::kCurrent, .value = 8.0});
      softly.tick();
      most_a = std::max(most_a, std::fabs(softly.motor(kLeft).command_value));
    }
    return most_a;
  };
  EXPECT_EQ(mostCurrentA(0.0F), 8.0F);
  EXPECT_LT(mostCurrentA(0.2F), 1.0F);
}

TEST_F(SchedulerTest, DoesNotAllocate) {
  enableAll();
  robot.hold(kLeft, kVelocity120, 50);
  const AllocGuard guard;
  robot.hold(kLeft, kVelocity120, 1000);
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST_F(SchedulerTest, TheAllocationGuardNoticesASingleNew) {
  const AllocGuard guard;
  robot.tick();
  const auto canary = std::make_unique<int>(1);
  EXPECT_EQ(guard.allocations(), 1U);
}

// A slew limit shows it: 0.1 A a period.
TEST(SchedulerGapTest, LoopsAdvanceByTheGapBetweenTicksButByNoMoreThanFivePeriods) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[kLeft].shaping.effort_slew_per_s = 100.0F;
  VirtualRobot robot{config};
  robot.run(5);
  (void)robot.order(Operation::kEnable);
  const auto step = [&](std::uint64_t periods) {
    const float before_a = robot.motor(kLeft).command_value;
    robot.command(kLeft, {.mode = ControlMode::kCurrent, .value = 15.0}, 1s);
    robot.tick(periods);
    return static_cast<double>(robot.motor(kLeft).command_value - before_a);
  };
  robot.hold(kLeft, {.mode = ControlMode::kCurrent, .value = 0.0}, 300);  // beyond the soft start
  for (const std::uint64_t periods : {1U, 2U, 4U, 5U, 6U, 60U}) {
    const double expected_a = 0.1 * static_cast<double>(std::min<std::uint64_t>(periods, 5));
    EXPECT_NEAR(step(periods), expected_a, 0.005) << periods;
  }
}

}  // namespace
}  // namespace rc10::test::scheduler_test
