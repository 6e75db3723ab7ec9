// AK motors and their simulated drives, frame by frame in virtual time.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "sim/cubemars_rig.hpp"

namespace rc10::test::cubemars_closed_loop_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class CubemarsLoop : public ::testing::TestWithParam<CubemarsCase> {
 protected:
  /// Fresh feedback, and enabled.
  static void wakeUp(SoloRig& rig) {
    rig.motor().order(rig.motor().driveFrames().poll == Provision::kFrame ? FrameKind::kPoll
                                                                          : FrameKind::kRest);
    rig.run(milliseconds{20});
    ASSERT_GT(rig.motor().feedback().samples, 0U);
    ASSERT_TRUE(rig.enable());
    rig.motor().order(FrameKind::kIdle);
    rig.run(milliseconds{20});
  }
  static double rpm(SoloRig& rig) { return static_cast<double>(rig.motor().feedback().velocity_rpm); }
};

TEST(CubemarsScale, AMitDriveOnAnotherSpeedScaleIsStoppedAtItsFirstMotion) {
  for (const auto* of_drive : {"AK80-9", "AK80-6"}) {
    const bool right = std::string_view{of_drive} == "AK80-9";
    SoloRig rig(motorOf(settingsOf({"AK80-9", "mit"})),
                sim::makeCubemarsDrive(settingsOf({of_drive, "mit"}), {}));
    rig.comeOnline();
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kVelocity, .value = 60.0});
    rig.run(seconds{1});
    const auto complaint = rig.motor().complaint();
    EXPECT_EQ(complaint.fault, right ? FaultCode::kNone : FaultCode::kDriveSetting);
    if (!right) {
      EXPECT_NEAR(static_cast<double>(complaint.native_code - SoloMotor::kSpeedScaleComplaint), 66.0, 2.0);
    }
  }
}

// A load drives the shaft faster than the field of its speed, and a brake ends that.
TEST(CubemarsScale, AShaftFasterThanItsSpeedFieldIsReadAndBrakedInTheRightDirection) {
  for (const auto& model : cubemarsModels()) {
    if (model.v3) continue;
    for (const float sign : {1.0F, -1.0F}) {
      SCOPED_TRACE(std::string{model.name});
      auto rig = rigOf(settingsOf({model.name.data(), "mit"}));
      rig.comeOnline();
      ASSERT_TRUE(rig.enable());
      rig.command({.mode = ControlMode::kCurrent});
      sim::MotorLoad load;
      load.load_torque_nm = -3.0F * sign * static_cast<float>(model.ranges.torque_nm);
      // A second to the no-load speed: the drive's own filter lags little.
      load.inertia_kg_m2 =
          std::abs(load.load_torque_nm) / (model.no_load_rpm * static_cast<float>(kRadPerSPerRpm));
      rig.drive().setLoad(load);
      const double most_rpm = 1.6 * static_cast<double>(model.no_load_rpm);
      const auto right = [&] {
        const double rpm = rig.drive().physics().outputRpm();
        EXPECT_NEAR(rig.motor().feedback().velocity_rpm, rpm, 3.0 + 0.01 * std::abs(rpm));
        EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
      };
      for (int i = 0; i < 3000 && std::abs(rig.drive().physics().outputRpm()) < most_rpm; ++i)
        rig.run(milliseconds{1}, right);
      ASSERT_GE(static_cast<double>(sign) * rig.drive().physics().outputRpm(), most_rpm);
      rig.drive().setLoad({});
      rig.motor().order(FrameKind::kBrake);
      rig.run(seconds{2});
      EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
      EXPECT_NEAR(rig.drive().physics().outputRpm(), 0.0, 2.0);
      EXPECT_EQ(rig.motor().feedback().jumps, 0U);
      EXPECT_TRUE(rig.motor().feedback().zeroed);
    }
  }
}

TEST_P(CubemarsLoop, EnablingMovesNothing) {
  auto rig = rigOf(settingsOf(GetParam()));
  wakeUp(rig);
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), 0.0, 1e-6);
  EXPECT_NEAR(rig.drive().physics().currentA(), 0.0, 0.1);
}

TEST_P(CubemarsLoop, CurrentGivesTorqueInThePositiveDirection) {
  sim::MotorLoad load;
  load.stalled = true;
  auto rig = rigOf(settingsOf(GetParam()), load);
  wakeUp(rig);
  rig.command({.mode = ControlMode::kCurrent, .value = 4.0});
  rig.run(milliseconds{200});
  EXPECT_NEAR(rig.motor().feedback().current_a, 4.0, 0.2);
  EXPECT_NEAR(rig.motor().feedback().torque_nm,
              4.0 * rig.drive().physics().parameters().torque_nm_per_a * rig.motor().get_GearRatio(), 0.3);
  EXPECT_NEAR(rig.drive().physics().currentA(), 4.0 * GetParam().direction, 0.1);
}

TEST_P(CubemarsLoop, VelocityReachesItsTarget) {
  auto rig = rigOf(settingsOf(GetParam(), {{"velocity_gain_nms_per_rad", 5.0}}));
  wakeUp(rig);
  rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
  rig.run(seconds{2});
  EXPECT_NEAR(rpm(rig), 40.0, 6.0);  // MIT mode has no integral part
  rig.command({.mode = ControlMode::kVelocity, .value = -40.0});
  rig.run(seconds{2});
  EXPECT_NEAR(rpm(rig), -40.0, 6.0);
}

TEST_P(CubemarsLoop, AnglesReachTheirTargetsAndStay) {
  auto rig = rigOf(
      settingsOf(GetParam(), {{"angle_stiffness_nm_per_rad", 80.0}, {"angle_damping_nms_per_rad", 4.0}}));
  wakeUp(rig);
  rig.command({.mode = ControlMode::kTotalAngle, .value = 200.0});
  rig.run(seconds{3});
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 200.0, 3.0);
  rig.command({.mode = ControlMode::kAngle, .value = 290.0});
  rig.run(seconds{3});
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 290.0, 3.0);
  EXPECT_NEAR(rpm(rig), 0.0, 1.0);
}

TEST_P(CubemarsLoop, BrakeStopsAndDampSlows) {
  auto rig = rigOf(settingsOf(GetParam(), {{"velocity_gain_nms_per_rad", 5.0}}));
  wakeUp(rig);
  for (const auto kind : {FrameKind::kBrake, FrameKind::kDamp}) {
    rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
    rig.run(seconds{1});
    ASSERT_GT(rpm(rig), 20.0);
    rig.motor().order(kind);
    rig.run(seconds{2});
    EXPECT_NEAR(rpm(rig), 0.0, 2.0);
  }
}

TEST_P(CubemarsLoop, HoldStaysAgainstALoad) {
  auto rig = rigOf(
      settingsOf(GetParam(), {{"angle_stiffness_nm_per_rad", 100.0}, {"angle_damping_nms_per_rad", 4.0}}));
  wakeUp(rig);
  rig.motor().order(FrameKind::kHold);
  rig.run(milliseconds{100});
  sim::MotorLoad load;
  load.load_torque_nm = 2.0F;
  rig.drive().setLoad(load);
  rig.run(seconds{2});
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 0.0, 6.0);
  rig.motor().order(FrameKind::kRest);
  rig.run(seconds{2});
  EXPECT_GT(std::abs(rig.motor().feedback().total_angle_deg), 20.0) << "rest lets go";
}

TEST_P(CubemarsLoop, AFaultIsAComplaintAndAfterItEnablingAndMovingGoOn) {
  auto rig = rigOf(settingsOf(GetParam(), {{"velocity_gain_nms_per_rad", 5.0}}));
  wakeUp(rig);
  rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
  rig.run(seconds{1});
  rig.stall(true);
  rig.run(milliseconds{100});
  ASSERT_GT(rig.currentA(), 1.0);
  rig.drive().fault(4);
  rig.run(milliseconds{20});
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveUnderVoltage);
  EXPECT_EQ(rig.motor().complaint().native_code, 4U);
  EXPECT_NEAR(rig.drive().physics().currentA(), 0.0, 0.1) << "the drive has let go";
  rig.stall(false);
  rig.motor().order(rig.motor().driveFrames().poll == Provision::kFrame ? FrameKind::kPoll
                                                                        : FrameKind::kRest);
  rig.run(seconds{1});
  rig.motor().clearComplaint();
  const double before = rig.drive().physics().outputAngleDeg();
  rig.run(milliseconds{20});
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), before, 0.5) << "clearing moves nothing";
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  wakeUp(rig);
  rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
  rig.run(seconds{2});
  EXPECT_NEAR(rpm(rig), 40.0, 6.0);
}

TEST_P(CubemarsLoop, ARestartOfTheDriveIsNoticed) {
  auto rig = rigOf(settingsOf(GetParam()));
  wakeUp(rig);
  rig.command({.mode = ControlMode::kCurrent, .value = 1.0});
  rig.run(milliseconds{200});
  ASSERT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  ASSERT_TRUE(rig.motor().feedback().zeroed);
  rig.drive().restart();
  rig.run(milliseconds{500});
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(rig.motor().feedback().zeroed);
  rig.motor().clearComplaint();
  EXPECT_TRUE(rig.enable());
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
}

TEST_P(CubemarsLoop, RestHasNoTorqueWhateverWasBefore) {
  for (const auto mode : {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kTotalAngle}) {
    auto rig = rigOf(settingsOf(GetParam()));
    wakeUp(rig);
    rig.command({.mode = mode, .value = 30.0});
    rig.run(milliseconds{100});
    EXPECT_GT(std::abs(rig.drive().physics().outputRpm()), 1.0) << "it obeyed before";
    rig.stall(true);
    rig.run(milliseconds{20});
    ASSERT_GT(rig.currentA(), 0.2);
    rig.motor().order(FrameKind::kRest);
    rig.run(milliseconds{20});
    EXPECT_NEAR(rig.drive().physics().currentA(), 0.0, 0.02);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Drives, CubemarsLoop,
    ::testing::Values(CubemarsCase{"AK80-9", "servo"}, CubemarsCase{"AK70-10", "servo", 20.0, -1},
                      CubemarsCase{"AK80-9", "mit"}, CubemarsCase{"AK60-6", "mit", 12.0, -1},
                      CubemarsCase{"AK80-8-V3", "mit_v3"}, CubemarsCase{"AK80-9-V3", "mit_v3", 18.0, -1}),
    [](const auto& each) {
      std::string name = std::string{each.param.model} + "_" + each.param.protocol;
      for (auto& letter : name) {
        if (letter == '-') letter = '_';
      }
      return name;
    });

TEST(CubemarsLoops, AServoDrivesWatchdogLetsGoAfterASecond) {
  sim::MotorLoad load;
  load.stalled = true;
  auto rig = rigOf(settingsOf({"AK80-9", "servo"}), load);
  rig.command({.mode = ControlMode::kCurrent, .value = 5.0});
  rig.run(milliseconds{500});
  rig.cut(true);
  rig.run(milliseconds{900});
  EXPECT_NEAR(rig.drive().physics().currentA(), 5.0, 0.5);
  rig.run(milliseconds{200});
  EXPECT_NEAR(rig.drive().physics().currentA(), 0.0, 0.1);
}

TEST(CubemarsLoops, ADriveInMitModeIsNotKnownToHaveAWatchdog) {
  sim::MotorLoad load;
  load.stalled = true;
  auto rig = rigOf(settingsOf({"AK80-9", "mit"}), load);
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{10});
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kCurrent, .value = 5.0});
  rig.run(milliseconds{200});
  rig.cut(true);
  rig.run(seconds{3});
  EXPECT_NEAR(rig.drive().physics().currentA(), 5.0, 0.1);
  EXPECT_FALSE(rig.motor().complaint().fault != FaultCode::kNone);
}

TEST(CubemarsLoops, WhatIsNotEnteredDoesNotMove) {
  auto rig = rigOf(settingsOf({"AK80-9", "mit"}));
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{10});
  rig.command({.mode = ControlMode::kCurrent, .value = 10.0});
  rig.run(milliseconds{500});
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), 0.0, 1e-6);
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kCurrent, .value = 10.0});
  rig.run(milliseconds{500});
  EXPECT_GT(rig.drive().physics().outputAngleDeg(), 1.0) << "entered, it does";
}

TEST(CubemarsLoops, AMotorThatIsEnabledAnewDoesNotGoOnToItsOldTarget) {
  sim::MotorLoad load;
  load.coulomb_nm = 2.0F;
  auto rig = rigOf(settingsOf({"AK80-9", "mit"}), load);
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{10});
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kTotalAngle, .value = 90.0});
  rig.run(milliseconds{30});  // on its way
  rig.motor().order(FrameKind::kPoll);
  rig.run(seconds{2});
  const double before = rig.drive().physics().outputAngleDeg();
  ASSERT_TRUE(rig.enable());
  rig.motor().order(FrameKind::kIdle);
  rig.run(milliseconds{500});
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), before, 0.1);
}

class LawOfAnotherProgram : public ::testing::Test {
 protected:
  static bool isOrder(const CanFrame& frame, cubemars::MitOrder order) {
    const CanFrame expected = cubemars::mitOrderFrame(12, order);
    return frame.id == expected.id && frame.data == expected.data;
  }
  /// Ended without a rest: 6 N·m, then out of the mode.
  void SetUp() override {
    sim::MotorLoad load;
    load.stalled = true;
    rig_.drive().setLoad(load);
    const CubemarsRanges ranges = findCubemarsModel("AK80-9")->ranges;
    rig_.drive().receive(cubemars::mitOrderFrame(12, cubemars::MitOrder::kEnter));
    rig_.drive().receive(cubemars::mitFrame(12, ranges, {.torque_nm = 6.0}));
    rig_.drive().receive(cubemars::mitOrderFrame(12, cubemars::MitOrder::kExit));
    rig_.drive().step(milliseconds{20});
    EXPECT_NEAR(rig_.currentA(), 0.0, 0.02);
  }
  void run(Duration duration) {
    rig_.run(duration, [this] { most_a_ = std::max(most_a_, rig_.currentA()); });
  }

  SoloRig rig_ = rigOf(settingsOf({"AK80-9", "mit"}));
  double most_a_ = 0.0;
};

TEST_F(LawOfAnotherProgram, ActsAgainInADriveThatIsOnlyToldToEnter) {
  rig_.drive().receive(cubemars::mitFrame(12, findCubemarsModel("AK80-9")->ranges, {}));
  rig_.drive().receive(cubemars::mitOrderFrame(12, cubemars::MitOrder::kEnter));
  rig_.drive().step(milliseconds{20});
  EXPECT_GT(rig_.currentA(), 5.0) << "outside of the mode no law is taken in";
}

TEST_F(LawOfAnotherProgram, GivesNoTorqueWhenItIsEnabledOrCleared) {
  rig_.motor().order(FrameKind::kPoll);
  run(milliseconds{100});
  rig_.motor().clearComplaint();
  run(milliseconds{100});
  rig_.motor().order(FrameKind::kEnable);
  for (int i = 0; i < 100; ++i) run(milliseconds{1});
  ASSERT_EQ(rig_.motor().sequenceProgress(), SequenceProgress::kDone);
  rig_.motor().order(FrameKind::kIdle);
  run(milliseconds{100});
  EXPECT_LT(most_a_, 0.05);
  rig_.command({.mode = ControlMode::kCurrent, .value = 4.0});
  run(milliseconds{100});
  EXPECT_NEAR(rig_.currentA(), 4.0, 0.2);
}

TEST_F(LawOfAnotherProgram, IsNotLeftBehindByARest) {
  rig_.comeOnline();
  ASSERT_TRUE(rig_.enable());
  rig_.command({.mode = ControlMode::kCurrent, .value = 4.0});
  run(milliseconds{50});
  rig_.motor().order(FrameKind::kRest);
  run(milliseconds{50});
  rig_.drive().receive(cubemars::mitOrderFrame(12, cubemars::MitOrder::kEnter));
  rig_.drive().step(milliseconds{20});
  EXPECT_NEAR(rig_.currentA(), 0.0, 0.05);
}

// The bus carries nothing from before the stop until the drive is at rest for us.
TEST_F(LawOfAnotherProgram, IsNotLeftBehindByARestThatWasHeldBack) {
  rig_.comeOnline();
  ASSERT_TRUE(rig_.enable());
  rig_.command({.mode = ControlMode::kCurrent, .value = 4.0});
  run(milliseconds{50});
  rig_.cut(true);
  run(milliseconds{20});
  rig_.motor().order(FrameKind::kPoll);
  run(milliseconds{50});
  rig_.cut(false);
  (void)rig_.takeSent();
  run(milliseconds{50});
  EXPECT_FALSE(isOrder(rig_.takeSent().front(), cubemars::MitOrder::kExit)) << "no torque leaves before it";
  rig_.drive().receive(cubemars::mitOrderFrame(12, cubemars::MitOrder::kEnter));
  rig_.drive().step(milliseconds{20});
  EXPECT_NEAR(rig_.currentA(), 0.0, 0.05);
}

TEST_F(LawOfAnotherProgram, ActsForNoMoreThanATickWhenTheEnteringIsCutShort) {
  auto settings = settingsOf({"AK80-9", "mit"});
  settings.command_divider = 20;
  SoloRig seldom = rigOf(settings);
  std::swap(rig_, seldom);
  SetUp();
  rig_.motor().order(FrameKind::kPoll);
  run(milliseconds{50});
  bool entered = false;
  rig_.lose([&entered](const CanFrame& frame) {
    return std::exchange(entered, isOrder(frame, cubemars::MitOrder::kEnter));
  });
  rig_.motor().order(FrameKind::kEnable);
  int pulled_ms = 0;
  rig_.run(milliseconds{49}, [&] { pulled_ms += rig_.currentA() > 0.05 ? 1 : 0; });
  EXPECT_LE(pulled_ms, 2);
}

TEST(CubemarsLoops, MoreTurnsThanItsPositionFieldAreCounted) {
  for (const CubemarsCase& each : {CubemarsCase{"AK80-9", "mit"}, CubemarsCase{"AK80-9", "servo"}}) {
    auto rig = rigOf(settingsOf(each));
    rig.motor().order(FrameKind::kPoll);
    rig.run(milliseconds{10});
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kVelocity, .value = 100.0});
    rig.run(seconds{4});
    const double turned = rig.drive().physics().outputAngleDeg();
    EXPECT_GT(turned, 1500.0);
    EXPECT_NEAR(rig.motor().feedback().total_angle_deg, turned, 4.0);
  }
}

TEST(CubemarsLoops, ImpedanceIsASpring) {
  sim::MotorLoad load;
  load.coulomb_nm = 0.0F;
  auto rig = rigOf(settingsOf({"AK80-9", "mit"}), load);
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{10});
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kImpedance,
               .value = 0.0,
               .stiffness_nm_per_rad = 20.0F,
               .damping_nms_per_rad = 1.0F});
  load.load_torque_nm = 2.0F;
  rig.drive().setLoad(load);
  rig.run(seconds{3});
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, -2.0 / 20.0 * 180.0 / 3.14159265, 0.5);
}

TEST(CubemarsLoops, AVelocityLimitBoundsTheWayToAnAngle) {
  for (const CubemarsCase& each : {CubemarsCase{"AK80-9", "servo"}, CubemarsCase{"AK80-9", "mit"}}) {
    auto settings = settingsOf(each);
    settings.velocity_limit_rpm = 20.0F;
    auto rig = rigOf(settings);
    rig.motor().order(FrameKind::kPoll);
    rig.run(milliseconds{10});
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kTotalAngle, .value = 400.0});
    double fastest = 0.0;
    rig.run(seconds{2},
            [&] { fastest = std::max(fastest, static_cast<double>(rig.motor().feedback().velocity_rpm)); });
    EXPECT_LT(fastest, 23.0) << each.protocol;
    EXPECT_GT(fastest, 12.0) << each.protocol;
  }
}

TEST(CubemarsLoops, ALoadIsHeldWhateverTheVelocityLimitIs) {
  auto settings = settingsOf({"AK80-9", "mit"});
  settings.velocity_limit_rpm = 30.0F;
  auto rig = rigOf(settings);
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{10});
  ASSERT_TRUE(rig.enable());
  rig.drive().setLoad({.coulomb_nm = 0.0F, .load_torque_nm = 5.0F});
  rig.motor().order(FrameKind::kHold);
  rig.run(seconds{1});
  const double sagged_deg = rig.motor().feedback().total_angle_deg;
  EXPECT_NEAR(sagged_deg, -5.0 / 30.0 * 180.0 / 3.14159265, 3.0);
  rig.run(seconds{2});
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, sagged_deg, 0.5);
}

TEST(CubemarsLoops, TheServoDriveObeysDuty) {
  auto rig = rigOf(settingsOf({"AK80-9", "servo"}));
  rig.command({.mode = ControlMode::kDuty, .value = 0.25});
  rig.run(seconds{3});
  EXPECT_NEAR(rig.motor().feedback().velocity_rpm, 0.25 * 533.0, 25.0);
}

TEST(CubemarsLoops, FeedbackComesAtTheRateThatIsSetOnTheDrive) {
  auto settings = settingsOf({"AK80-9", "servo"});
  settings.feedback_hz = 50;
  auto rig = rigOf(settings);
  rig.motor().order(FrameKind::kIdle);
  rig.run(seconds{2});
  EXPECT_NEAR(static_cast<double>(rig.motor().feedback().samples), 100.0, 2.0);
}

}  // namespace
}  // namespace rc10::test::cubemars_closed_loop_test
