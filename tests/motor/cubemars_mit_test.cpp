#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "motor/cubemars_bench.hpp"
#include "sim/wrapped_code.hpp"

namespace rc10::test::cubemars_mit_test {
namespace {

using namespace cubemars_bench;

// --- MIT -----------------------------------------------------------------------------------------------

TEST(CubemarsMit, RestAndPollLeaveTheMode) {
  Mit bench(mit());
  std::array<CanFrame, 4> out{};
  ASSERT_EQ(bench.motor().packRest(out), 2U);
  EXPECT_TRUE(bench.isNoTorque(out[0]));
  EXPECT_TRUE(isExit(out[1]));
  ASSERT_EQ(bench.tick(FrameKind::kRest).size(), 2U) << "the law in the drive is not known yet";
  bench.answer(5);
  for (const auto kind : {FrameKind::kRest, FrameKind::kPoll, FrameKind::kDisable}) {
    const auto frames = bench.tick(kind);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_TRUE(isExit(frames[0]));
  }
}

TEST(CubemarsMit, NoLawOfItsOwnIsLeftInADriveThatLeavesTheMode) {
  for (const auto before : {FrameKind::kCommand, FrameKind::kBrake, FrameKind::kHold, FrameKind::kEnable}) {
    Mit bench(mit());
    (void)bench.feedMit(0.0);
    (void)bench.tick(FrameKind::kRest);
    (void)bench.tick(before);
    for (int answers = 0; answers < 5; ++answers) {
      const auto frames = bench.tick(answers % 2 == 0 ? FrameKind::kRest : FrameKind::kPoll);
      ASSERT_EQ(frames.size(), 2U) << "they may have been held back";
      EXPECT_TRUE(bench.isNoTorque(frames[0]));
      EXPECT_TRUE(isExit(frames[1]));
      bench.answer(1);
    }
    EXPECT_EQ(bench.tick(FrameKind::kPoll).size(), 1U);
  }
}

TEST(CubemarsMit, NoTorqueFollowsInTheTickAfterEnteringWhateverTheRhythmOfCommands) {
  auto settings = mit();
  settings.command_divider = 20;
  Mit bench(settings);
  (void)bench.feedMit(0.0);
  ASSERT_EQ(bench.tick(FrameKind::kEnable).size(), 3U);
  const auto frames = bench.tick();
  ASSERT_EQ(frames.size(), 1U) << "the last of the three may not have left";
  EXPECT_TRUE(bench.isNoTorque(frames[0]));
  EXPECT_TRUE(bench.tick().empty());
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
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_TRUE(bench.isNoTorque(frames[0])) << "in case it is in the mode";
  EXPECT_TRUE(isEnter(frames[1]));
  EXPECT_TRUE(bench.isNoTorque(frames[2])) << "in case a law of before stands in it";
  EXPECT_EQ(bench.motor().sequenceProgress(), SequenceProgress::kPending);
  for (int i = 0; i < 3; ++i) (void)bench.feedMit(0.0);
  frames = bench.tick();
  EXPECT_EQ(bench.motor().sequenceProgress(), SequenceProgress::kPending)
      << "one of the three may be the answer to an older frame";
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
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_TRUE(bench.isNoTorque(frames[0]));
  EXPECT_TRUE(isEnter(frames[1]));
  EXPECT_TRUE(bench.isNoTorque(frames[2]));
  EXPECT_TRUE(isExit(frames[3]));
  const auto rest = bench.tick();
  ASSERT_EQ(rest.size(), 2U) << "once only";
  EXPECT_TRUE(bench.isNoTorque(rest[0]));
  EXPECT_TRUE(isExit(rest[1]));
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

TEST(CubemarsMit, AfterAPushAgainstWhatBlocksItAStopDoesNotPressOn) {
  auto settings = mit({{"angle_stiffness_nm_per_rad", 30.0}, {"angle_damping_nms_per_rad", 1.0}});
  settings.velocity_limit_rpm = 10.0F;
  settings.effort_limit = 12.0F;
  Mit bench(settings);
  const auto torqueAt0Nm = [&](double place_deg) {
    (void)bench.feedMit(0.0);
    return bench.sumNm(bench.command({.mode = ControlMode::kTotalAngle, .value = place_deg}), 0.0, 0.0);
  };
  for (int i = 0; i < 1500; ++i) (void)torqueAt0Nm(60.0);
  ASSERT_GT(torqueAt0Nm(60.0), 9.0);
  bench.motor().dropWindup(0.5F);
  EXPECT_LT(torqueAt0Nm(60.0), 1.3) << "damping times limit";
  EXPECT_LT(torqueAt0Nm(0.0), 0.2);
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
    (void)bench.feedMit(rad, 10.0);
  }
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, 40.0 * 180.0 / kPi, 0.1);
  for (int i = 0; i < 8000; ++i) {
    rad -= 0.01;
    (void)bench.feedMit(rad, -10.0);
  }
  EXPECT_NEAR(bench.motor().feedback().total_angle_deg, -40.0 * 180.0 / kPi, 0.1);
  EXPECT_EQ(bench.motor().feedback().jumps, 0U);
}

// A field of 65536 codes, of which 65535 steps are the range.
TEST(CubemarsMit, CountsTheTurnsOfItsPositionFieldExactlyHoweverManyTheyAre) {
  for (const double sign : {1.0, -1.0}) {
    Mit bench(mit());
    double farthest_deg = 0.0;
    for (double rad = 0.0; rad < 2500.0; rad += 0.04) {
      (void)bench.feedCode(sim::wrappedCode(sign * rad, 12.5, 16));
      const double off_deg = bench.motor().feedback().total_angle_deg - sign * rad * 180.0 / kPi;
      farthest_deg = std::max(farthest_deg, std::fabs(off_deg));
    }
    EXPECT_LE(farthest_deg, 0.05);
  }
}

TEST(CubemarsMit, AShaftFasterThanItsFieldIsReadWithItsSignAndSize) {
  for (const double sign : {1.0, -1.0}) {
    Mit bench(mit());
    double rad = 0.0;
    (void)bench.feedMit(0.0);
    (void)bench.command({.mode = ControlMode::kCurrent});
    for (double rad_s = 0.0; rad_s < 80.0; rad_s += 0.1) {
      rad += sign * rad_s * 1e-3;
      (void)bench.feedMit(rad, sign * rad_s);
      ASSERT_NEAR(bench.motor().feedback().velocity_rpm, sign * rad_s * 30.0 / kPi, 0.3);
      ASSERT_EQ(bench.motor().complaint().fault, FaultCode::kNone) << rad_s;
    }
    EXPECT_EQ(bench.motor().feedback().jumps, 0U);
  }
}

// The damping that the drive computes from its own speed is bounded by that speed.
TEST(CubemarsMit, AShaftFasterThanItsFieldIsBrakedWithinTheLimit) {
  auto settings = mit();
  settings.effort_limit = 4.0F;
  for (const double sign : {1.0, -1.0}) {
    Mit bench(settings);
    double rad = 0.0;
    (void)bench.feedMit(0.0);
    for (double rad_s = 0.0; rad_s < 70.0; rad_s += 0.1) {
      rad += sign * rad_s * 1e-3;
      (void)bench.feedMit(rad, sign * rad_s);
      const auto frame = bench.command({.mode = ControlMode::kBrake});
      ASSERT_LE(sign * bench.sumNm(frame, 0.0, sign * rad_s), 0.1) << rad_s;
      ASSERT_GE(sign * bench.sumNm(frame, 0.0, sign * rad_s), -4.0 * 9 * 0.091 - 0.2) << rad_s;
    }
    const auto frame = bench.command({.mode = ControlMode::kBrake});
    EXPECT_LT(sign * bench.sumNm(frame, 0.0, sign * 70.0), -1.0);
  }
}

// A firmware that does not let its field wrap: the way says how fast it is.
TEST(CubemarsMit, AShaftBeyondAFieldThatIsCutOffIsBrakedWithinTheLimit) {
  auto settings = mit();
  settings.effort_limit = 4.0F;
  const double end_rad_s = setupOf(settings).ranges.velocity_rad_s;
  const double fast_rad_s = 1.4 * end_rad_s;
  for (const double sign : {1.0, -1.0}) {
    Mit bench(settings);
    double rad = 0.0;
    (void)bench.feedMit(0.0);
    for (int i = 0; i < 100; ++i) {
      rad += sign * fast_rad_s * 1e-3;
      (void)bench.feedMit(rad, sign * end_rad_s);
    }
    EXPECT_NEAR(bench.motor().feedback().velocity_rpm, sign * end_rad_s * 30.0 / kPi, 0.3);
    const double sum_nm =
        sign * bench.sumNm(bench.command({.mode = ControlMode::kBrake}), 0.0, sign * fast_rad_s);
    EXPECT_LT(sum_nm, -1.0);
    EXPECT_GE(sum_nm, -4.0 * 9 * 0.091 - 0.1);
  }
}

TEST(CubemarsMit, OutsideOfTheFieldAnAngleOnlyDamps) {
  Mit bench(mit());
  double rad = 11.0;
  (void)bench.feedMit(rad);
  while (rad < 14.0) (void)bench.feedMit(rad += 0.05);
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
    while (rad < 14.0) (void)bench.feedMit(rad += 0.05, 20.0);
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
  EXPECT_FALSE(bench.motor().feedback().angle_at_end);
  (void)bench.feedMit(12.5);
  EXPECT_FALSE(bench.motor().feedback().zeroed);
  EXPECT_TRUE(bench.motor().feedback().angle_at_end);
  EXPECT_FALSE(bench.motor().setZero(0.0)) << "the next sample would lose it";
  EXPECT_FALSE(bench.motor().feedback().zeroed);
  (void)bench.feedMit(12.0);
  EXPECT_FALSE(bench.motor().feedback().angle_at_end);
}

TEST(CubemarsMit, ATurnThatIsUnknownAfterASilenceTakesNoZeroWithinATravel) {
  for (const bool limited : {true, false}) {
    auto settings = mit();
    if (limited) settings.travel = {-100.0, 100.0};
    Mit bench(settings);
    double rad = 11.0;
    (void)bench.feedMit(rad);
    while (rad < 14.0) (void)bench.feedMit(rad += 0.05);
    EXPECT_FALSE(bench.motor().feedback().zero_refused);
    (void)bench.feedMit(rad, 0.0, 0.0, 0, milliseconds{200});
    EXPECT_EQ(bench.motor().feedback().zero_refused, limited);
    EXPECT_EQ(bench.motor().setZero(0.0), !limited);
  }
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

TEST(CubemarsMitV3, AShaftFasterThanItsVelocityFieldIsBrakedWithinTheLimit) {
  const auto torqueAt = [](double rpm) {
    Mit bench(mitV3());
    (void)bench.feedServo(0.0);
    (void)bench.feedServo(0.0, 168.0 * rpm);
    const auto command = bench.decode(bench.command({.mode = ControlMode::kVelocity}));
    return command.damping_nms_per_rad * (command.velocity_rad_s - rpm * kRadPerSPerRpm);
  };
  const double most_nm = torqueAt(-300.0);
  EXPECT_NEAR(torqueAt(-290.0), most_nm, 0.02 * most_nm) << "its limit";
  for (const double rpm : {-400.0, -600.0, -1000.0}) EXPECT_NEAR(torqueAt(rpm), most_nm, 0.05 * most_nm);
}

}  // namespace
}  // namespace rc10::test::cubemars_mit_test
