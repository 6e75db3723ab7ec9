#include "client/first_spin.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include <gmock/gmock.h>

namespace rc10::client::test::first_spin_test {
namespace {

using testing::HasSubstr;
using Outcome = FirstSpin::Outcome;
using Double = std::numeric_limits<double>;

constexpr double kNan = Double::quiet_NaN();
constexpr double kInfinity = Double::infinity();

constexpr Duration kTurn = std::chrono::milliseconds{20};

struct Seen {
  double angle_deg;
  float velocity_rpm;
  std::uint32_t limits = 0;
};

std::int64_t asUs(MonotonicTime time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
}

link::MotorState state(const Seen& seen) {
  link::MotorState motor;
  motor.total_angle_deg = seen.angle_deg;
  motor.velocity_rpm = seen.velocity_rpm;
  motor.limits = seen.limits;
  return motor;
}

class FirstSpinTest : public ::testing::Test {
 protected:
  /// A second of these states, each for the same time, as long as it goes on; the number of those taken.
  std::size_t spin(std::initializer_list<Seen> states) {
    std::size_t taken = 0;
    for (const auto& each : states) {
      ++taken;
      for (const auto end = now + FirstSpin::kTime / static_cast<int>(states.size()); now < end;
           now += kTurn) {
        if (!turn(each)) return taken;
      }
    }
    return taken;
  }
  /// A turn of the program, with a state of this age.
  bool turn(const Seen& seen, Duration age = std::chrono::milliseconds{5}) {
    return first.goesOn(state(seen), asUs(now - age), now);
  }
  std::string words() { return text(first, "wheel"); }

  FirstSpin first{60.0};
  MonotonicTime now{std::chrono::seconds{1000}};
};

TEST_F(FirstSpinTest, AMotorThatTurnsWithTheCurrentIsReady) {
  EXPECT_EQ(spin({{358.0, 0.0F}, {380.0, 30.0F}, {442.8, 40.0F}}), 3U);
  EXPECT_EQ(first.outcome(), Outcome::kRight);
  EXPECT_EQ(words(), "wheel turned by 84.8 deg the right way: it is ready");
}

TEST_F(FirstSpinTest, AMotorWhoseTurnsWereNotCountedIsNotJudged) {
  EXPECT_EQ(spin({{358.0, 0.0F}, {380.0, 30.0F}}), 2U);
  first.loseAngle();
  EXPECT_EQ(spin({{20.0, 40.0F}, {40.0, 40.0F}}), 1U);
  EXPECT_EQ(first.outcome(), Outcome::kAngleLost);
  EXPECT_THAT(words(), HasSubstr("commission again"));
}

TEST_F(FirstSpinTest, OverSpeedEndsItAndIsASuccessHoweverShortTheWay) {
  EXPECT_EQ(spin({{0.0, 0.0F}, {0.5, 30.0F}, {2.0, 61.0F}, {9.0, 90.0F}}), 3U);
  EXPECT_EQ(first.outcome(), Outcome::kRight);
  EXPECT_THAT(words(), HasSubstr("2.0 deg the right way"));
}

TEST_F(FirstSpinTest, TheOverSpeedItselfIsNotBeyondIt) {
  EXPECT_EQ(spin({{0.0, 0.0F}, {20.0, 60.0F}, {40.0, -60.0F}}), 3U);
}

TEST_F(FirstSpinTest, AgainstTheCurrentIsTheWrongWay) {
  (void)spin({{0.0, 0.0F}, {-3.0, -20.0F}, {-30.0, -40.0F}});
  EXPECT_EQ(first.outcome(), Outcome::kWrongWay);
  EXPECT_THAT(words(), HasSubstr("wheel turned by -30.0 deg with a positive current: the drive's current has "
                                 "the other sign than its encoder"));
}

TEST_F(FirstSpinTest, OverSpeedAgainstTheCurrentEndsItAndIsTheWrongWay) {
  EXPECT_EQ(spin({{0.0, 0.0F}, {-1.0, -61.0F}, {-9.0, -90.0F}}), 2U);
  EXPECT_EQ(first.outcome(), Outcome::kWrongWay);
}

TEST_F(FirstSpinTest, AStalledMotorHasNotMoved) {
  for (const double end_deg : {0.0, 4.9, -4.9}) {
    first = FirstSpin{60.0};
    EXPECT_EQ(spin({{100.0, 0.0F}, {100.0 + end_deg, 1.0F}}), 2U);
    EXPECT_EQ(first.outcome(), Outcome::kNotMoved) << end_deg;
  }
  EXPECT_THAT(words(), HasSubstr("it did not move: is it blocked, or the current too small (--limit)?"));
}

TEST_F(FirstSpinTest, AMotorThatASoftLimitHoldsIsToldToBeTurnedBack) {
  EXPECT_EQ(spin({{402.7, 0.0F, kLimitAngle}}), 1U);
  EXPECT_EQ(first.outcome(), Outcome::kAtLimit);
  EXPECT_THAT(words(), HasSubstr("its soft limits (angle_min_deg, angle_max_deg) hold it: turn it by hand"));
}

TEST_F(FirstSpinTest, AShaftThatTurnsBeforeTheCurrentBeginsSaysNothing) {
  for (const float velocity_rpm : {90.0F, -90.0F}) {
    first = FirstSpin{60.0};
    EXPECT_EQ(spin({{100.0, velocity_rpm}, {200.0, velocity_rpm}}), 1U);
    EXPECT_EQ(first.outcome(), Outcome::kTurnedSoon);
    EXPECT_THAT(words(), HasSubstr("let it come to rest"));
  }
}

TEST_F(FirstSpinTest, ASpeedAgainstTheAngleIsNoSuccess) {
  for (const Seen& seen : {Seen{-20.0, 70.0F}, Seen{20.0, -70.0F}, Seen{0.0, 70.0F}}) {
    first = FirstSpin{60.0};
    EXPECT_EQ(spin({{0.0, 0.0F}, seen}), 2U);
    EXPECT_EQ(first.outcome(), Outcome::kDisagree);
    EXPECT_THAT(words(), HasSubstr("wrong sign"));
  }
}

TEST_F(FirstSpinTest, WithoutASpeedOrAnAngleItEndsAndNothingIsJudged) {
  for (const Seen& seen : {Seen{20.0, NAN}, Seen{kNan, 10.0F}, Seen{kNan, NAN}, Seen{kInfinity, 10.0F}}) {
    first = FirstSpin{60.0};
    EXPECT_EQ(spin({{0.0, 0.0F}, seen, {90.0, 10.0F}}), 2U);
    EXPECT_EQ(first.outcome(), Outcome::kUnknown);
    EXPECT_THAT(words(), HasSubstr("nothing can be judged"));
  }
}

TEST_F(FirstSpinTest, AnOldStateEndsItAndNothingIsJudged) {
  for (int ms = 0; ms <= 100; ms += 20, now += kTurn)
    EXPECT_TRUE(turn({0.0, 0.0F}, std::chrono::milliseconds{ms}));
  EXPECT_FALSE(turn({0.0, 0.0F}, std::chrono::milliseconds{101}));
  EXPECT_EQ(first.outcome(), Outcome::kLate);
  EXPECT_THAT(words(), HasSubstr("nothing can be judged: commission again"));
}

TEST_F(FirstSpinTest, OldFeedbackInAYoungStateEndsItToo) {
  auto motor = state({0.0, 0.0F});
  motor.feedback_age_us = 200'000;
  EXPECT_TRUE(first.goesOn(motor, asUs(now), now));
  motor.feedback_age_us = 200'001;
  EXPECT_FALSE(first.goesOn(motor, asUs(now), now));
  EXPECT_EQ(first.outcome(), Outcome::kLate);
}

TEST_F(FirstSpinTest, AfterAPauseInTheSpinNothingIsJudged) {
  EXPECT_TRUE(turn({0.0, 0.0F}));
  now += std::chrono::milliseconds{101};
  EXPECT_FALSE(turn({90.0, 10.0F}));
  EXPECT_EQ(first.outcome(), Outcome::kLate);
}

TEST_F(FirstSpinTest, APauseToTheEndOfTheSpinIsNoStandstill) {
  for (int turns = 0; turns < 44; ++turns, now += kTurn) EXPECT_TRUE(turn({0.0, 0.0F}));
  EXPECT_EQ(first.outcome(), Outcome::kLate);
  for (int turns = 0; turns < 2; ++turns, now += kTurn) EXPECT_TRUE(turn({0.0, 0.0F}));
  EXPECT_EQ(first.outcome(), Outcome::kNotMoved);
}

TEST_F(FirstSpinTest, StatesThatAreTooRareAreRefusedWithTheKey) {
  EXPECT_EQ(whyTooRare(20), "");
  EXPECT_THAT(whyTooRare(19), HasSubstr("`lcm: {state_hz: 19}` makes them too rare to end a spin in time"));
}

TEST_F(FirstSpinTest, NothingSeenIsNoSuccess) { EXPECT_EQ(first.outcome(), Outcome::kUnknown); }

}  // namespace
}  // namespace rc10::client::test::first_spin_test
