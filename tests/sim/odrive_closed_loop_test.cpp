// An ODrive_Motor and a simulated ODrive, all loops closed, in virtual time.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "drives/odrive/odrive_simulated.hpp"
#include "sim/solo_rig.hpp"
#include "support/odrive_settings.hpp"

namespace rc10::test::odrive_closed_loop_test {
namespace {

using namespace std::chrono_literals;

constexpr sim::MotorLoad kNoLoad{};

class OdriveLoop : public testing::TestWithParam<std::string> {
 protected:
  void make(const MotorSettings& settings, const sim::MotorLoad& load = kNoLoad) {
    auto drive = sim::makeOdriveDrive(settings, load);
    drive_ = dynamic_cast<sim::OdriveDrive*>(drive.get());
    rig_ = std::make_unique<SoloRig>(odriveMotor(settings), std::move(drive));
    rig_->run(300ms);  // heartbeats
  }
  void SetUp() override { make(odriveSettings(GetParam())); }

  void command(const Target& target, Duration duration) {
    rig_->command(target);
    rig_->run(duration);
  }
  void rest(Duration duration = 300ms) {
    rig_->motor().order(FrameKind::kRest);
    rig_->run(duration);
  }
  [[nodiscard]] const MotorFeedback& feedback() { return rig_->motor().feedback(); }
  [[nodiscard]] double currentA() { return rig_->drive().physics().currentA(); }
  [[nodiscard]] FaultCode fault() { return rig_->motor().complaint().fault; }

  std::unique_ptr<SoloRig> rig_;
  sim::OdriveDrive* drive_ = nullptr;
};

TEST_P(OdriveLoop, EnablingTakesLessThanTheSupervisorsPatience) {
  ASSERT_TRUE(rig_->enable(450ms));
  EXPECT_EQ(drive_->state(), odrive::AxisState::kClosedLoop);
  EXPECT_NEAR(currentA(), 0.0, 1e-6);
}

TEST_P(OdriveLoop, AfterEnablingNothingMovesUntilTheFirstTarget) {
  ASSERT_TRUE(rig_->enable());
  rig_->motor().order(FrameKind::kIdle);
  double most_a = 0.0;
  rig_->run(500ms, [&] { most_a = std::max(most_a, std::abs(currentA())); });
  EXPECT_LT(most_a, 1e-6);
}

TEST_P(OdriveLoop, EveryModeReachesItsTarget) {
  ASSERT_TRUE(rig_->enable());
  command({.mode = ControlMode::kVelocity, .value = 300.0}, 1s);
  EXPECT_NEAR(feedback().velocity_rpm, 300.0, 3.0);
  command({.mode = ControlMode::kBrake}, 1s);
  EXPECT_NEAR(feedback().velocity_rpm, 0.0, 1.0);
  ASSERT_TRUE(rig_->motor().setZero(0.0));
  command({.mode = ControlMode::kTotalAngle, .value = 900.0}, 2s);
  EXPECT_NEAR(feedback().total_angle_deg, 900.0, 1.0);
  command({.mode = ControlMode::kAngle, .value = 200.0}, 2s);
  EXPECT_NEAR(feedback().total_angle_deg, 920.0, 1.0);
  command({.mode = ControlMode::kCurrent, .value = 3.0}, 30ms);
  EXPECT_NEAR(currentA(), 3.0, 0.05);
  EXPECT_NEAR(feedback().current_a, 3.0, 0.1);
  EXPECT_NEAR(feedback().torque_nm, 0.15, 0.01);
  command({.mode = ControlMode::kCoast}, 30ms);
  EXPECT_NEAR(currentA(), 0.0, 0.05);
}

TEST_P(OdriveLoop, HoldsWhereItIs) {
  ASSERT_TRUE(rig_->enable());
  command({.mode = ControlMode::kTotalAngle, .value = 90.0}, 1s);
  rig_->motor().order(FrameKind::kHold);
  const double before_deg = feedback().total_angle_deg;
  double farthest_deg = 0.0;
  rig_->run(500ms, [&] {
    farthest_deg = std::max(farthest_deg, std::abs(feedback().total_angle_deg - before_deg));
  });
  EXPECT_LT(farthest_deg, 1.0);
}

TEST_P(OdriveLoop, GearAndDirectionAreThoseOfTheOutputShaft) {
  for (const int direction : {1, -1}) {
    auto settings = odriveSettings(GetParam());
    settings.gear_ratio = 8.0;
    settings.direction = direction;
    settings.velocity_limit_rpm = 200.0F;
    make(settings);
    ASSERT_TRUE(rig_->enable());
    command({.mode = ControlMode::kVelocity, .value = 50.0}, 1s);
    EXPECT_NEAR(feedback().velocity_rpm, 50.0, 1.0);
    EXPECT_NEAR(rig_->drive().physics().outputRpm(), 50.0 * direction, 1.0);
    ASSERT_TRUE(rig_->motor().setZero(0.0));
    command({.mode = ControlMode::kTotalAngle, .value = -400.0}, 3s);
    EXPECT_NEAR(feedback().total_angle_deg, -400.0, 1.0);
    command({.mode = ControlMode::kCurrent, .value = 2.0}, 30ms);
    EXPECT_NEAR(currentA(), 2.0 * direction, 0.05);
    EXPECT_NEAR(feedback().torque_nm, 0.8, 0.05);
  }
}

TEST_P(OdriveLoop, TheDriveKeepsToItsLimits) {
  auto settings = odriveSettings(GetParam());
  settings.effort_limit = 5.0F;
  settings.velocity_limit_rpm = 240.0F;
  make(settings);
  ASSERT_TRUE(rig_->enable());
  double most_a = 0.0;
  double fastest_rpm = 0.0;
  rig_->command({.mode = ControlMode::kTotalAngle, .value = 1800.0});
  rig_->run(2s, [&] {
    most_a = std::max(most_a, std::abs(currentA()));
    fastest_rpm = std::max(fastest_rpm, std::abs(static_cast<double>(feedback().velocity_rpm)));
  });
  EXPECT_LE(most_a, 5.05);
  EXPECT_LE(fastest_rpm, 260.0);
  EXPECT_NEAR(feedback().total_angle_deg, 1800.0, 2.0);
}

TEST_P(OdriveLoop, TorqueControlKeepsToTheVelocityLimitToo) {
  auto settings = odriveSettings(GetParam());
  settings.velocity_limit_rpm = 240.0F;
  make(settings);
  ASSERT_TRUE(rig_->enable());
  command({.mode = ControlMode::kCurrent, .value = 5.0}, 2s);
  EXPECT_GT(feedback().velocity_rpm, 150.0F);
  EXPECT_LT(feedback().velocity_rpm, 250.0F);
  EXPECT_EQ(fault(), FaultCode::kNone);
}

// Driven far beyond its velocity limit by its load: the limit of the torque is the last word. Near the
// no-load speed the winding brakes by itself.
TEST_P(OdriveLoop, TorqueControlBrakesNoHarderThanItsCurrentLimit) {
  auto settings = odriveSettings(GetParam());
  settings.effort_limit = 5.0F;
  settings.velocity_limit_rpm = 240.0F;
  auto load = kNoLoad;
  load.load_torque_nm = -1.0F;
  make(settings);
  ASSERT_TRUE(rig_->enable());
  rig_->drive().setLoad(load);
  double most_a = 0.0;
  rig_->command({.mode = ControlMode::kCurrent, .value = 1.0});
  double fastest_rpm = 0.0;
  rig_->run(500ms, [&] {
    const double rpm = rig_->drive().physics().outputRpm();
    if (rpm > 2000.0) return;
    fastest_rpm = std::max(fastest_rpm, rpm);
    most_a = std::max(most_a, std::abs(currentA()));
  });
  EXPECT_GT(fastest_rpm, 1000.0);
  EXPECT_NEAR(most_a, 5.0, 0.05);
}

TEST_P(OdriveLoop, AFaultIsReportedClearedAndTheMotorEnabledAgain) {
  const std::uint32_t over_voltage_or_encoder = 0x100;
  ASSERT_TRUE(rig_->enable());
  command({.mode = ControlMode::kVelocity, .value = 100.0}, 300ms);
  rig_->drive().fault(over_voltage_or_encoder);
  rig_->run(150ms);
  EXPECT_EQ(rig_->motor().complaint().native_code, over_voltage_or_encoder);
  EXPECT_NE(fault(), FaultCode::kNone);
  rest();
  EXPECT_FALSE(rig_->enable());
  rest();
  EXPECT_NE(fault(), FaultCode::kNone);  // until somebody clears it
  rig_->motor().clearComplaint();
  rest();
  EXPECT_EQ(fault(), FaultCode::kNone);
  EXPECT_NEAR(currentA(), 0.0, 1e-6);
  ASSERT_TRUE(rig_->enable());
  command({.mode = ControlMode::kVelocity, .value = 100.0}, 1s);
  EXPECT_NEAR(feedback().velocity_rpm, 100.0, 2.0);
}

TEST_P(OdriveLoop, RestHasNoTorqueWhateverWasBefore) {
  for (const auto& target : {Target{.mode = ControlMode::kVelocity, .value = 200.0},
                             Target{.mode = ControlMode::kTotalAngle, .value = 720.0},
                             Target{.mode = ControlMode::kCurrent, .value = 2.0}}) {
    ASSERT_TRUE(rig_->enable());
    rig_->stall(true);
    command(target, 100ms);
    ASSERT_GT(std::abs(currentA()), 0.5) << "it obeyed before";
    rest(50ms);
    rig_->stall(false);
    EXPECT_NEAR(currentA(), 0.0, 1e-6);
    EXPECT_EQ(drive_->state(), odrive::AxisState::kIdle);
    rest();
  }
}

TEST_P(OdriveLoop, ARestartIsNoticedAndTheAngleIsNotTrustedAnyMore) {
  ASSERT_TRUE(rig_->enable());
  command({.mode = ControlMode::kTotalAngle, .value = 720.0}, 2s);
  ASSERT_TRUE(rig_->motor().setZero(0.0));
  rig_->drive().restart();
  rig_->run(500ms);
  EXPECT_EQ(fault(), FaultCode::kDriveStopped);
  EXPECT_FALSE(feedback().zeroed);
  EXPECT_EQ(feedback().jumps, 0U);
  rest(2s);
  EXPECT_EQ(fault(), FaultCode::kNone);
  EXPECT_FALSE(feedback().zeroed);
  ASSERT_TRUE(rig_->enable());
}

TEST_P(OdriveLoop, ItsWatchdogStopsItWhenTheBusIsCut) {
  ASSERT_TRUE(rig_->enable());
  drive_->setWatchdog(100ms);
  command({.mode = ControlMode::kVelocity, .value = 200.0}, 500ms);
  EXPECT_EQ(fault(), FaultCode::kNone);
  rig_->stall(true);
  rig_->run(50ms);
  ASSERT_GT(std::abs(currentA()), 0.5);
  rig_->cut(true);
  rig_->run(150ms);
  EXPECT_EQ(drive_->state(), odrive::AxisState::kIdle);
  EXPECT_NEAR(currentA(), 0.0, 1e-6);
  rig_->cut(false);
  rig_->run(150ms);
  EXPECT_EQ(fault(), FaultCode::kDriveCommunication);
}

TEST_P(OdriveLoop, ARestingMotorKeepsTheWatchdogContentAtAnyDivider) {
  auto settings = odriveSettings(GetParam());
  settings.command_divider = 10;
  make(settings);
  drive_->setWatchdog(50ms);
  rest(1s);
  EXPECT_EQ(fault(), FaultCode::kNone);
  ASSERT_TRUE(rig_->enable());
  rig_->motor().order(FrameKind::kIdle);
  rig_->run(1s);
  EXPECT_EQ(fault(), FaultCode::kNone);
}

TEST_P(OdriveLoop, WithoutAWatchdogTheLastTargetHolds) {
  ASSERT_TRUE(rig_->enable());
  command({.mode = ControlMode::kVelocity, .value = 200.0}, 500ms);
  rig_->cut(true);
  rig_->run(1s);
  EXPECT_NEAR(rig_->drive().physics().outputRpm(), 200.0, 5.0);
}

TEST_P(OdriveLoop, ADriveThatRunsAlreadyIsStoppedBeforeItIsEnabled) {
  ASSERT_TRUE(rig_->enable());
  command({.mode = ControlMode::kVelocity, .value = 200.0}, 500ms);
  ASSERT_TRUE(rig_->enable());  // as a restarted host would
  EXPECT_EQ(drive_->state(), odrive::AxisState::kClosedLoop);
  EXPECT_NEAR(currentA(), 0.0, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Models, OdriveLoop, testing::Values("ODrive_S1", "ODrive_Pro", "ODrive_v3"),
                         [](const auto& model) { return model.param; });

}  // namespace
}  // namespace rc10::test::odrive_closed_loop_test
