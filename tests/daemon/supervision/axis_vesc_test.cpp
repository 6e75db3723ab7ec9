// A VESC obeys whatever it hears: by its answers and its watchdog alone it shows that it hears.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "daemon/supervision/one_motor.hpp"

namespace rc10::test::axis_vesc_test {
namespace {

using namespace std::chrono_literals;

const std::string kVesc =
    "model: VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000, feedback_hz: 500, kv_rpm_per_v: 100";

TEST(VescThatReceivesNothing, IsAFaultWithinASecondAndDoesNotStartAgainByItself) {
  OneMotor motor{kVesc};
  auto& robot = motor.robot();
  const auto& shaft = robot.simBus().drive(0).physics();
  motor.follow(ControlMode::kVelocity, 600.0, 2000);
  ASSERT_NEAR(shaft.outputRpm(), 600.0, 30.0);
  for (int i = 0; i < 2000; ++i) {
    motor.follow(ControlMode::kVelocity, 600.0, 1);
    (void)robot.takeFrames();
    if (i == 500) EXPECT_EQ(motor.seen().status, MotorStatus::kActive) << "some answers may be lost";
    if (i == 1000) EXPECT_EQ(motor.seen().fault, FaultCode::kDriveCommunication);
  }
  const double before_rpm = shaft.outputRpm();
  for (int i = 0; i < 1000; ++i) {
    motor.follow(ControlMode::kVelocity, 600.0, 1);
    ASSERT_LE(shaft.outputRpm(), before_rpm);
  }
  EXPECT_EQ(motor.seen().status, MotorStatus::kFault);
}

}  // namespace
}  // namespace rc10::test::axis_vesc_test
