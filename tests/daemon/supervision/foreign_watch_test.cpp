#include "daemon/supervision/foreign_watch.hpp"

#include <gtest/gtest.h>

#include "daemon/exchange/events.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::foreign_watch_test {
namespace {

using namespace std::chrono_literals;

constexpr CanId kWheels{.value = 0x200};
constexpr CanId kYaw{.value = 0x2FE};
constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr std::size_t kYawMotor = 2;

/// Two buses of the same ids.
RobotConfig twoBuses(const ForeignLimit& limit) {
  auto config = twoWheelsAndYaw();
  config.buses[0].foreign = limit;
  auto& other = config.buses.emplace_back(config.buses[0]);
  other.name = "other";
  for (auto& motor : other.motors) motor.settings.name += "_2";
  return config;
}

class ForeignWatchTest : public ::testing::Test {
 protected:
  explicit ForeignWatchTest(const ForeignLimit& limit = {.frames = 3, .within = 100ms})
      : robot(twoBuses(limit)), watch(robot.robot()) {}

  void hear(CanId id, Duration at, std::size_t bus = 0, bool here = false) {
    CanFrame frame{.id = id, .length = 8, .sent_here = here, .received = MonotonicTime{at}};
    frame.data[1] = 100;
    watch.onForeign(*robot.robot().buses()[bus].bus, frame);
  }

  VirtualRobot robot;
  ForeignWatch watch;
};

TEST_F(ForeignWatchTest, SoManyWithinTheTimeTakeOver) {
  hear(kWheels, 1000ms);
  hear(kWheels, 1050ms);
  EXPECT_FALSE(watch.tookOver(kLeft));
  hear(kWheels, 1100ms);
  EXPECT_TRUE(watch.tookOver(kLeft));
  EXPECT_EQ(watch.takeover(kLeft), foreignFrame(kWheels, false));
}

TEST_F(ForeignWatchTest, LaterThanTheTimeTheyDoNot) {
  for (int i = 0; i < 20; ++i) hear(kWheels, 1000ms + i * (50ms + Duration{1}));
  EXPECT_FALSE(watch.tookOver(kLeft));
  hear(kWheels, 1000ms + 19 * (50ms + Duration{1}));
  EXPECT_TRUE(watch.tookOver(kLeft)) << "the last three count, and two are one";
}

TEST_F(ForeignWatchTest, CountingBeginsAnewAfterATakeover) {
  for (int i = 0; i < 3; ++i) hear(kWheels, 1000ms, 0, true);
  EXPECT_EQ(watch.takeover(kLeft), foreignFrame(kWheels, true));
  EXPECT_FALSE(watch.tookOver(kLeft));
  EXPECT_EQ(watch.takeover(kLeft), std::nullopt);
  hear(kWheels, 1001ms);
  hear(kWheels, 1001ms);
  EXPECT_FALSE(watch.tookOver(kLeft));
  hear(kWheels, 1001ms);
  EXPECT_TRUE(watch.tookOver(kLeft));
}

TEST_F(ForeignWatchTest, EachConcernsTheMotorsOfItsIdOnItsBus) {
  for (int i = 0; i < 3; ++i) hear(kWheels, 1000ms);
  for (const auto motor : {kLeft, kRight}) EXPECT_TRUE(watch.tookOver(motor));
  for (const auto motor : {kYawMotor, kLeft + 3, kRight + 3, kYawMotor + 3})
    EXPECT_FALSE(watch.tookOver(motor)) << motor;
  for (int i = 0; i < 3; ++i) hear(kYaw, 1000ms, 1);
  EXPECT_TRUE(watch.tookOver(kYawMotor + 3));
  EXPECT_FALSE(watch.tookOver(kYawMotor));
}

TEST_F(ForeignWatchTest, RestFramesAreNone) {
  const CanFrame rest{.id = kWheels, .length = 8, .received = MonotonicTime{1s}};
  for (int i = 0; i < 20; ++i) watch.onForeign(*robot.robot().buses()[0].bus, rest);
  EXPECT_FALSE(watch.tookOver(kLeft));
}

TEST_F(ForeignWatchTest, TheFirstFramesOfItsLifeAreNoneOfBefore) {
  hear(kWheels, 10ms);
  hear(kWheels, 20ms);
  EXPECT_FALSE(watch.tookOver(kLeft)) << "slots that nothing filled are no frames";
}

class FirstForeignFrameTest : public ForeignWatchTest {
 protected:
  FirstForeignFrameTest() : ForeignWatchTest({.frames = 1, .within = 100ms}) {}
};

TEST_F(FirstForeignFrameTest, OneMayBeEnough) {
  hear(kWheels, 1000ms);
  EXPECT_TRUE(watch.tookOver(kLeft));
}

class AnyForeignFramesTest : public ForeignWatchTest {
 protected:
  AnyForeignFramesTest() : ForeignWatchTest({.frames = 0, .within = 100ms}) {}
};

TEST_F(AnyForeignFramesTest, NoNumberOfThemMayBeEnough) {
  for (int i = 0; i < 200; ++i) hear(kWheels, 1000ms);
  EXPECT_FALSE(watch.tookOver(kLeft));
}

}  // namespace
}  // namespace rc10::test::foreign_watch_test
