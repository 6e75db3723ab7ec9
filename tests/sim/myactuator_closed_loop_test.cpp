// MyActuator_Motor and its simulated drive, frame by frame in virtual time.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "drives/myactuator/myactuator_family.hpp"
#include "drives/myactuator/myactuator_motor.hpp"
#include "drives/myactuator/myactuator_simulated.hpp"
#include "sim/solo_rig.hpp"
#include "support/own_defaults.hpp"

namespace rc10::test::myactuator_closed_loop_test {
namespace {

using namespace std::chrono_literals;

struct Variation {
  std::string model = "RMD-X8-25";
  double gear_ratio = 0.0;
  int direction = 1;
  int command_divider = 1;
  bool absolute = false;
  double zero_deg = 0.0;
  float initial_angle_deg = 30.0F;
};

class MyActuatorRig : public testing::Test {
 protected:
  static MotorSettings settingsOf(const Variation& variation) {
    MotorSettings settings;
    settings.name = "joint";
    settings.model = variation.model;
    settings.id = 3;
    settings.gear_ratio = variation.gear_ratio;
    settings.direction = variation.direction;
    settings.command_divider = variation.command_divider;
    settings.zero_deg = variation.zero_deg;
    settings.own = ownDefaults(myactuatorFamily());
    settings.own.set("absolute_encoder", variation.absolute ? 1.0 : 0.0);
    return settings;
  }
  static SoloRig rigOf(const Variation& variation) {
    const auto settings = settingsOf(variation);
    const auto traits = myactuatorFamily().traits(settings.model, settings.own);
    sim::MotorLoad load;
    load.initial_angle_deg = variation.initial_angle_deg;
    return SoloRig(std::make_unique<MyActuator_Motor>(settings, traits),
                   sim::makeMyactuatorDrive(settings, load));
  }
};

class MyActuatorLoop : public MyActuatorRig, public testing::WithParamInterface<Variation> {};

TEST_P(MyActuatorLoop, EveryModeReachesItsTarget) {
  SoloRig rig = rigOf(GetParam());
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  EXPECT_LT(rig.currentA(), 0.02) << "enabling gives no torque";
  ASSERT_TRUE(rig.motor().setZero(0.0));
  const auto& feedback = rig.motor().feedback();

  rig.command({.mode = ControlMode::kVelocity, .value = 30.0});
  rig.run(800ms);
  EXPECT_NEAR(feedback.velocity_rpm, 30.0, 0.5);
  rig.command({.mode = ControlMode::kTotalAngle, .value = 150.0});
  rig.run(3s);
  EXPECT_NEAR(feedback.total_angle_deg, 150.0, 0.3);
  rig.command({.mode = ControlMode::kAngle, .value = 340.0});
  rig.run(2s);
  EXPECT_NEAR(feedback.total_angle_deg, -20.0, 0.3) << "the short way";
  rig.command({.mode = ControlMode::kCurrent, .value = 0.5});
  rig.run(30ms);
  EXPECT_NEAR(feedback.current_a, 0.5, 0.05);
  EXPECT_GT(feedback.velocity_rpm, 0.0) << "a positive current drives it in the positive direction";
  rig.command({.mode = ControlMode::kBrake});
  rig.run(1s);
  EXPECT_NEAR(feedback.velocity_rpm, 0.0, 0.2);
  const double here_deg = feedback.total_angle_deg;
  rig.command({.mode = ControlMode::kImpedance,
               .value = here_deg + 20.0,
               .stiffness_nm_per_rad = 20.0F,
               .damping_nms_per_rad = 2.0F});
  rig.run(3s);
  EXPECT_NEAR(feedback.total_angle_deg, here_deg + 20.0, 3.0) << "friction is all that keeps it away";
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
}

TEST_P(MyActuatorLoop, RestAndPollLeaveNoTorqueWhateverItDidBefore) {
  expectNoTorqueAtRestAndPoll([] { return rigOf(GetParam()); },
                              {.mode = ControlMode::kVelocity, .value = 30.0});
}

TEST_P(MyActuatorLoop, HoldsBrakesAndDamps) {
  SoloRig rig = rigOf(GetParam());
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 30.0});
  rig.run(500ms);
  rig.motor().order(FrameKind::kDamp);
  rig.run(1s);
  EXPECT_NEAR(rig.motor().feedback().velocity_rpm, 0.0, 2.0);
  rig.motor().order(FrameKind::kBrake);
  rig.run(100ms);
  rig.motor().order(FrameKind::kHold);
  const double here_deg = rig.motor().feedback().total_angle_deg;
  rig.run(500ms);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, here_deg, 0.5);
}

INSTANTIATE_TEST_SUITE_P(Variations, MyActuatorLoop,
                         testing::Values(Variation{}, Variation{.direction = -1},
                                         Variation{.gear_ratio = 18.0}, Variation{.command_divider = 4},
                                         Variation{.model = "RMD-X6-7"}, Variation{.model = "RMD-X10-40"}),
                         [](const auto& each) { return "case" + std::to_string(each.index); });

TEST_F(MyActuatorRig, AnAbsoluteDriveKnowsItsAngleAndAnotherDoesNot) {
  SoloRig known = rigOf({.absolute = true, .zero_deg = 20.0});
  known.comeOnline();
  EXPECT_TRUE(known.motor().feedback().zeroed);
  EXPECT_NEAR(known.motor().feedback().total_angle_deg, 10.0, 0.02);
  SoloRig unknown = rigOf({});
  unknown.comeOnline();
  EXPECT_FALSE(unknown.motor().feedback().zeroed);
}

TEST_F(MyActuatorRig, AnErrorIsAComplaintUntilTheDriveWasRestartedAndItCanBeEnabledAgain) {
  SoloRig rig = rigOf({});
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 20.0});
  rig.run(300ms);
  rig.drive().fault(0x0002);
  rig.run(150ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveStalled);
  EXPECT_EQ(rig.motor().complaint().native_code, 0x0002U);
  rig.drive().fault(0);
  rig.motor().order(FrameKind::kPoll);
  rig.run(150ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveStalled) << "latched";
  EXPECT_FALSE(rig.enable()) << "not while it has an error";
  rig.motor().order(FrameKind::kPoll);
  rig.run(10ms);
  rig.motor().clearComplaint();
  rig.run(600ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 20.0});
  rig.run(800ms);
  EXPECT_NEAR(rig.motor().feedback().velocity_rpm, 20.0, 0.5);
}

TEST_F(MyActuatorRig, ARestartedDriveIsNoticedAndNeverTurnsToAnAngleOfItsFormerLife) {
  SoloRig rig = rigOf({});
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.motor().setZero(0.0));
  rig.command({.mode = ControlMode::kTotalAngle, .value = 300.0});
  rig.run(3s);
  rig.drive().restart();
  const double before_deg = rig.drive().physics().outputAngleDeg();
  rig.run(600ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(rig.motor().feedback().zeroed);
  rig.motor().order(FrameKind::kPoll);
  rig.run(50ms);
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), before_deg, 1.0);
  rig.motor().clearComplaint();
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  EXPECT_TRUE(rig.enable());
}

TEST_F(MyActuatorRig, TheDrivesProtectionAgainstSilenceIsNoticed) {
  SoloRig rig = rigOf({});
  static_cast<sim::MyactuatorDrive&>(rig.drive()).setSilenceLimit(50ms);
  rig.comeOnline();
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 20.0});
  rig.run(500ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  rig.cut(true);
  rig.run(80ms);
  EXPECT_LT(rig.currentA(), 0.02) << "stopped by itself";
  rig.cut(false);
  rig.run(20ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveCommunication);
  rig.motor().order(FrameKind::kPoll);
  rig.run(50ms);
  rig.motor().clearComplaint();
  EXPECT_TRUE(rig.enable());
}

TEST_F(MyActuatorRig, EnablingFailsWhenNobodyAnswers) {
  SoloRig rig = rigOf({});
  rig.cut(true);
  EXPECT_FALSE(rig.enable());
}

}  // namespace
}  // namespace rc10::test::myactuator_closed_loop_test
