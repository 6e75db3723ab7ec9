// A Damiao motor and its simulated drive, frame by frame: enabling, every mode, faults, restart, watchdog.
#include <cmath>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "drives/damiao/damiao_simulated.hpp"
#include "sim/solo_rig.hpp"
#include "support/damiao_motors.hpp"

namespace rc10::test::damiao_closed_loop_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

SoloRig rigOf(const MotorSettings& settings, const sim::MotorLoad& load = {}) {
  return {std::make_unique<Damiao_Motor>(settings), sim::makeDamiaoDrive(settings, load)};
}

/// Polled until it knows where it is.
SoloRig onlineRig(const MotorSettings& settings, const sim::MotorLoad& load = {}) {
  SoloRig rig = rigOf(settings, load);
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{50});
  return rig;
}

bool released(SoloRig& rig) { return std::fabs(rig.drive().physics().currentA()) < 1e-3; }

double shaftDeg(SoloRig& rig) { return rig.drive().physics().outputAngleDeg(); }

TEST(DamiaoClosedLoop, APolledDriveIsSeenWithoutTorque) {
  auto rig = onlineRig(damiaoSettingsOf(), {.initial_angle_deg = 40.0F});
  const auto& feedback = rig.motor().feedback();
  EXPECT_GE(feedback.samples, 45U);
  EXPECT_TRUE(feedback.zeroed);
  EXPECT_NEAR(feedback.total_angle_deg, 40.0, 0.05);
  EXPECT_NEAR(static_cast<double>(feedback.velocity_rpm), 0.0, 0.2);
  EXPECT_TRUE(released(rig));
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
}

TEST(DamiaoClosedLoop, EnablingDoesNotMoveTheMotorInAnyControlMode) {
  for (const auto control : kDamiaoControlNames) {
    SCOPED_TRACE(control);
    auto rig = onlineRig(damiaoSettingsOf("DM4310", std::string{control}), {.initial_angle_deg = -100.0F});
    ASSERT_TRUE(rig.enable());
    double farthest_deg = 0.0;
    rig.motor().order(FrameKind::kIdle);
    rig.run(milliseconds{300},
            [&] { farthest_deg = std::max(farthest_deg, std::fabs(shaftDeg(rig) + 100.0)); });
    EXPECT_LT(farthest_deg, 0.2);
    EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  }
}

TEST(DamiaoClosedLoop, EnablingTakesHundredthsOfASecond) {
  auto rig = onlineRig(damiaoSettingsOf());
  EXPECT_TRUE(rig.enable(milliseconds{30}));
}

struct Geared {
  const char* name;
  const char* model;
  double gear_ratio;
  int direction;
  double zero_deg;
};
void PrintTo(const Geared& c, std::ostream* out) { *out << c.name; }

class DamiaoMounted : public testing::TestWithParam<Geared> {
 protected:
  [[nodiscard]] static MotorSettings settings(const std::string& control) {
    auto settings = damiaoSettingsOf(GetParam().model, control);
    settings.gear_ratio = GetParam().gear_ratio;
    settings.direction = GetParam().direction;
    settings.zero_deg = GetParam().zero_deg;
    settings.zero_at_power_on = GetParam().gear_ratio > 0.0;
    return settings;
  }
  /// By the physics, as the user sees it.
  [[nodiscard]] static double movedDeg(SoloRig& rig, double from_deg) {
    return GetParam().direction * (shaftDeg(rig) - from_deg);
  }
};

TEST_P(DamiaoMounted, ReachesAnAngleInEveryModeThatHasAngles) {
  for (const std::string control : {"mit", "position_velocity", "force_position"}) {
    SCOPED_TRACE(control);
    auto rig = onlineRig(settings(control), {.initial_angle_deg = 10.0F});
    ASSERT_TRUE(rig.motor().feedback().zeroed);
    ASSERT_TRUE(rig.enable());
    const double from_deg = rig.motor().feedback().total_angle_deg;
    const double from_shaft_deg = shaftDeg(rig);
    rig.command({.mode = ControlMode::kTotalAngle, .value = from_deg + 75.0});
    rig.run(seconds{4});
    EXPECT_NEAR(rig.motor().feedback().total_angle_deg, from_deg + 75.0, 1.5);
    EXPECT_NEAR(movedDeg(rig, from_shaft_deg), 75.0, 1.5);
    EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  }
}

TEST_P(DamiaoMounted, ReachesASpeedInEveryModeThatHasSpeeds) {
  for (const std::string control : {"mit", "velocity"}) {
    SCOPED_TRACE(control);
    auto rig = onlineRig(settings(control));
    ASSERT_TRUE(rig.enable());
    for (const double rpm : {15.0, -12.0}) {
      rig.command({.mode = ControlMode::kVelocity, .value = rpm});
      rig.run(seconds{2});
      const double tolerance = control == "mit" ? 8.0 : 0.5;  // MIT has no integral: friction slows it down
      EXPECT_NEAR(static_cast<double>(rig.motor().feedback().velocity_rpm), rpm, tolerance);
      EXPECT_NEAR(GetParam().direction * rig.drive().physics().outputRpm(), rpm, tolerance);
    }
    rig.motor().order(FrameKind::kBrake);
    rig.run(seconds{1});
    EXPECT_NEAR(rig.drive().physics().outputRpm(), 0.0, 0.5);
  }
}

TEST_P(DamiaoMounted, TheSignsOfCurrentAndTorqueAreThoseOfTheShaft) {
  auto rig = onlineRig(settings("mit"), {.stalled = true});
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kCurrent, .value = 2.0});
  rig.run(milliseconds{100});
  const auto& feedback = rig.motor().feedback();
  EXPECT_NEAR(static_cast<double>(feedback.current_a), 2.0, 0.05);
  EXPECT_GT(feedback.torque_nm, 0.0F);
  EXPECT_GT(GetParam().direction * rig.drive().physics().outputTorqueNm(), 0.0);
  EXPECT_NEAR(static_cast<double>(rig.motor().commandValue()), 2.0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Models, DamiaoMounted,
                         testing::Values(Geared{"plain", "DM4310", 0.0, 1, 0.0},
                                         Geared{"reversed", "DM4310", 0.0, -1, 0.0},
                                         Geared{"zeroed", "DM4340", 0.0, 1, 123.0},
                                         Geared{"reversedZeroed", "DM8009", 0.0, -1, -40.0},
                                         Geared{"withAGearBehind", "DM4310", 20.0, -1, 0.0}),
                         [](const auto& each) { return std::string{each.param.name}; });

TEST(DamiaoClosedLoop, EveryModelEnablesAndTurns) {
  ASSERT_GE(damiaoModelNames().size(), 10U);
  for (const auto name : damiaoModelNames()) {
    SCOPED_TRACE(name);
    auto rig = onlineRig(damiaoSettingsOf(std::string{name}, "velocity"));
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kVelocity, .value = 10.0});
    rig.run(seconds{1});
    EXPECT_NEAR(static_cast<double>(rig.motor().feedback().velocity_rpm), 10.0, 2.0);
  }
}

TEST(DamiaoClosedLoop, ManyTurnsAreCountedOverTheWrapsOfTheFeedback) {
  for (const std::string control : {"position_velocity", "force_position"}) {
    auto rig = onlineRig(damiaoSettingsOf("DM4310", control));
    ASSERT_TRUE(rig.enable());
    for (const double deg : {3600.0, -1800.0}) {
      rig.command({.mode = ControlMode::kTotalAngle, .value = deg});
      rig.run(seconds{6});
      EXPECT_NEAR(rig.motor().feedback().total_angle_deg, deg, 1.0);
      EXPECT_NEAR(shaftDeg(rig), deg, 1.0);
    }
  }
}

// The host was started again while the drive counts from somewhere else: 12.5 rad are no whole turns.
TEST(DamiaoClosedLoop, ADriveThatHasTurnedBeyondItsRangeBeforeTheStartIsNotMisread) {
  const auto settings = damiaoSettingsOf("DM4310", "position_velocity");
  auto drive = sim::makeDamiaoDrive(settings, {});
  auto* const kept = drive.get();
  SoloRig first(std::make_unique<Damiao_Motor>(settings), std::move(drive));
  first.motor().order(FrameKind::kPoll);
  first.run(milliseconds{50});
  ASSERT_TRUE(first.enable());
  first.command({.mode = ControlMode::kTotalAngle, .value = 1500.0});
  first.run(seconds{4});
  first.motor().order(FrameKind::kPoll);
  first.run(milliseconds{200});

  // A second motor hears the same drive from now on.
  Damiao_Motor second(settings);
  second.order(FrameKind::kPoll);
  MonotonicTime now = first.now();
  const auto exchange = [&](std::uint64_t index) {
    const Tick tick{.index = index, .now = now, .dt_s = 0.001F};
    second.update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = second.packCommand(tick, out);
    for (std::size_t i = 0; i < count; ++i) kept->receive(out[i]);
    kept->step(milliseconds{1});
    std::array<CanFrame, sim::Drive::kMaxFrames> in{};
    const auto answers = kept->answers(in);
    now += milliseconds{1};
    for (std::size_t i = 0; i < answers; ++i) {
      in[i].received = now;
      (void)second.updateFeedback(in[i]);
    }
  };
  exchange(1);
  EXPECT_FALSE(second.feedback().zeroed) << "before the drive has told its count";
  for (std::uint64_t i = 2; i < 60; ++i) exchange(i);
  EXPECT_TRUE(second.feedback().zeroed);
  EXPECT_NEAR(static_cast<double>(second.feedback().angle_deg), 1500.0 - 4 * 360.0, 1.0);
  const double before_deg = kept->physics().outputAngleDeg();
  second.order(FrameKind::kEnable);
  for (std::uint64_t i = 60; i < 120; ++i) exchange(i);
  ASSERT_EQ(second.sequenceProgress(), SequenceProgress::kDone);
  second.order(FrameKind::kHold);
  for (std::uint64_t i = 120; i < 600; ++i) exchange(i);
  EXPECT_NEAR(kept->physics().outputAngleDeg(), before_deg, 0.5);
}

TEST(DamiaoClosedLoop, MitBeyondItsRangeHoldsByDampingAndDoesNotRunBack) {
  auto rig = onlineRig(damiaoSettingsOf());
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 100.0});
  rig.run(seconds{2});
  rig.motor().order(FrameKind::kBrake);
  rig.run(milliseconds{500});
  const double before_deg = shaftDeg(rig);
  ASSERT_GT(before_deg, 720.0);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, before_deg, 1.0);
  rig.motor().order(FrameKind::kHold);
  rig.run(seconds{1});
  EXPECT_NEAR(shaftDeg(rig), before_deg, 1.0);
  EXPECT_NE(rig.motor().limits() & kLimitAngle, 0U);
}

TEST(DamiaoClosedLoop, ImpedanceIsAsStiffAsTold) {
  auto rig = onlineRig(damiaoSettingsOf(), {.coulomb_nm = 0.0F, .load_torque_nm = 2.0F});
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kImpedance,
               .value = 30.0,
               .stiffness_nm_per_rad = 40.0F,
               .damping_nms_per_rad = 1.0F});
  rig.run(seconds{2});
  EXPECT_NEAR(shaftDeg(rig), 30.0 - 2.0 / 40.0 * 57.3, 0.3);
}

TEST(DamiaoClosedLoop, AnArmSagsByTheSineOfItsAngleAndAStopHoldsIt) {
  auto rig = onlineRig(damiaoSettingsOf(), {.coulomb_nm = 0.0F, .gravity_nm = 2.0F, .stop_max_deg = 40.0F});
  ASSERT_TRUE(rig.enable());
  const auto spring_to = [&](double deg) {
    rig.command({.mode = ControlMode::kImpedance,
                 .value = deg,
                 .stiffness_nm_per_rad = 40.0F,
                 .damping_nms_per_rad = 1.0F});
    rig.run(seconds{2});
  };
  spring_to(30.0);
  EXPECT_NEAR(shaftDeg(rig), 30.0 - 2.0 * 0.477 / 40.0 * 57.3, 0.3);  // 0.477: the sine of what comes out
  spring_to(60.0);
  EXPECT_NEAR(shaftDeg(rig), 40.0, 1e-6);
}

TEST(DamiaoClosedLoop, TheCurrentLimitBoundsTheTorque) {
  for (const std::string control : {"mit", "force_position"}) {
    SCOPED_TRACE(control);
    auto settings = damiaoSettingsOf("DM4310", control);
    settings.effort_limit = 1.5F;
    auto rig = onlineRig(settings, {.stalled = true});
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kTotalAngle, .value = 90.0});
    rig.run(milliseconds{500});
    EXPECT_NEAR(static_cast<double>(rig.motor().feedback().current_a), 1.5, 0.05);
    rig.motor().derate(0.5F);
    rig.run(milliseconds{500});
    EXPECT_NEAR(static_cast<double>(rig.motor().feedback().current_a), 0.75, 0.05);
  }
}

TEST(DamiaoClosedLoop, TheVelocityLimitBoundsAnAngleAndASpeed) {
  for (const std::string control : {"mit", "position_velocity", "force_position"}) {
    SCOPED_TRACE(control);
    auto settings = damiaoSettingsOf("DM4310", control);
    settings.velocity_limit_rpm = 30.0F;
    auto rig = onlineRig(settings);
    ASSERT_TRUE(rig.enable());
    double fastest_rpm = 0.0;
    rig.command({.mode = ControlMode::kTotalAngle, .value = 360.0});
    rig.run(seconds{3}, [&] { fastest_rpm = std::max(fastest_rpm, rig.drive().physics().outputRpm()); });
    EXPECT_LT(fastest_rpm, 35.0);
    EXPECT_GT(fastest_rpm, 15.0);
    EXPECT_NEAR(shaftDeg(rig), 360.0, 2.0);
  }
}

TEST(DamiaoClosedLoop, ALoadIsHeldWhateverTheVelocityLimitIs) {
  auto settings = damiaoSettingsOf("DM4310", "mit");
  settings.velocity_limit_rpm = 10.0F;
  auto rig = onlineRig(settings, {.coulomb_nm = 0.0F, .load_torque_nm = 3.0F});
  ASSERT_TRUE(rig.enable());
  for (const auto order : {FrameKind::kHold, FrameKind::kCommand}) {
    if (order == FrameKind::kCommand)
      rig.command({.mode = ControlMode::kTotalAngle, .value = rig.motor().feedback().total_angle_deg});
    else
      rig.motor().order(order);
    const double before_deg = shaftDeg(rig);
    rig.run(seconds{1});
    const double sagged_deg = shaftDeg(rig);
    EXPECT_GT(sagged_deg, before_deg - 30.0);
    rig.run(seconds{1});
    EXPECT_NEAR(shaftDeg(rig), sagged_deg, 0.5);
  }
}

TEST(DamiaoClosedLoop, TheSpeedOfATrajectoryCountsInTheVelocityLimit) {
  auto settings = damiaoSettingsOf("DM4310", "mit");
  settings.velocity_limit_rpm = 30.0F;
  auto rig = onlineRig(settings);
  ASSERT_TRUE(rig.enable());
  double fastest_rpm = 0.0;
  rig.command({.mode = ControlMode::kTotalAngle, .value = 360.0, .velocity_ff_rpm = 30.0F});
  rig.run(seconds{1}, [&] { fastest_rpm = std::max(fastest_rpm, rig.drive().physics().outputRpm()); });
  EXPECT_LT(fastest_rpm, 35.0);
}

TEST(DamiaoClosedLoop, AHeldMotorResistsALoad) {
  for (const std::string control : {"mit", "position_velocity", "force_position"}) {
    SCOPED_TRACE(control);
    auto rig = onlineRig(damiaoSettingsOf("DM4310", control), {.initial_angle_deg = 20.0F});
    ASSERT_TRUE(rig.enable());
    rig.motor().order(FrameKind::kHold);
    rig.run(milliseconds{100});
    rig.drive().setLoad({.load_torque_nm = 1.0F});
    rig.run(seconds{2});
    EXPECT_NEAR(shaftDeg(rig), 20.0, control == "mit" ? 4.0 : 1.0);
  }
}

TEST(DamiaoClosedLoop, DampingSlowsDownAndNeverPushes) {
  auto rig = onlineRig(damiaoSettingsOf(), {.coulomb_nm = 0.0F});
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 80.0});
  rig.run(seconds{1});
  const double before_rpm = rig.drive().physics().outputRpm();
  rig.motor().order(FrameKind::kDamp);
  double slowest_rpm = before_rpm;
  rig.run(seconds{1}, [&] { slowest_rpm = std::min(slowest_rpm, rig.drive().physics().outputRpm()); });
  EXPECT_LT(rig.drive().physics().outputRpm(), 0.2 * before_rpm);
  EXPECT_GT(slowest_rpm, -1.0);
}

TEST(DamiaoClosedLoop, AFaultIsToldClearedByRequestOnlyAndTheMotorEnabledAgain) {
  auto rig = onlineRig(damiaoSettingsOf());
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kCurrent, .value = 1.0});
  rig.run(milliseconds{20});
  rig.drive().fault(0xA);
  rig.run(milliseconds{5});
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveOverCurrent);
  EXPECT_EQ(rig.motor().complaint().native_code, 0xAU);
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{100});
  EXPECT_TRUE(released(rig));
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveOverCurrent) << "latched";
  EXPECT_FALSE(rig.enable()) << "nothing automatic clears it";
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{10});
  rig.motor().clearComplaint();
  rig.run(milliseconds{10});
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kCurrent, .value = 1.0});
  rig.run(milliseconds{50});
  EXPECT_FALSE(released(rig));
  rig.motor().order(FrameKind::kRest);
  rig.run(milliseconds{20});
  EXPECT_TRUE(released(rig));
}

TEST(DamiaoClosedLoop, ARestartIsNoticedAndGetsNoTarget) {
  auto rig = onlineRig(damiaoSettingsOf());
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 60.0});
  rig.run(seconds{1});
  rig.drive().restart();
  rig.run(milliseconds{3});
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveStopped);
  (void)rig.takeSent();
  rig.run(milliseconds{20});
  int told = 0;
  for (const auto& frame : rig.takeSent()) {
    if (frame.id.value == 1) {
      EXPECT_EQ(frame.data[7], 0xFD);
      ++told;
    }
  }
  EXPECT_EQ(told, 20);
  EXPECT_TRUE(released(rig));
  rig.motor().order(FrameKind::kPoll);
  rig.run(seconds{1});
  EXPECT_TRUE(rig.motor().feedback().zeroed) << "absolute";
  const double shaft_deg = shaftDeg(rig);
  EXPECT_NEAR(std::remainder(rig.motor().feedback().total_angle_deg - shaft_deg, 360.0), 0.0, 0.5);
  EXPECT_TRUE(rig.enable());
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
}

TEST(DamiaoClosedLoop, ASetZeroIsLostWithTheDrivesPowerIfItIsNotAbsolute) {
  auto rig = onlineRig(damiaoSettingsOf("DMH6215"));
  EXPECT_FALSE(rig.motor().feedback().zeroed);
  ASSERT_TRUE(rig.motor().setZero(5.0));
  rig.run(milliseconds{5});
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  ASSERT_TRUE(rig.enable());
  rig.motor().order(FrameKind::kIdle);
  rig.run(milliseconds{5});
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  rig.drive().restart();
  rig.run(milliseconds{100});
  EXPECT_FALSE(rig.motor().feedback().zeroed);
}

TEST(DamiaoClosedLoop, TheDrivesWatchdogTripsWhenCommandsStayAway) {
  auto rig = onlineRig(damiaoSettingsOf());
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kCurrent, .value = 1.0});
  rig.run(milliseconds{50});
  ASSERT_FALSE(released(rig));
  rig.cut(true);
  rig.run(milliseconds{90});
  EXPECT_FALSE(released(rig));
  rig.run(milliseconds{30});
  EXPECT_TRUE(released(rig));
  rig.cut(false);
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{5});
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveCommunication);
}

TEST(DamiaoClosedLoop, ADriveWithAnotherScaleIsNotEnabledAndTheRegisterIsTold) {
  for (const auto& [address, value] : {std::pair{21, 6.28F}, std::pair{22, 45.0F}, std::pair{23, 28.0F}}) {
    auto rig = onlineRig(damiaoSettingsOf());
    rig.drive().receive(damiaoFrame(0x7FF, {1, 0, 0x55, static_cast<std::uint8_t>(address),
                                            static_cast<std::uint8_t>(damiao::bitsOf(value)),
                                            static_cast<std::uint8_t>(damiao::bitsOf(value) >> 8U),
                                            static_cast<std::uint8_t>(damiao::bitsOf(value) >> 16U),
                                            static_cast<std::uint8_t>(damiao::bitsOf(value) >> 24U)}));
    EXPECT_FALSE(rig.enable());
    EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveSetting);
    EXPECT_EQ(rig.motor().complaint().native_code, 0x100U + static_cast<std::uint32_t>(address));
    EXPECT_TRUE(released(rig));
    rig.motor().order(FrameKind::kPoll);
    rig.motor().clearComplaint();
    rig.run(milliseconds{5});
    EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  }
}

TEST(DamiaoClosedLoop, ASilentDriveIsGivenUpWithinTheTimeOfTheSequence) {
  auto rig = rigOf(damiaoSettingsOf());
  rig.cut(true);
  rig.motor().order(FrameKind::kEnable);
  rig.run(milliseconds{200});
  EXPECT_EQ(rig.motor().sequenceProgress(), SequenceProgress::kPending);
  rig.run(milliseconds{60});
  EXPECT_EQ(rig.motor().sequenceProgress(), SequenceProgress::kFailed);
  rig.cut(false);
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{1});
  EXPECT_TRUE(rig.enable());
}

TEST(DamiaoClosedLoop, LostFramesDelayTheSequenceAndDoNotEndIt) {
  auto rig = onlineRig(damiaoSettingsOf());
  rig.motor().order(FrameKind::kEnable);
  for (int i = 0; i < 6; ++i) {
    rig.cut(true);
    rig.run(milliseconds{3});
    rig.cut(false);
    rig.run(milliseconds{50});
  }
  rig.run(milliseconds{100});
  EXPECT_EQ(rig.motor().sequenceProgress(), SequenceProgress::kDone);
}

TEST(DamiaoClosedLoop, SpeaksCanFdIfTheDriveDoes) {
  auto settings = damiaoSettingsOf();
  settings.own.set("can_fd", 1.0);
  auto rig = onlineRig(settings);
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 30.0});
  rig.run(seconds{1});
  EXPECT_GT(rig.drive().physics().outputRpm(), 20.0);
  const auto sent = rig.takeSent();
  const auto received = rig.takeReceived();
  EXPECT_GT(std::min(sent.size(), received.size()), 1000U);
  for (const auto& frame : sent) EXPECT_TRUE(frame.fd && frame.bit_rate_switch);
  for (const auto& frame : received) EXPECT_TRUE(frame.fd);
}

}  // namespace
}  // namespace rc10::test::damiao_closed_loop_test
