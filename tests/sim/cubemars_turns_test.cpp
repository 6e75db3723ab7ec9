// AK motors in MIT mode whose spring acts on another turn than the field of their position.
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "sim/cubemars_rig.hpp"

namespace rc10::test::cubemars_turns_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Its field says 16.5 degrees, and its spring starts from 1449.
TEST(CubemarsTurns, ADriveOnAnotherTurnOfItsFieldIsStoppedBeforeItGoesFar) {
  for (const int direction : {1, -1}) {
    sim::MotorLoad load;
    load.initial_angle_deg = 1449.0F;
    auto rig = rigOf(settingsOf({"AK80-9", "mit", 0.0, direction}), load);
    rig.comeOnline();
    ASSERT_TRUE(rig.enable());
    const double from_deg = rig.drive().physics().outputAngleDeg();
    rig.command({.mode = ControlMode::kTotalAngle, .value = rig.motor().feedback().total_angle_deg});
    int ticks = 0;
    for (; ticks < 100 && rig.motor().complaint().fault == FaultCode::kNone; ++ticks)
      rig.run(milliseconds{1});
    EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveSetting);
    EXPECT_EQ(rig.motor().complaint().native_code, 0x4000'0000U);
    EXPECT_LE(ticks, 8);
    EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), from_deg, 1.0);
    EXPECT_FALSE(rig.motor().feedback().zeroed);
    // After a clear it only damps.
    rig.motor().order(FrameKind::kRest);
    rig.motor().clearComplaint();
    rig.run(seconds{1});
    EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
    ASSERT_TRUE(rig.enable());
    const double at_deg = rig.drive().physics().outputAngleDeg();
    rig.command({.mode = ControlMode::kTotalAngle, .value = rig.motor().feedback().total_angle_deg + 20.0});
    rig.run(milliseconds{300});
    EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), at_deg, 0.5);
    EXPECT_NE(rig.motor().limits() & kLimitAngle, 0U);
  }
}

// Half of its torque, told a moment ago, does not excuse all of it.
TEST(CubemarsTurns, ASpringOnAnotherTurnIsSeenBehindATorqueOfThatDirectionToo) {
  sim::MotorLoad load;
  load.initial_angle_deg = 1449.0F;
  load.stalled = true;
  auto rig = rigOf(settingsOf({"AK80-9", "mit"}), load);
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kCurrent, .torque_ff_nm = -9.0F});
  rig.run(milliseconds{50});
  ASSERT_NEAR(rig.motor().feedback().torque_nm, -9.0, 0.5);
  rig.command({.mode = ControlMode::kTotalAngle, .value = rig.motor().feedback().total_angle_deg});
  int ticks = 0;
  for (; ticks < 100 && rig.motor().complaint().fault == FaultCode::kNone; ++ticks) rig.run(milliseconds{1});
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveSetting);
  EXPECT_LE(ticks, 8);
}

// Its spring pulls against a load for some milliseconds longer than it is told to.
TEST(CubemarsTurns, AReleasedSpringWhoseAnswersComeLateIsNoOtherTurn) {
  for (const int late_ms : {0, 5, 7, 9}) {
    for (const float sign : {1.0F, -1.0F}) {
      SCOPED_TRACE(late_ms);
      auto rig = rigOf(settingsOf({"AK80-9", "mit"}));
      rig.delay(milliseconds{late_ms});
      rig.comeOnline();
      ASSERT_TRUE(rig.enable());
      rig.stall(true);
      const auto at_deg = rig.motor().feedback().total_angle_deg;
      const Target pulls{.mode = ControlMode::kImpedance,
                         .value = at_deg + 40.0 * static_cast<double>(sign),
                         .stiffness_nm_per_rad = 60.0F,
                         .damping_nms_per_rad = 1.0F};
      Target rests = pulls;
      rests.value = at_deg;
      for (int i = 0; i < 20; ++i) {
        rig.command(i % 2 == 0 ? pulls : rests);
        rig.run(milliseconds{30 + i},
                [&] { ASSERT_EQ(rig.motor().complaint().fault, FaultCode::kNone) << i; });
        ASSERT_EQ(rig.motor().feedback().torque_nm * sign > 11.0F, i % 2 == 0);
      }
    }
  }
}

// At the end of such a step the drive gives far less than it is told: its back-EMF takes it away.
TEST(CubemarsTurns, ALargeStepAtFullSpeedIsNoOtherTurn) {
  for (const auto* model : {"AK80-9", "AK80-64", "AK10-9", "AK60-6", "AK70-10", "AK80-8"}) {
    for (const double step_deg : {180.0, 360.0, -360.0}) {
      auto rig = rigOf(settingsOf({model, "mit"}));
      rig.comeOnline();
      ASSERT_TRUE(rig.enable());
      rig.command({.mode = ControlMode::kTotalAngle, .value = step_deg});
      for (int i = 0; i < 1500; ++i) {
        rig.run(milliseconds{1});
        ASSERT_EQ(rig.motor().complaint().fault, FaultCode::kNone) << model << " " << step_deg << " " << i;
      }
    }
  }
}

TEST(CubemarsTurns, ASoftSpringOnAnotherTurnIsSeenToo) {
  for (const float stiffness : {0.15F, 0.4F}) {
    sim::MotorLoad load;
    load.initial_angle_deg = 1449.0F;
    load.stalled = stiffness < 0.2F;
    auto rig = rigOf(settingsOf({"AK80-9", "mit"}), load);
    rig.comeOnline();
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kImpedance,
                 .value = rig.motor().feedback().total_angle_deg,
                 .stiffness_nm_per_rad = stiffness,
                 .damping_nms_per_rad = 0.2F});
    for (int ticks = 0; ticks < 50 && rig.motor().complaint().fault == FaultCode::kNone; ++ticks)
      rig.run(milliseconds{1});
    EXPECT_EQ(rig.motor().complaint().native_code, 0x4000'0000U) << stiffness;
  }
}

TEST(CubemarsTurns, AfterASilenceOutsideOfItsFieldNoSpringIsTrusted) {
  auto rig = rigOf(settingsOf({"AK80-9", "mit"}));
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 200.0});
  rig.run(seconds{2});
  ASSERT_GT(rig.motor().feedback().total_angle_deg, 800.0);
  rig.motor().order(FrameKind::kRest);
  rig.run(seconds{2});
  rig.cut(true);
  rig.run(milliseconds{200});
  rig.cut(false);
  rig.motor().clearComplaint();
  rig.run(milliseconds{50});
  ASSERT_TRUE(rig.enable());
  const double at_deg = rig.drive().physics().outputAngleDeg();
  rig.command({.mode = ControlMode::kTotalAngle, .value = rig.motor().feedback().total_angle_deg + 20.0});
  rig.run(milliseconds{300});
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), at_deg, 0.5);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
}

}  // namespace
}  // namespace rc10::test::cubemars_turns_test
