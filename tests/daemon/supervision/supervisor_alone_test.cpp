// One motor that is enabled alone: nothing else can be enabled as long as it is.

#include <memory>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "blackbox/memory_box.hpp"
#include "daemon/robot_of_text.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::supervisor_alone_test {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::Not;

constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr std::size_t kYaw = 2;
constexpr Target kVelocity120{.mode = ControlMode::kVelocity, .value = 120.0};

MotorSet only(std::size_t motor) { return MotorSet{}.set(motor); }

class EnableAloneTest : public ::testing::Test {
 protected:
  void start(RobotConfig config, FlightRecorder* recorder = nullptr) {
    robot = std::make_unique<VirtualRobot>(std::move(config), recorder);
    robot->run(5);
  }
  void SetUp() override { start(twoWheelsAndYaw()); }

  Refusal alone(std::size_t motor) {
    return robot->orderFor(only(motor), Operation::kEnableAlone).motors[motor];
  }
  Refusal enable(std::size_t motor) { return robot->orderFor(only(motor), Operation::kEnable).motors[motor]; }
  void disable(std::size_t motor) { robot->orderFor(only(motor), Operation::kDisable); }
  MotorStatus status(std::size_t motor) { return robot->motor(motor).status; }
  /// All of these in one tick.
  void together(const std::vector<std::pair<Operation, MotorSet>>& orders) {
    for (const auto& [operation, motors] : orders) {
      Order order;
      order.id = 1000;
      order.operation = operation;
      order.motors = motors;
      ASSERT_TRUE(robot->exchange().orders.push(order));
    }
    robot->run(5);
  }

  std::unique_ptr<VirtualRobot> robot;
};

TEST_F(EnableAloneTest, TheMotorIsActiveAndObeys) {
  EXPECT_EQ(alone(kLeft), Refusal::kNone);
  EXPECT_EQ(status(kLeft), MotorStatus::kActive);
  robot->hold(kLeft, kVelocity120, 1000);
  EXPECT_NEAR(robot->motor(kLeft).feedback.velocity_rpm, 120.0F, 3.0F);
}

TEST_F(EnableAloneTest, IsRefusedWhileOthersAreActiveAndNamesThem) {
  robot->orderFor(only(kRight) | only(kYaw), Operation::kEnable);
  const auto result = robot->orderFor(only(kLeft), Operation::kEnableAlone);
  EXPECT_EQ(result.motors[kLeft], Refusal::kOthersOn);
  EXPECT_EQ(result.in_the_way, only(kRight) | only(kYaw));
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
  disable(kRight);
  disable(kYaw);
  EXPECT_EQ(alone(kLeft), Refusal::kNone);
}

TEST_F(EnableAloneTest, IsRefusedWhileAnotherIsBeingEnabled) {
  together({{Operation::kEnable, only(kRight)}, {Operation::kEnableAlone, only(kLeft)}});
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
}

TEST_F(EnableAloneTest, ARefusalOfAMotorThatIsBeingEnabledIsNotTakenBack) {
  together({{Operation::kEnable, only(kRight) | only(kLeft)}, {Operation::kEnableAlone, only(kLeft)}});
  OrderResult result;
  bool refused = false;
  while (robot->exchange().results.pop(result)) refused |= result.motors[kLeft] == Refusal::kOthersOn;
  EXPECT_TRUE(refused);
}

TEST_F(EnableAloneTest, NoRequestEnablesAnotherAndTheRefusalNamesTheOne) {
  (void)alone(kLeft);
  const auto result = robot->order(Operation::kEnable);
  EXPECT_EQ(result.motors[kLeft], Refusal::kNone) << "it is ACTIVE";
  EXPECT_EQ(result.motors[kRight], Refusal::kAlone);
  EXPECT_EQ(result.motors[kYaw], Refusal::kAlone);
  EXPECT_EQ(result.in_the_way, only(kLeft));
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
  EXPECT_EQ(robot->orderFor(only(kYaw), Operation::kEnableAlone).motors[kYaw], Refusal::kOthersOn);
}

TEST_F(EnableAloneTest, NothingIsEnabledInTheSameTickEither) {
  together({{Operation::kEnableAlone, only(kLeft)}, {Operation::kEnable, only(kRight)}});
  EXPECT_EQ(status(kLeft), MotorStatus::kActive);
  EXPECT_EQ(status(kRight), MotorStatus::kReady);
}

TEST_F(EnableAloneTest, TheOtherRequestsAreTaken) {
  (void)alone(kLeft);
  EXPECT_EQ(robot->orderFor(only(kRight), Operation::kZero, 90.0).motors[kRight], Refusal::kNone);
  disable(kRight);
  EXPECT_EQ(enable(kRight), Refusal::kAlone) << "disabling another ends nothing";
}

TEST_F(EnableAloneTest, OneThatIsActiveAlreadyIsLockedInWhenItIsTheOnlyOne) {
  (void)enable(kLeft);
  EXPECT_EQ(alone(kLeft), Refusal::kNone);
  EXPECT_EQ(enable(kRight), Refusal::kAlone);
}

TEST_F(EnableAloneTest, ThePlainRequestForTheSameMotorEndsNothing) {
  (void)alone(kLeft);
  EXPECT_EQ(enable(kLeft), Refusal::kNone);
  EXPECT_EQ(enable(kRight), Refusal::kAlone);
}

// The one that rests already moves the same thing: its disable is a second one, that of the other is not.
TEST(OneOfAPairThatIsEnabledAlone, IsBrakedByADisableOfBoth) {
  for (const std::size_t alone : {0U, 1U}) {
    VirtualRobot robot{robotOfText(
        "robot: lifter\nrealtime: preferred\nbuses:\n  - name: lifts\n    type: sim\n    motors:\n"
        "      - {name: left, model: M3508, id: 1, on_disable: brake}\n"
        "      - {name: right, model: M3508, id: 2, on_disable: brake}\n"
        "groups: [{name: both, motors: [left, right], together: true}]\n")};
    robot.run(5);
    ASSERT_EQ(robot.orderFor(only(alone), Operation::kEnableAlone).motors[alone], Refusal::kNone);
    robot.hold(alone, kVelocity120, 500);
    robot.orderFor(only(0) | only(1), Operation::kDisable);
    EXPECT_EQ(robot.motor(alone).acting, Acting::kBrake);
    robot.orderFor(only(0) | only(1), Operation::kDisable);
    EXPECT_EQ(robot.motor(alone).acting, Acting::kNothing) << "once more lets go";
  }
}

TEST_F(EnableAloneTest, AThirdThatIsHeldStopsWithALostMemberOfItsGroupWhateverTheGroupsOrder) {
  for (const auto& order : {std::vector<std::size_t>{0, 1, 2}, std::vector<std::size_t>{2, 1, 0}}) {
    auto config = twoWheelsAndYaw();
    auto& motors = config.buses[0].motors;
    BusConfig other = config.buses[0];
    other.name = "other";
    other.motors = {motors[kRight]};
    motors.erase(motors.begin() + kRight);
    motors[0].fallback.on_disable = FallbackAction::kHold;
    config.buses.push_back(std::move(other));
    auto group = leftAndRight();
    group.motors = order;
    config.groups.push_back(group);
    start(std::move(config));
    constexpr std::size_t kHeld = 0;
    constexpr std::size_t kTried = 1;
    constexpr std::size_t kLost = 2;
    ASSERT_EQ(robot->order(Operation::kEnable).motors[kHeld], Refusal::kNone);
    robot->run(50);
    robot->order(Operation::kDisable);
    robot->run(500);
    ASSERT_EQ(robot->motor(kHeld).acting, Acting::kHold);
    ASSERT_EQ(alone(kTried), Refusal::kNone);
    ASSERT_EQ(robot->motor(kHeld).acting, Acting::kHold);
    robot->freezeBus(1, true);
    robot->run(50);
    EXPECT_EQ(status(kLost), MotorStatus::kOffline);
    EXPECT_EQ(robot->motor(kHeld).acting, Acting::kNothing);
    EXPECT_EQ(status(kTried), MotorStatus::kActive);
  }
}

TEST_F(EnableAloneTest, HasTheRulesOfEnabling) {
  robot->order(Operation::kEstop);
  EXPECT_EQ(alone(kLeft), Refusal::kEstop);
  robot->order(Operation::kClear);
  robot->freezeSimulation(true);
  robot->run(50);
  EXPECT_EQ(alone(kLeft), Refusal::kOffline);
  robot->freezeSimulation(false);
  robot->run(5);
  EXPECT_EQ(enable(kRight), Refusal::kNone) << "what was refused locks nothing";
}

TEST_F(EnableAloneTest, EndsWithADisable) {
  (void)alone(kLeft);
  disable(kLeft);
  EXPECT_EQ(enable(kRight), Refusal::kNone);
  EXPECT_EQ(enable(kLeft), Refusal::kNone) << "enabled again, it is one of many";
  EXPECT_EQ(enable(kYaw), Refusal::kNone);
}

TEST_F(EnableAloneTest, EndsWithADisableWhileItIsBeingEnabled) {
  together({{Operation::kEnableAlone, only(kLeft)},
            {Operation::kDisable, only(kLeft)},
            {Operation::kEnable, only(kRight)}});
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
}

TEST_F(EnableAloneTest, EndsWithAnEstop) {
  (void)alone(kLeft);
  robot->exchange().estop.store(true);
  robot->tick();
  robot->order(Operation::kClear);
  EXPECT_EQ(enable(kRight), Refusal::kNone);
}

TEST_F(EnableAloneTest, EndsWhenItsFeedbackIsLost) {
  (void)alone(kLeft);
  robot->simBus().silence(kLeft, true);
  robot->run(50);
  EXPECT_EQ(status(kLeft), MotorStatus::kOffline);
  EXPECT_EQ(enable(kRight), Refusal::kNone);
  robot->simBus().silence(kLeft, false);
  robot->run(50);
  EXPECT_EQ(enable(kYaw), Refusal::kNone) << "its return locks nothing";
}

TEST_F(EnableAloneTest, EndsWithAFault) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[kLeft].guard.overspeed_rpm = 60.0F;
  start(std::move(config));
  (void)alone(kLeft);
  robot->hold(kLeft, kVelocity120, 1000);
  ASSERT_EQ(status(kLeft), MotorStatus::kFault);
  EXPECT_EQ(enable(kRight), Refusal::kNone);
}

TEST_F(EnableAloneTest, LastsWhenTheClientIsGone) {
  (void)alone(kLeft);
  robot->hold(kLeft, kVelocity120, 100);
  robot->run(5000);
  EXPECT_EQ(robot->motor(kLeft).target.mode, ControlMode::kCoast);
  EXPECT_EQ(enable(kRight), Refusal::kAlone);
}

TEST_F(EnableAloneTest, IsInTheBlackBox) {
  MemoryBox box;
  FlightRecorder recorder{box.handOff()};
  start(twoWheelsAndYaw(), &recorder);
  (void)alone(kLeft);
  const auto orders = all<blackbox::Order>(box.recording());
  ASSERT_EQ(orders.size(), 1U);
  EXPECT_EQ(orders[0].header.flags, static_cast<int>(Operation::kEnableAlone));
  EXPECT_EQ(orders[0].motors[0], 0b001U);
}

/// `left` and `right` are coupled, on buses of their own, and come back by themselves.
class EnableAloneInAGroupTest : public EnableAloneTest {
 protected:
  void SetUp() override {
    auto config = twoWheelsAndYaw();
    BusConfig other = config.buses[0];
    other.name = "other";
    config.buses[0].motors = {makeMotor("left", kM3508, 1)};
    other.motors = {makeMotor("right", kM3508, 2), makeMotor("yaw", kGM6020, 5)};
    config.buses.push_back(std::move(other));
    config.groups.push_back(leftAndRight(GroupConfig::Return::kRearmAtRest));
    start(std::move(config));
  }
  void losePower(std::size_t bus) {
    robot->freezeBus(bus, true);
    robot->run(50);
    robot->freezeBus(bus, false);
  }
};

TEST_F(EnableAloneInAGroupTest, AMemberIsEnabledWithoutTheOthers) {
  EXPECT_EQ(alone(kLeft), Refusal::kNone);
  EXPECT_EQ(enable(kRight), Refusal::kAlone);
}

TEST_F(EnableAloneInAGroupTest, AMemberIsEnabledWhileAnotherIsMissing) {
  robot->freezeBus(0, true);
  robot->run(50);
  EXPECT_EQ(alone(kRight), Refusal::kNone);
  EXPECT_EQ(status(kRight), MotorStatus::kActive);
}

TEST_F(EnableAloneInAGroupTest, AGroupThatWaitsToComeBackWaitsForARequestInstead) {
  for (const bool ends_at_once : {false, true}) {
    robot->orderFor(only(kLeft) | only(kRight), Operation::kEnable);
    losePower(0);
    robot->run(5);
    ASSERT_EQ(status(kLeft), MotorStatus::kReady);
    (void)robot->events();
    EXPECT_EQ(alone(kYaw), Refusal::kNone);
    robot->run(ends_at_once ? 0 : 2000);
    disable(kYaw);
    robot->run(2000);
    EXPECT_EQ(status(kLeft), MotorStatus::kReady) << ends_at_once;
    EXPECT_EQ(status(kRight), MotorStatus::kReady) << ends_at_once;
    EXPECT_THAT(robot->events(), Not(Contains(Field(&Event::code, EventCode::kGroupRearmed))))
        << ends_at_once;
  }
}

TEST_F(EnableAloneInAGroupTest, AMemberThatWasLostDoesNotComeBackByItself) {
  (void)alone(kLeft);
  losePower(0);
  robot->run(2000);
  EXPECT_EQ(status(kLeft), MotorStatus::kReady);
  EXPECT_EQ(enable(kRight), Refusal::kNone);
}

}  // namespace
}  // namespace rc10::test::supervisor_alone_test
