// RobStride and CyberGear motors with their simulated drives: every control, faults, restarts, the watchdog.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drives/robstride/robstride_simulated.hpp"
#include "sim/solo_rig.hpp"
#include "support/robstride_settings.hpp"

namespace rc10::test::robstride_closed_loop_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Rig : SoloRig {
  explicit Rig(const MotorSettings& settings, const sim::MotorLoad& load = {})
      : Rig(settings, settings, load) {}
  Rig(const MotorSettings& settings, const MotorSettings& of_drive, const sim::MotorLoad& load = {})
      : SoloRig(std::make_unique<RobStride_Motor>(settings), sim::makeRobstrideDrive(of_drive, load)) {
    motor().order(FrameKind::kPoll);
    run(milliseconds{5});
  }
  double total() { return motor().feedback().total_angle_deg; }
  double rpm() { return static_cast<double>(motor().feedback().velocity_rpm); }
  FaultCode fault() { return motor().complaint().fault; }
};

MotorSettings controlled(const std::string& control, std::string_view model = "RS00") {
  auto settings = robStrideSettings(model);
  settings.own.set("control", control);
  return settings;
}

struct Mounting {
  std::string_view model;
  double gear_ratio;
  int direction;
};
const std::vector<Mounting> kMountings{{"RS00", 0.0, 1},      {"RS00", 20.0, -1},     {"RS01", 0.0, -1},
                                       {"RS02", 7.75, 1},     {"RS03", 0.0, 1},       {"RS04", 27.0, 1},
                                       {"RS05", 0.0, -1},     {"RS06", 0.0, 1},       {"EL05", 9.0, 1},
                                       {"CyberGear", 0.0, 1}, {"CyberGear", 15.5, -1}};

MotorSettings mounted(const Mounting& mounting, const std::string& control) {
  auto settings = controlled(control, mounting.model);
  settings.gear_ratio = mounting.gear_ratio;
  settings.direction = mounting.direction;
  return settings;
}

TEST(RobStrideClosedLoop, OperationModeFollowsEveryKindOfTarget) {
  for (const auto& mounting : kMountings) {
    SCOPED_TRACE(std::string{mounting.model} + " " + std::to_string(mounting.gear_ratio));
    Rig rig(mounted(mounting, "operation"));
    ASSERT_TRUE(rig.enable());
    const double start_deg = rig.total();
    rig.command({.mode = ControlMode::kTotalAngle, .value = start_deg + 60.0});
    rig.run(seconds{2});
    EXPECT_NEAR(rig.total(), start_deg + 60.0, 2.5);
    rig.command({.mode = ControlMode::kImpedance,
                 .value = start_deg,
                 .stiffness_nm_per_rad = 20.0F,
                 .damping_nms_per_rad = 1.0F});
    rig.run(seconds{3});
    EXPECT_NEAR(rig.total(), start_deg, 15.0);  // no more than friction keeps it from
    rig.command({.mode = ControlMode::kVelocity, .value = 30.0});
    rig.run(milliseconds{500});
    EXPECT_NEAR(rig.rpm(), 30.0, 4.0);
    rig.command({.mode = ControlMode::kBrake});
    rig.run(milliseconds{500});
    EXPECT_NEAR(rig.rpm(), 0.0, 0.5);
    rig.command({.mode = ControlMode::kCurrent, .value = 1.0});
    rig.run(milliseconds{100});
    EXPECT_NEAR(rig.motor().feedback().current_a, 1.0F, 0.1F);
    EXPECT_GT(rig.rpm(), 0.0);
    EXPECT_EQ(rig.fault(), FaultCode::kNone);
  }
}

TEST(RobStrideClosedLoop, TheCurrentLoopGivesItsCurrent) {
  for (const auto& mounting : kMountings) {
    Rig rig(mounted(mounting, "current"));
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kCurrent, .value = -1.5});
    rig.run(milliseconds{60});
    EXPECT_NEAR(rig.motor().feedback().current_a, -1.5F, 0.1F) << mounting.model;
    EXPECT_LT(rig.rpm(), 0.0) << mounting.model;
  }
}

TEST(RobStrideClosedLoop, TheVelocityLoopReachesItsSpeed) {
  for (const auto& mounting : kMountings) {
    Rig rig(mounted(mounting, "velocity"));
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
    rig.run(seconds{1});
    EXPECT_NEAR(rig.rpm(), 40.0, 1.0) << mounting.model;
    rig.command({.mode = ControlMode::kBrake});
    rig.run(seconds{1});
    EXPECT_NEAR(rig.rpm(), 0.0, 0.5) << mounting.model;
  }
}

TEST(RobStrideClosedLoop, ThePositionLoopReachesItsAngle) {
  for (const auto& mounting : kMountings) {
    Rig rig(mounted(mounting, "position"));
    ASSERT_TRUE(rig.enable());
    const double start_deg = rig.total();
    rig.command({.mode = ControlMode::kTotalAngle, .value = start_deg - 200.0});
    rig.run(seconds{3});
    EXPECT_NEAR(rig.total(), start_deg - 200.0, 1.0) << mounting.model;
  }
}

TEST(RobStrideClosedLoop, ThePositionLoopGoesOverManyTurnsAndFindsBackAfterANewStartOfTheHost) {
  const auto settings = controlled("position");
  Rig rig(settings);
  ASSERT_TRUE(rig.enable());
  const double start_deg = rig.total();
  rig.command({.mode = ControlMode::kTotalAngle, .value = start_deg + 3000.0});
  rig.run(seconds{5});
  EXPECT_NEAR(rig.total(), start_deg + 3000.0, 1.0);

  // Another host: it sees only the scale of the feedback, and asks for the count of turns.
  RobStride_Motor second(settings);
  const auto exchange = [&](FrameKind kind, const Target& target, int ticks) {
    static MonotonicTime now{std::chrono::hours{2}};
    static std::uint64_t index = 0;
    for (int i = 0; i < ticks; ++i) {
      now += milliseconds{1};
      const Tick tick{.index = ++index, .now = now, .dt_s = 0.001F};
      second.order(kind, target);
      second.update(tick);
      std::array<CanFrame, kMaxFramesPerPacker> out{};
      const auto count = second.packCommand(tick, out);
      for (std::size_t f = 0; f < count; ++f) rig.drive().receive(out[f]);
      rig.drive().step(milliseconds{1});
      std::array<CanFrame, sim::Drive::kMaxFrames> in{};
      const auto answers = rig.drive().answers(in);
      for (std::size_t f = 0; f < answers; ++f) {
        in[f].received = now;
        if (second.matchesFrame(in[f])) (void)second.updateFeedback(in[f]);
      }
    }
  };
  exchange(FrameKind::kPoll, {}, 300);
  const double before_deg = rig.drive().physics().outputAngleDeg();
  exchange(FrameKind::kEnable, {}, 50);
  ASSERT_EQ(second.sequenceProgress(), SequenceProgress::kDone);
  exchange(FrameKind::kCommand,
           {.mode = ControlMode::kTotalAngle, .value = second.feedback().total_angle_deg + 10.0}, 1000);
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), before_deg + 10.0, 1.0);
}

TEST(RobStrideClosedLoop, EnablingNeverMovesTheMotor) {
  for (const std::string control : {"operation", "current", "velocity", "position"}) {
    SCOPED_TRACE(control);
    Rig rig(controlled(control), {.initial_angle_deg = 77.0F});
    ASSERT_TRUE(rig.enable());
    const bool angles = control == "operation" || control == "position";
    rig.command(angles ? Target{.mode = ControlMode::kTotalAngle, .value = rig.total() + 90.0}
                       : Target{.mode = control == "current" ? ControlMode::kCurrent : ControlMode::kVelocity,
                                .value = 2.0});
    rig.run(milliseconds{100});
    rig.motor().order(FrameKind::kPoll);
    rig.run(seconds{20});
    ASSERT_NEAR(rig.rpm(), 0.0, 0.1);  // it has run out
    const double rest_deg = rig.total();
    // The drive still has the references of the last time.
    ASSERT_TRUE(rig.enable());
    rig.motor().order(FrameKind::kIdle);
    rig.run(milliseconds{500});
    EXPECT_NEAR(rig.total(), rest_deg, 0.1);
    EXPECT_NEAR(rig.motor().feedback().torque_nm, 0.0F, 0.02F);
  }
}

TEST(RobStrideClosedLoop, TorqueAndSpeedStayWithinTheirLimitsOnTheWayToAFarAngle) {
  for (const std::string control : {"operation", "position"}) {
    for (const std::string_view model : {"RS00", "RS04", "CyberGear"}) {
      SCOPED_TRACE(control + " " + std::string{model});
      auto settings = controlled(control, model);
      settings.effort_limit = 3.0F;
      settings.velocity_limit_rpm = 20.0F;
      Rig rig(settings);
      ASSERT_TRUE(rig.enable());
      const double start_deg = rig.total();
      rig.command({.mode = ControlMode::kTotalAngle, .value = start_deg + 300.0});
      const auto& motor = rig.drive().physics();
      double most_a = 0.0;
      double most_rpm = 0.0;
      rig.run(seconds{6}, [&] {
        most_a = std::max(most_a, std::abs(motor.currentA()));
        most_rpm = std::max(most_rpm, std::abs(motor.outputRpm()));
      });
      // Stiff as RS04 is by default, what happens in the millisecond after the last feedback counts.
      EXPECT_LT(most_a, 3.5);
      EXPECT_LT(most_rpm, 22.0);
      EXPECT_NEAR(rig.total(), start_deg + 300.0, 3.0);
    }
  }
}

TEST(RobStrideClosedLoop, ALoadIsHeldWhateverTheVelocityLimitIs) {
  auto settings = controlled("operation");
  settings.velocity_limit_rpm = 10.0F;
  Rig rig(settings, {.coulomb_nm = 0.0F, .load_torque_nm = 4.0F});
  ASSERT_TRUE(rig.enable());
  const double before_deg = rig.total();
  rig.motor().order(FrameKind::kHold);
  rig.run(seconds{1});
  const double sagged_deg = rig.total();
  EXPECT_GT(sagged_deg, before_deg - 30.0);
  rig.run(seconds{1});
  EXPECT_NEAR(rig.total(), sagged_deg, 0.5);
}

TEST(RobStrideClosedLoop, OlderFirmwareHasItsOwnScale) {
  auto settings = controlled("operation");
  settings.own.set("position_range_rad", 12.5);
  Rig rig(settings, {.initial_angle_deg = 300.0F});
  ASSERT_TRUE(rig.enable());
  EXPECT_NEAR(rig.total(), -60.0, 0.1);
  rig.command({.mode = ControlMode::kTotalAngle, .value = 40.0});
  rig.run(seconds{2});
  EXPECT_NEAR(rig.total(), 40.0, 2.5);
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), 400.0, 2.5);
}

TEST(RobStrideClosedLoop, BeyondTheScaleOperationModeDoesNotPullBack) {
  Rig rig(controlled("operation"), {.initial_angle_deg = 300.0F});
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 100.0});
  rig.run(seconds{2});  // three turns
  const double far_deg = rig.total();
  ASSERT_GT(far_deg, 800.0);
  rig.command({.mode = ControlMode::kTotalAngle, .value = 0.0});
  rig.run(seconds{2});
  EXPECT_GE(rig.total(), far_deg - 1.0);
  EXPECT_NEAR(rig.rpm(), 0.0, 1.0);
  EXPECT_NE(rig.motor().limits() & kLimitAngle, 0U);
}

TEST(RobStrideClosedLoop, RestHasNoTorque) {
  Rig rig(controlled("operation"));
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kCurrent, .value = 5.0});
  rig.run(milliseconds{100});
  EXPECT_GT(rig.drive().physics().outputTorqueNm(), 1.0);
  rig.motor().order(FrameKind::kRest);
  rig.run(milliseconds{20});
  EXPECT_NEAR(rig.drive().physics().outputTorqueNm(), 0.0, 0.01);
}

TEST(RobStrideClosedLoop, AFaultIsClearedAndTheDriveEnabledAgain) {
  for (const std::uint32_t native : {1U << 3U, 1U << 2U, 1U << 26U}) {
    Rig rig(controlled("operation"));
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kVelocity, .value = 20.0});
    rig.run(milliseconds{100});
    rig.drive().fault(native);
    rig.run(milliseconds{5});
    const auto code = robstride::faultOf(native, false);
    EXPECT_EQ(rig.fault(), code);
    EXPECT_TRUE(rig.motor().feedback().zeroed);  // it stopped where it was
    rig.motor().order(FrameKind::kPoll);
    rig.run(milliseconds{100});
    EXPECT_EQ(rig.fault(), code) << "latched";
    EXPECT_FALSE(rig.enable());
    rig.motor().order(FrameKind::kPoll);
    rig.motor().clearComplaint();
    rig.run(milliseconds{5});
    EXPECT_EQ(rig.fault(), FaultCode::kNone);
    EXPECT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kVelocity, .value = 20.0});
    rig.run(milliseconds{300});
    EXPECT_NEAR(rig.rpm(), 20.0, 3.0);
  }
}

TEST(RobStrideClosedLoop, ARestartIsNoticedAndNothingMovesUntilEnabledAnew) {
  Rig rig(controlled("operation", "CyberGear"), {.initial_angle_deg = 100.0F});
  rig.motor().setZero(0.0);
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kTotalAngle, .value = 10.0});
  rig.run(seconds{1});
  rig.stall(true);
  rig.command({.mode = ControlMode::kTotalAngle, .value = 20.0});
  rig.run(milliseconds{50});
  ASSERT_GT(rig.drive().physics().outputTorqueNm(), 0.1);
  rig.drive().restart();
  rig.run(milliseconds{3});
  EXPECT_EQ(rig.fault(), FaultCode::kDriveStopped);
  EXPECT_FALSE(rig.motor().feedback().zeroed);
  rig.run(milliseconds{200});
  EXPECT_NEAR(rig.drive().physics().outputTorqueNm(), 0.0, 0.01);
  rig.motor().order(FrameKind::kPoll);
  rig.run(milliseconds{10});
  EXPECT_EQ(rig.fault(), FaultCode::kNone);
  EXPECT_TRUE(rig.enable());
}

TEST(RobStrideClosedLoop, TheDrivesWatchdogTripsWhenTheHostIsGone) {
  for (const std::string_view model : {"RS00", "CyberGear"}) {
    auto settings = controlled("operation", model);
    settings.own.set("watchdog_ms", 100.0);
    Rig rig(settings);
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kCurrent, .value = 3.0});
    rig.run(milliseconds{300});
    EXPECT_GT(rig.drive().physics().outputTorqueNm(), 0.5);
    rig.cut(true);
    rig.run(milliseconds{95});
    EXPECT_GT(rig.drive().physics().outputTorqueNm(), 0.1);
    rig.run(milliseconds{20});
    EXPECT_NEAR(rig.drive().physics().outputTorqueNm(), 0.0, 0.05);
    rig.cut(false);
    rig.run(milliseconds{5});
    EXPECT_EQ(rig.fault(), FaultCode::kDriveStopped);
  }
}

TEST(RobStrideClosedLoop, ADriveThatIsNotThereCannotBeEnabled) {
  Rig rig(controlled("operation"));
  rig.cut(true);
  EXPECT_FALSE(rig.enable());
}

TEST(RobStrideClosedLoop, AnAbsoluteDriveKnowsItsAngleAndZero) {
  auto settings = robStrideSettings("RS02");
  settings.zero_deg = 30.0;
  Rig rig(settings, {.initial_angle_deg = 50.0F});
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  EXPECT_NEAR(rig.total(), 20.0, 0.1);
  Rig other(robStrideSettings("CyberGear"), {.initial_angle_deg = 50.0F});
  EXPECT_FALSE(other.motor().feedback().zeroed);
}

TEST(RobStrideClosedLoop, ManyTurnsAreCountedWhileItRuns) {
  Rig rig(controlled("velocity"));
  ASSERT_TRUE(rig.enable());
  const double offset_deg = rig.total() - rig.drive().physics().outputAngleDeg();
  rig.command({.mode = ControlMode::kVelocity, .value = 200.0});
  rig.run(seconds{10});
  EXPECT_GT(rig.total(), 360.0 * 25);
  EXPECT_NEAR(rig.total() - rig.drive().physics().outputAngleDeg(), offset_deg, 2.0);
  EXPECT_TRUE(rig.motor().feedback().zeroed);
}

TEST(RobStrideClosedLoop, SlowCommandsAreEnough) {
  auto settings = controlled("operation");
  settings.command_divider = 10;
  Rig rig(settings);
  ASSERT_TRUE(rig.enable());
  const double start_deg = rig.total();
  rig.command({.mode = ControlMode::kTotalAngle, .value = start_deg + 45.0});
  rig.run(seconds{2});
  EXPECT_NEAR(rig.total(), start_deg + 45.0, 2.5);
  EXPECT_EQ(rig.fault(), FaultCode::kNone);
}

// Another model's speed and torque scale, as the maker's sample and its manuals contradict each other.
TEST(RobStrideClosedLoop, ADriveOnAnotherScaleIsStoppedAtItsFirstMotion) {
  struct Pair {
    std::string_view told, is;
    unsigned percent;
  };
  for (const auto& pair : {Pair{"RS00", "RS03", 165}, Pair{"RS03", "RS00", 61}, Pair{"RS05", "RS00", 152},
                           Pair{"RS06", "RS03", 250}, Pair{"RS01", "RS05", 88}}) {
    SCOPED_TRACE(std::string{pair.told} + " " + std::string{pair.is});
    Rig rig(controlled("velocity", pair.told), controlled("velocity", pair.is));
    ASSERT_TRUE(rig.enable());
    EXPECT_EQ(rig.fault(), FaultCode::kNone);
    rig.command({.mode = ControlMode::kVelocity, .value = 40.0});
    rig.run(seconds{1});
    if (pair.percent == 88) {  // near enough to be somebody's noise
      EXPECT_EQ(rig.fault(), FaultCode::kNone);
      continue;
    }
    EXPECT_EQ(rig.fault(), FaultCode::kDriveSetting);
    EXPECT_NEAR(static_cast<double>(rig.motor().complaint().native_code - SoloMotor::kSpeedScaleComplaint),
                pair.percent, 2.0);
    rig.motor().order(FrameKind::kPoll);
    rig.run(milliseconds{10});
    EXPECT_EQ(rig.fault(), FaultCode::kNone) << "until it moves again";
  }
}

TEST(RobStrideClosedLoop, TheDriveAnswersNothingToOthersAndNothingUnasked) {
  Rig rig(controlled("operation"));
  std::array<CanFrame, sim::Drive::kMaxFrames> out{};
  EXPECT_EQ(rig.drive().feedbackPeriod(), Duration::zero());
  (void)rig.drive().answers(out);
  CanFrame frame = makeClassicFrame({0x0300FD01, true}, std::array<std::uint8_t, 8>{});
  rig.drive().receive(frame);
  frame.id = {0x7F, false};
  rig.drive().receive(frame);
  EXPECT_EQ(rig.drive().answers(out), 0U);
  frame.id = {0x0400FD7F, true};
  rig.drive().receive(frame);
  EXPECT_EQ(rig.drive().answers(out), 1U);
}

}  // namespace
}  // namespace rc10::test::robstride_closed_loop_test
