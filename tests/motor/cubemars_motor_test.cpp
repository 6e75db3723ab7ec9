#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/byte_order.hpp"
#include "support/cubemars_settings.hpp"

namespace rc10::test::cubemars_motor_test {
namespace {

using std::chrono::milliseconds;

constexpr double kPi = 3.14159265358979323846;

/// One motor, fed by hand, a millisecond per tick.
template <typename Motor>
class Bench {
 public:
  explicit Bench(const MotorSettings& settings)
      : settings_(settings), motor_(settings, setupOf(settings)), ranges_(setupOf(settings).ranges) {}

  [[nodiscard]] Motor& motor() { return motor_; }

  FrameVerdict feedServo(double degrees, double erpm = 0.0, double amperes = 0.0, int temperature_c = 30,
                         std::uint8_t error = 0, Duration after = milliseconds{1}) {
    now_ += after;
    return motor_.updateFeedback(servoFrame(degrees, erpm, amperes, temperature_c, error));
  }
  [[nodiscard]] CanFrame servoFrame(double degrees, double erpm, double amperes, int temperature_c,
                                    std::uint8_t error) const {
    std::array<std::uint8_t, 8> data{};
    writeBigEndian(data, 0, static_cast<std::int16_t>(std::lround(degrees * 10.0)));
    writeBigEndian(data, 2, static_cast<std::int16_t>(std::lround(erpm / 10.0)));
    writeBigEndian(data, 4, static_cast<std::int16_t>(std::lround(amperes * 100.0)));
    data[6] = static_cast<std::uint8_t>(temperature_c);
    data[7] = error;
    CanFrame frame = makeClassicFrame({0x2900U + static_cast<std::uint32_t>(settings_.id), true}, data);
    frame.received = now_;
    return frame;
  }
  FrameVerdict feedMit(double rad, double rad_s = 0.0, double nm = 0.0, std::uint8_t error = 0,
                       Duration after = milliseconds{1}) {
    now_ += after;
    CanFrame frame = mitReply(rad, rad_s, nm, error);
    return motor_.updateFeedback(frame);
  }
  [[nodiscard]] CanFrame mitReply(double rad, double rad_s, double nm, std::uint8_t error) const {
    const auto code = [](double value, double reach, double last) {
      return static_cast<unsigned>(std::lround((value + reach) / (2 * reach) * last));
    };
    const unsigned p = code(rad, ranges_.position_rad, 65535);
    const unsigned v = code(rad_s, ranges_.velocity_rad_s, 4095);
    const unsigned t = code(nm, ranges_.torque_nm, 4095);
    const std::array<std::uint8_t, 8> data{static_cast<std::uint8_t>(settings_.id),
                                           static_cast<std::uint8_t>(p >> 8U),
                                           static_cast<std::uint8_t>(p & 0xFFU),
                                           static_cast<std::uint8_t>(v >> 4U),
                                           static_cast<std::uint8_t>((v & 0xFU) << 4U | t >> 8U),
                                           static_cast<std::uint8_t>(t & 0xFFU),
                                           70,
                                           error};
    CanFrame frame = makeClassicFrame({0, false}, data);
    frame.received = now_;
    return frame;
  }
  /// Its frame in a tick at the present time.
  std::vector<CanFrame> tick(FrameKind kind) {
    motor_.order(kind);
    return tick();
  }
  std::vector<CanFrame> tick() {
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    motor_.update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_.packCommand(tick, out);
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)};
  }
  CanFrame command(const Target& target) {
    motor_.order(FrameKind::kCommand, target);
    const auto frames = tick();
    EXPECT_EQ(frames.size(), 1U);
    return frames.empty() ? CanFrame{} : frames.front();
  }
  void pass(Duration duration) { now_ += duration; }

  /// The fields of a MIT command, as numbers.
  [[nodiscard]] cubemars::MitCommand decode(const CanFrame& frame) const {
    const auto& d = frame.data;
    const auto number = [](unsigned code, double low, double high, double last) {
      return low + (high - low) * code / last;
    };
    const auto& r = ranges_;
    if (frame.id.extended) {
      return {.position_rad = number(d[3] * 256U + d[4], -r.position_rad, r.position_rad, 65535),
              .velocity_rad_s = number(d[5] * 16U + d[6] / 16U, -r.velocity_rad_s, r.velocity_rad_s, 4095),
              .stiffness_nm_per_rad = number(d[0] * 16U + d[1] / 16U, 0, 500, 4095),
              .damping_nms_per_rad = number((d[1] & 15U) * 256U + d[2], 0, 5, 4095),
              .torque_nm = number((d[6] & 15U) * 256U + d[7], -r.torque_nm, r.torque_nm, 4095)};
    }
    return {.position_rad = number(d[0] * 256U + d[1], -r.position_rad, r.position_rad, 65535),
            .velocity_rad_s = number(d[2] * 16U + d[3] / 16U, -r.velocity_rad_s, r.velocity_rad_s, 4095),
            .stiffness_nm_per_rad = number((d[3] & 15U) * 256U + d[4], 0, 500, 4095),
            .damping_nms_per_rad = number(d[5] * 16U + d[6] / 16U, 0, 5, 4095),
            .torque_nm = number((d[6] & 15U) * 256U + d[7], -r.torque_nm, r.torque_nm, 4095)};
  }
  /// The drive's torque for it at this position and speed.
  [[nodiscard]] double sumNm(const CanFrame& frame, double rad, double rad_s) const {
    const auto c = decode(frame);
    return c.stiffness_nm_per_rad * (c.position_rad - rad) +
           c.damping_nms_per_rad * (c.velocity_rad_s - rad_s) + c.torque_nm;
  }

 private:
  MotorSettings settings_;
  Motor motor_;
  CubemarsRanges ranges_;
  MonotonicTime now_{std::chrono::hours{1}};
  std::uint64_t ticks_ = 0;
};

using Servo = Bench<CubemarsServo>;
using Mit = Bench<CubemarsMit>;

MotorSettings servo(const OwnKeys& keys = {}) { return cubemarsSettings("AK80-9", 5, keys); }
MotorSettings mit(OwnKeys keys = {}) {
  keys.emplace_back("protocol", std::string{"mit"});
  return cubemarsSettings("AK80-9", 5, keys);
}
MotorSettings mitV3(OwnKeys keys = {}) {
  keys.emplace_back("protocol", std::string{"mit_v3"});
  return cubemarsSettings("AK80-8-V3", 5, keys);
}

std::int32_t int32Of(const CanFrame& frame) { return readBigEndian<std::int32_t>(frame.payload(), 0); }

bool isCurrentZero(const CanFrame& frame) {
  return frame.id == CanId{0x105, true} && frame.length == 4 && int32Of(frame) == 0;
}
bool isExit(const CanFrame& frame) { return frame.id == CanId{5, false} && frame.data[7] == 0xFD; }
bool isEnter(const CanFrame& frame) { return frame.id == CanId{5, false} && frame.data[7] == 0xFC; }

// --- servo: what is told -------------------------------------------------------------------------------

TEST(CubemarsServo, RestIsACurrentOfNothingEvenBeforeAnyFeedback) {
  Servo bench(servo());
  std::array<CanFrame, 4> out{};
  ASSERT_EQ(bench.motor().packRest(out), 1U);
  EXPECT_TRUE(isCurrentZero(out[0]));
  for (const auto kind : {FrameKind::kRest, FrameKind::kPoll, FrameKind::kIdle, FrameKind::kEnable}) {
    const auto frames = bench.tick(kind);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_TRUE(isCurrentZero(frames[0]));
  }
}

TEST(CubemarsServo, CurrentIsBoundedByTheDeratedLimit) {
  auto settings = servo();
  settings.effort_limit = 10.0F;
  Servo bench(settings);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kCurrent, .value = 4.0})), 4000);
  EXPECT_EQ(bench.motor().limits(), 0U);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kCurrent, .value = -12.0})), -10000);
  EXPECT_EQ(bench.motor().limits(), kLimitCurrent);
  bench.motor().derate(0.5F);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kCurrent, .value = 12.0})), 5000);
}

TEST(CubemarsServo, TorqueFeedForwardBecomesCurrent) {
  Servo bench(servo());
  const auto frame = bench.command({.mode = ControlMode::kCurrent, .value = 1.0, .torque_ff_nm = 0.819F});
  EXPECT_NEAR(int32Of(frame), 2000, 1);
}

TEST(CubemarsServo, DirectionTurnsEveryCommandAndEveryReading) {
  auto settings = servo();
  settings.direction = -1;
  Servo bench(settings);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kCurrent, .value = 2.0})), -2000);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kVelocity, .value = 10.0})), -1890);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kDuty, .value = 0.5})), -50000);
  ASSERT_EQ(bench.feedServo(0.0), FrameVerdict::kAccepted);
  ASSERT_EQ(bench.feedServo(1.0, 1890.0, 3.0), FrameVerdict::kAccepted);
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, -1.0, 1e-9);
  EXPECT_NEAR(bench.motor().feedback().velocity_rpm, -10.0, 1e-4);
  EXPECT_NEAR(bench.motor().feedback().current_a, -3.0, 1e-6);
  EXPECT_LT(bench.motor().feedback().torque_nm, 0.0F);
}

TEST(CubemarsServo, VelocityIsBounded) {
  auto settings = servo();
  settings.velocity_limit_rpm = 100.0F;
  Servo bench(settings);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kVelocity, .value = 1e300})), 18900);
  EXPECT_EQ(bench.motor().limits(), kLimitVelocity);
  Servo unbounded(servo());
  EXPECT_EQ(int32Of(unbounded.command({.mode = ControlMode::kVelocity, .value = -1e300})), -100000);
}

TEST(CubemarsServo, AnglesAreThoseOfTheReference) {
  Servo bench(servo());
  (void)bench.feedServo(50.0);
  ASSERT_TRUE(bench.motor().setZero(0.0));
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kTotalAngle, .value = 10.0})), 600000);
  // The shortest way to 350 degrees is 10 degrees back.
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kAngle, .value = 350.0})), 400000);
}

TEST(CubemarsServo, AnglesThatTheFeedbackCannotShowAreNotSent) {
  Servo bench(servo());
  (void)bench.feedServo(0.0);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kTotalAngle, .value = 5000.0})), 32000000);
  EXPECT_EQ(bench.motor().limits(), kLimitAngle);
}

TEST(CubemarsServo, AtTheEndOfThePositionFieldTheReferenceIsLostAndAnAngleBrakes) {
  auto settings = servo();
  settings.zero_at_power_on = true;
  Servo bench(settings);
  (void)bench.feedServo(3199.0);
  EXPECT_TRUE(bench.motor().feedback().zeroed);
  (void)bench.feedServo(3200.0);
  EXPECT_FALSE(bench.motor().feedback().zeroed);
  const auto frame = bench.command({.mode = ControlMode::kTotalAngle, .value = 0.0});
  EXPECT_EQ(frame.id, (CanId{0x205, true}));
  EXPECT_EQ(bench.motor().limits(), kLimitAngle);
  EXPECT_EQ(bench.tick(FrameKind::kHold).front().id, (CanId{0x205, true}));
}

TEST(CubemarsServo, AGearBehindTheDriveIsInEveryNumber) {
  auto settings = servo();
  settings.gear_ratio = 18.0;
  Servo bench(settings);
  (void)bench.feedServo(0.0);
  (void)bench.feedServo(20.0, 1890.0, 1.0);
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, 10.0, 1e-9);
  EXPECT_NEAR(bench.motor().feedback().velocity_rpm, 5.0, 1e-4);
  EXPECT_NEAR(bench.motor().feedback().torque_nm, 18 * 0.091, 1e-4);
  EXPECT_EQ(int32Of(bench.command({.mode = ControlMode::kVelocity, .value = 5.0})), 1890);
}

TEST(CubemarsServo, ThePositionBasisScalesBothWays) {
  struct Row {
    const char* basis;
    double factor;
  };
  for (const Row& row : {Row{"output", 1.0}, Row{"rotor", 9.0}, Row{"electrical", 189.0}}) {
    SCOPED_TRACE(row.basis);
    Servo bench(servo({{"position_basis", std::string{row.basis}}}));
    (void)bench.feedServo(0.0);
    (void)bench.feedServo(row.factor);
    EXPECT_NEAR(bench.motor().feedback().total_angle_deg, 1.0, 1e-9);
    const auto frame = bench.command({.mode = ControlMode::kTotalAngle, .value = 2.0});
    EXPECT_NEAR(int32Of(frame), 2e4 * row.factor, 1);
  }
}

TEST(CubemarsServo, BrakeDampAndHoldAreFramesOfTheDrive) {
  Servo bench(servo({{"brake_current_a", 7.0}}));
  (void)bench.feedServo(12.5);
  auto frame = bench.tick(FrameKind::kBrake).front();
  EXPECT_EQ(frame.id, (CanId{0x205, true}));
  EXPECT_EQ(int32Of(frame), 7000);
  frame = bench.command({.mode = ControlMode::kBrake});
  EXPECT_EQ(frame.id, (CanId{0x205, true}));
  frame = bench.tick(FrameKind::kDamp).front();
  EXPECT_EQ(frame.id, (CanId{0x005, true}));
  EXPECT_EQ(int32Of(frame), 0);
  frame = bench.tick(FrameKind::kHold).front();
  EXPECT_EQ(frame.id, (CanId{0x405, true}));
  EXPECT_EQ(int32Of(frame), 125000);
  (void)bench.feedServo(13.0);
  EXPECT_EQ(int32Of(bench.tick(FrameKind::kHold).front()), 125000) << "it stays where the hold began";
}

TEST(CubemarsServo, AHoldWithoutFeedbackLetsGo) {
  Servo bench(servo());
  EXPECT_TRUE(isCurrentZero(bench.tick(FrameKind::kHold).front()));
}

TEST(CubemarsServo, WhenNothingIsLeftOfTheLimitEveryModeLetsGo) {
  Servo bench(servo());
  (void)bench.feedServo(0.0);
  bench.motor().derate(0.0F);
  for (const auto mode : {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kTotalAngle,
                          ControlMode::kDuty, ControlMode::kBrake}) {
    EXPECT_TRUE(isCurrentZero(bench.command({.mode = mode, .value = 0.5})));
    EXPECT_EQ(bench.motor().limits(), kLimitCurrent);
  }
  EXPECT_TRUE(isCurrentZero(bench.tick(FrameKind::kDamp).front()));
}

TEST(CubemarsServo, NumbersThatAreNoneLetGo) {
  Servo bench(servo());
  (void)bench.feedServo(0.0);
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (const auto mode : {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kAngle,
                            ControlMode::kTotalAngle, ControlMode::kDuty}) {
      EXPECT_TRUE(isCurrentZero(bench.command({.mode = mode, .value = value})));
    }
  }
  const auto frame = bench.command({.mode = ControlMode::kCurrent, .value = 1.0, .torque_ff_nm = INFINITY});
  EXPECT_EQ(int32Of(frame), 1000);
}

TEST(CubemarsServo, TellsSomethingInItsOwnTicksOnly) {
  auto settings = servo();
  settings.command_divider = 4;
  settings.command_phase = 1;
  Servo bench(settings);
  bench.motor().order(FrameKind::kIdle);
  std::vector<std::size_t> counts;
  for (int i = 0; i < 8; ++i) counts.push_back(bench.tick().size());
  EXPECT_EQ(counts, (std::vector<std::size_t>{1, 0, 0, 0, 1, 0, 0, 0}));
}

// --- feedback ------------------------------------------------------------------------------------------

TEST(CubemarsServo, ReadsTheWholeRangeAsItWasSent) {
  std::mt19937 random(20'260'101);
  std::uniform_real_distribution<double> degrees(-3199.0, 3199.0);
  std::uniform_real_distribution<double> erpm(-100'000.0, 100'000.0);
  std::uniform_real_distribution<double> amperes(-60.0, 60.0);
  std::uniform_int_distribution<int> celsius(-20, 127);
  for (int i = 0; i < 2000; ++i) {
    Servo bench(servo());
    const double deg = degrees(random);
    const double speed = erpm(random);
    const double current = amperes(random);
    const int temperature = celsius(random);
    (void)bench.feedServo(0.0);
    (void)bench.feedServo(deg, speed, current, temperature, 0, std::chrono::seconds{1});
    const auto& feedback = bench.motor().feedback();
    ASSERT_NEAR(feedback.total_angle_deg, deg, 0.051);
    ASSERT_NEAR(feedback.velocity_rpm, speed / 189.0, 0.03);
    ASSERT_NEAR(feedback.current_a, current, 0.0051);
    ASSERT_EQ(feedback.temperature_c, static_cast<float>(temperature));
  }
}

TEST(CubemarsServo, TakesOnlyWholeFramesOfItsOwnId) {
  Servo bench(servo());
  const CanFrame good = bench.servoFrame(1.0, 0.0, 0.0, 20, 0);
  auto other = good;
  other.id.value = 0x2906;
  EXPECT_FALSE(bench.motor().matchesFrame(other));
  other = good;
  other.id = {0x105, false};
  EXPECT_FALSE(bench.motor().matchesFrame(other));
  other = good;
  other.sent_here = true;  // as on a virtual bus
  EXPECT_TRUE(bench.motor().matchesFrame(other));
  for (int change = 0; change < 3; ++change) {
    auto wrong = good;
    if (change == 0) wrong.length = 7;
    if (change == 1) wrong.type = FrameType::kRemote;
    if (change == 2) wrong.fd = true;
    ASSERT_TRUE(bench.motor().matchesFrame(wrong));
    EXPECT_EQ(bench.motor().updateFeedback(wrong), FrameVerdict::kMalformed);
  }
  EXPECT_EQ(bench.motor().feedback().samples, 0U);
  EXPECT_EQ(bench.motor().updateFeedback(good), FrameVerdict::kAccepted);
}

TEST(CubemarsServo, ADriveWithAnOutputEncoderKnowsItsAngle) {
  auto settings = servo({{"output_encoder", 1.0}});
  settings.zero_deg = 30.0;
  Servo bench(settings);
  (void)bench.feedServo(50.0);
  EXPECT_TRUE(bench.motor().feedback().zeroed);
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, 20.0, 1e-9);
  Servo plain(servo());
  (void)plain.feedServo(50.0);
  EXPECT_FALSE(plain.motor().feedback().zeroed);
}

TEST(CubemarsServo, AModelWithUnsignedCurrentReportsNone) {
  const auto settings = cubemarsSettings("AK10-9-V3", 5);
  Servo bench(settings);
  (void)bench.feedServo(0.0, 100.0, 3.0);
  EXPECT_TRUE(std::isnan(bench.motor().feedback().current_a));
  EXPECT_TRUE(std::isnan(bench.motor().feedback().torque_nm));
  EXPECT_EQ(cubemarsTraits(setupOf(settings)).frozen_a, 0.0F);
}

TEST(CubemarsServo, EveryErrorOfTheDriveIsAComplaint) {
  Servo bench(servo());
  ASSERT_GE(cubemarsFaults().size(), 5U);
  for (const auto& fault : cubemarsFaults()) {
    (void)bench.feedServo(0.0, 0.0, 0.0, 30, static_cast<std::uint8_t>(fault.native));
    EXPECT_EQ(bench.motor().complaint().fault, fault.fault) << fault.words;
    EXPECT_EQ(bench.motor().complaint().native_code, fault.native);
  }
  (void)bench.feedServo(0.0, 0.0, 0.0, 30, 99);
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kDriveOther);
  (void)bench.feedServo(0.0);
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kNone);
}

TEST(CubemarsServo, ASilenceLongEnoughToStartUpInIsARestart) {
  auto settings = servo();
  settings.zero_at_power_on = true;
  Servo bench(settings);
  (void)bench.feedServo(0.0);
  (void)bench.tick(FrameKind::kIdle);
  (void)bench.feedServo(0.0, 0, 0, 30, 0, milliseconds{90});
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kNone);
  EXPECT_TRUE(bench.motor().feedback().zeroed);
  (void)bench.feedServo(0.0, 0, 0, 30, 0, milliseconds{110});
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(bench.motor().feedback().zeroed);
  bench.motor().clearComplaint();
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kNone);
}

TEST(CubemarsServo, ASilenceWhileItRestsIsNoComplaint) {
  Servo bench(servo());
  (void)bench.feedServo(0.0);
  (void)bench.tick(FrameKind::kRest);
  (void)bench.feedServo(0.0, 0, 0, 30, 0, std::chrono::seconds{1});
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kNone);
}

TEST(CubemarsServo, APositionThatItCannotHaveReachedIsAJump) {
  auto settings = servo();
  settings.zero_at_power_on = true;
  Servo bench(settings);
  (void)bench.feedServo(0.0);
  (void)bench.feedServo(4.0);
  EXPECT_EQ(bench.motor().feedback().jumps, 0U);
  (void)bench.feedServo(60.0);
  EXPECT_EQ(bench.motor().feedback().jumps, 1U);
  EXPECT_FALSE(bench.motor().feedback().zeroed);
}

// --- MIT -----------------------------------------------------------------------------------------------

TEST(CubemarsMit, RestAndPollLeaveTheMode) {
  Mit bench(mit());
  std::array<CanFrame, 4> out{};
  ASSERT_EQ(bench.motor().packRest(out), 1U);
  EXPECT_TRUE(isExit(out[0]));
  for (const auto kind : {FrameKind::kRest, FrameKind::kPoll, FrameKind::kDisable}) {
    const auto frames = bench.tick(kind);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_TRUE(isExit(frames[0]));
  }
}

TEST(CubemarsMit, IdleHasNoGainsAndNoTorque) {
  Mit bench(mit());
  (void)bench.feedMit(1.0, 3.0);
  const auto frames = bench.tick(FrameKind::kIdle);
  ASSERT_EQ(frames.size(), 1U);
  const auto command = bench.decode(frames[0]);
  EXPECT_EQ(command.stiffness_nm_per_rad, 0.0);
  EXPECT_EQ(command.damping_nms_per_rad, 0.0);
  EXPECT_NEAR(command.torque_nm, 0.0, 0.005);
}

TEST(CubemarsMit, EntersTheModeWithoutTorqueAndIsDoneWhenTheDriveHasAnswered) {
  Mit bench(mit());
  (void)bench.feedMit(0.0);
  auto frames = bench.tick(FrameKind::kEnable);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(bench.decode(frames[0]).stiffness_nm_per_rad, 0.0) << "what it finds when it enters";
  EXPECT_TRUE(isEnter(frames[1]));
  EXPECT_EQ(bench.motor().sequenceProgress(), SequenceProgress::kPending);
  (void)bench.feedMit(0.0);
  (void)bench.feedMit(0.0);
  frames = bench.tick();
  EXPECT_EQ(bench.motor().sequenceProgress(), SequenceProgress::kPending)
      << "one of the two may be the answer to an older frame";
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(bench.decode(frames[0]).stiffness_nm_per_rad, 0.0);
  (void)bench.feedMit(0.0);
  (void)bench.tick();
  EXPECT_EQ(bench.motor().sequenceProgress(), SequenceProgress::kDone);
}

TEST(CubemarsMit, AnUnansweredEnterIsSentAgainFiveTimesAndThenHasFailed) {
  Mit bench(mit());
  (void)bench.feedMit(0.0);
  int entered = 0;
  for (int i = 0; i < 400 && bench.motor().sequenceProgress() != SequenceProgress::kFailed; ++i) {
    for (const auto& frame : bench.tick(FrameKind::kEnable)) entered += isEnter(frame) ? 1 : 0;
    bench.pass(milliseconds{1});
  }
  EXPECT_EQ(entered, 6);
  EXPECT_EQ(bench.motor().sequenceProgress(), SequenceProgress::kFailed);
  (void)bench.tick(FrameKind::kPoll);
  (void)bench.tick(FrameKind::kEnable);
  EXPECT_EQ(bench.motor().sequenceProgress(), SequenceProgress::kPending) << "it starts anew";
}

TEST(CubemarsMit, ADriveWithAnErrorIsNotEnabled) {
  Mit bench(mit());
  (void)bench.feedMit(0.0, 0.0, 0.0, 3);
  for (int i = 0; i < 10; ++i) {
    (void)bench.tick(FrameKind::kEnable);
    (void)bench.feedMit(0.0, 0.0, 0.0, 3);
  }
  EXPECT_EQ(bench.motor().sequenceProgress(), SequenceProgress::kPending);
  EXPECT_EQ(bench.motor().complaint().fault, FaultCode::kDriveOverVoltage);
}

TEST(CubemarsMit, ClearingEntersWithoutTorqueAndLeavesAgain) {
  Mit bench(mit());
  (void)bench.feedMit(0.0, 0.0, 0.0, 2);
  (void)bench.tick(FrameKind::kPoll);
  bench.motor().clearComplaint();
  const auto frames = bench.tick();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(bench.decode(frames[0]).stiffness_nm_per_rad, 0.0);
  EXPECT_TRUE(isEnter(frames[1]));
  EXPECT_TRUE(isExit(frames[2]));
  EXPECT_TRUE(isExit(bench.tick().front())) << "once only";
}

TEST(CubemarsMit, CurrentIsTorqueOfTheModelsConstant) {
  Mit bench(mit());
  (void)bench.feedMit(0.0);
  const auto command = bench.decode(bench.command({.mode = ControlMode::kCurrent, .value = 5.0}));
  EXPECT_NEAR(command.torque_nm, 5.0 * 9 * 0.091, 0.01);
  EXPECT_EQ(command.stiffness_nm_per_rad, 0.0);
  EXPECT_EQ(command.damping_nms_per_rad, 0.0);
  EXPECT_NEAR(bench.motor().commandValue(), 5.0, 1e-4);
}

TEST(CubemarsMit, TheDrivesSumStaysWithinTheLimitInEveryMode) {
  auto settings = mit({{"angle_stiffness_nm_per_rad", 200.0}});
  settings.effort_limit = 4.0F;
  const double limit_nm = 4.0 * 9 * 0.091;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> position(-12.0, 12.0);
  std::uniform_real_distribution<double> velocity(-45.0, 45.0);
  std::uniform_real_distribution<double> value(-600.0, 600.0);
  std::uniform_real_distribution<float> gain(0.0F, 400.0F);
  for (int i = 0; i < 5000; ++i) {
    Mit bench(settings);
    const double rad = position(random);
    const double rad_s = velocity(random);
    (void)bench.feedMit(rad, rad_s);
    for (const auto mode : {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kTotalAngle,
                            ControlMode::kImpedance, ControlMode::kBrake}) {
      const Target target{.mode = mode,
                          .value = value(random),
                          .velocity_ff_rpm = static_cast<float>(value(random)),
                          .torque_ff_nm = static_cast<float>(value(random)),
                          .stiffness_nm_per_rad = gain(random),
                          .damping_nms_per_rad = gain(random) / 100.0F};
      const auto frame = bench.command(target);
      // The fields have steps, of commands and of the feedback that they were made from.
      const auto c = bench.decode(frame);
      const double steps_nm = 0.009 + 0.037 * c.damping_nms_per_rad + 0.001 * c.stiffness_nm_per_rad +
                              0.1222 * std::abs(c.position_rad - rad) +
                              0.0013 * std::abs(c.velocity_rad_s - rad_s);
      ASSERT_LE(std::abs(bench.sumNm(frame, rad, rad_s)), limit_nm + steps_nm) << static_cast<int>(mode);
      ASSERT_LE(std::abs(bench.motor().commandValue()), 4.0F * 1.0001F);
    }
  }
}

TEST(CubemarsMit, AnAngleIsApproachedNoFasterThanTheLimit) {
  auto settings = mit({{"angle_stiffness_nm_per_rad", 40.0}, {"angle_damping_nms_per_rad", 2.0}});
  settings.velocity_limit_rpm = 30.0F;
  Mit bench(settings);
  (void)bench.feedMit(0.0);
  const auto command = bench.decode(bench.command({.mode = ControlMode::kTotalAngle, .value = 300.0}));
  EXPECT_NEAR(command.position_rad * 40.0 / 2.0, kPi, 0.02);  // 30 rpm
  EXPECT_NE(bench.motor().limits() & kLimitVelocity, 0U);
}

TEST(CubemarsMit, GainsAndTorqueCountAtTheShaftBehindTheGear) {
  auto settings = mit();
  settings.gear_ratio = 18.0;  // 2 behind the drive's own 9
  settings.direction = -1;
  Mit bench(settings);
  (void)bench.feedMit(0.0);
  const auto command = bench.decode(bench.command({.mode = ControlMode::kImpedance,
                                                   .value = 0.0,
                                                   .velocity_ff_rpm = 3.0F,
                                                   .torque_ff_nm = 4.0F,
                                                   .stiffness_nm_per_rad = 40.0F,
                                                   .damping_nms_per_rad = 2.0F}));
  EXPECT_NEAR(command.stiffness_nm_per_rad, 10.0, 0.13);
  EXPECT_NEAR(command.damping_nms_per_rad, 0.5, 0.002);
  EXPECT_NEAR(command.torque_nm, -2.0, 0.01);
  EXPECT_NEAR(command.velocity_rad_s, -6.0 * kPi / 30.0, 0.03);
}

TEST(CubemarsMit, CountsTheTurnsOfItsPositionField) {
  Mit bench(mit());
  double rad = 0.0;
  (void)bench.feedMit(0.0);
  for (int i = 0; i < 4000; ++i) {
    rad += 0.01;
    (void)bench.feedMit(std::remainder(rad, 25.0), 10.0);
  }
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, 40.0 * 180.0 / kPi, 0.1);
  for (int i = 0; i < 8000; ++i) {
    rad -= 0.01;
    (void)bench.feedMit(std::remainder(rad, 25.0), -10.0);
  }
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, -40.0 * 180.0 / kPi, 0.1);
  EXPECT_EQ(bench.motor().feedback().jumps, 0U);
}

TEST(CubemarsMit, OutsideOfTheFieldAnAngleOnlyDamps) {
  Mit bench(mit());
  double rad = 11.0;
  (void)bench.feedMit(rad);
  while (rad < 14.0) (void)bench.feedMit(std::remainder(rad += 0.05, 25.0));
  const auto command = bench.decode(bench.command({.mode = ControlMode::kTotalAngle, .value = 0.0}));
  EXPECT_EQ(command.stiffness_nm_per_rad, 0.0);
  EXPECT_GT(command.damping_nms_per_rad, 0.0);
  EXPECT_NE(bench.motor().limits() & kLimitAngle, 0U);
}

TEST(CubemarsMit, OutsideOfTheFieldAnyDampingOpposesTheShaftWithAllThatIsAllowed) {
  auto settings = mit();
  settings.effort_limit = 4.0F;
  for (const auto stiffness : {0.0F, 1.0F, 1e30F}) {
    Mit bench(settings);
    double rad = 11.0;
    (void)bench.feedMit(rad);
    while (rad < 14.0) (void)bench.feedMit(std::remainder(rad += 0.05, 25.0), 20.0);
    const auto frame = bench.command(
        {.mode = ControlMode::kImpedance, .stiffness_nm_per_rad = stiffness, .damping_nms_per_rad = 1e30F});
    EXPECT_NEAR(bench.sumNm(frame, std::remainder(rad, 25.0), 20.0), -4.0 * 9 * 0.091, 0.2) << stiffness;
    EXPECT_NEAR(bench.motor().commandValue(), -4.0F, 1e-3F) << stiffness;
  }
}

TEST(CubemarsMit, APositionFieldThatIsCutOffLosesTheReference) {
  auto settings = mit();
  settings.zero_at_power_on = true;
  Mit bench(settings);
  (void)bench.feedMit(12.49);
  (void)bench.feedMit(12.5);
  EXPECT_TRUE(bench.motor().feedback().zeroed);
  (void)bench.feedMit(12.5);
  EXPECT_FALSE(bench.motor().feedback().zeroed);
}

TEST(CubemarsMit, WithoutFreshFeedbackNothingButNoTorqueIsSent) {
  Mit bench(mit());
  const Target target{.mode = ControlMode::kVelocity, .value = 60.0};
  EXPECT_EQ(bench.decode(bench.command(target)).damping_nms_per_rad, 0.0);
  (void)bench.feedMit(0.0);
  EXPECT_GT(bench.decode(bench.command(target)).damping_nms_per_rad, 0.0);
  bench.pass(milliseconds{101});
  EXPECT_EQ(bench.decode(bench.command(target)).damping_nms_per_rad, 0.0);
}

TEST(CubemarsMit, HugeAndMissingNumbersAreHarmless) {
  Mit bench(mit());
  (void)bench.feedMit(1.0, 2.0);
  const double huge = std::numeric_limits<double>::max();
  const float huge_f = std::numeric_limits<float>::max();
  for (const double value : {huge, -huge, std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (const float extra : {huge_f, -huge_f, NAN, INFINITY}) {
      for (int mode = 0; mode < kControlModeCount; ++mode) {
        const auto frame = bench.command({.mode = static_cast<ControlMode>(mode),
                                          .value = value,
                                          .velocity_ff_rpm = extra,
                                          .torque_ff_nm = extra,
                                          .stiffness_nm_per_rad = extra,
                                          .damping_nms_per_rad = extra});
        ASSERT_TRUE(std::isfinite(bench.motor().commandValue()));
        ASSERT_LE(std::abs(bench.sumNm(frame, 1.0, 2.0)), 18.0 * 1.05) << mode;
      }
    }
  }
}

TEST(CubemarsMit, AnswersComeFromIdZeroOrFromItsOwnAndBelongToItByTheirFirstByte) {
  Mit bench(mit());
  CanFrame reply = bench.mitReply(0.0, 0.0, 0.0, 0);
  EXPECT_TRUE(bench.motor().matchesFrame(reply));
  reply.id.value = 5;
  EXPECT_TRUE(bench.motor().matchesFrame(reply));
  reply.id.value = 6;
  EXPECT_FALSE(bench.motor().matchesFrame(reply));
  reply.id.value = 0;
  reply.data[0] = 6;
  EXPECT_FALSE(bench.motor().matchesFrame(reply));
  reply.data[0] = 5;
  reply.length = 7;
  ASSERT_TRUE(bench.motor().matchesFrame(reply));
  EXPECT_EQ(bench.motor().updateFeedback(reply), FrameVerdict::kMalformed);
  reply.length = 6;  // the oldest firmware: no temperature, no error
  EXPECT_EQ(bench.motor().updateFeedback(reply), FrameVerdict::kAccepted);
  EXPECT_TRUE(std::isnan(bench.motor().feedback().temperature_c));
  EXPECT_EQ(bench.motor().filters().size(), 2U);
}

TEST(CubemarsMitV3, RestIsSaidInBothProtocols) {
  Mit bench(mitV3());
  std::array<CanFrame, 4> out{};
  ASSERT_EQ(bench.motor().packRest(out), 2U);
  EXPECT_EQ(out[0].id, (CanId{0x805, true}));
  EXPECT_EQ(bench.decode(out[0]).stiffness_nm_per_rad, 0.0);
  EXPECT_EQ(bench.decode(out[0]).damping_nms_per_rad, 0.0);
  EXPECT_TRUE(isCurrentZero(out[1]));
  EXPECT_EQ(bench.motor().sequenceProgress(), SequenceProgress::kDone) << "it needs no enabling";
}

TEST(CubemarsMitV3, ItsFeedbackIsThatOfTheServoProtocol) {
  Mit bench(mitV3());
  ASSERT_TRUE(bench.motor().matchesFrame(bench.servoFrame(0, 0, 0, 0, 0)));
  (void)bench.feedServo(0.0);
  (void)bench.feedServo(3.0, 168.0 * 5.0, 2.0, 41);
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, 3.0, 1e-9);
  EXPECT_NEAR(bench.motor().feedback().velocity_rpm, 5.0, 1e-3);
  EXPECT_NEAR(bench.motor().feedback().torque_nm, 2.0 * 1.0566, 1e-3);
  EXPECT_EQ(bench.motor().feedback().temperature_c, 41.0F);
}

TEST(CubemarsMitV3, BeyondTheReachOfItsCommandsAnAngleOnlyDamps) {
  Mit bench(mitV3());
  (void)bench.feedServo(800.0);  // 12.5 rad are 716 degrees
  const auto command = bench.decode(bench.command({.mode = ControlMode::kTotalAngle, .value = 0.0}));
  EXPECT_EQ(command.stiffness_nm_per_rad, 0.0);
  EXPECT_GT(command.damping_nms_per_rad, 0.0);
}

// --- codec ---------------------------------------------------------------------------------------------

TEST(CubemarsFrames, MitCommandsKeepTheirValuesToOneStep) {
  std::mt19937 random(99);
  for (const auto& model : cubemarsModels()) {
    const auto settings =
        cubemarsSettings(model.name, 9, {{"protocol", std::string{model.v3 ? "mit_v3" : "mit"}}});
    const Mit bench(settings);
    const auto& r = model.ranges;
    const auto any = [&random](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int i = 0; i < 500; ++i) {
      const cubemars::MitCommand wanted{.position_rad = any(-r.position_rad, r.position_rad),
                                        .velocity_rad_s = any(-r.velocity_rad_s, r.velocity_rad_s),
                                        .stiffness_nm_per_rad = any(0, 500),
                                        .damping_nms_per_rad = any(0, 5),
                                        .torque_nm = any(-r.torque_nm, r.torque_nm)};
      const auto got =
          bench.decode(model.v3 ? cubemars::mitV3Frame(9, r, wanted) : cubemars::mitFrame(9, r, wanted));
      ASSERT_NEAR(got.position_rad, wanted.position_rad, 2.01 * r.position_rad / 65535);
      ASSERT_NEAR(got.velocity_rad_s, wanted.velocity_rad_s, 2.01 * r.velocity_rad_s / 4095);
      ASSERT_NEAR(got.stiffness_nm_per_rad, wanted.stiffness_nm_per_rad, 500.1 / 4095);
      ASSERT_NEAR(got.damping_nms_per_rad, wanted.damping_nms_per_rad, 5.01 / 4095);
      ASSERT_NEAR(got.torque_nm, wanted.torque_nm, 2.01 * r.torque_nm / 4095);
    }
  }
}

TEST(CubemarsFrames, WhatIsTooMuchIsCutOffAndNeverWraps) {
  const double huge = 1e300;
  EXPECT_EQ(int32Of(cubemars::dutyFrame(1, huge)), 100'000);
  EXPECT_EQ(int32Of(cubemars::currentFrame(1, -huge)), -60'000);
  EXPECT_EQ(int32Of(cubemars::brakeFrame(1, -huge)), 0);
  EXPECT_EQ(int32Of(cubemars::velocityFrame(1, huge)), 100'000);
  EXPECT_EQ(int32Of(cubemars::positionFrame(1, huge)), 360'000'000);
  const auto planned = cubemars::positionVelocityFrame(1, -huge, huge, huge);
  EXPECT_EQ(int32Of(planned), -360'000'000);
  EXPECT_EQ(readBigEndian<std::int16_t>(planned.payload(), 4), 32767);
  EXPECT_EQ(readBigEndian<std::int16_t>(planned.payload(), 6), 32767);
  EXPECT_EQ(int32Of(cubemars::currentFrame(1, std::nan(""))), 0);
  const CubemarsRanges r = cubemarsModels()[0].ranges;
  const auto high = cubemars::mitFrame(1, r, {huge, huge, huge, huge, huge});
  const auto low = cubemars::mitFrame(1, r, {-huge, -huge, -huge, -huge, -huge});
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(high.data[i], 0xFF);
    EXPECT_EQ(low.data[i], 0x00);
  }
}

TEST(Cubemars, GarbageLeavesFiniteReadings) {
  std::mt19937 random(5);
  Servo servo_bench(servo());
  Mit mit_bench(mit());
  for (int i = 0; i < 20'000; ++i) {
    CanFrame frame;
    frame.length = static_cast<std::uint8_t>(random() % 9U);
    for (std::size_t k = 0; k < 8; ++k) frame.data[k] = static_cast<std::uint8_t>(random());
    frame.received = MonotonicTime{std::chrono::hours{1}} + std::chrono::microseconds{i * 500};
    frame.id = {0x2905, true};
    (void)servo_bench.motor().updateFeedback(frame);
    frame.id = {0, false};
    frame.data[0] = 5;
    if (mit_bench.motor().matchesFrame(frame)) (void)mit_bench.motor().updateFeedback(frame);
  }
  for (const auto* motor : {static_cast<const SoloMotor*>(&servo_bench.motor()),
                            static_cast<const SoloMotor*>(&mit_bench.motor())}) {
    const auto& feedback = motor->feedback();
    EXPECT_GT(feedback.samples, 0U);
    EXPECT_TRUE(std::isfinite(feedback.total_angle_deg));
    EXPECT_TRUE(feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F);
    EXPECT_TRUE(std::isfinite(feedback.velocity_rpm) && std::isfinite(feedback.current_a));
  }
}

// --- the family ----------------------------------------------------------------------------------------

TEST(CubemarsFamily, EveryModelHasTraitsForEachOfItsProtocols) {
  const auto& family = cubemarsFamily();
  EXPECT_EQ(family.name(), "CubeMars");
  EXPECT_EQ(family.models().size(), cubemarsModels().size());
  for (const auto model : family.models()) {
    const bool v3 = findCubemarsModel(model)->v3;
    for (const std::string protocol : {"servo", v3 ? "mit_v3" : "mit"}) {
      SCOPED_TRACE(std::string{model} + " " + protocol);
      const auto settings = cubemarsSettings(model, 1, {{"protocol", protocol}});
      ASSERT_TRUE(family.check(settings));
      const auto traits = family.traits(model, settings.own);
      EXPECT_GT(traits.effort_full_scale, 10.0F);
      EXPECT_LE(traits.effort_full_scale, 60.0F);
      EXPECT_GT(traits.torque_nm_per_a, 0.0F);
      EXPECT_GT(traits.no_load_rpm, 0.0F);
      EXPECT_GT(setupOf(settings).pole_pairs, 0);
      EXPECT_EQ(traits.asked, protocol == "mit");
      EXPECT_EQ(traits.frames.poll == Provision::kFrame, traits.asked);
    }
  }
}

TEST(CubemarsFamily, RefusesAProtocolThatTheDriveDoesNotSpeak) {
  const auto& family = cubemarsFamily();
  auto refused = family.check(cubemarsSettings("AK80-9", 1, {{"protocol", std::string{"mit_v3"}}}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.rfind("protocol: ", 0), 0U) << refused.error().message;
  refused = family.check(cubemarsSettings("AK10-9-V3", 1, {{"protocol", std::string{"mit"}}}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.rfind("protocol: ", 0), 0U) << refused.error().message;
}

TEST(CubemarsFamily, RefusesAPositionBasisWhereThereIsOnlyOne) {
  const auto refused = cubemarsFamily().check(cubemarsSettings(
      "AK80-9", 1, {{"protocol", std::string{"mit"}}, {"position_basis", std::string{"rotor"}}}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message.rfind("position_basis: ", 0), 0U) << refused.error().message;
}

TEST(CubemarsFamily, KeysChangeWhatTheTableSays) {
  const auto settings = cubemarsSettings("AK80-9", 1,
                                         {{"protocol", std::string{"mit"}},
                                          {"pole_pairs", 14.0},
                                          {"torque_constant_nm_per_a", 0.115},
                                          {"velocity_range_rad_s", 22.5},
                                          {"torque_range_nm", 12.0}});
  const auto setup = setupOf(settings);
  EXPECT_EQ(setup.pole_pairs, 14);
  EXPECT_NEAR(setup.torque_nm_per_a, 1.035, 1e-6);
  EXPECT_EQ(setup.ranges.velocity_rad_s, 22.5);
  EXPECT_EQ(setup.ranges.torque_nm, 12.0);
  EXPECT_NEAR(cubemarsTraits(setup).effort_full_scale, 12.0 / 1.035, 1e-4);
}

TEST(CubemarsFamily, TellsEveryIdOnTheBus) {
  const auto& family = cubemarsFamily();
  auto settings = servo();
  settings.feedback_hz = 200;
  settings.command_divider = 5;
  auto use = family.busUse(settings);
  ASSERT_EQ(use.sends.size(), 1U);
  EXPECT_EQ(use.sends[0].id, (CanId{0x2905, true}));
  ASSERT_EQ(use.obeys.size(), 1U);
  EXPECT_TRUE(accepts(use.obeys[0], cubemars::currentFrame(5, 0.0)));
  EXPECT_TRUE(accepts(use.obeys[0], cubemars::positionVelocityFrame(5, 0, 0, 0)));
  EXPECT_FALSE(accepts(use.obeys[0], cubemars::currentFrame(6, 0.0)));
  EXPECT_EQ(use.feedback[0].per_second, 200.0);
  EXPECT_EQ(use.commands[0].per_second, 200.0);
  use = family.busUse(mit());
  ASSERT_EQ(use.sends.size(), 2U);
  EXPECT_EQ(use.sends[0].id, (CanId{0, false}));
  EXPECT_EQ(use.sends[0].discriminator->value, 5);
  EXPECT_EQ(use.feedback[0].per_second, 1000.0);
}

}  // namespace
}  // namespace rc10::test::cubemars_motor_test
