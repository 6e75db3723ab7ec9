#include "daemon/threads/gpio_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/fake_gpio.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::gpio_loop_test {
namespace {

using namespace std::chrono_literals;
using enum ContactState;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A robot whose e-stop input the test holds in its hand.
class EstopInputTest : public ::testing::Test {
 protected:
  EstopInputTest() {
    look();
    robot.run(5);
  }
  void look() { gpio.turn(robot.now(), robot.scheduler().ticks()); }
  void see(ContactState state) {
    input.now = state;
    look();
    robot.tick();
  }
  void enable() {
    EXPECT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kNone);
    ASSERT_EQ(robot.motor(0).status, MotorStatus::kActive);
  }
  RobotStatus state() { return robot.scheduler().supervisor().robotState(); }
  std::vector<std::int32_t> contactEvents() {
    std::vector<std::int32_t> values;
    for (const auto& event : robot.events()) {
      if (event.code == EventCode::kEstopInput) values.push_back(event.value);
    }
    return values;
  }

  VirtualRobot robot{twoWheelsAndYaw()};
  FakeContact::State input;
  GpioLoop gpio{std::make_unique<FakeContact>(input), std::nullopt, robot.exchange()};
};

TEST_F(EstopInputTest, AClosedContactLetsTheRobotRun) {
  enable();
  for (int i = 0; i < 500; ++i) see(kClosed);
  EXPECT_EQ(state(), RobotStatus::kRun);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
}

TEST_F(EstopInputTest, AnOpenContactRestsEveryMotorInTheNextTickAndTellsTheCause) {
  enable();
  robot.hold(0, {.mode = ControlMode::kVelocity, .value = 100.0}, 50);
  (void)robot.events();
  see(kOpen);
  EXPECT_EQ(state(), RobotStatus::kEstop);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NE(robot.motor(i).status, MotorStatus::kActive);
  EXPECT_EQ(robot.motor(0).command_value, 0.0F);
  const auto events = robot.events();
  ASSERT_GE(events.size(), 2U);
  EXPECT_EQ(events[0].code, EventCode::kEstopInput);  // the cause comes first
  EXPECT_EQ(events[0].severity, Severity::kError);
  EXPECT_THAT(describe(events[0]), HasSubstr("e-stop: the input is open"));
}

TEST_F(EstopInputTest, AChipThatCannotBeReadIsAnEstop) {
  enable();
  see(kUnreadable);
  EXPECT_EQ(state(), RobotStatus::kEstop);
  EXPECT_THAT(contactEvents(), ElementsAre(static_cast<int>(kUnreadable)));
}

TEST_F(EstopInputTest, AThreadThatNoLongerLooksIsAnEstop) {
  enable();
  robot.run(150);
  EXPECT_EQ(state(), RobotStatus::kRun);
  robot.run(100);
  EXPECT_EQ(state(), RobotStatus::kEstop);
}

TEST_F(EstopInputTest, ClearIsRefusedInWordsUntilTheContactIsClosed) {
  see(kOpen);
  const auto refused = robot.order(Operation::kClear);
  EXPECT_EQ(refused.motors[0], Refusal::kEstopInput);
  EXPECT_EQ(refused.motors[2], Refusal::kEstopInput);
  EXPECT_EQ(state(), RobotStatus::kEstop);
  see(kClosed);
  EXPECT_EQ(state(), RobotStatus::kEstop);  // closing alone is not enough
  EXPECT_EQ(robot.order(Operation::kEnable).motors[0], Refusal::kEstop);
  EXPECT_EQ(robot.order(Operation::kClear).motors[0], Refusal::kNone);
  EXPECT_EQ(state(), RobotStatus::kRun);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kReady);  // enabling is a request of its own
  EXPECT_THAT(contactEvents(), ElementsAre(static_cast<int>(kOpen), static_cast<int>(kClosed)));
}

TEST_F(EstopInputTest, AnOpeningThatIsOverBeforeTheTickActsToo) {
  enable();
  input.first = {kOpen, kClosed};
  look();
  look();
  robot.tick();
  EXPECT_EQ(state(), RobotStatus::kEstop);
  EXPECT_EQ(robot.order(Operation::kClear).motors[0], Refusal::kNone);
}

TEST_F(EstopInputTest, AnOpeningThatIsOverBeforeItsTickVetoesAClearOfThatTick) {
  see(kOpen);
  see(kClosed);
  input.first = {kOpen, kClosed};
  look();
  look();
  EXPECT_EQ(robot.order(Operation::kClear).motors[0], Refusal::kEstopAsked);
  EXPECT_EQ(state(), RobotStatus::kEstop);
  EXPECT_EQ(robot.order(Operation::kClear).motors[0], Refusal::kNone);
}

TEST_F(EstopInputTest, OneThatIsOpenAtTheStartIsAnEstopInTheFirstTick) {
  VirtualRobot other{twoWheelsAndYaw()};
  FakeContact::State pressed{.now = kOpen, .first = {}, .waits = {}};
  GpioLoop loop{std::make_unique<FakeContact>(pressed), std::nullopt, other.exchange()};
  loop.turn({}, 0);
  other.tick();
  EXPECT_EQ(other.scheduler().supervisor().robotState(), RobotStatus::kEstop);
}

/// A robot with an enabling switch in the other hand.
class EnablingSwitchTest : public EstopInputTest {
 protected:
  EnablingSwitchTest() { turn(); }
  void turn() { both.turn(robot.now(), robot.scheduler().ticks()); }
  void hold(ContactState state) {
    switch_.now = state;
    turn();
    robot.tick();
  }

  FakeContact::State switch_;
  GpioLoop both{std::make_unique<FakeContact>(input), std::nullopt, robot.exchange(),
                std::make_unique<FakeContact>(switch_)};
};

TEST_F(EnablingSwitchTest, HeldInTheMiddleItLetsTheRobotRun) {
  enable();
  for (int i = 0; i < 500; ++i) hold(kClosed);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kActive);
}

TEST_F(EnablingSwitchTest, ReleasedOrSqueezedItStopsInTheNextTickAndSaysSo) {
  enable();
  robot.hold(0, {.mode = ControlMode::kVelocity, .value = 100.0}, 50);
  (void)robot.events();
  hold(kOpen);
  EXPECT_EQ(state(), RobotStatus::kEstop);
  EXPECT_EQ(robot.motor(0).command_value, 0.0F);
  const auto events = robot.events();
  ASSERT_GE(events.size(), 2U);
  EXPECT_THAT(describe(events[0]), HasSubstr("the enabling switch is released or squeezed"));
}

TEST_F(EnablingSwitchTest, HoldingItAgainStartsNothing) {
  enable();
  hold(kOpen);
  switch_.now = kOpen;
  turn();
  EXPECT_EQ(robot.order(Operation::kClear).motors[0], Refusal::kEstopInput);
  for (int i = 0; i < 10; ++i) hold(kClosed);
  EXPECT_EQ(state(), RobotStatus::kEstop);
  EXPECT_EQ(robot.order(Operation::kClear).motors[0], Refusal::kNone);
  EXPECT_EQ(robot.motor(0).status, MotorStatus::kReady) << "it has to be enabled anew";
}

TEST_F(EnablingSwitchTest, AReleaseThatIsOverBeforeTheTickActsTooAndIsToldAsOne) {
  enable();
  (void)robot.events();
  switch_.first = {kOpen, kClosed};
  turn();
  turn();
  robot.tick();
  EXPECT_EQ(state(), RobotStatus::kEstop);
  EXPECT_EQ(contactEvents().front(), static_cast<int>(kReleased));
}

TEST_F(EnablingSwitchTest, OneThatCannotBeReadIsAnEstop) {
  enable();
  hold(kUnreadable);
  EXPECT_EQ(state(), RobotStatus::kEstop);
}

TEST_F(EnablingSwitchTest, TheButtonCountsAsBefore) {
  enable();
  input.now = kOpen;
  hold(kClosed);
  EXPECT_EQ(state(), RobotStatus::kEstop);
  EXPECT_EQ(contactEvents().back(), static_cast<int>(kOpen));
}

TEST(GpioLoop, AnEnablingSwitchAloneIsWaitedFor) {
  LinkExchange exchange;
  FakeContact::State switch_;
  GpioLoop loop{nullptr, std::nullopt, exchange, std::make_unique<FakeContact>(switch_)};
  loop.turn(MonotonicTime{1s}, 1);
  EXPECT_THAT(switch_.waits, ElementsAre(10ms));
  EXPECT_FALSE(exchange.estop_contact.look(0.001F).opened);
  switch_.now = kOpen;
  loop.turn(MonotonicTime{2s}, 2);
  EXPECT_EQ(exchange.estop_contact.look(0.001F).news, kReleased);
}

TEST(GpioLoop, BesideTheButtonNeitherWaitsLong) {
  LinkExchange exchange;
  FakeContact::State input;
  FakeContact::State switch_;
  GpioLoop loop{std::make_unique<FakeContact>(input), std::nullopt, exchange,
                std::make_unique<FakeContact>(switch_)};
  loop.turn(MonotonicTime{1s}, 1);
  EXPECT_THAT(input.waits, ElementsAre(1ms));
  EXPECT_THAT(switch_.waits, ElementsAre(0ms));
}

TEST(GpioLoop, AMissingEnablingSwitchIsAnErrorThatNamesItsKey) {
  LinkExchange exchange;
  RobotConfig config;
  config.enabling_gpio = ContactGpioConfig{.pin = {"no_such_chip", 22}};
  const auto loop = GpioLoop::create(config, exchange);
  ASSERT_FALSE(loop);
  EXPECT_THAT(loop.error().message, HasSubstr("enabling_gpio: no_such_chip:22: "));
}

TEST(GpioLoop, TheModeInputAloneIsWaitedForAndStopsNothing) {
  LinkExchange exchange;
  FakeContact::State door;
  GpioLoop loop{nullptr, std::nullopt, exchange, nullptr, std::make_unique<FakeContact>(door)};
  door.now = kOpen;
  loop.turn(MonotonicTime{1s}, 1);
  EXPECT_THAT(door.waits, ElementsAre(10ms));
  EXPECT_EQ(exchange.mode_contact.look(0.001F).news, kOpen);
  EXPECT_FALSE(exchange.estop_contact.look(0.001F).opened);
}

TEST(GpioLoop, BesideTheButtonTheModeInputDoesNotDelayIt) {
  LinkExchange exchange;
  FakeContact::State input;
  FakeContact::State door;
  GpioLoop loop{std::make_unique<FakeContact>(input), std::nullopt, exchange, nullptr,
                std::make_unique<FakeContact>(door)};
  loop.turn(MonotonicTime{1s}, 1);
  EXPECT_THAT(input.waits, ElementsAre(1ms));
  EXPECT_THAT(door.waits, ElementsAre(0ms));
  input.now = kOpen;
  loop.turn(MonotonicTime{2s}, 2);
  EXPECT_TRUE(exchange.estop_contact.look(0.001F).opened);
  EXPECT_FALSE(exchange.mode_contact.look(0.001F).opened);
}

TEST(GpioLoop, AMissingModeInputIsAnErrorThatNamesItsKey) {
  LinkExchange exchange;
  RobotConfig config;
  config.mode_gpio = ContactGpioConfig{.pin = {"no_such_chip", 23}};
  const auto loop = GpioLoop::create(config, exchange);
  ASSERT_FALSE(loop);
  EXPECT_THAT(loop.error().message, HasSubstr("mode_gpio: no_such_chip:23: "));
}

TEST(GpioLoop, LooksAtTheInputAlsoWhenNothingChanges) {
  LinkExchange exchange;
  FakeContact::State input;
  GpioLoop loop{std::make_unique<FakeContact>(input), std::nullopt, exchange};
  loop.turn(MonotonicTime{1s}, 1);
  EXPECT_THAT(input.waits, ElementsAre(10ms));
}

TEST(GpioLoop, DoesNotWaitForTheInputLongerThanTheHeartbeatCan) {
  LinkExchange exchange;
  FakeContact::State input;
  FakePulse::State output;
  GpioLoop loop{std::make_unique<FakeContact>(input), Heartbeat{std::make_unique<FakePulse>(output), 12ms},
                exchange};
  loop.turn(MonotonicTime{1s}, 1);
  loop.turn(MonotonicTime{1s + 4ms}, 5);
  loop.turn(MonotonicTime{1s + 6ms}, 7);
  EXPECT_THAT(output.levels, ElementsAre(true, false));
  ASSERT_EQ(input.waits.size(), 3U);
  for (const auto wait : input.waits) EXPECT_LE(wait, 6ms);
}

TEST(GpioLoop, AHeartbeatThatCannotBeSetIsToldOnce) {
  LinkExchange exchange;
  FakeContact::State input;
  FakePulse::State output{.levels = {}, .refuses = true};
  GpioLoop loop{std::make_unique<FakeContact>(input), Heartbeat{std::make_unique<FakePulse>(output), 12ms},
                exchange};
  EXPECT_FALSE(loop.takeHeartbeatFailure());
  loop.turn(MonotonicTime{1s}, 1);
  loop.turn(MonotonicTime{2s}, 2);
  EXPECT_TRUE(loop.takeHeartbeatFailure());
  EXPECT_FALSE(loop.takeHeartbeatFailure());
}

TEST(GpioLoop, WithoutConfigurationThereIsNoThread) {
  LinkExchange exchange;
  const auto loop = GpioLoop::create(RobotConfig{}, exchange);
  ASSERT_TRUE(loop);
  EXPECT_EQ(*loop, nullptr);
}

TEST(GpioLoop, AMissingSafetyInputIsAnErrorThatNamesTheRemedy) {
  LinkExchange exchange;
  RobotConfig config;
  config.estop_gpio = ContactGpioConfig{.pin = {"no_such_chip", 17}};
  const auto loop = GpioLoop::create(config, exchange);
  ASSERT_FALSE(loop);
  EXPECT_THAT(loop.error().message, HasSubstr("estop_gpio: no_such_chip:17: "));
  EXPECT_THAT(loop.error().message, HasSubstr("`gpiodetect`"));
}

}  // namespace
}  // namespace rc10::test::gpio_loop_test
