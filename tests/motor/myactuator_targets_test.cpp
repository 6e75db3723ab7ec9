#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motor/myactuator_bench.hpp"

namespace rc10::test::myactuator_targets_test {
namespace {

using namespace myactuator_bench;

TEST_F(MyActuatorMotor, TargetsBecomeTheDrivesOwnCommands) {
  comeOnline(1000);
  ASSERT_TRUE(motor_.setZero(0.0));
  EXPECT_EQ(told({.mode = ControlMode::kCurrent, .value = -1.0}), "141#A10000009CFF0000");
  EXPECT_EQ(told({.mode = ControlMode::kVelocity, .value = -100.0 / 6.0}), "141#A2000000F0D8FFFF");
  EXPECT_EQ(told({.mode = ControlMode::kTotalAngle, .value = 350.0}), "141#A400FFFFA08C0000");
  EXPECT_EQ(told({.mode = ControlMode::kAngle, .value = 350.0}), "141#A400FFFF00000000") << "the short way";
  EXPECT_EQ(told({.mode = ControlMode::kBrake}), "141#A200000000000000");
  EXPECT_EQ(told({.mode = ControlMode::kCoast}), "141#A100000000000000");
  EXPECT_THAT(told({.mode = ControlMode::kImpedance, .stiffness_nm_per_rad = 5.0F}), StartsWith("401#"));
  motor_.order(FrameKind::kIdle);
  EXPECT_EQ(tick().at(0), "141#A100000000000000");
  motor_.order(FrameKind::kBrake);
  EXPECT_EQ(tick().at(0), "141#A200000000000000");
  motor_.order(FrameKind::kHold);
  EXPECT_EQ(tick().at(0), "141#A400FFFFE8030000") << "where it is";
  motor_.order(FrameKind::kDamp);
  EXPECT_THAT(tick().at(0), StartsWith("401#"));
}

TEST_F(MyActuatorMotor, TheAngleIsAskedForWithEveryCommandOrEveryNth) {
  MotorSettings settings = settingsOf();
  settings.own.set("angle_divider", 4.0);
  MyActuator_Motor slow = motorOf(settings);
  EXPECT_EQ(slow.feedbackPeriod(), std::chrono::milliseconds{4});
  slow.order(FrameKind::kPoll);
  int asked = 0;
  for (int i = 0; i < 100; ++i) {
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    slow.update(tick);
    std::array<CanFrame, 4> out{};
    const auto count = slow.packCommand(tick, out);
    for (std::size_t n = 0; n < count; ++n) asked += out[n].data[0] == 0x92 ? 1 : 0;
  }
  EXPECT_EQ(asked, 25);
}

TEST_F(MyActuatorMotor, NothingIsSentBetweenItsTurns) {
  MotorSettings settings = settingsOf();
  settings.command_divider = 4;
  settings.command_phase = 1;
  MyActuator_Motor slow = motorOf(settings);
  slow.order(FrameKind::kRest);
  std::array<CanFrame, 4> out{};
  for (std::uint64_t i = 0; i < 16; ++i) {
    const Tick tick{.index = i, .now = now_, .dt_s = 0.001F};
    slow.update(tick);
    EXPECT_EQ(slow.packCommand(tick, out), i % 4 == 1 ? 1U : 0U);
  }
}

TEST_F(MyActuatorMotor, LimitsBoundWhatIsSentAndSaySo) {
  MotorSettings settings = settingsOf();
  settings.effort_limit = 2.0F;
  settings.velocity_limit_rpm = 50.0F;
  MyActuator_Motor bounded = motorOf(settings);
  for (CanFrame frame : {uptimeReply(1000), angleReply(1000)}) {
    frame.received = now_;
    (void)bounded.updateFeedback(frame);
  }
  const auto send = [&](const Target& target) {
    bounded.order(FrameKind::kCommand, target);
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    bounded.update(tick);
    std::array<CanFrame, 4> out{};
    (void)bounded.packCommand(tick, out);
    return textOf(out[0]);
  };
  EXPECT_EQ(send({.mode = ControlMode::kCurrent, .value = 1e9}), "141#A1000000C8000000");
  EXPECT_EQ(bounded.limits(), kLimitCurrent);
  EXPECT_EQ(send({.mode = ControlMode::kVelocity, .value = -1e9}), "141#A2000000D08AFFFF");
  EXPECT_EQ(bounded.limits(), kLimitVelocity);
  EXPECT_EQ(send({.mode = ControlMode::kTotalAngle, .value = 1e300}), "141#A4002C01FFFFFF7F");
  EXPECT_EQ(bounded.limits(), kLimitAngle);
  bounded.derate(0.5F);
  EXPECT_EQ(send({.mode = ControlMode::kCurrent, .value = -5.0}), "141#A10000009CFF0000");
  bounded.derate(0.0F);
  EXPECT_EQ(send({.mode = ControlMode::kVelocity, .value = 10.0}), "141#A100000000000000")
      << "no loop of the drive when no torque is allowed";
}

TEST_F(MyActuatorMotor, NonFiniteAndHugeTargetsAreHarmless) {
  comeOnline(1000);
  for (const double value : {std::nan(""), kInfinity, -kInfinity, 1e300, -1e300}) {
    for (int mode = 0; mode < kControlModeCount; ++mode) {
      Target target{.mode = static_cast<ControlMode>(mode), .value = value};
      target.velocity_ff_rpm = static_cast<float>(value);
      target.torque_ff_nm = static_cast<float>(value);
      target.stiffness_nm_per_rad = static_cast<float>(value);
      target.damping_nms_per_rad = static_cast<float>(value);
      const std::string frame = told(target);
      EXPECT_EQ(frame.size(), 20U);
      EXPECT_FALSE(std::isnan(motor_.commandValue())) << mode;
    }
  }
}

TEST_F(MyActuatorMotor, ASpeedThatItsFieldCannotSayIsCutBeforeTheTorqueIsBounded) {
  comeOnline(100);
  hear(frameOf("241#A132000000000000"));
  ASSERT_TRUE(motor_.setZero(0.0));
  motor_.order(FrameKind::kCommand, {.mode = ControlMode::kImpedance,
                                     .value = -54.0,
                                     .velocity_ff_rpm = 900.0F,
                                     .stiffness_nm_per_rad = 100.0F,
                                     .damping_nms_per_rad = 1.0F});
  (void)tick();
  EXPECT_NE(motor_.limits() & kLimitVelocity, 0U);
  EXPECT_NE(motor_.limits() & kLimitCurrent, 0U) << "spring and damper do not balance any more";
}

TEST_F(MyActuatorMotor, ATargetBeyondItsRangeOfAnglesOnlyDamps) {
  comeOnline(100);
  hear(frameOf("241#A132000000000000"));
  ASSERT_TRUE(motor_.setZero(0.0));
  const Target far{.mode = ControlMode::kImpedance, .value = 1000.0, .stiffness_nm_per_rad = 10.0F};
  auto pushed = far;
  pushed.velocity_ff_rpm = 60.0F;
  pushed.torque_ff_nm = 2.0F;
  EXPECT_EQ(told(pushed), told(far));
  EXPECT_NE(motor_.limits() & kLimitAngle, 0U);
  EXPECT_EQ(motor_.commandValue(), 0.0F);
}

// Neither the end of the field nor the limit of what is commanded is that of its loops.
TEST_F(MyActuatorMotor, ALoopOfTheDriveIsAtItsOwnLimitOnlyWhereThatIsKnown) {
  for (const float own_limit_a : {0.0F, 3.0F}) {
    MotorSettings settings = settingsOf();
    settings.effort_limit = 1.0F;
    settings.own_limit_a = own_limit_a;
    MyActuator_Motor motor = motorOf(settings);
    const auto limitsAt = [&](const char* answer, ControlMode mode) {
      for (CanFrame frame : {uptimeReply(1000), angleReply(1000), frameOf(answer)}) {
        frame.received = now_;
        (void)motor.updateFeedback(frame);
      }
      motor.order(FrameKind::kCommand, {.mode = mode, .value = 10.0});
      now_ += std::chrono::milliseconds{1};
      motor.update({.index = ++ticks_, .now = now_, .dt_s = 0.001F});
      return motor.limits() & kLimitCurrent;
    };
    const auto at_limit = own_limit_a > 0.0F ? kLimitCurrent : 0U;
    for (const auto mode : {ControlMode::kVelocity, ControlMode::kTotalAngle}) {
      SCOPED_TRACE(toString(mode));
      EXPECT_EQ(limitsAt("241#A21EC80000000000", mode), 0U) << "2 A";
      EXPECT_EQ(limitsAt("241#A21E220100000000", mode), at_limit) << "2.9 A";
      motor.derate(0.5F);
      EXPECT_EQ(limitsAt("241#A21EC80000000000", mode), 0U) << "2 A, derated";
      EXPECT_EQ(limitsAt("241#A21EDEFE00000000", mode), at_limit) << "-2.9 A, derated";
      motor.derate(1.0F);
    }
  }
}

MotorSettings ofOneAmpere() {
  auto settings = settingsOf();
  settings.effort_limit = 1.0F;  // 3.125 N·m
  return settings;
}

class MyActuatorOfOneAmpere : public MyActuatorMotor {
 protected:
  MyActuatorOfOneAmpere() : MyActuatorMotor(ofOneAmpere()) {}
};

// Field of the speed in motion answers: cut off at 45 rad/s.
TEST_F(MyActuatorOfOneAmpere, AShaftFasterThanItsMotionFieldIsDampedWithinTheLimit) {
  comeOnline(0);
  const auto fast = frameOf("501#017FFFFFF8000000");
  double damping = 0.0;
  for (int i = 1; i < 60; ++i) {
    hear(fast);
    hear(angleReply(static_cast<std::int32_t>(std::lround(i * 60e-3 * kDegPerRad * 100.0))));  // 60 rad/s
    const auto text = told({.mode = ControlMode::kImpedance, .damping_nms_per_rad = 2.0F});
    damping = std::stoi(text.substr(4 + 10, 3), nullptr, 16) * 5.0 / 4095.0;
  }
  EXPECT_GT(damping, 0.0);
  EXPECT_LE(60.0 * damping, 3.125 * 1.03);
}

TEST_F(MyActuatorMotor, TheTorqueIsBoundedByTheAngleOfItsMotionAnswers) {
  MyActuator_Motor motor = motorOf(ofOneAmpere());
  for (CanFrame frame : {uptimeReply(1000), angleReply(1)}) {
    frame.received = now_;
    (void)motor.updateFeedback(frame);
  }
  (void)motor.setZero(0.0);
  // A push has moved it by 0.2 rad since.
  auto answer = frameOf("501#01820C8008000000");
  answer.received = now_;
  (void)motor.updateFeedback(answer);
  motor.order(FrameKind::kCommand, {.mode = ControlMode::kImpedance, .stiffness_nm_per_rad = 100.0F});
  const Tick tick{.index = 1, .now = now_ + std::chrono::milliseconds{1}, .dt_s = 0.001F};
  motor.update(tick);
  std::array<CanFrame, 4> out{};
  (void)motor.packCommand(tick, out);
  const auto& d = out[0].data;
  ASSERT_EQ(out[0].id.value, 0x401U);
  EXPECT_LE(((d[3] & 0xF) << 8 | d[4]) * 500.0 / 4095.0 * 0.2, 3.3);
  EXPECT_NE(motor.limits() & kLimitCurrent, 0U);
}

TEST_F(MyActuatorMotor, ImpedanceNeverAsksForMoreTorqueThanTheLimitAllows) {
  MotorSettings settings = settingsOf();
  settings.effort_limit = 1.0F;  // 3.125 N·m
  MyActuator_Motor soft = motorOf(settings);
  std::mt19937 random(7);  // NOLINT: the same numbers every time
  std::uniform_real_distribution<double> angle(-700.0, 700.0);
  std::uniform_real_distribution<double> gain(0.0, 1000.0);
  std::uniform_real_distribution<double> torque(-100.0, 100.0);
  for (int i = 0; i < 2000; ++i) {
    const auto raw = static_cast<std::int32_t>(angle(random) * 100.0);
    for (CanFrame frame : {uptimeReply(static_cast<std::uint32_t>(1000 + i)), angleReply(raw | 1)}) {
      frame.received = now_;
      (void)soft.updateFeedback(frame);
    }
    (void)soft.setZero((raw | 1) * 0.01);
    soft.order(FrameKind::kCommand, {.mode = ControlMode::kImpedance,
                                     .value = angle(random),
                                     .torque_ff_nm = static_cast<float>(torque(random)),
                                     .stiffness_nm_per_rad = static_cast<float>(gain(random)),
                                     .damping_nms_per_rad = 0.0F});
    now_ += std::chrono::milliseconds{1};
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    soft.update(tick);
    std::array<CanFrame, 4> out{};
    (void)soft.packCommand(tick, out);
    ASSERT_EQ(out[0].id.value, 0x401U);
    const auto& d = out[0].data;
    const double p = (d[0] << 8 | d[1]) * 25.0 / 65535.0 - 12.5;
    const double kp = ((d[3] & 0xF) << 8 | d[4]) * 500.0 / 4095.0;
    const double ff = ((d[6] & 0xF) << 8 | d[7]) * 48.0 / 4095.0 - 24.0;
    const double here = (raw | 1) * 0.01 * std::numbers::pi / 180.0;
    // A step of the stiffness is 0.122 N·m/rad, of the torque 0.012 N·m.
    EXPECT_LE(std::abs(kp * (p - here) + ff), 3.125 + 0.07 * std::abs(p - here) + 0.02 + kp * 0.0003);
  }
}

TEST_F(MyActuatorMotor, SpeedsAndAnglesSurviveTheWayThereAndBack) {
  std::mt19937 random(3);  // NOLINT: the same numbers every time
  std::uniform_real_distribution<double> deg(-2e7, 2e7);
  for (int i = 0; i < 2000; ++i) {
    const double value = deg(random);
    const auto frame = myactuator::positionCommand(1, value, 100.0);
    EXPECT_NEAR(readLittleEndian<std::int32_t>(frame.payload(), 4) * 0.01, value, 0.00501);
  }
}

}  // namespace
}  // namespace rc10::test::myactuator_targets_test
