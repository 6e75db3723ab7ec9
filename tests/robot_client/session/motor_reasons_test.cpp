#include "robot_client/session/motor_reasons.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10 {
inline namespace robot_client {
namespace motor_reasons_test {
namespace {

using testing::IsEmpty;

bool known(std::string_view name) { return name == "left" || name == "right" || name == "arm"; }

TEST(MotorReasons, EachMotorGetsItsOwn) {
  const auto reasons = motorReasons(
      "enable: 0 of 3 motors (left, right: offline: no feedback from the drive; check power, wiring and id; "
      "arm: "
      "in FAULT: clear it first)",
      known);
  ASSERT_EQ(reasons.size(), 3U);
  EXPECT_EQ(reasons[0].motor, "left");
  EXPECT_EQ(reasons[0].reason, "offline: no feedback from the drive; check power, wiring and id");
  EXPECT_EQ(reasons[1].motor, "right");
  EXPECT_EQ(reasons[1].reason, reasons[0].reason);
  EXPECT_EQ(reasons[2].motor, "arm");
  EXPECT_EQ(reasons[2].reason, "in FAULT: clear it first");
}

TEST(MotorReasons, NoneInOtherMessages) {
  EXPECT_THAT(motorReasons("enable: 3 of 3 motors", known), IsEmpty());
  EXPECT_THAT(motorReasons("zero needs a motor: name it", known), IsEmpty());
  EXPECT_THAT(motorReasons(") odd (", known), IsEmpty());
  EXPECT_THAT(motorReasons("", known), IsEmpty());
}

}  // namespace
}  // namespace motor_reasons_test
}  // namespace robot_client
}  // namespace rc10
