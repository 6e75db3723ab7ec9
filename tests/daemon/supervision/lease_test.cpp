// Several clients on one motor: in the supervisor, as its users see it.

#include "daemon/supervision/lease.hpp"

#include <algorithm>
#include <initializer_list>

#include <gtest/gtest.h>

#include "daemon/virtual_robot.hpp"

namespace rc10::test::lease_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;

Target current(double amperes) { return {.mode = ControlMode::kCurrent, .value = amperes}; }

Lease::Holder planner(std::uint64_t session, int priority) {
  Lease::Holder holder{.client = {}, .session = session, .priority = priority};
  holder.client = "planner";
  return holder;
}

class LeaseTest : public ::testing::Test {
 protected:
  LeaseTest() {
    robot.run(5);
    robot.order(Operation::kEnable);
    (void)robot.events();
  }
  float commanded(std::size_t motor) { return robot.motor(motor).command_value; }
  /// Last word of a client that leaves; in the middle of a period, so that it is still valid in the tick.
  void end(const char* client, int priority, std::initializer_list<Command::Setpoint> setpoints) {
    Command command;
    command.client = client;
    command.priority = priority;
    command.received = command.said = robot.now() + 500us;
    command.deadline = command.received + 1ms;
    for (const auto& setpoint : setpoints) command.setpoints[command.count++] = setpoint;
    ASSERT_TRUE(robot.exchange().commands.push(command));
  }
  std::size_t reports() {
    const auto events = robot.events();
    return static_cast<std::size_t>(std::count_if(
        events.begin(), events.end(), [](const Event& e) { return e.code == EventCode::kNotOwner; }));
  }

  VirtualRobot robot{twoWheelsAndYaw()};
};

TEST_F(LeaseTest, OneThatIsShortenedToAnyTimeIsTakenAndLapses) {
  Lease lease;
  EXPECT_FALSE(lease.taken());
  lease.take(planner(1, 0), {.received = MonotonicTime{1s}, .until = MonotonicTime{2s}});
  lease.shorten(planner(1, 0), MonotonicTime{});
  EXPECT_TRUE(lease.taken());
  EXPECT_FALSE(lease.held(MonotonicTime{1s}));
  lease.release();
  EXPECT_FALSE(lease.taken());
}

TEST_F(LeaseTest, TheFirstClientHoldsTheMotorWhileItsCommandsAreValid) {
  robot.commandAs("planner", 0, kLeft, current(1.0));
  robot.tick();
  robot.commandAs("second", 0, kLeft, current(-2.0), 500ms);
  robot.tick();
  EXPECT_EQ(commanded(kLeft), 1.0F);
  EXPECT_EQ(robot.motor(kLeft).owner.view(), "planner");
  EXPECT_EQ(robot.snapshot().refused_commands, 1U);

  robot.run(50);  // the planner has gone
  robot.commandAs("second", 0, kLeft, current(-2.0));
  robot.tick();
  EXPECT_EQ(commanded(kLeft), -2.0F);
  EXPECT_EQ(robot.motor(kLeft).owner.view(), "second");
}

TEST_F(LeaseTest, AHigherPriorityTakesOverAndTheLowerOneCannotTakeBack) {
  robot.commandAs("planner", 0, kLeft, current(1.0));
  robot.tick();
  robot.commandAs("remote", 5, kLeft, current(0.5));
  robot.tick();
  EXPECT_EQ(commanded(kLeft), 0.5F);
  robot.commandAs("planner", 0, kLeft, current(1.0));
  robot.tick();
  EXPECT_EQ(commanded(kLeft), 0.5F);
  EXPECT_EQ(robot.motor(kLeft).owner.view(), "remote");
}

TEST_F(LeaseTest, ARemoteThatCoastsKeepsThePlannerFromMoving) {
  for (int i = 0; i < 20; ++i) {
    robot.commandAs("remote", 5, kLeft, {.mode = ControlMode::kCoast});
    robot.commandAs("planner", 0, kLeft, current(1.0));
    robot.tick();
    ASSERT_EQ(commanded(kLeft), 0.0F);
  }
  EXPECT_EQ(robot.motor(kLeft).owner.view(), "remote");
}

TEST_F(LeaseTest, ALowerPriorityCannotMakeTheMotorCoast) {
  robot.commandAs("remote", 5, kLeft, current(1.0));
  robot.tick();
  robot.commandAs("planner", 0, kLeft, {.mode = ControlMode::kCoast});
  robot.tick();
  EXPECT_EQ(commanded(kLeft), 1.0F);
}

TEST_F(LeaseTest, AMessageIsRefusedWholeForOneMotorThatIsHeld) {
  robot.commandAs("remote", 5, kRight, current(1.0));
  robot.tick();
  Command both;
  both.client = "planner";
  both.deadline = robot.now() + 50ms;
  both.count = 2;
  both.setpoints[0] = {kLeft, current(2.0)};
  both.setpoints[1] = {kRight, current(2.0)};
  ASSERT_TRUE(robot.exchange().commands.push(both));
  robot.tick();
  EXPECT_EQ(commanded(kLeft), 0.0F);
  EXPECT_EQ(commanded(kRight), 1.0F);
}

TEST_F(LeaseTest, AClientThatLeavesEndsItsTarget) {
  robot.commandAs("planner", 0, kLeft, current(1.0), 1000ms);
  robot.run(20);
  end("planner", 0, {{kLeft, current(1.0)}});
  robot.tick();
  EXPECT_EQ(commanded(kLeft), 1.0F);
  robot.tick();
  EXPECT_EQ(commanded(kLeft), 0.0F);
  EXPECT_EQ(robot.motor(kLeft).owner.view(), "");
}

TEST_F(LeaseTest, AClientThatLeavesEndsWhatItHoldsThoughItHasLostAnotherMotor) {
  for (const auto motor : {kLeft, kRight}) robot.commandAs("planner", 0, motor, current(1.0), 1000ms);
  robot.run(20);
  robot.commandAs("remote", 5, kLeft, current(-0.5), 1000ms);
  robot.run(20);
  end("planner", 0, {{kLeft, current(1.0)}, {kRight, current(1.0)}});
  robot.run(2);
  EXPECT_EQ(commanded(kLeft), -0.5F);
  EXPECT_EQ(commanded(kRight), 0.0F);
  EXPECT_EQ(reports(), 0U) << "it asks for nothing";
}

TEST_F(LeaseTest, ATargetThatWasDisplacedDoesNotComeBackWhenItsClientLeaves) {
  robot.commandAs("planner", 0, kLeft, current(1.0), 1000ms);
  robot.run(20);
  robot.commandAs("remote", 5, kLeft, current(-0.5));
  robot.run(60);
  end("planner", 0, {{kLeft, current(1.0)}});
  for (int i = 0; i < 5; ++i) {
    robot.tick();
    ASSERT_EQ(commanded(kLeft), 0.0F) << "tick " << i;
    ASSERT_EQ(robot.motor(kLeft).owner.view(), "");
  }
  EXPECT_GT(robot.snapshot().skipped_setpoints, 0U);
}

TEST_F(LeaseTest, AClientThatLeavesDisplacesNobodyWhateverItsPriority) {
  robot.commandAs("planner", 0, kLeft, current(1.0), 1000ms);
  robot.run(20);
  end("boss", 20, {{kLeft, current(-1.0)}});
  robot.run(5);
  EXPECT_EQ(commanded(kLeft), 1.0F);
  EXPECT_EQ(robot.motor(kLeft).owner.view(), "planner");
}

// A hold that began anew would be at another place.
TEST(LeaseOfAHeldMotor, AClientThatLeavesDoesNotEndWhatHoldsIt) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[kLeft].fallback.on_timeout = FallbackAction::kHold;
  for (const auto& last : {current(1.0), Target{}}) {
    VirtualRobot robot{config};
    robot.run(5);
    robot.order(Operation::kEnable);
    robot.commandAs("remote", 5, kLeft, current(0.1));
    robot.run(500);
    ASSERT_EQ(robot.motor(kLeft).acting, Acting::kHold);
    Command end;
    end.client = "planner";
    end.received = end.said = robot.now() + 500us;
    end.deadline = end.received + 1ms;
    end.count = 1;
    end.setpoints[0] = {kLeft, last};
    ASSERT_TRUE(robot.exchange().commands.push(end));
    for (int i = 0; i < 20; ++i) {
      robot.tick();
      ASSERT_EQ(robot.motor(kLeft).acting, Acting::kHold) << "tick " << i;
    }
  }
}

TEST(Lease, AnEndIsTakenFromItsHolderAlone) {
  const MonotonicTime now{10s};
  const auto allowed = [&](Duration validity, const Lease::Holder& sender, MonotonicTime at) {
    Lease lease;
    lease.take(planner(7, 0), {now - 10ms, now + 50ms});
    return lease.allows(sender, {at, at + validity}, at);
  };
  EXPECT_TRUE(allowed(1ms, planner(7, -5), now));
  EXPECT_FALSE(allowed(1ms, planner(8, 9), now)) << "a higher priority";
  EXPECT_FALSE(allowed(1ms, planner(7, 0), now + 50ms)) << "it has lapsed";
  EXPECT_FALSE(allowed(1ms, planner(8, 0), now + 50ms));
  EXPECT_TRUE(allowed(2ms, planner(8, 9), now)) << "of a stream";
  EXPECT_TRUE(allowed(2ms, planner(7, 0), now + 50ms));
  EXPECT_FALSE(Lease{}.allows(planner(7, 0), {now, now + 1ms}, now)) << "nobody has said anything";
}

TEST_F(LeaseTest, AnotherSessionUnderTheNameIsAnotherClient) {
  Lease lease;
  const MonotonicTime now{10s};
  lease.take(planner(7, 0), {now, now + 50ms});
  EXPECT_TRUE(lease.allows(planner(7, 0), now));
  EXPECT_FALSE(lease.allows(planner(8, 0), now));
  EXPECT_TRUE(lease.allows(planner(8, 1), now));
  EXPECT_TRUE(lease.allows(planner(8, 0), now + 50ms));
}

TEST(Lease, IsHeldUntilItsDeadlineAndTakenUntilItIsReleased) {
  Lease lease;
  const MonotonicTime now{10s};
  EXPECT_FALSE(lease.taken());
  EXPECT_FALSE(lease.held(now));
  EXPECT_EQ(lease.received(), MonotonicTime{});
  lease.take(planner(7, 0), {now, now + 50ms});
  EXPECT_TRUE(lease.taken());
  EXPECT_TRUE(lease.held(now + 50ms - Duration{1}));
  EXPECT_FALSE(lease.held(now + 50ms));
  EXPECT_TRUE(lease.taken()) << "though it has lapsed";
  EXPECT_EQ(lease.client().view(), "planner");
  EXPECT_EQ(lease.received(), now);
  lease.release();
  EXPECT_FALSE(lease.taken());
  EXPECT_TRUE(lease.client().view().empty());
}

TEST(Lease, GivesWayToAHigherPriorityAlone) {
  Lease lease;
  const MonotonicTime now{10s};
  lease.take(planner(7, 2), {now, now + 50ms});
  for (const int priority : {-5, 0, 1, 2}) EXPECT_FALSE(lease.allows(planner(8, priority), now)) << priority;
  EXPECT_TRUE(lease.allows(planner(8, 3), now));
  EXPECT_TRUE(lease.allows(planner(7, -5), now)) << "its holder";
  for (const char* name : {"another", "rival"}) {
    Lease::Holder other{.client = {}, .session = 7, .priority = 2};
    other.client = name;
    EXPECT_FALSE(lease.allows(other, now)) << "of the same session number";
  }
}

TEST(Lease, IsShortenedByItsHolderAloneAndNeverLengthened) {
  Lease lease;
  const MonotonicTime now{10s};
  lease.take(planner(7, 0), {now, now + 50ms});
  lease.shorten(planner(8, 9), now + 10ms);
  EXPECT_TRUE(lease.held(now + 49ms)) << "another session";
  lease.shorten(planner(7, 0), now + 90ms);
  EXPECT_FALSE(lease.held(now + 50ms));
  lease.shorten(planner(7, 0), now + 10ms);
  EXPECT_TRUE(lease.held(now + 10ms - Duration{1}));
  EXPECT_FALSE(lease.held(now + 10ms));
}

TEST(Lease, APriorityThatNobodyGaveIsZero) {
  EXPECT_EQ(Lease::Holder{}.priority, 0);
  EXPECT_EQ(Lease::Holder{}.session, 0U);
}

TEST_F(LeaseTest, RefusalsAreAllCountedAndToldOnceASecond) {
  for (int i = 0; i < 1500; ++i) {
    robot.commandAs("remote", 5, kLeft, current(0.1));
    robot.commandAs("planner", 0, kLeft, current(1.0));
    robot.tick();
  }
  EXPECT_EQ(robot.snapshot().refused_commands, 1500U);
  EXPECT_EQ(reports(), 2U);
}

}  // namespace
}  // namespace rc10::test::lease_test
