#include "drives/moteus/moteus_motor.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "drives/moteus/moteus_family.hpp"
#include "support/alloc_guard.hpp"
#include "support/moteus_answers.hpp"

namespace rc10::test::moteus_motor_test {
namespace {

using enum moteus::Register;
using namespace std::chrono_literals;

constexpr double kStop = 0.0;
constexpr double kPositionMode = 10.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// 8.27 / 304, the drive's own formula.
constexpr double kNmPerA = 0.0272;

TEST(MoteusMotor, RestStopsBeforeAnythingIsKnown) {
  for (const auto kind : {FrameKind::kRest, FrameKind::kPoll, FrameKind::kDisable}) {
    MoteusBench bench;
    bench.motor.order(kind);
    bench.tick();
    ASSERT_EQ(bench.sent_count, 1U);
    EXPECT_EQ(bench.mode(), kStop);
  }
}

TEST(MoteusMotor, NothingButTheSequenceSwitchesItOn) {
  for (const auto kind :
       {FrameKind::kIdle, FrameKind::kDamp, FrameKind::kBrake, FrameKind::kHold, FrameKind::kCommand}) {
    MoteusBench bench;
    bench.motor.order(kind);
    (void)bench.motor.setTarget({.mode = ControlMode::kVelocity, .value = 100.0});
    bench.answer({});
    EXPECT_EQ(bench.mode(), kStop);
    EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kDriveStopped);
  }
}

TEST(MoteusMotor, TheSequenceStopsEngagesWithoutTorqueAndVerifiesTheWatchdog) {
  MoteusBench bench;
  bench.motor.order(FrameKind::kEnable);
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kPending);
  bench.tick();
  EXPECT_EQ(bench.mode(), kStop);
  bench.answer({.position_rev = 0.3, .version = 5});
  EXPECT_EQ(bench.mode(), kPositionMode);
  EXPECT_NEAR(*bench.written(kCommandPosition), 0.3, 1e-6);
  EXPECT_EQ(bench.written(kCommandTorque), 0.0);
  EXPECT_EQ(bench.written(kKpScale), 0.0);
  EXPECT_EQ(bench.written(kKdScale), 0.0);
  EXPECT_EQ(bench.written(kIlimitScale), 0.0);
  EXPECT_NEAR(*bench.written(kTimeout), 0.1, 1e-9);
  bench.answer({.mode = moteus::Mode::kCalibrating, .position_rev = 0.3});
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kPending);
  bench.answer({.mode = moteus::Mode::kPosition, .position_rev = 0.3});
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kPending);
  bench.answer({.mode = moteus::Mode::kPosition, .position_rev = 0.3, .timeout_s = 0.1});
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kDone);
}

TEST(MoteusMotor, APlaceThatItCannotHaveReachedLosesTheReference) {
  for (const bool moves : {false, true}) {
    MoteusBench bench;
    bench.answer({.position_rev = 1.0, .velocity_rev_s = 100.0});
    (void)bench.motor.setZero(0.0);
    ASSERT_TRUE(bench.motor.feedback().zeroed);
    bench.answer({.position_rev = moves ? 1.1 : 38.0, .velocity_rev_s = 100.0});
    EXPECT_EQ(bench.motor.feedback().zeroed, moves);
    EXPECT_EQ(bench.motor.feedback().jumps, moves ? 0U : 1U);
  }
}

TEST(MoteusMotor, ADriveThatStoppedMayHaveRestarted) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable());
  (void)bench.motor.setZero(0.0);
  bench.motor.order(FrameKind::kIdle);
  bench.answer({.mode = moteus::Mode::kStopped});
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kDriveStopped);
  EXPECT_FALSE(bench.motor.feedback().zeroed);
}

TEST(MoteusMotor, AWatchdogThatWasNotTakenFailsTheSequence) {
  MoteusBench bench;
  bench.motor.order(FrameKind::kEnable);
  bench.tick();
  bench.answer({.version = 5});
  bench.answer({.mode = moteus::Mode::kPosition});
  bench.answer({.mode = moteus::Mode::kPosition, .timeout_s = kNaN});
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kPending) << "no answer to that question";
  bench.answer({.mode = moteus::Mode::kPosition, .timeout_s = 1.0});
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kFailed);
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kDriveSetting);
  EXPECT_EQ(bench.mode(), kStop);
}

TEST(MoteusMotor, ASilentDriveFailsTheSequenceAndANewOneBeginsAnew) {
  MoteusBench bench;
  bench.motor.order(FrameKind::kEnable);
  for (int i = 0; i < 260; ++i) {
    bench.tick();
    bench.now += 1ms;
  }
  EXPECT_EQ(bench.motor.sequenceProgress(), SequenceProgress::kFailed);
  bench.motor.order(FrameKind::kPoll);
  bench.tick();
  EXPECT_TRUE(bench.enable());
}

TEST(MoteusMotor, VelocityIsToldWithTheCourseOfTheShaft) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable(0.5));
  ASSERT_TRUE(bench.command({.mode = ControlMode::kVelocity, .value = 120.0}, 0.5));
  EXPECT_NEAR(*bench.written(kCommandPosition), 0.5, 1e-6) << "no jump";
  EXPECT_FLOAT_EQ(static_cast<float>(*bench.written(kCommandVelocity)), 2.0F);
  EXPECT_FALSE(bench.written(kKpScale).has_value());
  EXPECT_LT(*bench.written(kVelocityLimit), 0.0);
  bench.answer({.mode = moteus::Mode::kPosition, .position_rev = 0.5});
  EXPECT_NEAR(*bench.written(kCommandPosition), 0.502, 1e-6);
  // A shaft that does not follow is not left behind by more than the slip.
  for (int i = 0; i < 5000; ++i) bench.answer({.mode = moteus::Mode::kPosition, .position_rev = 0.5});
  EXPECT_NEAR(*bench.written(kCommandPosition), 1.0, 0.01);
}

TEST(MoteusMotor, AnglesAreToldInRevolutionsWithTheLimitOfTheSpeed) {
  auto settings = moteusMotor();
  settings.velocity_limit_rpm = 300.0F;
  MoteusBench bench(settings);
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.motor.setZero(0.0));
  ASSERT_TRUE(bench.command({.mode = ControlMode::kTotalAngle, .value = 90.0, .velocity_ff_rpm = 6.0F}));
  EXPECT_NEAR(*bench.written(kCommandPosition), 0.25, 1e-6);
  EXPECT_NEAR(*bench.written(kCommandVelocity), 0.1, 1e-6);
  EXPECT_NEAR(*bench.written(kVelocityLimit), 5.0, 1e-6);
  EXPECT_FALSE(bench.written(kAccelerationLimit).has_value()) << "as configured in the drive";
  ASSERT_TRUE(bench.command({.mode = ControlMode::kAngle, .value = 350.0}));
  EXPECT_NEAR(*bench.written(kCommandPosition), -10.0 / 360.0, 1e-6) << "the shortest way";
}

TEST(MoteusMotor, CurrentsBecomeTorqueWithoutGains) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.command({.mode = ControlMode::kCurrent, .value = 5.0}));
  EXPECT_NEAR(*bench.written(kCommandTorque), 5.0 * kNmPerA, 1e-4);
  EXPECT_EQ(bench.written(kKpScale), 0.0);
  EXPECT_EQ(bench.written(kKdScale), 0.0);
  EXPECT_EQ(bench.motor.commandUnit(), CommandUnit::kAmpere);
  EXPECT_NEAR(bench.motor.commandValue(), 5.0F, 1e-4F);
}

TEST(MoteusMotor, TheEffortLimitBoundsEveryMode) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable());
  bench.motor.derate(0.5F);
  ASSERT_TRUE(bench.command({.mode = ControlMode::kCurrent, .value = 1e6}));
  EXPECT_NEAR(*bench.written(kCommandTorque), 10.0 * kNmPerA, 1e-3);
  EXPECT_TRUE((bench.motor.limits() & kLimitCurrent) != 0);
  ASSERT_TRUE(bench.command({.mode = ControlMode::kVelocity, .value = 10.0, .torque_ff_nm = -1e6F}));
  EXPECT_NEAR(*bench.written(kMaxTorque), 10.0 * kNmPerA, 1e-3);
  EXPECT_NEAR(*bench.written(kCommandTorque), -10.0 * kNmPerA, 1e-3);
  bench.motor.derate(0.0F);
  ASSERT_TRUE(bench.command({.mode = ControlMode::kTotalAngle, .value = 10.0}));
  EXPECT_EQ(bench.written(kMaxTorque), 0.0);
}

TEST(MoteusMotor, TheVelocityLimitBoundsVelocities) {
  auto settings = moteusMotor();
  settings.velocity_limit_rpm = 60.0F;
  MoteusBench bench(settings);
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.command({.mode = ControlMode::kVelocity, .value = -1e9}));
  EXPECT_NEAR(*bench.written(kCommandVelocity), -1.0, 1e-6);
  EXPECT_TRUE((bench.motor.limits() & kLimitVelocity) != 0);
}

TEST(MoteusMotor, AnglesBeyondItsRangeAreBoundedAndSaid) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable());
  ASSERT_TRUE(bench.command({.mode = ControlMode::kTotalAngle, .value = 1e12}));
  EXPECT_TRUE((bench.motor.limits() & kLimitAngle) != 0);
  EXPECT_NEAR(*bench.written(kCommandPosition), 32000.0, 1.0);
}

TEST(MoteusMotor, BrakeIdleAndDampAreTheDrivesOwn) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable());
  bench.motor.order(FrameKind::kBrake);
  bench.answer({.mode = moteus::Mode::kPosition});
  EXPECT_EQ(bench.mode(), 15.0);
  bench.answer({.mode = moteus::Mode::kBrake});
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kNone);
  bench.motor.order(FrameKind::kDamp);
  bench.answer({.mode = moteus::Mode::kBrake});
  EXPECT_EQ(bench.mode(), kPositionMode);
  EXPECT_EQ(bench.written(kKpScale), 0.0);
  EXPECT_EQ(bench.written(kKdScale), 1.0);
  bench.motor.order(FrameKind::kIdle);
  bench.answer({.mode = moteus::Mode::kPosition});
  EXPECT_EQ(bench.written(kKdScale), 0.0);
  EXPECT_EQ(bench.written(kCommandTorque), 0.0);
}

TEST(MoteusMotor, HoldStaysWhereItBegan) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable(2.0));
  bench.motor.order(FrameKind::kHold);
  bench.answer({.mode = moteus::Mode::kPosition, .position_rev = 2.0});
  bench.answer({.mode = moteus::Mode::kPosition, .position_rev = 2.1});
  EXPECT_NEAR(*bench.written(kCommandPosition), 2.0, 1e-6);
}

TEST(MoteusMotor, EachFaultHasItsCode) {
  MoteusBench bench;
  for (int native = 32; native <= 50; ++native) {
    bench.answer({.mode = moteus::Mode::kFault, .fault = native});
    EXPECT_EQ(bench.motor.complaint().native_code, static_cast<std::uint32_t>(native));
    EXPECT_NE(bench.motor.complaint().fault, FaultCode::kNone);
    EXPECT_NE(bench.motor.complaint().fault, FaultCode::kDriveOther) << native;
  }
  bench.answer({.mode = moteus::Mode::kFault, .fault = 77});
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kDriveOther);
}

TEST(MoteusMotor, WhatBoundsItsOutputIsALimitAndNoFault) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable());
  bench.motor.order(FrameKind::kIdle);
  // Derated by heat, the current is at its limit all the same.
  for (const std::uint32_t native : {100U, 101U}) {
    bench.answer({.mode = moteus::Mode::kPosition, .fault = static_cast<int>(native)});
    EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kNone);
    EXPECT_EQ(bench.motor.limits(), kLimitTemperature | kLimitCurrent);
  }
  bench.answer({.mode = moteus::Mode::kPosition, .fault = 104});
  EXPECT_EQ(bench.motor.limits(), 0U);
}

TEST(MoteusMotor, AFaultIsLookedAtUntilClearedAndStoppedWhenItsReadingIsOld) {
  MoteusBench bench;
  bench.motor.order(FrameKind::kPoll);
  bench.answer({.mode = moteus::Mode::kFault, .fault = 34});
  EXPECT_FALSE(bench.mode().has_value()) << "a question alone";
  bench.now += 1s;
  bench.tick();
  EXPECT_EQ(bench.mode(), kStop);
  bench.answer({.mode = moteus::Mode::kFault, .fault = 34});
  EXPECT_FALSE(bench.mode().has_value());
  bench.motor.order(FrameKind::kRest);
  bench.tick();
  EXPECT_EQ(bench.mode(), kStop) << "rest is unconditional";
  bench.motor.order(FrameKind::kPoll);
  bench.motor.clearComplaint();
  bench.tick();
  EXPECT_EQ(bench.mode(), kStop);
  bench.answer({});
  EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kNone);
}

TEST(MoteusMotor, ADriveThatLeavesItsModeIsStoppedAndSaid) {
  for (const auto mode : {moteus::Mode::kStopped, moteus::Mode::kEnabling, moteus::Mode::kZeroVelocity}) {
    MoteusBench bench;
    ASSERT_TRUE(bench.enable());
    ASSERT_TRUE(bench.command({.mode = ControlMode::kVelocity, .value = 10.0}));
    bench.answer({.mode = mode});
    EXPECT_EQ(bench.motor.complaint().fault, FaultCode::kDriveStopped);
    EXPECT_EQ(bench.mode(), kStop);
    bench.answer({.mode = moteus::Mode::kPosition});
    EXPECT_EQ(bench.mode(), kStop) << "only a new sequence switches it on";
  }
}

TEST(MoteusMotor, ALongSilenceMayHideARestart) {
  auto settings = moteusMotor();
  settings.zero_at_power_on = true;
  MoteusBench bench(settings);
  bench.now = MonotonicTime{65'536ms * 10 + 5s};
  bench.motor.order(FrameKind::kPoll);
  bench.answer({});
  bench.now += 20s;
  bench.answer({});
  EXPECT_TRUE(bench.motor.feedback().zeroed) << "its clock has gone on";
  bench.now += 40s;
  bench.answer({});
  EXPECT_FALSE(bench.motor.feedback().zeroed);
}

TEST(MoteusMotor, AClockThatCouldBeThatOfARestartedDriveLosesTheReference) {
  auto settings = moteusMotor();
  settings.zero_at_power_on = true;
  MoteusBench bench(settings);
  bench.now = MonotonicTime{65'536ms * 10 + 44'999ms};
  bench.motor.order(FrameKind::kPoll);
  bench.answer({.position_rev = 3.0});
  ASSERT_TRUE(bench.motor.feedback().zeroed);
  // Off for 20.35 s, and on since 50 ms, where the clock of before would be at 65,400.
  bench.now += 20'399ms;
  bench.answer({.position_rev = 0.2, .clock_late = bench.now.time_since_epoch() - 49ms});
  EXPECT_FALSE(bench.motor.feedback().zeroed);
}

TEST(MoteusMotor, ItsClockGoesRoundWithoutALossOverAShortSilence) {
  auto settings = moteusMotor();
  settings.zero_at_power_on = true;
  MoteusBench bench(settings);
  bench.now = MonotonicTime{65'536ms * 10 - 40ms};
  bench.motor.order(FrameKind::kPoll);
  for (int i = 0; i < 10; ++i) {
    bench.answer({});
    bench.now += 90ms;
  }
  EXPECT_TRUE(bench.motor.feedback().zeroed);
}

TEST(MoteusMotor, AClockThatIsOnlyLateIsNoRestart) {
  auto settings = moteusMotor();
  settings.zero_at_power_on = true;
  MoteusBench bench(settings);
  bench.now = MonotonicTime{65'536ms * 10 + 40s};
  bench.motor.order(FrameKind::kPoll);
  bench.answer({});
  bench.now += 5s;
  bench.answer({.clock_late = 4s});
  EXPECT_TRUE(bench.motor.feedback().zeroed);
  // From 0 again a second ago, in a gap of two.
  bench.now += 2s;
  bench.answer({.clock_late = bench.now.time_since_epoch() - 1s});
  EXPECT_FALSE(bench.motor.feedback().zeroed);
}

TEST(MoteusMotor, TheAngleGoesOnWhereThePositionRegisterGoesRound) {
  MoteusBench bench;
  bench.motor.order(FrameKind::kPoll);
  bench.answer({.position_rev = 32767.5});
  const double before_deg = bench.motor.feedback().total_angle_deg;
  bench.answer({.position_rev = -32767.5});
  EXPECT_NEAR(bench.motor.feedback().total_angle_deg - before_deg, 360.0, 1.0);
  bench.answer({.position_rev = 32767.5});
  EXPECT_NEAR(bench.motor.feedback().total_angle_deg, before_deg, 1.0);
}

TEST(MoteusMotor, OtherFramesAreNotItsOwn) {
  MoteusBench bench;
  CanFrame frame = moteusAnswer({}, bench.now);
  EXPECT_TRUE(bench.motor.matchesFrame(frame));
  frame.id.extended = true;
  EXPECT_FALSE(bench.motor.matchesFrame(frame));
  frame = moteusAnswer({}, bench.now, 2);
  EXPECT_FALSE(bench.motor.matchesFrame(frame));
  frame = moteusAnswer({}, bench.now);
  frame.type = FrameType::kRemote;
  EXPECT_FALSE(bench.motor.matchesFrame(frame));
}

TEST(MoteusMotor, AnAnswerToSomebodyElseIsNotTaken) {
  MoteusBench bench;
  // A coarse position would read as a jump; an error subframe says that a question was not understood.
  moteus::Writer coarse(moteus::replyId(0, 1), true);
  coarse.reply(moteus::Type::kInt16, kMode, {0.0, 3.2767, 0.0, 0.0})
      .reply(moteus::Type::kInt8, kFault, {0.0})
      .reply(moteus::Type::kInt16, kMilliseconds, {5.0});
  EXPECT_EQ(bench.motor.updateFeedback(coarse.frame()), FrameVerdict::kMalformed);
  CanFrame error = moteusAnswer({}, bench.now);
  error.data[0] = 0x31;
  EXPECT_EQ(bench.motor.updateFeedback(error), FrameVerdict::kMalformed);
  for (std::uint8_t length = 0; length < 27; ++length) {
    CanFrame cut = moteusAnswer({}, bench.now);
    cut.length = length;
    EXPECT_EQ(bench.motor.updateFeedback(cut), FrameVerdict::kMalformed) << int{length};
  }
  EXPECT_EQ(bench.motor.feedback().samples, 0U);
}

TEST(MoteusMotor, ADriveWithoutAPositionGivesNoSample) {
  MoteusBench bench;
  EXPECT_EQ(bench.answer({.position_rev = kNaN}), FrameVerdict::kAccepted);
  EXPECT_EQ(bench.motor.feedback().samples, 0U);
  EXPECT_EQ(bench.answer({.position_rev = 1e9}), FrameVerdict::kMalformed);
  EXPECT_EQ(bench.answer({.velocity_rev_s = 1e30}), FrameVerdict::kMalformed);
}

TEST(MoteusMotor, WithoutAReadingNothingMoves) {
  MoteusBench bench;
  bench.motor.order(FrameKind::kEnable);
  bench.tick();
  bench.answer({.position_rev = kNaN, .version = 5});
  EXPECT_EQ(bench.mode(), kPositionMode);
  EXPECT_TRUE(std::isnan(*bench.written(kCommandPosition))) << "where it is";
  EXPECT_EQ(bench.written(kKpScale), 0.0);
}

TEST(MoteusMotor, ItIsToldInItsOwnTicksOnly) {
  auto settings = moteusMotor();
  settings.command_divider = 4;
  settings.command_phase = 1;
  MoteusBench bench(settings);
  bench.motor.order(FrameKind::kPoll);
  for (int i = 0; i < 16; ++i) {
    bench.tick();
    EXPECT_EQ(bench.sent_count, bench.index % 4 == 1 ? 1U : 0U);
  }
}

TEST(MoteusMotor, EveryFrameIsOneThatCanFdHasAndTheBitRateSwitchIsAsConfigured) {
  for (const double brs : {0.0, 1.0}) {
    auto settings = moteusMotor();
    settings.own.set("bit_rate_switch", brs);
    settings.velocity_limit_rpm = 100.0F;
    MoteusBench bench(settings);
    ASSERT_TRUE(bench.enable());
    for (const auto mode : {ControlMode::kCoast, ControlMode::kCurrent, ControlMode::kVelocity,
                            ControlMode::kTotalAngle, ControlMode::kBrake}) {
      ASSERT_TRUE(bench.command({.mode = mode, .value = 1.0}));
      EXPECT_TRUE(isValidLength(true, bench.frames[0].length));
      EXPECT_LE(bench.frames[0].length, 48) << "what busUse() says";
      EXPECT_EQ(bench.frames[0].bit_rate_switch, brs != 0.0);
      EXPECT_TRUE(bench.frames[0].fd);
    }
  }
}

TEST(MoteusMotor, SayingItBackAndForthChangesNothing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> position(-32000.0, 32000.0);
  std::uniform_real_distribution<double> speed(-400.0, 400.0);
  std::uniform_real_distribution<double> torque(-50.0, 50.0);
  for (int i = 0; i < 2000; ++i) {
    auto settings = moteusMotor();
    settings.direction = i % 2 == 0 ? 1 : -1;
    settings.gear_ratio = 1.0 + (i % 7);
    MoteusBench bench(settings);
    const double rev = position(random);
    const double rev_s = speed(random);
    const double nm = torque(random);
    bench.answer({.position_rev = rev, .velocity_rev_s = rev_s, .torque_nm = nm, .current_a = nm});
    const double turns = settings.gear_ratio * settings.direction;
    EXPECT_NEAR(bench.motor.feedback().velocity_rpm, rev_s * 60.0 / turns, 1e-2);
    EXPECT_NEAR(bench.motor.feedback().torque_nm, nm * turns, 1e-3);
    EXPECT_NEAR(bench.motor.feedback().current_a, nm * settings.direction, 0.101);
    ASSERT_TRUE(bench.enable(rev));
    const double total_deg = bench.motor.feedback().total_angle_deg;
    ASSERT_TRUE(bench.command({.mode = ControlMode::kTotalAngle, .value = total_deg + 90.0}, rev));
    EXPECT_NEAR(*bench.written(kCommandPosition), rev + 0.25 * turns, 5e-3);
  }
}

TEST(MoteusMotor, EveryIntegerScaleRoundTripsAndSaturates) {
  std::mt19937 random(11);
  for (const auto type : {moteus::Type::kInt8, moteus::Type::kInt16, moteus::Type::kInt32}) {
    const double most = type == moteus::Type::kInt8    ? 127.0
                        : type == moteus::Type::kInt16 ? 32767.0
                                                       : 2147483647.0;
    for (const auto reg : {kMode, kPosition, kVelocity, kTorque, kQCurrent, kVoltage, kTemperature, kTimeout,
                           kKpScale, kAccelerationLimit}) {
      const double scale = moteus::scaleOf(reg, type);
      std::uniform_real_distribution<double> within(-most * scale, most * scale);
      const auto back = [&](double value) {
        const CanFrame frame = moteus::Writer({1, true}, true).write(type, reg, {value}).frame();
        moteus::Reader reader(frame.payload());
        moteus::Item item;
        EXPECT_EQ(reader.next(item), moteus::Reader::Step::kItem);
        return item.value;
      };
      for (int i = 0; i < 100; ++i) {
        const double value = within(random);
        EXPECT_NEAR(back(value), value, scale * 0.51);
      }
      EXPECT_NEAR(back(1e300), most * scale, scale * 1e-3);
      EXPECT_NEAR(back(-1e300), -most * scale, scale * 1e-3);
      EXPECT_TRUE(std::isnan(back(kNaN)));
      EXPECT_TRUE(std::isnan(back(std::numeric_limits<double>::infinity())));
    }
  }
}

TEST(MoteusMotor, TargetsThatAreNoNumbersAreHarmless) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double value : {kNaN, kInfinity, -kInfinity, 1e308, -1e308}) {
    for (const auto mode :
         {ControlMode::kCurrent, ControlMode::kVelocity, ControlMode::kTotalAngle, ControlMode::kAngle}) {
      const Target target{.mode = mode,
                          .value = value,
                          .velocity_ff_rpm = static_cast<float>(std::clamp(value, -1e38, 1e38)),
                          .torque_ff_nm = static_cast<float>(std::clamp(value, -1e38, 1e38))};
      bench.motor.order(FrameKind::kCommand, target);
      bench.answer({.mode = moteus::Mode::kPosition});
      EXPECT_TRUE(std::isfinite(*bench.written(kCommandPosition)));
      EXPECT_TRUE(std::isfinite(*bench.written(kCommandVelocity)));
      EXPECT_LE(std::abs(*bench.written(kCommandTorque)), 20.0 * kNmPerA + 1e-3);
      EXPECT_TRUE(std::isfinite(bench.motor.commandValue()));
    }
  }
}

TEST(MoteusMotor, ATickDoesNotAllocate) {
  MoteusBench bench;
  ASSERT_TRUE(bench.enable());
  bench.motor.order(FrameKind::kCommand);
  ASSERT_TRUE(bench.motor.setTarget({.mode = ControlMode::kVelocity, .value = 10.0}));
  const AllocGuard guard;
  for (int i = 0; i < 100; ++i) bench.answer({.mode = moteus::Mode::kPosition});
  EXPECT_EQ(guard.allocations(), 0U);
}

TEST(MoteusFamily, ObeysWhateverHasItsLowByte) {
  auto settings = moteusMotor(5);
  const auto use = moteusFamily().busUse(settings);
  const auto obeys = [&use](CanId id) {
    CanFrame frame;
    frame.id = id;
    return std::any_of(use.obeys.begin(), use.obeys.end(), [&](const auto& f) { return accepts(f, frame); });
  };
  EXPECT_TRUE(obeys({0x8005, true}));
  EXPECT_TRUE(obeys({0x0305, true})) << "a VESC's SET_RPM to its id 5";
  EXPECT_TRUE(obeys({0x205, false})) << "a DJI motor's feedback";
  EXPECT_TRUE(obeys({0x807F, true})) << "everybody";
  EXPECT_FALSE(obeys({0x8006, true}));
  EXPECT_FALSE(obeys({0x1'0005, true})) << "another prefix";
}

TEST(MoteusFamily, TorqueAndSpeedComeFromItsKv) {
  auto settings = moteusMotor();
  settings.own.set("rotor_to_output_ratio", 0.1);
  const auto traits = moteusFamily().traits("moteus", settings.own);
  EXPECT_NEAR(traits.gear_ratio, 10.0, 1e-9);
  EXPECT_NEAR(traits.torque_nm_per_a, 10.0 * kNmPerA, 1e-3);
  EXPECT_NEAR(traits.no_load_rpm, 729.6, 0.1);
  EXPECT_TRUE(traits.asked && traits.fd && traits.watchdog && !traits.classic_only);
}

TEST(MoteusFamily, AWatchdogShorterThanThreeCommandsIsRefused) {
  auto settings = moteusMotor();
  EXPECT_TRUE(moteusFamily().check(settings).has_value());
  settings.command_divider = 50;
  const auto checked = moteusFamily().check(settings);
  ASSERT_FALSE(checked.has_value());
  EXPECT_EQ(checked.error().message.rfind("watchdog_ms: ", 0), 0U);
}

}  // namespace
}  // namespace rc10::test::moteus_motor_test
