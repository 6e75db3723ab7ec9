#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "motor/robstride_bench.hpp"

namespace rc10::test::robstride_update_test {
namespace {

using namespace robstride_bench;

// --- Commands in operation mode

TEST(RobStrideMotor, IdleIsAFrameWithoutAnyTorque) {
  Bench bench(robStrideSettings("RS00"));
  bench.run(0.5, 3.0);
  const auto frames = bench.tick(FrameKind::kIdle);
  ASSERT_FALSE(frames.empty());
  const auto told = bench.codec.operation(frames[0]);
  EXPECT_EQ(told.stiffness_nm_per_rad, 0.0);
  EXPECT_EQ(told.damping_nms_per_rad, 0.0);
  EXPECT_NEAR(told.torque_nm, 0.0, 14.0 / 65535);
}

TEST(RobStrideMotor, ACurrentBecomesTheTorqueOfItsTorqueConstant) {
  Bench bench(robStrideSettings("CyberGear"));
  const auto told = bench.operation({.mode = ControlMode::kCurrent, .value = 4.0});
  EXPECT_NEAR(told.torque_nm, 4.0 * 0.87 / std::numbers::sqrt2, 1e-3);
  EXPECT_EQ(told.stiffness_nm_per_rad, 0.0);
  EXPECT_NEAR(bench.motor.commandValue(), 4.0F, 1e-3F);
  EXPECT_EQ(bench.motor.commandUnit(), CommandUnit::kAmpere);
}

TEST(RobStrideMotor, ImpedanceArrivesInTheDrivesOwnMeasure) {
  auto settings = robStrideSettings("RS00");
  settings.gear_ratio = 20.0;  // twice its own
  settings.direction = -1;
  Bench bench(settings);
  bench.run();
  const auto told = bench.operation({.mode = ControlMode::kImpedance,
                                     .value = bench.motor.feedback().total_angle_deg + 2.0,
                                     .velocity_ff_rpm = 3.0F,
                                     .torque_ff_nm = 1.0F,
                                     .stiffness_nm_per_rad = 40.0F,
                                     .damping_nms_per_rad = 4.0F});
  EXPECT_NEAR(told.position_rad, -4.0 / kDegPerRad, 1e-3);
  EXPECT_NEAR(told.velocity_rad_s, -6.0 / kRpmPerRadPerS, 2e-3);
  EXPECT_NEAR(told.stiffness_nm_per_rad, 10.0, 0.01);
  EXPECT_NEAR(told.damping_nms_per_rad, 1.0, 1e-3);
  EXPECT_NEAR(told.torque_nm, -0.5, 1e-3);
}

TEST(RobStrideMotor, TheTorqueStaysWithinTheLimitWhereverTheTargetIs) {
  for (const std::string_view model : {"RS00", "RS04", "EL05", "CyberGear"}) {
    auto settings = robStrideSettings(model);
    settings.effort_limit = 2.0F;
    Bench bench(settings);
    const double limit_nm = 2.0 * bench.codec.model->torqueNmPerA();
    const double lsb_nm = 2.5 * bench.codec.model->torque_range_nm / 65535;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (int i = 0; i < 2000; ++i) {
      // As the motor reads them.
      const auto seen = bench.codec.feedback(
          bench.codec.answer({.position_rad = 6.0 * any(random), .velocity_rad_s = 5.0 * any(random)}));
      const double position_rad = seen.position_rad;
      const double velocity_rad_s = seen.velocity_rad_s;
      bench.motor.order(FrameKind::kPoll);
      bench.run(position_rad, velocity_rad_s);
      bench.tick(FrameKind::kEnable);  // ends any doubt about jumps
      Target target{.mode = static_cast<ControlMode>(1 + i % 5), .value = 360.0 * any(random)};
      target.torque_ff_nm = static_cast<float>(10.0 * any(random));
      target.stiffness_nm_per_rad = static_cast<float>(50.0 + 50.0 * any(random));
      target.damping_nms_per_rad = static_cast<float>(1.0 + any(random));
      const auto told = bench.operation(target);
      // The raw position counts for as much as the stiffness makes of it.
      const double slack_nm = lsb_nm + 0.001 * told.stiffness_nm_per_rad + 0.004 * told.damping_nms_per_rad;
      EXPECT_LE(std::abs(torqueOf(told, position_rad, velocity_rad_s)), limit_nm + slack_nm)
          << model << " " << i;
    }
    EXPECT_NE(bench.motor.limits() & kLimitCurrent, 0U);
  }
}

// The field would cut the position, and the damping torque would be alone.
TEST(RobStrideMotor, ATargetThatItsFieldCannotSayDoesNotPassTheLimit) {
  auto settings = controlled("operation");
  settings.effort_limit = 2.0F;
  Bench bench(settings);
  bench.run();
  for (const double rad_s : {5.0, -5.0}) {
    bench.run(0.0, rad_s);
    const auto told = bench.operation({.mode = ControlMode::kImpedance,
                                       .value = 0.0,
                                       .stiffness_nm_per_rad = 1.0F,
                                       .damping_nms_per_rad = 5.0F});
    const double limit_nm = 2.0 * bench.codec.model->torqueNmPerA();
    EXPECT_LE(std::fabs(torqueNm(told, {.position_rad = 0.0, .velocity_rad_s = rad_s})), limit_nm * 1.02);
  }
}

// The field of its speed is cut off at 33 rad/s: damping by the drive's own speed is more than by that.
TEST(RobStrideMotor, AShaftFasterThanItsSpeedFieldIsDampedWithinTheLimit) {
  auto settings = controlled("operation");
  settings.effort_limit = 4.0F;
  for (const double rad_s : {45.0, -45.0}) {
    Bench bench(settings);
    const double limit_nm = 4.0 * bench.codec.model->torqueNmPerA();
    double rad = 0.0;
    for (const auto mode : {ControlMode::kVelocity, ControlMode::kBrake, ControlMode::kImpedance}) {
      SpringLaw told;
      for (int i = 0; i < 50; ++i) {
        rad += rad_s * 1e-3;
        bench.run(std::remainder(rad, 4.0 * kRadPerTurn), rad_s);
        told = bench.operation({.mode = mode, .damping_nms_per_rad = 3.0F});
      }
      const double nm = torqueOf(told, 0.0, rad_s);
      EXPECT_LE(std::abs(nm), 1.02 * limit_nm) << static_cast<int>(mode);
      EXPECT_LT(nm * rad_s, 0.0);
    }
  }
}

TEST(RobStrideMotor, DeratingScalesTheTorque) {
  Bench bench(robStrideSettings("RS00"));
  bench.motor.derate(0.25F);
  const auto told = bench.operation({.mode = ControlMode::kCurrent, .value = 100.0});
  EXPECT_NEAR(told.torque_nm, 14.0 / 4, 0.05);
  EXPECT_NE(bench.motor.limits() & kLimitCurrent, 0U);
}

TEST(RobStrideMotor, AVelocityTargetIsCutOffAtTheLimit) {
  auto settings = robStrideSettings("RS00");
  settings.velocity_limit_rpm = 60.0F;
  Bench bench(settings);
  bench.run(0.0, 60.0 / kRpmPerRadPerS);
  const auto told = bench.operation({.mode = ControlMode::kVelocity, .value = -1e9});
  EXPECT_NE(bench.motor.limits() & kLimitVelocity, 0U);
  EXPECT_GE(told.velocity_rad_s, -60.0 / kRpmPerRadPerS - 1e-2);
}

TEST(RobStrideMotor, AnAngleTargetIsNotApproachedFasterThanTheLimit) {
  auto settings = robStrideSettings("RS00");
  settings.velocity_limit_rpm = 30.0F;
  Bench bench(settings);
  bench.run(0.0, 30.0 / kRpmPerRadPerS);
  const auto told = bench.operation({.mode = ControlMode::kTotalAngle, .value = 300.0});
  EXPECT_NEAR(torqueOf(told, 0.0, 30.0 / kRpmPerRadPerS), 0.0, 0.02);  // at the limit nothing pushes any more
  EXPECT_NE(bench.motor.limits() & kLimitVelocity, 0U);
}

TEST(RobStrideMotor, AfterAPushAgainstWhatBlocksItAStopDoesNotPressOn) {
  auto settings = robStrideSettings("RS00");
  settings.velocity_limit_rpm = 10.0F;
  Bench bench(settings);
  const auto torqueAt0Nm = [&](double place_deg) {
    bench.run();
    return torqueOf(bench.operation({.mode = ControlMode::kTotalAngle, .value = place_deg}), 0.0, 0.0);
  };
  for (int i = 0; i < 1500; ++i) (void)torqueAt0Nm(60.0);
  ASSERT_GT(torqueAt0Nm(60.0), 13.0);
  bench.motor.dropWindup(0.5F);
  EXPECT_LT(torqueAt0Nm(60.0), 1.3) << "damping times limit";
  EXPECT_LT(torqueAt0Nm(0.0), 0.2);
}

TEST(RobStrideMotor, DampAndBrakeResistTheMotion) {
  Bench bench(robStrideSettings("RS03"));
  bench.run(0.0, 2.0);
  const auto damp = bench.codec.operation(bench.tick(FrameKind::kDamp)[0]);
  const auto brake = bench.codec.operation(bench.tick(FrameKind::kBrake)[0]);
  EXPECT_LT(torqueOf(damp, 0.0, 2.0), 0.0);
  EXPECT_LT(torqueOf(brake, 0.0, 2.0), torqueOf(damp, 0.0, 2.0));
}

TEST(RobStrideMotor, HoldStaysWhereItBegan) {
  Bench bench(robStrideSettings("RS00"));
  bench.run(1.0);
  EXPECT_NEAR(bench.codec.operation(bench.tick(FrameKind::kHold)[0]).position_rad, 1.0, 1e-3);
  bench.run(1.05);
  EXPECT_NEAR(bench.codec.operation(bench.tick(FrameKind::kHold)[0]).position_rad, 1.0, 1e-3);
}

TEST(RobStrideMotor, WithoutFeedbackNothingThatDependsOnItIsSent) {
  Bench bench(robStrideSettings("RS00"));
  for (const auto mode : {ControlMode::kVelocity, ControlMode::kTotalAngle, ControlMode::kImpedance}) {
    const auto told = bench.operation({.mode = mode, .value = 10.0, .stiffness_nm_per_rad = 50.0F});
    EXPECT_EQ(told.stiffness_nm_per_rad, 0.0);
    EXPECT_EQ(told.damping_nms_per_rad, 0.0);
  }
}

TEST(RobStrideMotor, InputThatIsNoNumberIsHarmless) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const std::string control : {"operation", "current", "velocity", "position"}) {
    Bench bench(controlled(control));
    bench.run(0.2, 1.0);
    for (const double value : {kNan, kInf, -kInf, 1e308, -1e308}) {
      for (int mode = 0; mode < kControlModeCount; ++mode) {
        Target target{.mode = static_cast<ControlMode>(mode), .value = value};
        target.torque_ff_nm = target.velocity_ff_rpm = static_cast<float>(value);
        target.stiffness_nm_per_rad = target.damping_nms_per_rad = static_cast<float>(value);
        for (const auto& frame : bench.tick(FrameKind::kCommand, target)) {
          EXPECT_TRUE(isValidLength(false, frame.length));
          EXPECT_LE(frame.id.value, kExtendedIdMask);
          if (typeOf(frame) == 18) {
            EXPECT_TRUE(std::isfinite(readLittleEndian<float>(frame.payload(), 4)));
          }
          if (typeOf(frame) == 1) {
            EXPECT_LE(std::abs(torqueOf(bench.codec.operation(frame), 0.2, 1.0)), 14.1);
          }
        }
        EXPECT_TRUE(std::isfinite(bench.motor.commandValue()) || std::abs(value) > 1e30);
      }
    }
  }
}

TEST(RobStrideMotor, EveryValueOnTheScalesComesBack) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (const auto& model : robstrideModels()) {
    const robstride::Codec codec{.model = &model,
                                 .position_range_rad = model.position_range_rad,
                                 .drive_id = kDrive,
                                 .host_id = kHost};
    for (int i = 0; i < 500; ++i) {
      const SpringLaw wanted{
          .position_rad = share(random) * model.position_range_rad,
          .velocity_rad_s = share(random) * model.velocity_range_rad_s,
          .stiffness_nm_per_rad = std::abs(share(random)) * model.stiffness_range_nm_per_rad,
          .damping_nms_per_rad = std::abs(share(random)) * model.damping_range_nms_per_rad,
          .torque_nm = share(random) * model.torque_range_nm};
      const auto told = codec.operation(codec.operate(wanted));
      EXPECT_NEAR(told.position_rad, wanted.position_rad, 2 * model.position_range_rad / 65535);
      EXPECT_NEAR(told.velocity_rad_s, wanted.velocity_rad_s, 2 * model.velocity_range_rad_s / 65535);
      EXPECT_NEAR(told.stiffness_nm_per_rad, wanted.stiffness_nm_per_rad,
                  model.stiffness_range_nm_per_rad / 65535);
      EXPECT_NEAR(told.damping_nms_per_rad, wanted.damping_nms_per_rad,
                  model.damping_range_nms_per_rad / 65535);
      EXPECT_NEAR(told.torque_nm, wanted.torque_nm, 2 * model.torque_range_nm / 65535);
    }
  }
}

// --- Run modes

TEST(RobStrideMotor, TheCurrentModeWritesItsReference) {
  auto settings = controlled("current");
  settings.direction = -1;
  settings.effort_limit = 5.0F;
  Bench bench(settings);
  const auto frames = bench.tick(FrameKind::kCommand, {.mode = ControlMode::kCurrent, .value = 9.0});
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), robstride::parameter::kCurrentRef);
  EXPECT_FLOAT_EQ(readLittleEndian<float>(frames[0].payload(), 4), -5.0F);
  EXPECT_NE(bench.motor.limits() & kLimitCurrent, 0U);
  EXPECT_FLOAT_EQ(bench.motor.commandValue(), 5.0F);
}

TEST(RobStrideMotor, TheVelocityModeHasNoCurrentUntilThereIsATarget) {
  Bench bench(controlled("velocity"));
  bench.run();
  auto frames = bench.tick(FrameKind::kIdle);
  EXPECT_FLOAT_EQ(readLittleEndian<float>(frames[0].payload(), 4), 0.0F);
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[1].payload(), 0), robstride::parameter::kCurrentLimit);
  EXPECT_FLOAT_EQ(readLittleEndian<float>(frames[1].payload(), 4), 0.0F);
  frames = bench.tick(FrameKind::kCommand, {.mode = ControlMode::kVelocity, .value = 60.0});
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), robstride::parameter::kVelocityRef);
  EXPECT_NEAR(readLittleEndian<float>(frames[0].payload(), 4), 60.0 / kRpmPerRadPerS, 1e-4);
  EXPECT_FLOAT_EQ(readLittleEndian<float>(frames[1].payload(), 4), 15.5F);
  EXPECT_EQ(typeOf(bench.tick()[0]), 18U);
}

TEST(RobStrideMotor, NoAngleIsFollowedByADriveThatCountsFartherThanItCanBeTold) {
  for (const float beyond_rad : {1.2e5F, std::numeric_limits<float>::quiet_NaN()}) {
    Bench bench(controlled("position"));
    bench.run(1.0);
    bench.tick(FrameKind::kEnable);
    bench.parameter(robstride::parameter::kPosition, std::bit_cast<std::uint32_t>(beyond_rad));
    bench.run(1.0);
    bench.tick(FrameKind::kHold);
    EXPECT_EQ(bench.motor.limits() & kLimitAngle, kLimitAngle);
  }
  Bench bench(controlled("position"));
  bench.run(1.0);
  bench.tick(FrameKind::kEnable);
  bench.parameter(robstride::parameter::kPosition, std::bit_cast<std::uint32_t>(1.0F));
  bench.run(1.0);
  bench.tick(FrameKind::kHold);
  EXPECT_EQ(bench.motor.limits() & kLimitAngle, 0U);
}

TEST(RobStrideMotor, ThePositionModeGoesBeyondTheScaleOfFeedback) {
  Bench bench(controlled("position"));
  bench.run(1.0);
  const auto frames = bench.tick(
      FrameKind::kCommand,
      {.mode = ControlMode::kTotalAngle, .value = bench.motor.feedback().total_angle_deg + 3600.0});
  EXPECT_EQ(readLittleEndian<std::uint16_t>(frames[0].payload(), 0), robstride::parameter::kPositionRef);
  EXPECT_NEAR(readLittleEndian<float>(frames[0].payload(), 4), 1.0 + 20 * std::numbers::pi, 1e-3);
}

}  // namespace
}  // namespace rc10::test::robstride_update_test
