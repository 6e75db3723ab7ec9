#include "robot_client/session/obstacle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace obstacle_test {
namespace {

using testing::HasSubstr;

TEST(Obstacle, SaysWhatToDo) {
  RobotState state;
  EXPECT_EQ(*obstacle(state, "lift", Mode::kVelocity), "there is no motor 'lift'; the motors are: none");
  state.motors.emplace_back();
  state.motors[0].name = "lift";
  state.motors[0].status = MotorStatus::kReady;
  EXPECT_EQ(*obstacle(state, "lift", Mode::kVelocity), "lift is READY: enable it first");
  state.motors[0].status = MotorStatus::kActive;
  EXPECT_FALSE(obstacle(state, "lift", Mode::kVelocity));
  EXPECT_THAT(*obstacle(state, "lift", Mode::kTotalAngle), HasSubstr("zero: power_on"));
  state.status = RobotStatus::kEstop;
  EXPECT_THAT(*obstacle(state, "lift", Mode::kVelocity), HasSubstr("ESTOP: clear it"));
}

}  // namespace
}  // namespace obstacle_test
}  // namespace robot_client
}  // namespace rc10
