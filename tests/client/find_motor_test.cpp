#include "client/find_motor.hpp"

#include <gtest/gtest.h>

namespace rc10::client::find_motor_test {
namespace {

link::Welcome twoMotors() {
  link::Welcome welcome{};
  welcome.motor_count = 2;
  welcome.motors[0].name = "left";
  welcome.motors[1].name = "right";
  return welcome;
}

TEST(FindMotor, AMotorIsFoundByItsName) { EXPECT_EQ(findMotor(twoMotors(), "right"), 1U); }

TEST(FindMotor, TheErrorListsTheMotors) {
  EXPECT_EQ(findMotor(twoMotors(), "yaw").error().message,
            "there is no motor 'yaw'; the motors are: left, right");
}

TEST(FindMotor, MoreMotorsThanThereIsRoomForAreNotLookedAt) {
  auto welcome = twoMotors();
  welcome.motor_count = 0xFFFF;
  EXPECT_FALSE(findMotor(welcome, "yaw"));
}

}  // namespace
}  // namespace rc10::client::find_motor_test
