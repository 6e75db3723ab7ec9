#include "client/hand_turn.hpp"

#include <gmock/gmock.h>

#include "fake_rc10d.hpp"

namespace rc10::client::test::hand_turn_test {
namespace {

using rc10::test::heroWelcome;
using testing::HasSubstr;
using Outcome = HandTurn::Outcome;

HandTurn turn(double first_deg, double second_deg, bool angle_lost = false) {
  link::State before;
  before.motor_count = 2;
  before.motors[0].total_angle_deg = 1000.0;
  auto after = before;
  after.motors[0].total_angle_deg += first_deg;
  after.motors[1].total_angle_deg += second_deg;
  return judgeHandTurn(before, after, 0, angle_lost);
}

TEST(HandTurn, OneTurnCounterClockwiseOfTheRightMotorIsGood) {
  EXPECT_EQ(turn(355.0, 2.0).outcome, Outcome::kGood);
  EXPECT_EQ(turn(330.0, 2.0).outcome, Outcome::kGood);
  EXPECT_EQ(turn(390.0, 2.0).outcome, Outcome::kGood);
}

TEST(HandTurn, ATouchIsNoTurn) { EXPECT_EQ(turn(5.0, -3.0).outcome, Outcome::kNotTurned); }

TEST(HandTurn, AnotherMotorThatTurnsHasTheWrongName) {
  const auto other = turn(0.5, 360.0);
  EXPECT_EQ(other.outcome, Outcome::kOtherMotor);
  EXPECT_THAT(text(other, heroWelcome(), 0), HasSubstr("yaw turned by 360.0 deg, and front_left did not"));
}

TEST(HandTurn, ClockwiseIsTheWrongSign) {
  EXPECT_EQ(turn(-360.0, 0.0).outcome, Outcome::kWrongSign);
  EXPECT_THAT(text(turn(-360.0, 0.0), heroWelcome(), 0), HasSubstr("direction: -1"));
}

TEST(HandTurn, AnEighthOfATurnTooMuchIsNoWholeTurn) {
  EXPECT_EQ(turn(402.7, 0.0).outcome, Outcome::kWrongRatio);
  EXPECT_EQ(turn(317.0, 0.0).outcome, Outcome::kWrongRatio);
}

TEST(HandTurn, AGapThatMayHideATurnLeavesNothingToJudge) {
  for (const double first_deg : {0.0, 360.0, -360.0, 720.0}) {
    const auto lost = turn(first_deg, 0.0, true);
    EXPECT_EQ(lost.outcome, Outcome::kAngleLost);
    EXPECT_THAT(text(lost, heroWelcome(), 0), HasSubstr("front_left's feedback had a gap"));
  }
}

TEST(HandTurn, AnotherAngleSaysTheRatio) {
  // The configuration has half the ratio of the gearbox.
  const auto bare = turn(720.0, 0.0);
  EXPECT_EQ(bare.outcome, Outcome::kWrongRatio);
  EXPECT_NEAR(bare.ratio_factor, 2.0, 1e-9);
  EXPECT_THAT(text(bare, heroWelcome(), 0), HasSubstr("multiply `gear_ratio` of front_left by 2.000"));
}

}  // namespace
}  // namespace rc10::client::test::hand_turn_test
