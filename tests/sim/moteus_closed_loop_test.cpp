// Moteus_Motor and MoteusDrive together: what a user sees of a motor.
#include "drives/moteus/moteus_motor.hpp"

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "drives/moteus/moteus_family.hpp"
#include "drives/moteus/moteus_simulated.hpp"
#include "sim/solo_rig.hpp"
#include "support/moteus_settings.hpp"

namespace rc10::test::moteus_closed_loop_test {
namespace {

using namespace std::chrono_literals;

class Rig : public SoloRig {
 public:
  explicit Rig(const MotorSettings& settings = moteusMotor(), const sim::MotorLoad& load = {})
      : SoloRig(makeMotor(settings), sim::makeMoteusDrive(settings, load)) {}

  void poll(Duration duration = 20ms) {
    motor().order(FrameKind::kPoll);
    run(duration);
  }
  /// As the supervisor goes about it: first it is polled.
  bool start() {
    poll();
    return enable();
  }
  [[nodiscard]] sim::MoteusDrive& moteus() { return dynamic_cast<sim::MoteusDrive&>(drive()); }
  [[nodiscard]] double currentA() { return drive().physics().currentA(); }
  [[nodiscard]] double shaftRpm() { return drive().physics().outputRpm(); }
  [[nodiscard]] double shaftDeg() { return drive().physics().outputAngleDeg(); }

 private:
  static std::unique_ptr<SoloMotor> makeMotor(const MotorSettings& settings) {
    return std::make_unique<Moteus_Motor>(settings, moteusFamily().traits(settings.model, settings.own));
  }
};

TEST(MoteusClosedLoop, PollingGivesReadingsAndNoTorque) {
  Rig rig(moteusMotor(), {.initial_angle_deg = 90.0F});
  rig.poll();
  const auto& feedback = rig.motor().feedback();
  EXPECT_GT(feedback.samples, 15U);
  EXPECT_NEAR(feedback.voltage_v, 24.0F, 0.5F);
  EXPECT_NEAR(feedback.temperature_c, 25.0F, 1.0F);
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kStopped);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
}

TEST(MoteusClosedLoop, EnablingEndsInPositionModeWithoutMoving) {
  Rig rig;
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kPosition);
  rig.motor().order(FrameKind::kIdle);
  rig.run(200ms, [&] { EXPECT_NEAR(rig.currentA(), 0.0, 1e-6); });
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kPosition);
}

TEST(MoteusClosedLoop, EveryModeReachesItsTarget) {
  Rig rig;
  ASSERT_TRUE(rig.start());
  rig.command({.mode = ControlMode::kVelocity, .value = 600.0});
  rig.run(1s);
  EXPECT_NEAR(rig.shaftRpm(), 600.0, 10.0);
  EXPECT_NEAR(rig.motor().feedback().velocity_rpm, 600.0F, 15.0F);

  rig.command({.mode = ControlMode::kTotalAngle, .value = 1000.0});
  rig.run(2s);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 1000.0, 2.0);

  rig.command({.mode = ControlMode::kAngle, .value = 10.0});
  rig.run(1s);
  EXPECT_NEAR(rig.motor().feedback().angle_deg, 10.0F, 2.0F);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 1090.0, 2.0) << "the shortest way round";

  rig.command({.mode = ControlMode::kCurrent, .value = 3.0});
  rig.run(10ms);
  EXPECT_NEAR(rig.currentA(), 3.0, 0.3);
  EXPECT_NEAR(rig.motor().feedback().current_a, 3.0F, 0.4F);
  rig.command({.mode = ControlMode::kBrake});
  rig.run(1s);
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kBrake);
  EXPECT_NEAR(rig.shaftRpm(), 0.0, 5.0);
  rig.command({.mode = ControlMode::kCoast});
  rig.run(50ms);
  EXPECT_NEAR(rig.currentA(), 0.0, 1e-3);
}

TEST(MoteusClosedLoop, OutputUnitsHoldForEveryGearAndDirection) {
  for (const double own_ratio : {1.0, 0.1}) {
    for (const double behind : {1.0, 3.0}) {
      for (const int direction : {1, -1}) {
        auto settings = moteusMotor();
        settings.own.set("rotor_to_output_ratio", own_ratio);
        settings.gear_ratio = behind / own_ratio;
        settings.effort_limit = 0.0F;
        settings.direction = direction;
        settings.zero_at_power_on = true;
        Rig rig(settings);
        ASSERT_TRUE(rig.start());
        rig.command({.mode = ControlMode::kVelocity, .value = 120.0});
        rig.run(1s);
        EXPECT_NEAR(rig.shaftRpm(), 120.0 * direction, 3.0);
        EXPECT_NEAR(rig.motor().feedback().velocity_rpm, 120.0F, 4.0F);
        rig.command({.mode = ControlMode::kTotalAngle, .value = -200.0});
        rig.run(2s);
        EXPECT_NEAR(rig.motor().feedback().total_angle_deg, -200.0, 2.0);
        EXPECT_NEAR(rig.shaftDeg(), -200.0 * direction, 2.0);
        rig.command({.mode = ControlMode::kCurrent, .value = 2.0});
        rig.run(8ms);
        EXPECT_NEAR(rig.currentA(), 2.0 * direction, 0.3);
        EXPECT_NEAR(rig.motor().feedback().current_a, 2.0F, 0.4F);
      }
    }
  }
}

TEST(MoteusClosedLoop, AVelocityLimitBoundsTheWayToAnAngle) {
  auto settings = moteusMotor();
  settings.velocity_limit_rpm = 60.0F;
  Rig rig(settings);
  ASSERT_TRUE(rig.start());
  rig.command({.mode = ControlMode::kTotalAngle, .value = 360.0});
  double fastest_rpm = 0.0;
  rig.run(2s, [&] { fastest_rpm = std::max(fastest_rpm, std::abs(rig.shaftRpm())); });
  EXPECT_LT(fastest_rpm, 75.0);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 360.0, 3.0);
}

TEST(MoteusClosedLoop, AHeldShaftThatIsLetGoDoesNotRaceAfterItsTarget) {
  sim::MotorLoad stalled;
  stalled.stalled = true;
  Rig rig(moteusMotor(), stalled);
  ASSERT_TRUE(rig.start());
  rig.command({.mode = ControlMode::kVelocity, .value = 300.0});
  rig.run(2s);
  const double before_deg = rig.shaftDeg();
  rig.drive().setLoad({});
  rig.run(1s);
  // One second at the target speed, and the slip that is allowed.
  EXPECT_LT(rig.shaftDeg() - before_deg, 300.0 * 6.0 + 0.6 * 360.0);
  EXPECT_NEAR(rig.shaftRpm(), 300.0, 10.0);
}

TEST(MoteusClosedLoop, NoTransitionJumps) {
  Rig rig;
  ASSERT_TRUE(rig.start());
  // Turned by torque alone, then the same motor holds, damps and follows velocities from where it is.
  rig.command({.mode = ControlMode::kCurrent, .value = 1.0});
  rig.run(300ms);
  rig.motor().order(FrameKind::kDamp);
  rig.run(1s);
  EXPECT_NEAR(rig.shaftRpm(), 0.0, 5.0);
  const double at_deg = rig.shaftDeg();
  rig.command({.mode = ControlMode::kVelocity, .value = 0.0});
  rig.run(200ms);
  EXPECT_NEAR(rig.shaftDeg(), at_deg, 5.0);
  rig.motor().order(FrameKind::kHold);
  rig.run(500ms);
  EXPECT_NEAR(rig.shaftDeg(), at_deg, 5.0);
}

TEST(MoteusClosedLoop, AFaultIsReportedAndStaysUntilItIsCleared) {
  Rig rig;
  ASSERT_TRUE(rig.start());
  rig.command({.mode = ControlMode::kVelocity, .value = 100.0});
  rig.run(100ms);
  rig.stall(true);
  rig.run(50ms);
  ASSERT_GT(std::abs(rig.currentA()), 0.1);
  rig.drive().fault(35);
  rig.run(3ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveEncoder);
  EXPECT_EQ(rig.motor().complaint().native_code, 35U);
  rig.poll(100ms);
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kFault) << "polling does not clear it";
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveEncoder);
  EXPECT_NEAR(rig.currentA(), 0.0, 1e-3);
  rig.stall(false);
  EXPECT_FALSE(rig.enable());
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kFault) << "nor does enabling";

  rig.motor().clearComplaint();
  rig.poll();
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kStopped);
  ASSERT_TRUE(rig.enable());
  rig.command({.mode = ControlMode::kVelocity, .value = 100.0});
  rig.run(1s);
  EXPECT_NEAR(rig.shaftRpm(), 100.0, 5.0);
  rig.motor().order(FrameKind::kRest);
  rig.run(20ms);
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kStopped);
  EXPECT_NEAR(rig.currentA(), 0.0, 1e-3);
}

TEST(MoteusClosedLoop, ARestartIsNoticedAndTheDriveIsNotSwitchedOnAgain) {
  auto settings = moteusMotor();
  settings.zero_at_power_on = true;
  Rig rig(settings);
  ASSERT_TRUE(rig.start());
  rig.command({.mode = ControlMode::kVelocity, .value = 100.0});
  rig.run(500ms);
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  const double before_deg = rig.motor().feedback().total_angle_deg;
  rig.drive().restart();
  rig.run(50ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(rig.motor().feedback().zeroed);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, before_deg, 60.0) << "the angle goes on";
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kStopped);
  EXPECT_NEAR(rig.currentA(), 0.0, 1e-3);
  rig.poll();
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  EXPECT_TRUE(rig.enable());
}

TEST(MoteusClosedLoop, ARestartAtRestLosesTheReferenceToo) {
  auto settings = moteusMotor();
  settings.zero_at_power_on = true;
  Rig rig(settings);
  rig.poll(1s);
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  rig.drive().restart();
  rig.poll();
  EXPECT_FALSE(rig.motor().feedback().zeroed);
}

TEST(MoteusClosedLoop, AnAbsoluteDriveKnowsItsAngleAgainAfterARestart) {
  auto settings = moteusMotor();
  settings.own.set("absolute", 1.0);
  settings.zero_deg = 30.0;
  Rig rig(settings, {.initial_angle_deg = 75.0F});
  rig.poll(1s);
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 45.0, 0.1);
  rig.drive().restart();
  rig.poll();
  EXPECT_TRUE(rig.motor().feedback().zeroed);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, 45.0, 0.1);
}

TEST(MoteusClosedLoop, AnEncoderThatDoesNotKnowItsAngleIsNotTakenForAbsolute) {
  auto settings = moteusMotor();
  settings.own.set("absolute", 1.0);
  Rig rig(settings);
  rig.moteus().setHomeState(0);
  EXPECT_FALSE(rig.start());
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveSetting);
}

TEST(MoteusClosedLoop, OtherRegisterMapsAreRefused) {
  Rig rig;
  rig.moteus().setRegisterMapVersion(4);
  EXPECT_FALSE(rig.start());
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveSetting);
  EXPECT_EQ(rig.motor().complaint().native_code, 4U);
  rig.motor().clearComplaint();
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
}

// The firmware truncates a read: each of these comes back as one count less.
TEST(MoteusClosedLoop, AWatchdogThatIsReadBackTruncatedIsTheRightOne) {
  for (const double watchdog_ms : {63.0, 125.0, 126.0, 250.0, 252.0, 500.0, 504.0, 505.0, 509.0, 1000.0}) {
    auto settings = moteusMotor();
    settings.own.set("watchdog_ms", watchdog_ms);
    Rig rig(settings);
    EXPECT_TRUE(rig.start()) << watchdog_ms;
  }
}

// Source of these answers: mjbots/mjlib, mjlib/multiplex/micro_server.cc; mjbots/moteus,
// fw/moteus_controller.cc.
class Conversation {
 public:
  std::string ask(std::initializer_list<std::uint8_t> payload, std::uint32_t id = 0x8001) {
    CanFrame frame;
    frame.id = {id, id > kStandardIdMask};
    frame.fd = true;
    frame.length = roundUpFdLength(payload.size());
    std::fill_n(frame.data.begin(), frame.length, std::uint8_t{0x50});
    std::copy(payload.begin(), payload.end(), frame.data.begin());
    drive->receive(frame);
    std::array<CanFrame, sim::Drive::kMaxFrames> out{};
    if (drive->answers(out) == 0) return "silence";
    std::string text;
    for (const auto byte : out[0].payload()) {
      constexpr std::string_view kDigits = "0123456789ABCDEF";
      text += {kDigits[byte >> 4U], kDigits[byte & 15U]};
    }
    while (text.ends_with("50")) text.resize(text.size() - 2);
    return text;
  }
  void wait(Duration time) { drive->step(time); }

  std::unique_ptr<sim::Drive> drive = sim::makeMoteusDrive(moteusMotor(), {});
};

TEST(MoteusClosedLoop, AnAnswerIsGroupedAsItsQuestion) {
  Conversation drive;
  EXPECT_EQ(drive.ask({0x11, 0x00, 0x13, 0x0D}), "210000230D301900");
  EXPECT_EQ(drive.ask({0x10, 0x05, 0x0B}), "20050B0101301900");
  // 15 registers as floats: 63 bytes in one subframe, one too many with a head each.
  EXPECT_EQ(drive.ask({0x1C, 0x0F, 0x20}), "312E01") << "one of them is not there";
  EXPECT_EQ(drive.ask({0x1C, 0x0E, 0x20}).substr(0, 6), "2C0E20");
  EXPECT_EQ(drive.ask({0x1C, 0x0E, 0x20}).size(), 2U * (3U + 14U * 4U));
}

TEST(MoteusClosedLoop, ARegisterThatIsNotThereIsAnsweredWithAnError) {
  Conversation drive;
  EXPECT_EQ(drive.ask({0x11, 0x00, 0x11, 0x08, 0x11, 0x0F}), "210000310801")
      << "and what follows is not read";
  EXPECT_EQ(drive.ask({0x13, 0x07}), "310801") << "nor what was read of its subframe";
  EXPECT_EQ(drive.ask({0x11, 0x82, 0x02}), "31820201") << "the version is an int32";
  EXPECT_EQ(drive.ask({0x19, 0x82, 0x02}),
            "2982020500"
            "0000");
  EXPECT_EQ(drive.ask({0x01, 0x08, 0x00, 0x01, 0x01, 0x00}), "300801300102");
  EXPECT_EQ(drive.ask({0x01, 0x00, 0x0A}, 0x001), "silence") << "nobody asked for an answer";
}

TEST(MoteusClosedLoop, ItsCommandRegistersAreReadAsTheyWereWritten) {
  Conversation drive;
  EXPECT_EQ(drive.ask({0x14, 0x0E, 0x20}),
            "240E20"
            "0000"
            "0000"
            "0000"
            "FF7F"
            "FF7F"
            "1027"
            "0080"
            "0000"
            "0080"
            "0080"
            "0080"
            "FF7F"
            "0080"
            "0000");
  EXPECT_EQ(drive.ask({0x01, 0x00, 0x0D, 0x05, 0x46, 0x3F, 0x00, 0x15, 0x27}), "25273E00")
      << "63 ms truncated";
  EXPECT_EQ(drive.ask({0x05, 0x1C, 0x1E, 0x00, 0x15, 0x1C}), "251C1E00");
}

TEST(MoteusClosedLoop, ItsOtherModesAreTakenAndLeftLikePositionMode) {
  for (std::uint8_t mode = 5; mode <= 15; ++mode) {
    Conversation drive;
    drive.ask({0x01, 0x00, mode});
    drive.wait(20ms);
    if (mode == 11) continue;  // its watchdog's
    EXPECT_EQ(drive.ask({0x11, 0x00, 0x11, 0x0F}),
              std::string{"2100"} + "0" + "0123456789ABCDEF"[mode] + "210F00");
    drive.ask({0x01, 0x00, 0x0F});
    EXPECT_EQ(drive.ask({0x11, 0x00}), "21000F");
    drive.ask({0x01, 0x00, 0x00});
    EXPECT_EQ(drive.ask({0x11, 0x00}), "210000");
  }
}

TEST(MoteusClosedLoop, ItsCurrentModeGivesTheCurrentAndStayWithinPushesBack) {
  Conversation drive;
  drive.ask({0x01, 0x00, 0x09, 0x05, 0x1C, 0x1E, 0x00});  // 3 A
  drive.wait(20ms);
  EXPECT_NEAR(drive.drive->physics().currentA(), 3.0, 0.1);
  EXPECT_GT(drive.drive->physics().outputRpm(), 10.0);

  Conversation held;  // at 0, told to be within 1 and 2 turns; a watchdog of 2 s
  held.ask({0x01, 0x00, 0x0D, 0x06, 0x40, 0x10, 0x27, 0xFF, 0x7F, 0x05, 0x46, 0xD0, 0x07});
  held.wait(1s);
  EXPECT_NEAR(held.drive->physics().outputAngleDeg(), 360.0, 20.0);
  EXPECT_NEAR(held.drive->physics().outputRpm(), 0.0, 5.0);
  held.wait(2s);
  EXPECT_EQ(held.ask({0x11, 0x00}), "21000B") << "it is watched";
}

TEST(MoteusClosedLoop, ItsWatchdogTripsLatchesAndIsLeftByAStopAlone) {
  auto settings = moteusMotor();
  settings.own.set("watchdog_ms", 30.0);
  Rig rig(settings);
  ASSERT_TRUE(rig.start());
  rig.command({.mode = ControlMode::kVelocity, .value = 300.0});
  rig.run(500ms);
  rig.cut(true);
  rig.run(25ms);
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kPosition);
  rig.run(10ms);
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kTimeout);
  rig.run(1s);
  EXPECT_NEAR(rig.shaftRpm(), 0.0, 5.0);
  rig.cut(false);
  rig.run(2ms);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kDriveCommunication);
  EXPECT_EQ(rig.motor().complaint().native_code, 11U);
  rig.poll();
  EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kStopped);
  EXPECT_EQ(rig.motor().complaint().fault, FaultCode::kNone);
  EXPECT_TRUE(rig.enable());
}

TEST(MoteusClosedLoop, ADriveThatIsAlreadyTimedOutIsEnabled) {
  auto settings = moteusMotor();
  Rig rig(settings);
  ASSERT_TRUE(rig.start());
  rig.motor().order(FrameKind::kIdle);
  rig.run(10ms);
  rig.cut(true);
  rig.run(200ms);
  ASSERT_EQ(rig.moteus().mode(), moteus::Mode::kTimeout);
  rig.cut(false);
  EXPECT_TRUE(rig.enable());
}

TEST(MoteusClosedLoop, ASilentDriveFailsToEnable) {
  Rig rig;
  rig.poll();
  rig.cut(true);
  EXPECT_FALSE(rig.enable());
}

TEST(MoteusClosedLoop, RestTakesTheTorqueAwayWhateverTheState) {
  for (const auto mode : {ControlMode::kVelocity, ControlMode::kCurrent, ControlMode::kBrake}) {
    Rig rig;
    ASSERT_TRUE(rig.start());
    rig.command({.mode = ControlMode::kVelocity, .value = 200.0});
    rig.run(300ms);
    rig.command({.mode = mode, .value = mode == ControlMode::kCurrent ? 2.0 : 400.0});
    rig.run(10ms);
    ASSERT_GT(std::abs(rig.currentA()), 0.1) << "a torque, to speed it up or to brake it";
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    ASSERT_EQ(rig.motor().packRest(out), 1U);
    rig.drive().receive(out[0]);
    rig.drive().step(20ms);
    EXPECT_NEAR(rig.currentA(), 0.0, 1e-3);
    EXPECT_EQ(rig.moteus().mode(), moteus::Mode::kStopped);
  }
}

TEST(MoteusClosedLoop, AWheelRunsOnOverTheRangeOfThePositionRegister) {
  auto settings = moteusMotor();
  settings.own.set("motor_kv_rpm_per_v", 2000.0);
  settings.zero_at_power_on = true;
  Rig rig(settings);
  ASSERT_TRUE(rig.start());
  rig.command({.mode = ControlMode::kVelocity, .value = 29'000.0});
  rig.run(2s);
  double slowest_rpm = 29'000.0;
  rig.run(68s, [&] { slowest_rpm = std::min(slowest_rpm, rig.shaftRpm()); });
  ASSERT_GT(rig.shaftDeg(), 32'800.0 * 360.0);
  EXPECT_GT(slowest_rpm, 28'500.0);
  EXPECT_NEAR(rig.motor().feedback().total_angle_deg, rig.shaftDeg(), 360.0);
}

}  // namespace
}  // namespace rc10::test::moteus_closed_loop_test
