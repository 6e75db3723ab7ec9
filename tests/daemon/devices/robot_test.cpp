#include "daemon/devices/robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/virtual_robot.hpp"

namespace rc10::test::robot_test {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

RobotConfig withMotors(std::vector<MotorConfig> motors) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors = std::move(motors);
  return config;
}

std::string refusal(const RobotConfig& config) {
  const auto robot = Robot::build(config);
  return robot ? "built" : robot.error().message;
}

TEST(Robot, HasItsMotorsInTheOrderOfTheConfiguration) {
  auto config = twoWheelsAndYaw();
  config.buses[0].motors[1].feedback_timeout = 35ms;
  auto second = config.buses[0];
  second.name = "arm";
  second.motors = {makeMotor("elbow", kM2006, 1)};
  config.buses.push_back(second);
  const auto robot = Robot::build(config).value();
  ASSERT_EQ(robot->motors().size(), 4U);
  const std::array names{"left", "right", "yaw", "elbow"};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(robot->motors()[i].motor->name(), names[i]);
  EXPECT_EQ(robot->motors()[2].bus, 0U);
  EXPECT_EQ(robot->motors()[3].bus, 1U);
  EXPECT_EQ(robot->motors()[1].feedback_timeout, 35ms);
  ASSERT_EQ(robot->buses().size(), 2U);
  EXPECT_EQ(robot->buses()[1].bus->name(), "arm");
}

TEST(Robot, HasOneGroupForEachCommandId) {
  const auto robot = Robot::build(twoWheelsAndYaw()).value();
  const auto& packers = robot->buses()[0].bus->packers();
  ASSERT_EQ(packers.size(), 2U);  // M3508 1 and 2 share one; GM6020 5 has another
  EXPECT_EQ(packers[0]->commandIds().front(), (CanId{0x200, false}));
  EXPECT_EQ(packers[1]->commandIds().front(), (CanId{0x2FE, false}));
}

TEST(Robot, WatchesTheEchoOfTheMostUrgentCommand) {
  const auto robot =
      Robot::build(withMotors({makeMotor("yaw", kGM6020, 5), makeMotor("a", kM3508, 1)})).value();
  EXPECT_THAT(robot->buses()[0].watched, ::testing::ElementsAre(CanId{0x200, false}));
}

TEST(Robot, MotorsOfDifferentModelsShareAGroup) {
  const auto robot = Robot::build(withMotors({makeMotor("a", kM3508, 1), makeMotor("b", kM2006, 2)})).value();
  EXPECT_EQ(robot->buses()[0].bus->packers().size(), 1U);
}

TEST(Robot, IdsAboveFourHaveAGroupOfTheirOwn) {
  const auto robot = Robot::build(withMotors({makeMotor("a", kM3508, 4), makeMotor("b", kM3508, 5)})).value();
  EXPECT_EQ(robot->buses()[0].bus->packers().size(), 2U);
}

TEST(Robot, TheSameIdsOnTwoBusesAreDifferentMotorsAndGroups) {
  auto config = twoWheelsAndYaw();
  config.buses.push_back(config.buses[0]);
  config.buses[1].name = "other";
  for (auto& motor : config.buses[1].motors) motor.settings.name = "other_" + motor.settings.name;
  const auto robot = Robot::build(config).value();
  EXPECT_EQ(robot->motors().size(), 6U);
  EXPECT_EQ(robot->buses()[0].bus->packers().size(), 2U);
  EXPECT_EQ(robot->buses()[1].bus->packers().size(), 2U);
  EXPECT_NE(robot->buses()[0].bus->packers()[0], robot->buses()[1].bus->packers()[0]);
}

TEST(Robot, TwoMotorsWithOneIdAreRefusedByName) {
  EXPECT_THAT(refusal(withMotors({makeMotor("left", kM3508, 3), makeMotor("right", kM3508, 3)})),
              AllOf(HasSubstr("left"), HasSubstr("right")));
}

TEST(Robot, TwoModelsWhoseFeedbackIdsCollideAreRefusedByName) {
  // M3508 5 and GM6020 1 both answer with 0x205.
  EXPECT_THAT(refusal(withMotors({makeMotor("wheel", kM3508, 5), makeMotor("gimbal", kGM6020, 1)})),
              AllOf(HasSubstr("wheel"), HasSubstr("gimbal")));
}

TEST(Robot, TwoMotorsOfOneNameOnABusAreRefused) {
  EXPECT_THAT(refusal(withMotors({makeMotor("left", kM3508, 1), makeMotor("left", kM3508, 2)})),
              HasSubstr("left"));
}

TEST(Robot, AnIdThatTheModelDoesNotHaveIsRefused) {
  EXPECT_THAT(refusal(withMotors({makeMotor("left", kM3508, 9)})), HasSubstr("left"));
}

TEST(Robot, AMissingInterfaceIsNamed) {
  auto config = twoWheelsAndYaw();
  config.buses[0].type = BusType::kSocketCan;
  config.buses[0].interface = "rc10nosuch";
  EXPECT_THAT(refusal(config), HasSubstr("rc10nosuch"));
}

TEST(Robot, ASimulatedBusHasItsDrivesAtTheOtherEnd) {
  const auto robot = Robot::build(twoWheelsAndYaw()).value();
  ASSERT_EQ(robot->simPorts().size(), 1U);
  auto& simulated = robot->simPorts()[0]->bus();
  EXPECT_EQ(simulated.size(), 3U);
  EXPECT_TRUE(simulated.indexOf("yaw"));
  const auto& entry = robot->buses()[0];
  EXPECT_TRUE(entry.interface.empty());
  EXPECT_FALSE(entry.echo);
  EXPECT_THAT(entry.watched, ::testing::ElementsAre(CanId{0x200, false}));
  // The drives receive all that the bus sends.
  entry.bus->packRest();
  entry.bus->flush();
  robot->simPorts()[0]->step(MonotonicTime{1s});
  EXPECT_EQ(robot->simPorts()[0]->counters().commands, 2U);
}

TEST(Robot, ABusWithoutMotorsIsBuilt) {
  const auto robot = Robot::build(withMotors({})).value();
  EXPECT_TRUE(robot->motors().empty());
  EXPECT_TRUE(robot->buses()[0].bus->packers().empty());
}

}  // namespace
}  // namespace rc10::test::robot_test
