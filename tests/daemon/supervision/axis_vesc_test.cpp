// A VESC obeys whatever it hears: by its answers and its watchdog alone it shows that it hears.
#include <gtest/gtest.h>

#include <string>

#include "daemon/supervision/one_motor.hpp"

namespace rc10::test::axis_vesc_test {
namespace {

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
    if (i == 400) {
      ASSERT_EQ(motor.seen().status, MotorStatus::kActive) << "some answers may be lost";
    }
    if (i == 900) {
      ASSERT_EQ(motor.seen().fault, FaultCode::kDriveCommunication);
    }
  }
  const double before_rpm = shaft.outputRpm();
  for (int i = 0; i < 1000; ++i) {
    motor.follow(ControlMode::kVelocity, 600.0, 1);
    ASSERT_LE(shaft.outputRpm(), before_rpm);
  }
  EXPECT_EQ(motor.seen().status, MotorStatus::kFault);
}

class VescThatIsHeld : public ::testing::TestWithParam<const char*> {
 protected:
  static constexpr MotorSet kOne{1U};

  Refusal enable() { return robot().orderFor(kOne, Operation::kEnable).motors[0]; }
  void disable(Acting expected) {
    (void)robot().orderFor(kOne, Operation::kDisable);
    ASSERT_EQ(motor_.seen().status, MotorStatus::kReady);
    ASSERT_EQ(motor_.seen().acting, expected);
  }
  VirtualRobot& robot() { return motor_.robot(); }

  OneMotor motor_{kVesc + GetParam()};
};

// Another drive may have been plugged in meanwhile, without a watchdog.
TEST_P(VescThatIsHeld, AfterAGapIsRefusedAndHeldOnAndHasToRestFirst) {
  robot().simBus().silence(0, true);
  robot().tick(330);  // a pause of the computer; another gap as long ends ACTIVE
  robot().simBus().silence(0, false);
  robot().run(50);
  ASSERT_EQ(motor_.seen().status, MotorStatus::kActive);
  disable(Acting::kHold);
  for (int attempt = 0; attempt < 2; ++attempt) {
    EXPECT_EQ(enable(), Refusal::kRestFirst);
    EXPECT_EQ(motor_.seen().status, MotorStatus::kReady);
    EXPECT_EQ(motor_.seen().acting, Acting::kHold) << "a load does not fall";
    robot().run(20);
  }
  disable(Acting::kNothing);
  EXPECT_EQ(enable(), Refusal::kNone);
  EXPECT_EQ(motor_.seen().status, MotorStatus::kActive);
}

TEST_P(VescThatIsHeld, AfterAGapInItsEnablingIsHeldOnAndHasToRestFirst) {
  disable(Acting::kHold);
  robot().simBus().silence(0, true);
  robot().beginEnabling(kOne);
  robot().tick();
  ASSERT_EQ(motor_.seen().status, MotorStatus::kEnabling);
  robot().tick(330);
  robot().simBus().silence(0, false);
  OrderResult result;
  for (int i = 0; i < 100 && !robot().exchange().results.pop(result); ++i) robot().tick();
  EXPECT_EQ(result.motors[0], Refusal::kRestFirst);
  EXPECT_EQ(motor_.seen().acting, Acting::kHold);
}

TEST_P(VescThatIsHeld, WithAProvenWatchdogIsEnabledAtOnce) {
  disable(Acting::kHold);
  EXPECT_EQ(enable(), Refusal::kNone);
  EXPECT_EQ(motor_.seen().acting, Acting::kHold);
}

INSTANTIATE_TEST_SUITE_P(All, VescThatIsHeld,
                         ::testing::Values(", feedback_timeout_ms: 400, on_disable: hold",
                                           ", feedback_timeout_ms: 400, on_disable: hold, angle: encoder"),
                         [](const auto& each) { return "case" + std::to_string(each.index); });

}  // namespace
}  // namespace rc10::test::axis_vesc_test
