// A group remembers what its members do from tick to tick, and forgets it.

#include <algorithm>
#include <chrono>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/robot_of_text.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::motor_group_test {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFirst = 0;
constexpr std::size_t kSecond = 1;
constexpr Target kSpin{.mode = ControlMode::kVelocity, .value = 60.0};
constexpr Target kTurn{.mode = ControlMode::kTotalAngle, .value = 200.0};
constexpr Target kBrake{.mode = ControlMode::kBrake};

MotorSet only(std::size_t motor) { return MotorSet{}.set(motor); }
const MotorSet kBoth = only(kFirst) | only(kSecond);

constexpr const char* kWheel = "model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 200";
constexpr const char* kOdrive =
    "model: ODrive_S1, id: 8, torque_constant_nm_per_a: 0.05, current_limit_a: 20, velocity_limit_rpm: 600, "
    "zero: power_on";

/// Two motors, each on its bus, in one group.
class GroupOfTwo : public ::testing::Test {
 protected:
  void build(const std::string& first, const std::string& second, const std::string& group) {
    const auto bus = [](const std::string& name, const std::string& motor, const std::string& keys) {
      return "  - {name: " + name + ", type: sim, motors: [{name: " + motor + ", " + keys + "}]}\n";
    };
    robot_.emplace(robotOfText("robot: two\nrealtime: preferred\nbuses:\n" + bus("a", "first", first) +
                               bus("b", "second", second) + "groups: [{name: both, " + group + "}]\n"));
    robot_->run(100);
  }
  void enableBoth() {
    robot_->orderFor(kBoth, Operation::kEnable);
    ASSERT_EQ(first().status, MotorStatus::kActive);
    ASSERT_EQ(second().status, MotorStatus::kActive);
  }
  const MotorSnapshot& first() { return robot_->motor(kFirst); }
  const MotorSnapshot& second() { return robot_->motor(kSecond); }

  /// One message for both in every tick.
  void stream(const Target& target, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      Command command;
      command.client = "test";
      command.received = command.said = robot_->now();
      command.deadline = robot_->now() + 50ms;
      command.count = 2;
      command.setpoints[0] = {kFirst, target};
      command.setpoints[1] = {kSecond, target};
      ASSERT_TRUE(robot_->exchange().commands.push(command));
      robot_->tick();
    }
  }
  /// The drive of `first` is without power for this time.
  void loseFirst(int ticks) {
    robot_->freezeBus(0, true);
    robot_->run(ticks);
    robot_->freezeBus(0, false);
  }
  void disableFirst(Asked asked) {
    robot_->carryOut({.operation = Operation::kDisable, .motors = only(kFirst), .asked = asked});
  }
  std::vector<Event> told(EventCode code) {
    auto events = robot_->events();
    std::erase_if(events, [code](const Event& event) { return event.code != code; });
    return events;
  }

  std::optional<VirtualRobot> robot_;
};

TEST_F(GroupOfTwo, StopsWhenTheDriveOfOneRefusesToBeEnabledAndMayBeEnabledAgain) {
  build(kOdrive, kWheel, "motors: [first, second]");
  robot_->beginEnabling(kBoth);
  OrderResult result;
  bool spun = false;
  for (int i = 0; i < 3000 && !robot_->exchange().results.pop(result); ++i) {
    robot_->command(kSecond, kSpin);
    robot_->tick();
    (void)robot_->takeFrames();  // none of them reaches the drive
    spun |= second().status == MotorStatus::kActive;
  }
  EXPECT_TRUE(spun);
  EXPECT_EQ(result.motors[kFirst], Refusal::kDriveRefused);
  EXPECT_EQ(first().status, MotorStatus::kReady);
  EXPECT_EQ(second().status, MotorStatus::kReady);
  const auto stops = told(EventCode::kGroupStopped);
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_EQ(stops[0].source, static_cast<std::int16_t>(kFirst));
  EXPECT_EQ(stops[0].extra, static_cast<std::int32_t>(GroupStop::kRefused));
  robot_->run(3000);
  EXPECT_EQ(second().status, MotorStatus::kReady);
  enableBoth();
}

TEST_F(GroupOfTwo, ComesBackAlsoWhereItWasDisabledBefore) {
  build(kWheel, kWheel, "motors: [first, second], on_return: rearm_at_rest");
  enableBoth();
  robot_->orderFor(kBoth, Operation::kDisable);
  robot_->run(10);
  enableBoth();
  stream(kBrake, 500);
  loseFirst(300);
  robot_->run(1000);
  EXPECT_EQ(first().status, MotorStatus::kActive);
  EXPECT_EQ(second().status, MotorStatus::kActive);
}

TEST_F(GroupOfTwo, DoesNotComeBackFromALossInTheTickOfWhichItWasDisabled) {
  int ticks_to_loss = 0;
  for (const bool disables : {false, true}) {
    build(kWheel, kWheel, "motors: [first, second], on_return: rearm_at_rest");
    enableBoth();
    stream(kBrake, 500);
    robot_->freezeBus(0, true);
    for (int i = 1; i < (disables ? ticks_to_loss : 1000) && first().status == MotorStatus::kActive; ++i) {
      if (!disables) ticks_to_loss = i;
      robot_->tick();
    }
    if (disables) {
      ASSERT_EQ(first().status, MotorStatus::kActive);
      Order order;
      order.operation = Operation::kDisable;
      order.motors = only(kFirst);
      order.asked = Asked::kUnasked;
      ASSERT_TRUE(robot_->exchange().orders.push(order));
      robot_->tick();
    }
    ASSERT_EQ(first().status, MotorStatus::kOffline);
    ASSERT_EQ(second().status, MotorStatus::kReady);
    robot_->freezeBus(0, false);
    robot_->run(2000);
    EXPECT_EQ(second().status, disables ? MotorStatus::kReady : MotorStatus::kActive);
  }
}

// A request ends what holds the others; a program that has ended does not, whatever somebody asked before.
TEST_F(GroupOfTwo, HoldsOnWhenOneIsDisabledUnaskedThoughItWasDisabledOnRequestBefore) {
  build(kWheel, std::string{kWheel} + ", on_timeout: hold", "motors: [first, second]");
  for (const auto asked : {Asked::kAnew, Asked::kUnasked}) {
    enableBoth();
    stream(kSpin, 100);
    robot_->run(200);  // silence
    ASSERT_EQ(second().acting, Acting::kHold);
    disableFirst(asked);
    robot_->run(5);
    EXPECT_EQ(second().status, MotorStatus::kReady);
    EXPECT_EQ(second().acting, asked == Asked::kAnew ? Acting::kNothing : Acting::kHold);
  }
}

TEST_F(GroupOfTwo, ThatMovesOneThingFollowsAnglesAgainOnceTheLostReferenceIsSet) {
  build(kWheel, kWheel, "motors: [first, second], together: true");
  enableBoth();
  stream(kTurn, 200);
  robot_->simBus(0).silence(0, true);
  stream(kBrake, 40);
  robot_->simBus(0).silence(0, false);
  stream(kBrake, 500);
  ASSERT_FALSE(first().feedback.zeroed);
  stream(kTurn, 20);
  ASSERT_EQ(second().target.mode, ControlMode::kBrake);
  robot_->orderFor(kBoth, Operation::kDisable);
  ASSERT_EQ(robot_->orderFor(only(kFirst), Operation::kZero).motors[kFirst], Refusal::kNone);
  enableBoth();
  stream(kTurn, 20);
  EXPECT_EQ(first().target.mode, ControlMode::kTotalAngle);
  EXPECT_EQ(second().target.mode, ControlMode::kTotalAngle);
}

/// `first` is no more than help to `second`.
class OptionalHelper : public GroupOfTwo {
 protected:
  void SetUp() override {
    build(std::string{kWheel} + ", optional: true", kWheel, "motors: [first, second], together: true");
  }
};

TEST_F(OptionalHelper, ThatIsOffHoldsNoMessageBack) {
  robot_->orderFor(only(kSecond), Operation::kEnable);
  stream(kSpin, 20);
  EXPECT_EQ(first().status, MotorStatus::kReady);
  EXPECT_EQ(second().target.mode, ControlMode::kVelocity);
}

TEST_F(OptionalHelper, WithoutReferenceKeepsNobodyFromFollowingAnAngle) {
  enableBoth();
  stream(kTurn, 200);
  robot_->simBus(0).silence(0, true);
  stream(kTurn, 40);
  robot_->simBus(0).silence(0, false);
  stream(kTurn, 20);
  ASSERT_FALSE(first().feedback.zeroed);
  EXPECT_NE(first().target.mode, ControlMode::kTotalAngle);
  EXPECT_EQ(second().target.mode, ControlMode::kTotalAngle);
}

TEST_F(GroupOfTwo, HoldsNoMessageBackFromAMemberThatIsEnabledAlone) {
  build(kWheel, kWheel, "motors: [first, second], together: true");
  robot_->orderFor(only(kSecond), Operation::kEnableAlone);
  stream(kSpin, 20);
  EXPECT_EQ(second().target.mode, ControlMode::kVelocity);
}

TEST_F(GroupOfTwo, SaysOfAMessageThatComesWhileItIsOffThatItsMotorsAreNotActive) {
  build(kWheel, kWheel, "motors: [first, second], together: true");
  robot_->events();
  stream(kSpin, 1);
  const auto skips = told(EventCode::kSetpointSkipped);
  ASSERT_EQ(skips.size(), 2U);
  for (const auto& skip : skips) EXPECT_EQ(skip.value, static_cast<std::int32_t>(SkipReason::kNotActive));
}

TEST_F(GroupOfTwo, ComesBackWhateverAnOptionalMemberDoesThatWasNotOn) {
  build(std::string{kWheel} + ", optional: true", kWheel,
        "motors: [first, second], on_return: rearm_at_rest");
  robot_->orderFor(only(kSecond), Operation::kEnable);
  ASSERT_EQ(second().status, MotorStatus::kActive);
  for (int i = 0; i < 500; ++i) {
    robot_->command(kSecond, kBrake);
    robot_->tick();
  }
  sim::MotorLoad load;
  load.load_torque_nm = 2.0F;
  robot_->simBus(0).setLoad(0, load);
  robot_->freezeBus(1, true);
  robot_->run(250);
  robot_->freezeBus(1, false);
  ASSERT_EQ(second().status, MotorStatus::kOffline);
  robot_->run(1000);
  ASSERT_GT(std::abs(first().feedback.velocity_rpm), 20.0F) << "it is turned by its load";
  EXPECT_EQ(first().status, MotorStatus::kReady);
  EXPECT_EQ(second().status, MotorStatus::kActive);
}

}  // namespace
}  // namespace rc10::test::motor_group_test
