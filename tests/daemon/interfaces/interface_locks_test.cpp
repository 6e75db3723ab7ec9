#include "daemon/interfaces/interface_locks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <map>

#include "daemon/virtual_robot.hpp"

namespace rc10::test::interface_locks_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// No interface has such an index: nobody else on this computer has its lock.
const int kBase = 1'500'000'000 + ::getpid();

// Interfaces by name, as a kernel without CAN has none.
std::map<std::string, int> interfaces;
int bound_to = 0;

InterfaceLocks::Source fakeInterfaces() {
  return {.find = [](const std::string& name) -> Result<int> {
            const auto found = interfaces.find(name);
            return found == interfaces.end() ? Result<int>{fail(name + " is not there")} : found->second;
          },
          .lock = link::InterfaceLock::take,
          .bound = [](int) { return bound_to; }};
}

RobotConfig robotOn(const std::vector<std::string>& names) {
  RobotConfig config;
  config.robot = "hero";
  for (const auto& name : names) {
    BusConfig bus;
    bus.name = "bus_" + name;
    bus.type = BusType::kSocketCan;
    bus.interface = name;
    config.buses.push_back(bus);
  }
  return config;
}

class InterfaceLocksTest : public ::testing::Test {
 protected:
  InterfaceLocksTest() { interfaces = {{"can0", kBase}, {"front", kBase}, {"can1", kBase + 1}}; }
};

TEST_F(InterfaceLocksTest, TwoNamesOfOneInterfaceAreNoTwoBuses) {
  const auto locks = InterfaceLocks::take(robotOn({"can0", "can1", "front"}), fakeInterfaces());
  ASSERT_FALSE(locks);
  EXPECT_THAT(
      locks.error().message,
      HasSubstr("buses 'bus_can0' and 'bus_front' are one: can0 and front are names of the same interface"));
  EXPECT_THAT(link::InterfaceLock::holder(kBase), IsEmpty());  // nothing is kept
}

TEST_F(InterfaceLocksTest, AnotherNameOfAnInterfaceIsRefusedToASecondRobot) {
  const auto first = InterfaceLocks::take(robotOn({"can0"}), fakeInterfaces());
  ASSERT_TRUE(first);
  const auto second = InterfaceLocks::take(robotOn({"can1", "front"}), fakeInterfaces());
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("front is driven by robot 'hero'"));
  EXPECT_THAT(link::InterfaceLock::holder(kBase + 1), IsEmpty());
}

TEST_F(InterfaceLocksTest, ANameThatMovedBetweenLockAndSocketIsNoticed) {
  auto robot = Robot::build(twoWheelsAndYaw()).value();
  const auto locks = InterfaceLocks::take(robotOn({"can0"}), fakeInterfaces());
  ASSERT_TRUE(locks);
  bound_to = kBase;
  EXPECT_TRUE(locks->check(*robot));
  bound_to = kBase + 1;
  EXPECT_FALSE(locks->check(*robot));
}

TEST_F(InterfaceLocksTest, APluggedInInterfaceIsLockedBeforeItIsOpenedAndTheOldOneIsFreeAfterwards) {
  auto locks = InterfaceLocks::take(robotOn({"can0"}), fakeInterfaces());
  ASSERT_TRUE(locks);
  interfaces["can0"] = kBase + 2;
  ASSERT_EQ(locks->takeAnew(0, "can0"), kBase + 2);
  ASSERT_EQ(locks->takeAnew(0, "can0"), kBase + 2);  // it could not be opened yet
  EXPECT_THAT(link::InterfaceLock::holder(kBase), HasSubstr("hero"));
  EXPECT_THAT(link::InterfaceLock::holder(kBase + 2), HasSubstr("hero"));
  locks->keep(0, kBase + 2);
  EXPECT_THAT(link::InterfaceLock::holder(kBase), IsEmpty());
  EXPECT_THAT(link::InterfaceLock::holder(kBase + 2), HasSubstr("hero"));
}

TEST_F(InterfaceLocksTest, AnInterfaceOfTheSameIndexThatCameBackStaysLocked) {
  auto locks = InterfaceLocks::take(robotOn({"can0"}), fakeInterfaces());
  ASSERT_TRUE(locks);
  ASSERT_EQ(locks->takeAnew(0, "can0"), kBase);
  locks->keep(0, kBase);
  EXPECT_THAT(link::InterfaceLock::holder(kBase), HasSubstr("hero"));
}

TEST_F(InterfaceLocksTest, ANameThatNowMeansAnotherRobotsInterfaceIsNotTaken) {
  auto first = InterfaceLocks::take(robotOn({"can0"}), fakeInterfaces());
  const auto second = InterfaceLocks::take(robotOn({"can1"}), fakeInterfaces());
  ASSERT_TRUE(first && second);
  interfaces["can0"] = kBase + 1;
  EXPECT_FALSE(first->takeAnew(0, "can0"));
  EXPECT_THAT(link::InterfaceLock::holder(kBase), Not(IsEmpty()));
}

}  // namespace
}  // namespace rc10::test::interface_locks_test
