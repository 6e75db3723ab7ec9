#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <gtest/gtest.h>

#include "support/dji_frames.hpp"

namespace rc10::test::dji_update_test {
namespace {

using namespace rc10::literals;

constexpr std::initializer_list<FrameKind> kWithoutTorque{
    FrameKind::kRest, FrameKind::kPoll, FrameKind::kIdle, FrameKind::kEnable, FrameKind::kDisable};

/// Proportional loops only, so that efforts can be computed by hand.
MotorSettings plain(const DjiModel& model, DjiCommand command = DjiCommand::kCurrent) {
  MotorSettings config = djiConfig(model, 1, command);
  config.loops = {
      .velocity = PID_Position::Config{.kp = 0.1F}, .angle = {.kp = 2.0F}, .velocity_limit_rpm = 100.0F};
  config.zero_at_power_on = true;
  return config;
}

/// Samples and ticks with one report until the start-up glide of the loops has faded.
void settle(DjiFeeder& feeder, const DjiReport& report, int ticks = 300) {
  for (int i = 0; i < ticks; ++i) feeder.feedAndTick(report);
}

TEST(DjiUpdate, WithoutTorqueTheEffortIsZeroWhateverTheTarget) {
  for (const FrameKind kind : kWithoutTorque) {
    DJI_Motor motor(plain(kM3508));
    DjiFeeder feeder(motor);
    motor.order(FrameKind::kCommand);
    ASSERT_TRUE(motor.setTargetRPM(50_rpm));
    settle(feeder, {});
    EXPECT_GT(motor.commandValue(), 4.9F);
    motor.order(kind);
    feeder.tick();
    EXPECT_FLOAT_EQ(motor.commandValue(), 0.0F);
    EXPECT_EQ(motor.rawCommand(), 0);
    motor.order(FrameKind::kCommand);  // the loops were reset: they start from nothing
    feeder.feedAndTick({});
    EXPECT_LT(motor.commandValue(), 0.6F);
  }
}

TEST(DjiUpdate, CurrentGoesStraightToTheDriveWithinTheLimit) {
  MotorSettings config = plain(kM3508);
  config.effort_limit = 12.0F;
  DJI_Motor motor(config);
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetCurrent(7.5_A));
  motor.update(Tick{});  // needs no feedback
  EXPECT_FLOAT_EQ(motor.commandValue(), 7.5F);
  EXPECT_EQ(motor.rawCommand(), 6144);
  EXPECT_EQ(motor.limits(), 0U);
  ASSERT_TRUE(motor.setTargetCurrent(Amperes{-1e300}));
  motor.update(Tick{});
  EXPECT_FLOAT_EQ(motor.commandValue(), -12.0F);
  EXPECT_EQ(motor.limits(), kLimitCurrent);
}

TEST(DjiUpdate, EveryRawCommandCanBeReachedAndNoneBeyondFullScale) {
  for (const DjiModel* model : djiModels()) {
    for (const auto kind : {DjiCommand::kCurrent, DjiCommand::kVoltage}) {
      if (!model->command(kind).exists()) continue;
      const DjiCommandTable& table = model->command(kind);
      for (const int direction : {1, -1}) {
        MotorSettings config = djiConfig(*model, 1, kind);
        config.direction = direction;
        DJI_Motor motor(config);
        motor.order(FrameKind::kCommand);
        const auto mode = kind == DjiCommand::kCurrent ? ControlMode::kCurrent : ControlMode::kVoltage;
        for (int raw = -32768; raw <= 32767; ++raw) {
          const double value = raw * static_cast<double>(table.full_scale) / table.raw_full_scale;
          ASSERT_TRUE(motor.setTarget({.mode = mode, .value = value}));
          motor.update(Tick{});
          const int expected = std::clamp<int>(raw, -table.raw_full_scale, table.raw_full_scale);
          ASSERT_EQ(motor.rawCommand(), direction * expected) << model->name;
        }
      }
    }
  }
}

TEST(DjiUpdate, RawCommandsAreRoundedToTheNearest) {
  DJI_Motor motor(djiConfig(kGM6020));
  motor.order(FrameKind::kCommand);
  for (const double sign : {1.0, -1.0}) {
    ASSERT_TRUE(motor.setTargetCurrent(Amperes{sign * 100.4 * 3.0 / 16384.0}));
    motor.update(Tick{});
    EXPECT_EQ(motor.rawCommand(), static_cast<int>(sign) * 100);
    ASSERT_TRUE(motor.setTargetCurrent(Amperes{sign * 100.6 * 3.0 / 16384.0}));
    motor.update(Tick{});
    EXPECT_EQ(motor.rawCommand(), static_cast<int>(sign) * 101);
  }
}

TEST(DjiUpdate, VoltageIsObeyedOnlyByAMotorCommandedInVolts) {
  DJI_Motor volts(djiConfig(kGM6020, 1, DjiCommand::kVoltage));
  volts.order(FrameKind::kCommand);
  EXPECT_EQ(volts.commandUnit(), CommandUnit::kVolt);
  EXPECT_FALSE(volts.setTargetCurrent(1_A));
  ASSERT_TRUE(volts.setTarget({.mode = ControlMode::kVoltage, .value = 12.0, .torque_ff_nm = 5.0F}));
  volts.update(Tick{});
  EXPECT_EQ(volts.rawCommand(), 12500);  // torque feed-forward means nothing in volts
  DJI_Motor amperes(djiConfig(kGM6020));
  EXPECT_EQ(amperes.commandUnit(), CommandUnit::kAmpere);
  EXPECT_FALSE(amperes.setTarget({.mode = ControlMode::kVoltage, .value = 12.0}));
}

TEST(DjiUpdate, LoopsNeedASample) {
  DJI_Motor motor(plain(kM3508));
  for (const FrameKind kind : {FrameKind::kCommand, FrameKind::kBrake, FrameKind::kHold}) {
    motor.order(kind);
    ASSERT_TRUE(motor.setTargetTotalAngle(9000_deg));
    motor.update(Tick{});
    EXPECT_FLOAT_EQ(motor.commandValue(), 0.0F);
  }
}

TEST(DjiUpdate, LoopsStopWhenTheFeedbackStops) {
  DJI_Motor motor(plain(kM3508));
  DjiFeeder feeder(motor);
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(50_rpm));
  settle(feeder, {});
  for (int i = 0; i < 90; ++i) feeder.tick();
  EXPECT_GT(motor.commandValue(), 4.9F);  // no new sample: the output is kept
  for (int i = 0; i < 20; ++i) feeder.tick();
  EXPECT_FLOAT_EQ(motor.commandValue(), 0.0F);
  feeder.feedAndTick({});
  EXPECT_LT(motor.commandValue(), 0.6F);  // and begins anew
}

TEST(DjiUpdate, CoastReleasesAndBrakeResistsTheMotion) {
  DJI_Motor motor(plain(kM3508));
  DjiFeeder feeder(motor);
  const DjiReport turning{.rpm = 1920};  // 100 rpm at the output
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTarget({.mode = ControlMode::kBrake}));
  settle(feeder, turning);
  EXPECT_NEAR(motor.commandValue(), -10.0F, 0.02F);
  ASSERT_TRUE(motor.setTarget({.mode = ControlMode::kCoast}));
  feeder.feedAndTick(turning);
  EXPECT_FLOAT_EQ(motor.commandValue(), 0.0F);
  motor.order(FrameKind::kBrake);  // the supervisor's order needs no target
  settle(feeder, turning);
  EXPECT_NEAR(motor.commandValue(), -10.0F, 0.02F);
}

TEST(DjiUpdate, HoldStaysAtTheAngleWhereItBegan) {
  DJI_Motor motor(plain(kGM6020));
  DjiFeeder feeder(motor);
  settle(feeder, {.position = 0}, 2);
  feeder.feedAndTick({.position = 1024});  // 45 deg
  motor.order(FrameKind::kHold);
  settle(feeder, {.position = 1024});
  EXPECT_NEAR(motor.commandValue(), 0.0F, 1e-3F);
  settle(feeder, {.position = 1024 + 46});  // pushed by 2.02 deg
  EXPECT_NEAR(motor.commandValue(), -2.0215F * 2.0F * 0.1F, 1e-3F);
  motor.order(FrameKind::kRest);
  settle(feeder, {.position = 1024 + 46}, 2);
  motor.order(FrameKind::kHold);  // a new hold begins here
  settle(feeder, {.position = 1024 + 46});
  EXPECT_NEAR(motor.commandValue(), 0.0F, 1e-3F);
}

TEST(DjiUpdate, AngleModesUseTheAngleWithinTheTurnAndTheTotalAngle) {
  DJI_Motor motor(plain(kGM6020));
  DjiFeeder feeder(motor);
  feeder.feedAndTick({});
  ASSERT_TRUE(motor.setZero(365.0));
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetAngle(355_deg));
  settle(feeder, {});
  EXPECT_NEAR(motor.commandValue(), -10.0F * 2.0F * 0.1F, 1e-3F);
  ASSERT_TRUE(motor.setTargetTotalAngle(370_deg));
  settle(feeder, {});
  EXPECT_NEAR(motor.commandValue(), 5.0F * 2.0F * 0.1F, 1e-3F);
}

TEST(DjiUpdate, FeedForwardTorqueBecomesCurrentAtTheOutputShaft) {
  DJI_Motor motor(plain(kM3508));
  DjiFeeder feeder(motor);
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTarget({.mode = ControlMode::kVelocity, .value = 0.0, .torque_ff_nm = 1.5F}));
  settle(feeder, {});
  EXPECT_NEAR(motor.commandValue(), 5.0F, 1e-3F);
  ASSERT_TRUE(motor.setTarget({.mode = ControlMode::kCurrent, .value = 1.0, .torque_ff_nm = 1.5F}));
  feeder.feedAndTick({});
  EXPECT_NEAR(motor.commandValue(), 6.0F, 1e-3F);
}

TEST(DjiUpdate, LimitFlagsSayWhichLimitActs) {
  MotorSettings config = plain(kM3508);
  config.effort_limit = 5.0F;
  DJI_Motor motor(config);
  DjiFeeder feeder(motor);
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(40_rpm));
  settle(feeder, {});
  EXPECT_EQ(motor.limits(), 0U);
  ASSERT_TRUE(motor.setTargetRPM(500_rpm));  // limits: 100 rpm, 5 A
  settle(feeder, {.rpm = 1000});             // 52 rpm
  EXPECT_EQ(motor.limits(), kLimitVelocity);
  settle(feeder, {});
  EXPECT_EQ(motor.limits(), kLimitVelocity | kLimitCurrent);
  motor.order(FrameKind::kRest);
  feeder.tick();
  EXPECT_EQ(motor.limits(), 0U);
}

TEST(DjiUpdate, DeratingScalesTheLimitAtOnceAlsoBetweenSamples) {
  DJI_Motor motor(plain(kM3508));
  DjiFeeder feeder(motor);
  motor.order(FrameKind::kCommand);
  ASSERT_TRUE(motor.setTargetRPM(100_rpm));
  settle(feeder, {});
  EXPECT_NEAR(motor.commandValue(), 10.0F, 0.01F);
  motor.derate(0.1F);
  feeder.tick();
  EXPECT_FLOAT_EQ(motor.commandValue(), 2.0F);
  motor.derate(-3.0F);
  feeder.tick();
  EXPECT_FLOAT_EQ(motor.commandValue(), 0.0F);
  motor.derate(50.0F);
  settle(feeder, {});
  EXPECT_NEAR(motor.commandValue(), 10.0F, 0.01F);
}

TEST(DjiUpdate, ModesAndFrameKindsAreThoseOfTheFamily) {
  const DJI_Motor amperes(djiConfig(kM3508));
  const DJI_Motor volts(djiConfig(kGM6020, 1, DjiCommand::kVoltage));
  for (const auto mode : {ControlMode::kCoast, ControlMode::kVelocity, ControlMode::kAngle,
                          ControlMode::kTotalAngle, ControlMode::kBrake}) {
    EXPECT_TRUE(amperes.modes().contains(mode));
    EXPECT_TRUE(volts.modes().contains(mode));
  }
  EXPECT_TRUE(amperes.modes().contains(ControlMode::kCurrent));
  EXPECT_TRUE(volts.modes().contains(ControlMode::kVoltage));
  EXPECT_EQ(amperes.driveFrames().rest, Provision::kFrame);
  EXPECT_EQ(amperes.driveFrames().brake, Provision::kHostLoop);
  EXPECT_EQ(amperes.driveFrames().hold, Provision::kHostLoop);
  EXPECT_EQ(amperes.driveFrames().enable, Provision::kNothing);
  EXPECT_TRUE(amperes.speaksUnasked());
  EXPECT_EQ(amperes.sequenceProgress(), SequenceProgress::kDone);
}

}  // namespace
}  // namespace rc10::test::dji_update_test
