// Ages of what a tick acts on, when its frames leave.
#include <sys/socket.h>

#include <gtest/gtest.h>

#include "config/load_config.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::tick_ages_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr Target kVelocity60{.mode = ControlMode::kVelocity, .value = 60.0};

RobotConfig toldEveryFifthTick() {
  auto outcome = parseRobotConfig(
      "robot: arm\nrealtime: preferred\nbuses:\n  - name: bench\n    type: sim\n    motors:\n"
      "      - {name: joint, model: DM4310, id: 1, master_id: 17, command_divider: 5}\n",
      "arm.yaml");
  EXPECT_TRUE(outcome.config) << outcome.errorText();
  return outcome.config.value_or(twoWheelsAndYaw());
}

class TickAgesTest : public ::testing::Test {
 protected:
  void enable() {
    robot.run(50);
    robot.order(Operation::kEnable);
    ASSERT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
  }

  VirtualRobot robot{twoWheelsAndYaw()};
  const TickAges& ages = robot.exchange().ages;
};

TEST_F(TickAgesTest, ThatOfFeedbackIsCountedInEachTickOfAMotorThatFollowsATarget) {
  enable();
  ASSERT_EQ(ages.feedback.size(), 3U);
  robot.command(kLeft, kVelocity60);
  robot.run(10);
  EXPECT_EQ(ages.feedback[kLeft].count(), 10U);
  EXPECT_EQ(ages.feedback[kRight].count(), 0U) << "it has no target";
}

TEST_F(TickAgesTest, ThatOfACommandIsCountedOnceForEachMotorAndUnderItsClient) {
  enable();
  robot.commandAs("teleop", 0, kLeft, kVelocity60);
  robot.run(10);
  robot.commandAs("planner", 0, kRight, kVelocity60);
  robot.run(10);
  EXPECT_EQ(ages.command.count(), 2U);
  EXPECT_EQ(ages.command.max(), 1ms);
  ASSERT_EQ(ages.clients.count(), 2U);
  EXPECT_EQ(ages.clients.name(0).view(), "teleop");
  EXPECT_EQ(ages.clients.of(0).count(), 1U);
  EXPECT_EQ(ages.clients.name(1).view(), "planner");
}

TEST_F(TickAgesTest, FramesThatTheKernelRefusedCarryNothing) {
  enable();
  robot.command(kLeft, kVelocity60);
  robot.run(2);
  const auto feedback = ages.feedback[kLeft].count();
  ASSERT_EQ(ages.command.count(), 1U);
  const int few_bytes = 1;  // the kernel takes its least
  const auto& bus = *robot.robot().buses()[0].bus;
  ASSERT_EQ(::setsockopt(bus.descriptor(), SOL_SOCKET, SO_SNDBUF, &few_bytes, sizeof few_bytes), 0);
  robot.freezeBus(0, true);
  const auto dropped = [&] { return bus.counters().tx_dropped; };
  for (int i = 0; i < 20 && dropped() == 0; ++i) robot.tick();
  ASSERT_GT(dropped(), 0U);
  const auto until_full = ages.feedback[kLeft].count();
  robot.command(kLeft, kVelocity60);
  robot.run(5);
  EXPECT_EQ(ages.command.count(), 1U);
  EXPECT_EQ(ages.feedback[kLeft].count(), until_full);
  EXPECT_GT(until_full, feedback) << "those before had left";
  robot.freezeBus(0, false);
  robot.run(2);
  EXPECT_EQ(ages.command.count(), 2U);
  EXPECT_GE(ages.command.max(), 6ms) << "its age grew until a frame carried it";
}

TEST(TickAges, OfMessagesToAModuleAreCountedWhileAnotherBusIsHeldAndNotFalselyAfterwards) {
  const auto outcome = parseRobotConfig(
      "robot: two\nrealtime: preferred\nbuses:\n"
      "  - {name: a, type: sim, motors: [{name: arm, model: M3508, id: 1, zero: power_on}]}\n"
      "  - {name: b, type: sim, motors: [{name: tool, model: M3508, id: 1}]}\n"
      "modules:\n  - {name: lift, type: joint, motor: arm, max_velocity_deg_s: 60, "
      "max_acceleration_deg_s2: 60}\n",
      "two.yaml");
  ASSERT_TRUE(outcome.config) << outcome.errorText();
  VirtualRobot robot{*outcome.config};
  const auto& ages = robot.exchange().ages;
  const auto ask = [&robot] { robot.giveInputs({5.0}, 1s); };
  robot.run(10);
  robot.inboxes()[1].link = CanLinkState::kDown;
  robot.run(10);
  ask();
  robot.run(10);
  EXPECT_EQ(ages.command.count(), 1U);
  robot.run(300);
  robot.inboxes()[1].link = CanLinkState::kUp;
  robot.run(20);
  EXPECT_EQ(ages.command.count(), 1U);
  EXPECT_LT(ages.command.max(), 3ms);
}

// A tick that takes so long until its frames have left.
constexpr Duration kUntilSent = 80us;
MonotonicTime tick_began{};
MonotonicTime whenSent() noexcept { return tick_began + kUntilSent; }

TEST(TickAges, EndWhenTheFramesHaveLeft) {
  VirtualRobot robot{twoWheelsAndYaw(), nullptr, whenSent};
  const auto tick = [&] {
    tick_began = robot.now() + 1ms;
    robot.tick();
  };
  for (int i = 0; i < 50; ++i) tick();
  robot.order(Operation::kEnable);
  ASSERT_EQ(robot.motor(kLeft).status, MotorStatus::kActive);
  robot.command(kLeft, kVelocity60);
  for (int i = 0; i < 10; ++i) tick();
  const auto& ages = robot.exchange().ages;
  EXPECT_EQ(ages.command.max(), 1ms + kUntilSent);
  EXPECT_EQ(ages.feedback[kLeft].max(), 500us + kUntilSent) << "drives speak half a period before the tick";
}

TEST(FeedbackAge, IsThatOfTheFeedbackThatTheFramesOfADriveWereComputedFrom) {
  VirtualRobot robot{toldEveryFifthTick()};
  robot.run(200);
  robot.order(Operation::kEnable);
  ASSERT_EQ(robot.motor(0).status, MotorStatus::kActive);
  const auto& ages = robot.exchange().ages.feedback[0];
  for (int i = 0; i < 11; ++i) {
    robot.command(0, kVelocity60);
    robot.run(5);
  }
  EXPECT_GE(ages.count(), 10U) << "it is told every fifth tick";
  EXPECT_LE(ages.count(), 12U) << "and at once where another order begins";
}

TEST(CommandAge, EndsInTheTickThatTellsTheDrive) {
  VirtualRobot robot{toldEveryFifthTick()};
  robot.run(200);
  robot.order(Operation::kEnable);
  ASSERT_EQ(robot.motor(0).status, MotorStatus::kActive);
  const auto& ages = robot.exchange().ages;
  robot.command(0, kVelocity60);
  robot.run(10);  // from now on no other order begins
  const auto first = ages.command.count();
  for (int i = 0; i < 5; ++i) {  // one at each distance from that tick
    const auto before = ages.command.count();
    robot.command(0, kVelocity60);
    for (int ticks = 0; ages.command.count() == before && ticks < 10; ++ticks) robot.tick();
    robot.run(i);
  }
  EXPECT_EQ(ages.command.count(), first + 5U);
  EXPECT_EQ(ages.command.max(), 5ms);
}

}  // namespace
}  // namespace rc10::test::tick_ages_test
