#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "motor/vesc_bench.hpp"

namespace rc10::test::vesc_feedback_test {
namespace {

using namespace vesc_bench;

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

TEST_F(VescMotorTest, ADutyIsOneOfNow) {
  auto& motor = makeZeroedAt(10.0);
  status(4200, 0.0, 0.7);
  steps(0);
  EXPECT_FLOAT_EQ(motor.reportedDuty(), 0.7F);
  for (int i = 0; i < 20; ++i) {  // STATUS_1 is missing
    tick(milliseconds{10});
    steps(0);
  }
  EXPECT_TRUE(std::isnan(motor.reportedDuty()));
  status(4200, 0.0, 0.7);
  EXPECT_FLOAT_EQ(motor.reportedDuty(), 0.7F);
  ASSERT_EQ(give(vescFrame(0x3907, "3630")), FrameVerdict::kAccepted);
  EXPECT_TRUE(std::isnan(motor.reportedDuty())) << "it has started again";
}

TEST_F(VescMotorTest, AnglesWithoutASpeedBesideThemAreNoFeedback) {
  auto& motor = makeZeroedAt(10.0);
  status(4200);
  steps(0);
  const auto samples = motor.feedback().samples;
  for (int i = 0; i < 20; ++i) {  // STATUS_1 is missing
    tick(milliseconds{10});
    steps(i);
  }
  EXPECT_LE(motor.feedback().samples, samples + 11) << "those within its patience";
  EXPECT_FALSE(motor.feedback().zeroed) << "turns cannot be counted meanwhile";
  status(4200);
  steps(20);
  EXPECT_GT(motor.feedback().samples, samples);
  EXPECT_TRUE(std::isfinite(motor.feedback().velocity_rpm));
}

TEST_F(VescMotorTest, AJumpOfTheTachometerIsCountedAndTheReferenceIsLost) {
  auto& motor = makeZeroedAt(10.0);
  tick(milliseconds{10});
  status(0);
  steps(5);
  EXPECT_EQ(motor.feedback().jumps, 1U);
  EXPECT_FALSE(motor.feedback().zeroed);
  EXPECT_NEAR(motor.feedback().total_angle_deg, 10.0, 1e-9);
}

TEST_F(VescMotorTest, ALongGapLosesTheReferenceWithoutAJump) {
  auto& motor = makeZeroedAt(10.0);
  tick(milliseconds{400});
  steps(3);
  EXPECT_EQ(motor.feedback().jumps, 0U);
  EXPECT_FALSE(motor.feedback().zeroed);
  EXPECT_NEAR(motor.feedback().total_angle_deg, 10.0, 1e-9);
}

TEST_F(VescMotorTest, ADriveThatStartsAgainWhileItIsToObeyComplains) {
  auto& motor = makeZeroedAt(10.0);
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
  std::uint64_t losses = 0;
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
    if (i == 0) reference_deg = feedback.total_angle_deg;
    if (std::exchange(losses, feedback.losses) != feedback.losses) {  // as a client that tells it anew
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

// At 50 Hz a shaft turns for 21 ms until the command that follows the next sample.
TEST_F(VescMotorTest, ANativePositionThatTheShaftMayPassByHalfATurnGivesWayToALowerSpeed) {
  struct Case {
    double rpm;
    double target_deg;
    vesc::Packet packet;
    std::int32_t raw;
    double divider = 1.0;
  };
  constexpr std::int32_t kSlowErpm = 1667;  // 30 degrees in 21 ms
  constexpr auto kPosition = vesc::Packet::kSetPosition;
  constexpr auto kSpeed = vesc::Packet::kSetErpm;
  for (const Case& c :
       {Case{400.0, -1000.0, kPosition, 280'000'000}, Case{500.0, -1000.0, kSpeed, kSlowErpm},
        Case{-500.0, 1000.0, kSpeed, -kSlowErpm}, Case{500.0, -1000.0, kPosition, 280'000'000, 5.0},
        Case{1100.0, 10.0, kPosition, 10'000'000}, Case{3000.0, 10.0, kSpeed, kSlowErpm},
        Case{1800.0, 1000.0, kPosition, 100'000'000}, Case{2000.0, 1000.0, kSpeed, kSlowErpm}}) {
    SCOPED_TRACE(std::to_string(c.rpm) + " rpm, to " + std::to_string(c.target_deg));
    auto settings = vescSettings({{"ask_status", 0.0}, {"angle", kEncoder}, {"position_divider", c.divider}});
    settings.feedback_hz = 50;
    make(settings);
    status(0);
    encoder(10.0);
    ASSERT_TRUE(motor_->setZero(10.0));
    status(static_cast<std::int32_t>(c.rpm * 7.0));
    EXPECT_NEAR(sent({.mode = ControlMode::kTotalAngle, .value = c.target_deg}), c.raw, 1);
    EXPECT_EQ(packet_, c.packet);
  }
}

}  // namespace
}  // namespace rc10::test::vesc_feedback_test
