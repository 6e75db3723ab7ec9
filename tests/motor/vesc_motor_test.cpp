#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "app/angle.hpp"
#include "bus/byte_order.hpp"
#include "drives/vesc/vesc_family.hpp"
#include "support/alloc_guard.hpp"
#include "support/vesc_motors.hpp"

namespace rc10::test::vesc_motor_test {
namespace {

using std::chrono::milliseconds;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const std::string kNone{"none"};
const std::string kEncoder{"encoder"};

/// One VESC, ticks and frames by hand.
class VescMotorTest : public ::testing::Test {
 protected:
  VESC_Motor& make(const MotorSettings& settings) {
    motor_ = std::make_unique<VESC_Motor>(settings);
    return *motor_;
  }
  VESC_Motor& makeWith(const std::vector<std::pair<std::string, OwnValues::Value>>& own = {}) {
    auto with = own;
    with.insert(with.begin(), {"ask_status", 0.0});
    return make(vescSettings(with));
  }
  std::vector<CanFrame> tick(Duration dt = milliseconds{1}) {
    tick_.now += dt;
    ++tick_.index;
    motor_->update(tick_);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_->packCommand(tick_, out);
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)};
  }
  FrameVerdict give(CanFrame frame) {
    frame.received = tick_.now;
    return motor_->matchesFrame(frame) ? motor_->updateFeedback(frame) : FrameVerdict::kMalformed;
  }
  void status(std::int32_t erpm, double current_a = 0.0, double duty = 0.0) {
    CanFrame frame = vescFrame(0x907, "0000000000000000");
    writeBigEndian<std::int32_t>(frame.data, 0, erpm);
    writeBigEndian<std::int16_t>(frame.data, 4, static_cast<std::int16_t>(std::lround(current_a * 10.0)));
    writeBigEndian<std::int16_t>(frame.data, 6, static_cast<std::int16_t>(std::lround(duty * 1000.0)));
    ASSERT_EQ(give(frame), FrameVerdict::kAccepted);
  }
  void steps(std::int32_t count) {
    CanFrame frame = vescFrame(0x1B07, "0000000000F00000");
    writeBigEndian<std::int32_t>(frame.data, 0, count);
    ASSERT_EQ(give(frame), FrameVerdict::kAccepted);
  }
  void encoder(double deg) {
    CanFrame frame = vescFrame(0x1007, "0000000000000000");
    writeBigEndian<std::int16_t>(frame.data, 6, static_cast<std::int16_t>(std::lround(deg * 50.0)));
    ASSERT_EQ(give(frame), FrameVerdict::kAccepted);
  }
  /// The command for this target in one tick: the raw value, and its packet.
  std::int32_t sent(const Target& target) {
    motor_->order(FrameKind::kCommand, target);
    return sent();
  }
  std::int32_t sent() {
    const auto frames = tick();
    EXPECT_EQ(frames.size(), 1U);
    if (frames.empty()) return 0;
    EXPECT_EQ(frames[0].length, 4);
    EXPECT_EQ(frames[0].id.value & 0xFFU, 7U);
    packet_ = static_cast<vesc::Packet>(frames[0].id.value >> 8U);
    return readBigEndian<std::int32_t>(frames[0].payload(), 0);
  }

  std::unique_ptr<VESC_Motor> motor_;
  Tick tick_{.index = 0, .now = MonotonicTime{std::chrono::hours{1}}};
  vesc::Packet packet_ = vesc::Packet::kPing;
};

TEST_F(VescMotorTest, AtFirstAndAtRestItSendsNoCurrent) {
  auto& motor = makeWith();
  EXPECT_EQ(sent(), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  std::array<CanFrame, 1> rest{};
  ASSERT_EQ(motor.packRest(rest), 1U);
  EXPECT_EQ(rest[0].id, (CanId{0x107, true}));
  EXPECT_EQ(rest[0].length, 4);
  EXPECT_EQ(rest[0].data, CanFrame{}.data);
}

TEST_F(VescMotorTest, EveryKindThatIsNoCommandSendsNoCurrent) {
  auto& motor = makeWith();
  ASSERT_TRUE(motor.setTarget({.mode = ControlMode::kCurrent, .value = 5.0}));
  for (const auto kind :
       {FrameKind::kRest, FrameKind::kPoll, FrameKind::kIdle, FrameKind::kEnable, FrameKind::kDisable}) {
    motor.order(kind);
    EXPECT_EQ(sent(), 0);
    EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  }
}

TEST_F(VescMotorTest, CurrentsGoThereAndBackOverTheWholeRange) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> amperes(-60.0, 60.0);
  makeWith();
  for (int i = 0; i < 1000; ++i) {
    const double a = amperes(random);
    EXPECT_NEAR(sent({.mode = ControlMode::kCurrent, .value = a}) / 1e3, a, 5.1e-4);
    EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  }
  makeWith({{"relative_current", 1.0}});
  for (int i = 0; i < 1000; ++i) {
    const double a = amperes(random);
    EXPECT_NEAR(sent({.mode = ControlMode::kCurrent, .value = a}) / 1e5 * 60.0, a, 1e-3);
    EXPECT_EQ(packet_, vesc::Packet::kSetCurrentRelative);
  }
}

TEST_F(VescMotorTest, VelocitiesGoThereAndBackBehindAGearAndADirection) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> rpm(-5000.0, 5000.0);
  auto settings = vescSettings({{"ask_status", 0.0}});
  settings.gear_ratio = 4.0;
  settings.direction = -1;
  auto& motor = make(settings);
  for (int i = 0; i < 1000; ++i) {
    const double wanted = rpm(random);
    const auto erpm = sent({.mode = ControlMode::kVelocity, .value = wanted});
    EXPECT_EQ(packet_, vesc::Packet::kSetErpm);
    EXPECT_EQ(erpm, std::lround(-wanted * 4.0 * 7.0));
    status(erpm);
    EXPECT_NEAR(static_cast<double>(motor.feedback().velocity_rpm), wanted, 0.02);
  }
}

TEST_F(VescMotorTest, WhatIsTooMuchIsBoundedAndTold) {
  auto settings = vescSettings({{"ask_status", 0.0}});
  settings.effort_limit = 20.0F;
  settings.velocity_limit_rpm = 1000.0F;
  auto& motor = make(settings);
  EXPECT_EQ(sent({.mode = ControlMode::kCurrent, .value = 1e300}), 20'000);
  EXPECT_EQ(motor.limits(), kLimitCurrent);
  EXPECT_EQ(sent({.mode = ControlMode::kVelocity, .value = -1e300}), -7000);
  EXPECT_EQ(motor.limits(), kLimitVelocity);
  EXPECT_EQ(sent({.mode = ControlMode::kDuty, .value = 7.0}), 100'000);
  motor.derate(0.5F);
  EXPECT_EQ(sent({.mode = ControlMode::kCurrent, .value = -50.0}), -10'000);
  EXPECT_EQ(sent({.mode = ControlMode::kCurrent, .value = 5.0}), 5000);
  EXPECT_EQ(motor.limits(), 0U);
}

TEST_F(VescMotorTest, AMotorThatMayHaveNoCurrentIsReleasedInEveryMode) {
  auto& motor = makeWith();
  motor.derate(0.0F);
  for (const auto mode :
       {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kDuty, ControlMode::kBrake}) {
    EXPECT_EQ(sent({.mode = mode, .value = 1.0}), 0);
    EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  }
}

TEST_F(VescMotorTest, AVelocityWithoutALimitSaturates) {
  makeWith();
  EXPECT_EQ(sent({.mode = ControlMode::kVelocity, .value = 1e300}), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(sent({.mode = ControlMode::kVelocity, .value = -1e300}),
            -std::numeric_limits<std::int32_t>::max());
}

TEST_F(VescMotorTest, NumbersThatAreNoneReleaseTheMotor) {
  for (const char* angle : {"tachometer", "encoder", "none"}) {
    makeWith({{"angle", std::string{angle}}});
    status(0);
    steps(0);
    encoder(10.0);
    for (const auto mode : {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kAngle,
                            ControlMode::kTotalAngle, ControlMode::kDuty}) {
      for (const double value : {kInfinity, -kInfinity, std::nan("")}) {
        EXPECT_EQ(sent({.mode = mode, .value = value}), 0) << angle;
        EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
      }
    }
  }
}

TEST_F(VescMotorTest, WhatAVelocityOfZeroMeansIsConfigured) {
  const Target zero{.mode = ControlMode::kVelocity, .value = 0.0};
  makeWith();
  EXPECT_EQ(sent(zero), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetErpm);
  makeWith({{"velocity_zero", std::string{"coast"}}});
  EXPECT_EQ(sent(zero), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  EXPECT_EQ(sent({.mode = ControlMode::kVelocity, .value = 0.0, .velocity_ff_rpm = 100.0F}), 0)
      << "a field that the mode does not use";
  makeWith({{"velocity_zero", std::string{"brake"}}, {"brake_current_a", 3.0}});
  EXPECT_EQ(sent(zero), 3000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
}

TEST_F(VescMotorTest, ABrakeWorksWithoutFeedbackAndWithinTheLimit) {
  auto settings = vescSettings({{"ask_status", 0.0}});
  settings.effort_limit = 4.0F;
  auto& motor = make(settings);
  motor.order(FrameKind::kBrake);
  EXPECT_EQ(sent(), 4000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
  EXPECT_EQ(motor.limits(), 0U);  // a brake at its limit at standstill is no stalled motor
  EXPECT_EQ(motor.commandUnit(), CommandUnit::kNative);
}

TEST_F(VescMotorTest, TheHandbrakeHoldsOnlyAtStandstill) {
  auto& motor = makeWith({{"angle", kNone}, {"handbrake_current_a", 6.0}});
  EXPECT_EQ(motor.driveFrames().hold, Provision::kFrame);
  motor.order(FrameKind::kHold);
  status(3000);
  EXPECT_EQ(sent(), 10'000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
  status(100);
  EXPECT_EQ(sent(), 6000);
  EXPECT_EQ(packet_, vesc::Packet::kSetHandbrake);
  status(300);  // it trembles
  EXPECT_EQ(sent(), 6000);
  EXPECT_EQ(packet_, vesc::Packet::kSetHandbrake);
  status(1000);  // it is dragged along
  EXPECT_EQ(sent(), 10'000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
  status(0);
  tick(milliseconds{500});  // who knows
  EXPECT_EQ(sent(), 10'000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
}

TEST_F(VescMotorTest, DampBrakesInProportionToTheSpeedAndNeedsAKv) {
  EXPECT_EQ(makeWith().driveFrames().damp, Provision::kUnsupported);
  auto& motor = makeWith({{"kv_rpm_per_v", 100.0}});
  EXPECT_EQ(motor.driveFrames().damp, Provision::kHostLoop);
  motor.order(FrameKind::kDamp);
  EXPECT_EQ(sent(), 0);  // no feedback yet
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
  status(-8400);  // 1200 of 2400 rpm
  steps(0);
  EXPECT_EQ(sent(), 30'000);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrentBrake);
}

TEST_F(VescMotorTest, TheSignOfTheCurrentIsThatOfTheTorque) {
  auto settings = vescSettings({{"ask_status", 0.0}, {"kv_rpm_per_v", 82.7}});
  auto& motor = make(settings);
  status(5000, 8.0, 0.4);  // drives forwards
  EXPECT_FLOAT_EQ(motor.feedback().current_a, 8.0F);
  EXPECT_NEAR(motor.feedback().torque_nm, 0.8F, 0.001F);
  status(5000, -8.0, 0.3);  // brakes while it turns forwards
  EXPECT_FLOAT_EQ(motor.feedback().current_a, -8.0F);
  status(-5000, 8.0, -0.4);  // drives backwards
  EXPECT_FLOAT_EQ(motor.feedback().current_a, -8.0F);
  status(-12345, -15.7, -0.432);  // brakes while it turns backwards
  EXPECT_FLOAT_EQ(motor.feedback().current_a, 15.7F);
  status(-70, 3.0, 0.0);  // a duty too small to be told
  EXPECT_FLOAT_EQ(motor.feedback().current_a, -3.0F);
  settings.direction = -1;
  auto& reversed = make(settings);
  status(5000, 8.0, 0.4);
  EXPECT_FLOAT_EQ(reversed.feedback().current_a, -8.0F);
  EXPECT_LT(reversed.feedback().velocity_rpm, 0.0F);
}

TEST_F(VescMotorTest, TheTachometerCountsTurnsThroughTheEndOfItsRange) {
  auto settings = vescSettings({{"ask_status", 0.0}});
  settings.gear_ratio = 2.0;
  settings.zero_at_power_on = true;
  auto& motor = make(settings);
  status(42'000);  // 6000 rpm: 42 steps in 10 ms
  steps(std::numeric_limits<std::int32_t>::max() - 20);
  tick(milliseconds{10});
  status(42'000);
  steps(std::numeric_limits<std::int32_t>::min() + 21);
  EXPECT_NEAR(motor.feedback().total_angle_deg, 180.0, 1e-6);
  EXPECT_TRUE(motor.feedback().zeroed);
  EXPECT_EQ(motor.feedback().jumps, 0U);
}

TEST_F(VescMotorTest, AJumpOfTheTachometerIsCountedAndTheReferenceIsLost) {
  auto& motor = makeWith();
  status(0);
  steps(1000);
  ASSERT_TRUE(motor.setZero(10.0));
  tick(milliseconds{10});
  status(0);
  steps(5);
  EXPECT_EQ(motor.feedback().jumps, 1U);
  EXPECT_FALSE(motor.feedback().zeroed);
  EXPECT_NEAR(motor.feedback().total_angle_deg, 10.0, 1e-9);
}

TEST_F(VescMotorTest, ALongGapLosesTheReferenceWithoutAJump) {
  auto& motor = makeWith();
  status(0);
  steps(1000);
  ASSERT_TRUE(motor.setZero(10.0));
  tick(milliseconds{400});
  steps(3);
  EXPECT_EQ(motor.feedback().jumps, 0U);
  EXPECT_FALSE(motor.feedback().zeroed);
  EXPECT_NEAR(motor.feedback().total_angle_deg, 10.0, 1e-9);
}

TEST_F(VescMotorTest, ADriveThatStartsAgainWhileItIsToObeyComplains) {
  auto& motor = makeWith();
  status(0);
  steps(1000);
  ASSERT_TRUE(motor.setZero(10.0));
  motor.order(FrameKind::kRest);
  tick();
  ASSERT_EQ(give(vescFrame(0x3907, "3630")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kNone);  // nobody cares
  EXPECT_FALSE(motor.feedback().zeroed);
  motor.order(FrameKind::kCommand);
  tick();
  ASSERT_EQ(give(vescFrame(0x3907, "3630")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kDriveStopped);
  motor.order(FrameKind::kRest);
  tick();
  motor.order(FrameKind::kCommand);
  tick();
  EXPECT_EQ(motor.complaint().fault, FaultCode::kNone);
  steps(0);
  EXPECT_NEAR(motor.feedback().total_angle_deg, 10.0, 1e-9);
}

TEST_F(VescMotorTest, TheEncoderIsAbsoluteAndCountsTurns) {
  auto settings = vescSettings({{"ask_status", 0.0}, {"angle", kEncoder}});
  settings.zero_deg = 100.0;
  auto& motor = make(settings);
  status(21'000);  // 3000 rpm: 180 deg in 10 ms
  encoder(190.0);
  EXPECT_TRUE(motor.feedback().zeroed);
  EXPECT_NEAR(motor.feedback().total_angle_deg, 90.0, 0.02);
  for (int i = 1; i <= 4; ++i) {
    tick(milliseconds{10});
    status(21'000);
    encoder(wrapDegrees(190.0 + 180.0 * i));
  }
  EXPECT_NEAR(motor.feedback().total_angle_deg, 90.0 + 720.0, 0.05);
  EXPECT_TRUE(motor.feedback().zeroed);
}

/// Turns of an encoder at a steady speed of the rotor, 500 Hz, one of 20 frames lost, each stamped up to
/// `late` after it was sent.
struct Counted {
  double off_deg = 0.0;  ///< Largest, while the reference was known.
  int losses = 0;
};
Counted countTurns(double rotor_rpm, std::chrono::microseconds late, unsigned seed) {
  auto settings = vescSettings({{"ask_status", 0.0}, {"angle", kEncoder}});
  settings.feedback_hz = 500;
  VESC_Motor motor(settings);
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int64_t> wait_us(0, late.count());
  std::uniform_int_distribution<int> lottery(1, 20);
  Counted counted;
  MonotonicTime received{std::chrono::hours{1}};
  const MonotonicTime begin = received;
  double reference_deg = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const MonotonicTime sent = begin + i * milliseconds{2};
    received = std::max(received, sent + std::chrono::microseconds{wait_us(random)});
    if (i > 0 && lottery(random) == 1) continue;
    CanFrame speed = vescFrame(0x907, "0000000000000000");
    writeBigEndian<std::int32_t>(speed.data, 0, static_cast<std::int32_t>(std::lround(rotor_rpm * 7.0)));
    speed.received = received;
    EXPECT_EQ(motor.updateFeedback(speed), FrameVerdict::kAccepted);
    const double deg = rotor_rpm * kDegPerSPerRpm * 0.002 * i;
    CanFrame angle = vescFrame(0x1007, "0000000000000000");
    const double within_deg = deg - 360.0 * std::floor(deg / 360.0);
    writeBigEndian<std::int16_t>(angle.data, 6, static_cast<std::int16_t>(std::lround(within_deg * 50.0)));
    angle.received = received;
    EXPECT_EQ(motor.updateFeedback(angle), FrameVerdict::kAccepted);
    const auto& feedback = motor.feedback();
    if (i == 0) {
      reference_deg = feedback.total_angle_deg;
      // Unless it follows an angle, it takes the one within a turn again.
      motor.order(FrameKind::kCommand, {.mode = ControlMode::kTotalAngle});
      motor.update(Tick{});
    }
    if (!feedback.zeroed) {  // as a client that tells it anew
      ++counted.losses;
      EXPECT_TRUE(motor.setZero(reference_deg + deg));
    }
    counted.off_deg = std::max(counted.off_deg, std::abs(feedback.total_angle_deg - reference_deg - deg));
  }
  return counted;
}

TEST(VescEncoder, StampsThatAreLateCostNoTurn) {
  for (const double rpm : {0.0, 100.0, 3000.0, -5000.0, 12'000.0, -20'000.0, 30'000.0, 45'000.0}) {
    for (const unsigned seed : {1U, 2U, 3U}) {
      const auto counted = countTurns(rpm, std::chrono::microseconds{1900}, seed);
      EXPECT_LT(counted.off_deg, 1.0) << rpm;
      // Turns of a whole period: nobody could tell one period from two.
      if (std::abs(rpm) < 25'000.0) {
        EXPECT_EQ(counted.losses, 0) << rpm;
      }
    }
  }
  EXPECT_GT(countTurns(30'000.0, std::chrono::microseconds{1900}, 1).losses, 0) << "it is told";
}

TEST_F(VescMotorTest, ANativePositionGoesTheWayThatIsMeantOverTurns) {
  makeWith({{"angle", kEncoder}});
  status(0);
  encoder(300.0);                                                                   // reads -60
  EXPECT_EQ(sent({.mode = ControlMode::kTotalAngle, .value = 700.0}), 30'000'000);  // 90 deg ahead
  EXPECT_EQ(packet_, vesc::Packet::kSetPosition);
  EXPECT_EQ(sent({.mode = ControlMode::kTotalAngle, .value = -700.0}), 210'000'000);
  EXPECT_EQ(sent({.mode = ControlMode::kAngle, .value = 310.0}), 310'000'000);
  tick(milliseconds{300});
  EXPECT_EQ(sent({.mode = ControlMode::kAngle, .value = 310.0}), 0);  // no fresh feedback
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
}

TEST_F(VescMotorTest, OnlyAnAngleLoopOnTheHostTakesOtherGains) {
  EXPECT_EQ(makeWith({{"angle", kEncoder}}).hostLoops(), nullptr);
  auto& motor = makeWith();
  ASSERT_NE(motor.hostLoops(), nullptr);
  auto loops = *motor.hostLoops();
  loops.angle.kp *= 2.0F;
  motor.retune(loops);
  EXPECT_EQ(motor.hostLoops()->angle.kp, loops.angle.kp);
  status(0);
  steps(0);
  EXPECT_EQ(sent({.mode = ControlMode::kTotalAngle, .value = 40.0}), 840);  // 3 rpm per degree
}

TEST_F(VescMotorTest, TheAngleLoopGivesSpeedsAndStopsWithoutFeedback) {
  auto& motor = makeWith();
  status(0);
  steps(0);
  EXPECT_EQ(sent({.mode = ControlMode::kTotalAngle, .value = 40.0}), 420);  // 1.5 rpm per degree
  status(0);
  steps(0);
  tick();
  status(0);
  steps(0);
  // sqrt(2 * 0.5 * 25000 / 7 * 6 * 1e5) deg/s, from where the drive's ramp can still stop it
  EXPECT_NEAR(sent({.mode = ControlMode::kTotalAngle, .value = 1e5}), 54'006, 10);
  EXPECT_EQ(packet_, vesc::Packet::kSetErpm);
  motor.order(FrameKind::kHold);
  EXPECT_EQ(sent(), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetErpm);
  tick(milliseconds{200});
  EXPECT_EQ(sent({.mode = ControlMode::kTotalAngle, .value = 40.0}), 0);
  EXPECT_EQ(packet_, vesc::Packet::kSetCurrent);
}

TEST_F(VescMotorTest, FramesOfOthersAndBrokenOnesAreRefused) {
  auto& motor = make(vescSettings());
  auto good = vescFrame(0x907, "FFFFCFC7FF63FE50");
  EXPECT_TRUE(motor.matchesFrame(good));
  auto other = good;
  other.id.value = 0x908;
  EXPECT_FALSE(motor.matchesFrame(other));
  other = good;
  other.id.extended = false;
  EXPECT_FALSE(motor.matchesFrame(other));
  other = good;
  other.fd = true;
  EXPECT_FALSE(motor.matchesFrame(other));
  other = good;
  other.type = FrameType::kRemote;
  EXPECT_FALSE(motor.matchesFrame(other));
  good.length = 7;
  EXPECT_EQ(motor.updateFeedback(good), FrameVerdict::kMalformed);
  EXPECT_EQ(give(vescFrame(0x8FD, "08013200008000FF")), FrameVerdict::kMalformed);  // another drive's answer
  EXPECT_EQ(give(vescFrame(0x8FD, "0701320000800000")), FrameVerdict::kAccepted);
  EXPECT_EQ(give(vescFrame(0x8FD, "0701330000800000")), FrameVerdict::kMalformed);
  EXPECT_EQ(give(vescFrame(0x8FD, "07013200")), FrameVerdict::kMalformed);
  EXPECT_EQ(motor.feedback().samples, 0U);
}

TEST_F(VescMotorTest, FaultsAreToldWithTheirNativeCode) {
  auto& motor = make(vescSettings());
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320000800006")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kDriveMotorTooHot);
  EXPECT_EQ(motor.complaint().native_code, 6U);
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320000800000")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kNone);
  EXPECT_EQ(vescFault(2), FaultCode::kDriveUnderVoltage);
  EXPECT_EQ(vescFault(31), FaultCode::kDriveLimit);
  EXPECT_EQ(vescFault(34), FaultCode::kDriveOther);
}

TEST_F(VescMotorTest, TheKillSwitchAndADeafDriveAreComplaints) {
  auto& motor = make(vescSettings());
  motor.order(FrameKind::kCommand);
  tick();
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320020000002")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kDriveStopped);
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320020000001")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kNone);  // it may not have heard us yet
  tick(milliseconds{400});
  ASSERT_EQ(give(vescFrame(0x8FD, "0701320020000001")), FrameVerdict::kAccepted);
  EXPECT_EQ(motor.complaint().fault, FaultCode::kDriveCommunication);
}

TEST_F(VescMotorTest, EnablingADriveThatDoesNotAnswerFails) {
  auto& motor = make(vescSettings());
  motor.order(FrameKind::kEnable);
  for (int i = 0; i < 499 && motor.sequenceProgress() != SequenceProgress::kFailed; ++i) tick();
  EXPECT_EQ(motor.sequenceProgress(), SequenceProgress::kFailed);
  motor.order(FrameKind::kRest);
  tick();
  motor.order(FrameKind::kEnable);
  tick();
  EXPECT_EQ(motor.sequenceProgress(), SequenceProgress::kPending);  // anew
}

TEST_F(VescMotorTest, TicksAndFramesAllocateNothing) {
  auto& motor = make(vescSettings());
  motor.order(FrameKind::kCommand, {.mode = ControlMode::kTotalAngle, .value = 100.0});
  const AllocGuard guard;
  std::array<CanFrame, kMaxFramesPerPacker> out{};
  for (int i = 0; i < 1000; ++i) {
    tick_.now += milliseconds{1};
    ++tick_.index;
    auto frame = vescFrame(0x1B07, "00");
    frame.length = 8;
    frame.received = tick_.now;
    (void)motor.updateFeedback(frame);
    motor.update(tick_);
    (void)motor.packCommand(tick_, out);
  }
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST_F(VescMotorTest, CommandsKeepTheirRhythm) {
  auto settings = vescSettings({{"ask_status", 0.0}});
  settings.command_divider = 10;
  settings.command_phase = 3;
  make(settings);
  int count = 0;
  for (int i = 0; i < 100; ++i) {
    const auto frames = tick();
    count += static_cast<int>(frames.size());
    EXPECT_EQ(frames.empty(), tick_.index % 10 != 3);
  }
  EXPECT_EQ(count, 10);
}

TEST(VescFamily, EveryKeyHasANameAndWords) {
  for (const FamilyKey& key : vescFamily().keys()) {
    EXPECT_FALSE(key.name.empty());
    EXPECT_FALSE(key.about.empty()) << key.name;
    EXPECT_TRUE(key.required || !key.default_text.empty()) << key.name;
  }
}

TEST(VescFamily, ImpossibleSettingsAreRefusedWithTheirKey) {
  auto settings = vescSettings();
  EXPECT_TRUE(vescFamily().check(settings));
  settings.feedback_hz = 20;
  EXPECT_EQ(vescFamily().check(settings).error().message.find("feedback_hz: "), 0U);
  settings = vescSettings({{"host_id", 7.0}});
  EXPECT_EQ(vescFamily().check(settings).error().message.find("host_id: "), 0U);
  settings = vescSettings({{"handbrake_current_a", 5.0}});
  EXPECT_EQ(vescFamily().check(settings).error().message.find("handbrake_current_a: "), 0U);
}

TEST(VescFamily, TheModesFollowFromTheSourceOfTheAngle) {
  const auto& family = vescFamily();
  EXPECT_TRUE(family.traits("VESC", vescSettings().own).modes.contains(ControlMode::kTotalAngle));
  EXPECT_FALSE(
      family.traits("VESC", vescSettings({{"angle", kNone}}).own).modes.contains(ControlMode::kAngle));
  EXPECT_TRUE(family.traits("VESC", vescSettings({{"angle", kEncoder}}).own).absolute);
  EXPECT_EQ(family.traits("VESC", vescSettings({{"angle", kEncoder}}).own).host_loops, nullptr);
}

TEST(VescFamily, TellsWhatTheDriveSendsAndObeys) {
  const auto use = vescFamily().busUse(vescSettings());
  const auto obeys = [&use](CanFrame frame) {
    return std::any_of(use.obeys.begin(), use.obeys.end(),
                       [&](const auto& filter) { return accepts(filter, frame); });
  };
  EXPECT_TRUE(obeys(vesc::makeCommand(vesc::Packet::kSetErpm, 7, 0)));
  EXPECT_TRUE(obeys(vesc::makeCommand(vesc::Packet::kSetErpm, 255, 0)));
  EXPECT_FALSE(obeys(vesc::makeCommand(vesc::Packet::kSetErpm, 8, 0)));
  EXPECT_FALSE(obeys(vescFrame(0x10007, "00000000")));
  EXPECT_EQ(use.sends.size(), 8U);
}

TEST(VescFamily, SeveralDrivesShareABusAndTheHostId) {
  auto bus = fdCANbus::adopt("can0", UniqueFd{}, false);
  BusParts parts(*bus);
  auto first = vescFamily().build(vescSettings(), parts);
  ASSERT_TRUE(first) << first.error().message;
  auto settings = vescSettings();
  settings.name = "other";
  settings.id = 8;
  auto second = vescFamily().build(settings, parts);
  ASSERT_TRUE(second) << second.error().message;
  settings.name = "third";
  EXPECT_FALSE(vescFamily().build(settings, parts));
}

}  // namespace
}  // namespace rc10::test::vesc_motor_test
