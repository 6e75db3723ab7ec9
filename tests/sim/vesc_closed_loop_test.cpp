// A VESC and its simulated drive, by their frames alone.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/angle.hpp"
#include "bus/byte_order.hpp"
#include "drives/vesc/vesc_simulated.hpp"
#include "sim/solo_rig.hpp"
#include "support/vesc_motors.hpp"

namespace rc10::test::vesc_closed_loop_test {
namespace {

using namespace std::chrono_literals;

struct Mounting {
  double gear_ratio;
  int direction;
};

MotorSettings settings(Mounting mounting = {1.0, 1},
                       std::vector<std::pair<std::string, OwnValues::Value>> own = {}) {
  own.insert(own.begin(), {{"kv_rpm_per_v", 100.0}, {"motor_current_max_a", 30.0}});
  auto result = vescSettings(own);
  result.gear_ratio = mounting.gear_ratio;
  result.direction = mounting.direction;
  result.zero_at_power_on = true;
  return result;
}

SoloRig rigOf(const MotorSettings& settings, const sim::MotorLoad& load = {}) {
  return SoloRig(std::make_unique<VESC_Motor>(settings), sim::makeVescDrive(settings, load));
}

sim::VescDrive& driveOf(SoloRig& rig) { return dynamic_cast<sim::VescDrive&>(rig.drive()); }
bool proven(SoloRig& rig) { return dynamic_cast<VESC_Motor&>(rig.motor()).watchdogProven(); }

constexpr std::array<Mounting, 4> kMountings{{{1.0, 1}, {1.0, -1}, {36.0, 1}, {36.0, -1}}};

TEST(VescClosedLoop, EveryModeReachesItsTargetHoweverTheMotorIsMounted) {
  for (const auto& mounting : kMountings) {
    SCOPED_TRACE("gear " + std::to_string(mounting.gear_ratio) + " direction " +
                 std::to_string(mounting.direction));
    auto rig = rigOf(settings(mounting));
    const double full_rpm = 2400.0 / mounting.gear_ratio;
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kVelocity, .value = 0.4 * full_rpm});
    rig.run(2s);
    EXPECT_NEAR(static_cast<double>(rig.motor().feedback().velocity_rpm), 0.4 * full_rpm, 0.01 * full_rpm);
    EXPECT_NEAR(mounting.direction * rig.drive().physics().outputRpm(), 0.4 * full_rpm, 0.01 * full_rpm);
    rig.command({.mode = ControlMode::kVelocity, .value = -0.4 * full_rpm});
    rig.run(2s);
    EXPECT_NEAR(static_cast<double>(rig.motor().feedback().velocity_rpm), -0.4 * full_rpm, 0.01 * full_rpm);

    rig.command({.mode = ControlMode::kBrake});
    rig.run(3s);
    EXPECT_NEAR(rig.drive().physics().outputRpm(), 0.0, 0.01 * full_rpm);

    rig.command({.mode = ControlMode::kDuty, .value = 0.5});
    rig.run(2s);
    EXPECT_NEAR(static_cast<double>(rig.motor().feedback().velocity_rpm), 0.5 * full_rpm, 0.05 * full_rpm);

    rig.command({.mode = ControlMode::kBrake});
    rig.run(3s);
    rig.command({.mode = ControlMode::kCurrent, .value = 2.0});
    rig.run(20ms);
    EXPECT_NEAR(static_cast<double>(rig.motor().feedback().current_a), 2.0, 0.2);
    EXPECT_GT(rig.motor().feedback().velocity_rpm, 0.0F);
    rig.command({.mode = ControlMode::kCurrent, .value = -2.0});
    rig.run(20ms);
    EXPECT_NEAR(static_cast<double>(rig.motor().feedback().current_a), -2.0, 0.2);
  }
}

TEST(VescClosedLoop, AnAngleIsReachedToTheSpeedThatTheDriveLetsGoAt) {
  for (const int direction : {1, -1}) {
    auto with = settings({36.0, direction});
    auto rig = rigOf(with);
    ASSERT_TRUE(rig.enable());
    for (const double target : {400.0, -250.0}) {
      rig.command({.mode = ControlMode::kTotalAngle, .value = target});
      rig.run(6s);
      // Below 900 ERPM the stock drive lets go: 3.6 rpm here, 2.4 degrees at 1.5 rpm per degree.
      EXPECT_NEAR(rig.motor().feedback().total_angle_deg, target, 3.0);
      EXPECT_NEAR(direction * rig.drive().physics().outputAngleDeg(), target, 3.5);
    }
  }
}

TEST(VescClosedLoop, ADriveWithAnEncoderReachesAnglesOverTurns) {
  for (const double divider : {1.0, 5.0}) {
    for (const int direction : {1, -1}) {
      auto with =
          settings({5.0, direction}, {{"angle", std::string{"encoder"}}, {"position_divider", divider}});
      auto rig = rigOf(with);
      ASSERT_TRUE(rig.enable());
      for (const double target : {500.0, -300.0}) {
        rig.command({.mode = ControlMode::kTotalAngle, .value = target});
        rig.run(4s);
        EXPECT_NEAR(rig.motor().feedback().total_angle_deg, target, 1.0) << divider;
        EXPECT_NEAR(direction * rig.drive().physics().outputAngleDeg(), target, 1.0) << divider;
      }
    }
  }
}

TEST(VescClosedLoop, AnAbsoluteEncoderReadsFromItsConfiguredZero) {
  auto with = settings({1.0, 1}, {{"angle", std::string{"encoder"}}});
  with.zero_at_power_on = false;
  with.zero_deg = 30.0;
  sim::MotorLoad load;
  load.initial_angle_deg = 120.0F;
  auto rig = rigOf(with, load);
  rig.run(50ms);
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 90.0, 0.1);
}

TEST(VescClosedLoop, RelativeCurrentsAreTheSameCurrents) {
  auto rig = rigOf(settings({1.0, 1}, {{"relative_current", 1.0}}));
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kCurrent, .value = 3.0});
  rig.run(20ms);
  EXPECT_NEAR(rig.drive().physics().currentA(), 3.0, 0.05);
}

TEST(VescClosedLoop, APaddedCurrentIsADifferentCurrent) {
  const auto with = settings();
  sim::VescDrive drive(with, {});
  auto frame = vesc::makeCommand(vesc::Packet::kSetCurrent, with.id, 1000);
  drive.receive(frame);
  drive.step(20ms);
  EXPECT_NEAR(drive.physics().currentA(), 1.0, 0.05);
  frame.length = 8;  // padded with zeros
  drive.receive(frame);
  drive.step(2ms);
  EXPECT_GT(drive.physics().currentA(), 20.0);
}

TEST(VescClosedLoop, NothingMovesBeforeTheFirstCommandAfterEnabling) {
  auto rig = rigOf(settings());
  rig.run(100ms);
  ASSERT_TRUE(rig.enable());
  rig.motor().order(FrameKind::kIdle);
  rig.run(100ms);
  int told = 0;
  for (const auto& frame : rig.takeSent()) {
    if (frame.id == vesc::canId(vesc::Packet::kProcessShortBuffer, 7)) continue;
    EXPECT_EQ(frame.id, vesc::canId(vesc::Packet::kSetCurrent, 7));
    EXPECT_EQ(frame.data, CanFrame{}.data);
    ++told;
  }
  EXPECT_GE(told, 100);
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), 0.0, 1e-6);
}

TEST(VescClosedLoop, RestLetsTheMotorGoInEveryMode) {
  for (const auto mode :
       {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kDuty, ControlMode::kTotalAngle}) {
    auto rig = rigOf(settings());
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = mode, .value = mode == ControlMode::kDuty ? 0.4 : 900.0});
    rig.run(300ms);
    rig.stall(true);
    rig.run(100ms);
    ASSERT_GT(rig.currentA(), 1.0) << "it obeyed before";
    rig.motor().order(FrameKind::kRest);
    rig.run(10ms);
    EXPECT_NEAR(rig.drive().physics().currentA(), 0.0, 0.01);
  }
}

TEST(VescClosedLoop, AFaultIsToldAndTheDriveClearsItItself) {
  auto rig = rigOf(settings());
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 800.0});
  rig.run(500ms);
  rig.stall(true);
  rig.run(100ms);
  ASSERT_GT(rig.currentA(), 1.0);
  rig.drive().fault(4);
  rig.run(250ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveOverCurrent);
  EXPECT_EQ(rig.motor().complaint().native_code, 4U);
  EXPECT_NEAR(rig.drive().physics().currentA(), 0.0, 0.01);
  rig.stall(false);
  rig.motor().order(FrameKind::kEnable);
  rig.run(100ms);
  EXPECT_EQ(rig.motor().sequenceProgress(), SequenceProgress::kFailed);
  rig.motor().order(FrameKind::kRest);
  rig.motor().clearComplaint();
  rig.run(600ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 800.0});
  rig.run(1s);
  EXPECT_NEAR(static_cast<double>(rig.motor().feedback().velocity_rpm), 800.0, 20.0);
  rig.motor().order(FrameKind::kRest);
  rig.run(10ms);
  EXPECT_NEAR(rig.drive().physics().currentA(), 0.0, 0.01);
}

TEST(VescClosedLoop, ARestartIsNoticedAndTheAngleHasNoReferenceAfterIt) {
  auto rig = rigOf(settings());
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 800.0});
  rig.run(500ms);
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  rig.drive().restart();
  rig.run(1100ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(rig.motor().feedback().zeroed);
  rig.motor().order(FrameKind::kRest);
  rig.run(1s);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  EXPECT_EQ(rig.motor().feedback().jumps, 0U);
}

TEST(VescClosedLoop, TheWatchdogStopsAMotorThatIsToldNothing) {
  auto rig = rigOf(settings());
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 800.0});
  rig.run(500ms);
  rig.cut(true);
  rig.stall(true);
  rig.run(900ms);
  EXPECT_FALSE(driveOf(rig).timedOut());
  EXPECT_GT(rig.currentA(), 1.0);
  rig.run(200ms);
  EXPECT_TRUE(driveOf(rig).timedOut());
  EXPECT_NEAR(rig.drive().physics().currentA(), 0.0, 0.01);
}

TEST(VescClosedLoop, TheWatchdogOfADriveThatNobodyCommandedIsProvenByOurSilence) {
  auto rig = rigOf(settings());
  ASSERT_TRUE(driveOf(rig).timedOut());
  rig.run(90ms);
  EXPECT_FALSE(driveOf(rig).timedOut()) << "it is told to rest first";
  EXPECT_FALSE(proven(rig));
  rig.run(1410ms);
  EXPECT_TRUE(proven(rig));
  ASSERT_TRUE(rig.enable(100ms));
}

TEST(VescClosedLoop, TheWatchdogOfADriveIsProvenWithinTheTimeOfEnabling) {
  auto rig = rigOf(settings());
  EXPECT_TRUE(rig.enable(1500ms));
  auto slow = settings();
  slow.command_divider = 100;
  auto told_seldom = rigOf(slow);
  EXPECT_TRUE(told_seldom.enable(1500ms));
}

TEST(VescClosedLoop, TheWatchdogThatIsShortIsProvenSoon) {
  auto rig = rigOf(settings());
  driveOf(rig).setWatchdog(100ms);
  EXPECT_TRUE(rig.enable(400ms));
}

TEST(VescClosedLoop, TheWatchdogIsNotProvenByATimeOutFromBefore) {
  for (const Duration before : {0ms, 50ms, 5000ms}) {
    SCOPED_TRACE(before.count());
    auto rig = rigOf(settings());
    driveOf(rig).setWatchdog(10s);
    ASSERT_TRUE(driveOf(rig).timedOut()) << "it was powered long before";
    rig.run(before);
    EXPECT_FALSE(proven(rig));
    for (int attempt = 0; attempt < 3; ++attempt) {
      EXPECT_FALSE(rig.enable());
      EXPECT_EQ(rig.motor().sequenceProgress(), SequenceProgress::kFailed);
      rig.motor().order(FrameKind::kRest);
      rig.run(1ms);
    }
  }
}

TEST(VescClosedLoop, TheWatchdogIsNotProvenByADriveThatTakesNoCommand) {
  auto rig = rigOf(settings());
  rig.lose([](const CanFrame& frame) { return frame.id == vesc::canId(vesc::Packet::kSetCurrent, 7); });
  rig.run(5s);
  EXPECT_FALSE(proven(rig));
  EXPECT_FALSE(rig.enable(500ms));
  EXPECT_EQ(rig.motor().sequenceProgress(), SequenceProgress::kFailed);
}

TEST(VescClosedLoop, TheWatchdogIsProvenAnewAfterAGapInWhichItMayHaveBecomeAnotherDrives) {
  for (const char* angle : {"tachometer", "encoder", "none"}) {
    for (const auto kind : {FrameKind::kRest, FrameKind::kCommand}) {
      SCOPED_TRACE(angle);
      auto rig = rigOf(settings({1.0, 1}, {{"angle", std::string{angle}}}));
      ASSERT_TRUE(rig.enable());
      const auto gap = [&](Duration length) {
        rig.motor().order(kind);
        rig.run(500ms);
        rig.cut(true);
        rig.run(length);
        rig.cut(false);
        rig.run(50ms);
      };
      gap(250ms);
      EXPECT_TRUE(proven(rig));
      gap(400ms);
      EXPECT_FALSE(proven(rig));
      rig.motor().order(FrameKind::kRest);
      rig.run(1500ms);
      EXPECT_TRUE(proven(rig));
      driveOf(rig).setWatchdog(10s);  // another drive
      gap(400ms);
      rig.motor().order(FrameKind::kRest);
      rig.run(100ms);
      EXPECT_FALSE(rig.enable());
    }
  }
}

TEST(VescClosedLoop, TheWatchdogOfADriveThatHasJustStartedIsProvenWhileItRests) {
  auto rig = rigOf(settings());
  rig.drive().restart();
  rig.run(1200ms);  // it starts
  EXPECT_FALSE(proven(rig));
  rig.run(1300ms);
  EXPECT_TRUE(proven(rig));
  ASSERT_TRUE(rig.enable(100ms));
}

TEST(VescClosedLoop, ADriveThatSpeaksAndAnswersNothingDoesNotReceive) {
  for (const char* angle : {"tachometer", "encoder", "none"}) {
    SCOPED_TRACE(angle);
    auto rig = rigOf(settings({1.0, 1}, {{"angle", std::string{angle}}}));
    ASSERT_TRUE(rig.enable());
    rig.command({.mode = ControlMode::kVelocity, .value = 800.0});
    rig.run(500ms);
    rig.lose([](const CanFrame&) { return true; });
    rig.run(450ms);
    EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
    rig.run(300ms);
    EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveCommunication);
    rig.motor().order(FrameKind::kRest);
    rig.run(1ms);
    EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone) << "nothing is to obey";
    rig.lose({});
    rig.run(200ms);
    EXPECT_TRUE(rig.enable()) << "it answers again";
  }
}

TEST(VescClosedLoop, ADriveThatIsSilentTooOrAnswersNowAndThenMayReceive) {
  auto rig = rigOf(settings());
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 800.0});
  int questions = 0;
  rig.lose([&questions](const CanFrame& frame) {
    const bool asks = frame.id == vesc::canId(vesc::Packet::kProcessShortBuffer, 7);
    return asks && ++questions % 4 != 0;
  });
  const auto expectNone = [&rig] { ASSERT_EQ(rig.motor().complaint().fault, FaultCode::kNone); };
  rig.run(5s, expectNone);
  rig.lose({});
  rig.cut(true);
  rig.run(950ms, expectNone);
  rig.cut(false);
  rig.run(1s, expectNone);
}

TEST(VescClosedLoop, ADriveWithoutAWatchdogIsNotEnabledUnlessNobodyAsks) {
  auto rig = rigOf(settings());
  driveOf(rig).setWatchdog(0ms);
  EXPECT_FALSE(rig.enable(2s));
  EXPECT_EQ(rig.motor().sequenceProgress(), SequenceProgress::kFailed);
  auto unasked = rigOf(settings({1.0, 1}, {{"ask_status", 0.0}}));
  driveOf(unasked).setWatchdog(0ms);
  EXPECT_TRUE(unasked.enable());
  EXPECT_EQ(unasked.motor().driveFrames().enable, Provision::kNothing);
}

TEST(VescClosedLoop, HoldStaysWhereItBegan) {
  auto rig = rigOf(settings({36.0, 1}));
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 20.0});
  rig.run(1s);
  const double began = rig.motor().feedback().total_angle_deg;
  rig.motor().order(FrameKind::kHold);
  rig.run(3s);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, began, 3.5);
}

/// A motor with an encoder that has seldom feedback, at 3000 rpm.
SoloRig fastRig(int direction, double divider) {
  auto with = settings(
      {1.0, 1}, {{"angle", std::string{"encoder"}}, {"position_divider", divider}, {"kv_rpm_per_v", 190.0}});
  with.feedback_hz = 50;
  sim::MotorLoad load;
  load.inertia_kg_m2 = 0.002F;
  auto rig = rigOf(with, load);
  EXPECT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = direction * 3000.0});
  rig.run(3s);
  EXPECT_NEAR(rig.drive().physics().outputRpm(), direction * 3000.0, 30.0);
  return rig;
}

/// Speed of the shaft, forwards as it turns, and what the drive was told last, as far ahead of the shaft as
/// it sees it itself.
struct Seen {
  double rpm;
  double ahead_deg = 0.0;
  double ahead_rpm = 0.0;
};
Seen seenOf(SoloRig& rig, int direction, double divider) {
  const auto& physics = rig.drive().physics();
  Seen seen{.rpm = direction * physics.outputRpm()};
  for (const auto& frame : rig.takeSent()) {
    if (frame.length != 4) continue;  // a question
    const double raw = readBigEndian<std::int32_t>(frame.payload(), 0);
    seen.ahead_deg = seen.ahead_rpm = 0.0;
    if (frame.id == vesc::canId(vesc::Packet::kSetPosition, 7)) {
      seen.ahead_deg = direction * shortestAngle(physics.outputAngleDeg() / divider, raw / vesc::kPerDegree);
    } else {
      EXPECT_EQ(frame.id, vesc::canId(vesc::Packet::kSetErpm, 7));
      seen.ahead_rpm = direction * raw / 7.0 - seen.rpm;
    }
  }
  return seen;
}

/// Until the shaft turns back no command leads forwards, whatever the gains of the drive, and its speed
/// falls.
void expectOnlyBraked(SoloRig& rig, int direction, double divider) {
  double least_rpm = 3100.0;
  (void)rig.takeSent();
  for (int ms = 0; ms < 3000 && least_rpm > 5.0; ++ms) {
    rig.run(1ms);
    const Seen seen = seenOf(rig, direction, divider);
    ASSERT_LT(seen.ahead_deg, 1.0) << seen.rpm << " rpm after " << ms << " ms";
    ASSERT_LT(seen.ahead_rpm, 1.0) << seen.rpm << " rpm after " << ms << " ms";
    ASSERT_LT(seen.rpm, least_rpm + 5.0) << ms;
    least_rpm = std::min(least_rpm, seen.rpm);
  }
  EXPECT_LT(least_rpm, 5.0) << "it slows down";
}

TEST(VescClosedLoop, AHoldOrAnAngleBegunAtSpeedNeverPushesTheShaftOn) {
  for (const double divider : {1.0, 2.0}) {
    for (const int direction : {1, -1}) {
      for (int phase_ms = 0; phase_ms < 20; phase_ms += 3) {
        SCOPED_TRACE(std::to_string(divider) + ", " + std::to_string(direction) + ", " +
                     std::to_string(phase_ms));
        auto held = fastRig(direction, divider);
        held.run(std::chrono::milliseconds{phase_ms});
        const double begun_deg = held.motor().feedback().total_angle_deg;
        held.motor().order(FrameKind::kHold);
        ASSERT_NO_FATAL_FAILURE(expectOnlyBraked(held, direction, divider));
        held.run(10s);
        EXPECT_NEAR(held.motor().feedback().total_angle_deg, begun_deg, 1.0);
        EXPECT_NEAR(held.drive().physics().outputRpm(), 0.0, 1.0);

        auto led = fastRig(direction, divider);
        led.run(std::chrono::milliseconds{phase_ms});
        const double behind_deg = led.motor().feedback().total_angle_deg - direction * 400.0;
        led.command({.mode = ControlMode::kTotalAngle, .value = behind_deg});
        ASSERT_NO_FATAL_FAILURE(expectOnlyBraked(led, direction, divider));
        led.run(10s);
        EXPECT_NEAR(led.motor().feedback().total_angle_deg, behind_deg, 1.0);
      }
    }
  }
}

TEST(VescClosedLoop, TheHandbrakeHoldsAgainstALoad) {
  auto with = settings({1.0, 1}, {{"angle", std::string{"none"}}, {"handbrake_current_a", 15.0}});
  sim::MotorLoad load;
  load.load_torque_nm = 0.3F;
  auto rig = rigOf(with, load);
  ASSERT_TRUE(rig.enable());
  rig.motor().order(FrameKind::kBrake);
  rig.run(1s);
  const double held = rig.drive().physics().outputAngleDeg();
  rig.run(2s);
  EXPECT_NEAR(rig.drive().physics().outputAngleDeg(), held, 2.0);
  EXPECT_TRUE(std::isnan(rig.motor().feedback().total_angle_deg));
}

TEST(VescClosedLoop, DampSlowsAMotorDown) {
  auto rig = rigOf(settings());
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 2000.0});
  rig.run(2s);
  rig.motor().order(FrameKind::kDamp);
  rig.run(1ms);
  const double before = rig.drive().physics().outputRpm();
  rig.run(200ms);
  EXPECT_LT(rig.drive().physics().outputRpm(), 0.5 * before);
  EXPECT_GT(rig.drive().physics().outputRpm(), -1.0);
}

}  // namespace
}  // namespace rc10::test::vesc_closed_loop_test
