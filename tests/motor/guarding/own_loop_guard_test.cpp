// Runaways in loops of the drive, where the reported current alone tells that the limit acts.
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "motor/guarding/guard_bench.hpp"

namespace rc10::test::own_loop_guard_test {
namespace {

using namespace guard_bench;

/// In a loop of the drive a runaway keeps what it has gained.
class OwnLoopGuardTest : public MotionGuardTest {
 protected:
  OwnLoopGuardTest() { shoved(); }
  /// Against all its torque it has gained speed the other way; `sign`: of that torque.
  void shoved(const Target& asked = {}, float sign = 1.0F) {
    guard = MotorGuard{{.runaway_rpm = 48.0F, .runaway_time = 100ms}};
    unit = CommandUnit::kNative;
    target = asked;
    feedback.current_a = sign * 20.0F;
    EXPECT_EQ(atLimit(sign * -1.0F, 1), FaultCode::kNone);
    EXPECT_EQ(atLimit(sign * -90.0F, 1), FaultCode::kNone);
  }
};

TEST_F(OwnLoopGuardTest, BackEmfThatTakesTheCurrentFromItsLimitHidesNoRunaway) {
  for (const float sign : {1.0F, -1.0F}) {
    shoved({}, sign);
    feedback.current_a = sign;
    EXPECT_EQ(run(99, 0), FaultCode::kNone);
    EXPECT_EQ(run(1, 0), FaultCode::kRunaway);
  }
}

// Each half turn the shorter way to an angle is the other one.
TEST_F(OwnLoopGuardTest, AnAngleThatItPassesOverAndOverHidesNoRunaway) {
  shoved({.mode = ControlMode::kAngle, .value = 90.0});
  for (int i = 0; i < 99; ++i) {
    feedback.angle_deg = i % 20 < 10 ? 100.0F : 80.0F;
    EXPECT_EQ(run(1, kLimitCurrent), FaultCode::kNone);
  }
  EXPECT_EQ(run(1, kLimitCurrent), FaultCode::kRunaway);
}

TEST_F(OwnLoopGuardTest, APushThatIsOverIsNone) {
  EXPECT_EQ(run(98, kLimitCurrent), FaultCode::kNone);
  EXPECT_EQ(atLimit(-77.0F, 1), FaultCode::kNone);
  for (int rpm = -77; rpm < 90; ++rpm) {
    feedback.velocity_rpm = static_cast<float>(rpm);
    EXPECT_EQ(run(1, kLimitCurrent), FaultCode::kNone) << "it is brought back";
  }
}

TEST_F(OwnLoopGuardTest, ASpeedThatIsAskedForMeanwhileIsNone) {
  EXPECT_EQ(run(50, kLimitCurrent), FaultCode::kNone);
  target = {.mode = ControlMode::kVelocity, .value = -100.0};
  EXPECT_EQ(run(200, kLimitCurrent), FaultCode::kNone);
}

// The current of a brake is still reported when the next way has begun.
TEST_F(OwnLoopGuardTest, AnOldReportMakesNoRunawayOfAMoveToAFarAngle) {
  for (const auto& [accelerating_a, limits] :
       {std::pair{20.0F, std::uint32_t{kLimitCurrent}}, std::pair{12.0F, 0U}}) {
    guard = MotorGuard{{.runaway_rpm = 48.0F, .runaway_time = 200ms}};
    target = {.mode = ControlMode::kAngle, .value = 175.0};
    feedback.angle_deg = 0.0F;
    feedback.current_a = -20.0F;
    for (int rpm = 0; rpm <= 70; ++rpm) EXPECT_EQ(atLimit(static_cast<float>(rpm), 1), FaultCode::kNone);
    feedback.current_a = accelerating_a;
    feedback.velocity_rpm = 90.0F;
    for (int i = 0; i < 255; ++i) {
      feedback.angle_deg = 20.0F + 0.5F * static_cast<float>(i);
      ASSERT_EQ(run(1, limits), FaultCode::kNone) << accelerating_a << " A, " << i << " ms";
    }
  }
}

TEST_F(OwnLoopGuardTest, ANoisyCurrentOfARunawayAtItsNoLoadSpeedHidesNothing) {
  for (int i = 0; i < 99; ++i) {
    feedback.current_a = i % 2 == 0 ? 0.4F : -0.4F;
    EXPECT_EQ(run(1, 0), FaultCode::kNone);
  }
  feedback.current_a = 0.4F;
  EXPECT_EQ(run(1, 0), FaultCode::kRunaway);
}

// The shove was during the loop; what follows gives it no torque, or has torque of its own.
TEST_F(OwnLoopGuardTest, AGainIsForgottenWhereTheLoopLeavesToAnEffort) {
  for (const auto& [mode, effort] :
       {std::pair{ControlMode::kCoast, 0.0F}, std::pair{ControlMode::kCurrent, 0.0F},
        std::pair{ControlMode::kCurrent, 20.0F}, std::pair{ControlMode::kImpedance, 20.0F},
        std::pair{ControlMode::kVoltage, 20.0F}}) {
    SCOPED_TRACE(std::string{toString(mode)});
    shoved();
    unit = mode == ControlMode::kVoltage ? CommandUnit::kVolt : CommandUnit::kAmpere;
    effort_a = effort;
    target = {.mode = mode};
    EXPECT_EQ(run(200, effort != 0.0F ? kLimitCurrent : 0U), FaultCode::kNone);
    EXPECT_EQ(atLimit(-91.0F, 10), FaultCode::kNone);
    EXPECT_EQ(atLimit(-139.0F, 1), effort != 0.0F ? FaultCode::kRunaway : FaultCode::kNone)
        << "speed gained against this effort";
  }
}

TEST_F(OwnLoopGuardTest, AGainIsOfTheModeThatSawIt) {
  for (const auto mode : {ControlMode::kAngle, ControlMode::kTotalAngle, ControlMode::kBrake}) {
    shoved();
    EXPECT_EQ(run(98, kLimitCurrent), FaultCode::kNone);
    target = {.mode = mode};
    feedback.current_a = 1.0F;
    EXPECT_EQ(run(300, 0), FaultCode::kNone);
    shoved();
    EXPECT_EQ(run(98, kLimitCurrent), FaultCode::kNone);
    target = {.mode = mode};
    EXPECT_EQ(run(100, kLimitCurrent), FaultCode::kNone);
    EXPECT_EQ(run(1, kLimitCurrent), FaultCode::kRunaway) << "it goes on against the new loop";
  }
}

}  // namespace
}  // namespace rc10::test::own_loop_guard_test
