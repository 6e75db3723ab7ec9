#include "module/joint_homing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include <gmock/gmock.h>

#include "joint_bench.hpp"

namespace rc10::test::joint_homing_test {
namespace {

using namespace joint_bench;
using namespace std::chrono_literals;
using ::testing::ElementsAre;

/// A joint that homes at a stop, or at a switch, and has no reference yet.
class HomingJoint : public JointBench {
 protected:
  void buildHoming(const char* way = "stop", double timeout_s = 5.0) {
    auto own = jointSettings();
    own.own.set("homing_timeout_s", timeout_s);
    own.own.set("homing", std::string{way});
    if (std::string_view{way} == "switch") own.own.set("switch", std::string{"limit.closed"});
    build(own);
    robot_.motor(0).feedback.zeroed = false;
    stop_deg_ = -15.0;
    showSwitch();
  }
  void buildWithStop() {
    auto own = jointSettings();
    own.own.set("homing", std::string{"stop"});
    build(own);
  }
  void homeOnce() {
    ask(kNoSignal, 1.0);
    for (int i = 0; i < 20'000 && state() != kFollowing; ++i) run(1);
    ASSERT_EQ(state(), kFollowing);
    events_.clear();
  }
  void fallSilent(int ticks) {
    module_->clearInputs();
    run(ticks);
  }
};

TEST_F(HomingJoint, FindsItsReferenceAtAStop) {
  buildWithStop();
  robot_.motor(0).feedback.zeroed = false;
  robot_.motor(0).feedback.total_angle_deg = 1000.0;
  stop_deg_ = 980.0;
  ask(kNoSignal, 1.0);
  run(1);
  EXPECT_EQ(state(), kHoming);
  EXPECT_EQ(mode(), ControlMode::kCurrent);
  EXPECT_GT(target(), 0.0) << "away from the end first";
  double most_a = 0.0;
  for (int i = 0; i < 4000 && state() == kHoming; ++i) {
    run(1);
    if (mode() == ControlMode::kCurrent) most_a = std::max(most_a, std::fabs(target()));
  }
  EXPECT_LE(most_a, 0.5);
  EXPECT_THAT(events_, ElementsAre(0U));
  EXPECT_NEAR(angle(), -30.0, 0.01);
  ask(-10.0);
  run(3000);
  EXPECT_EQ(angle(), -10.0);
}

TEST_F(HomingJoint, AGapInTheStreamOfItsClientIsNoNewHoming) {
  buildHoming();
  homeOnce();
  fallSilent(900);
  ask(kNoSignal, 1.0);
  run(10);
  EXPECT_EQ(state(), kFollowing);
  EXPECT_TRUE(robot_.motor(0).feedback.zeroed);
}

TEST_F(HomingJoint, IsHomedAgainOnceHomeHasFallenOrNobodyCommandsItForASecond) {
  buildHoming();
  homeOnce();
  ask(kNoSignal);  // a message that does not name it
  run(1);
  ask(kNoSignal, 1.0);
  run(1);
  EXPECT_EQ(state(), kHoming);
  homeOnce();
  fallSilent(1001);
  ask(kNoSignal, 1.0);
  run(1);
  EXPECT_EQ(state(), kHoming);
}

TEST_F(HomingJoint, AHomingEndsWhenAnotherClientTakesTheJointOver) {
  buildHoming();
  ask(kNoSignal, 1.0);
  run(200);
  module_->changeSender();
  ask(20.0);
  run(1);
  EXPECT_EQ(state(), kIdle);
  EXPECT_THAT(events_, ElementsAre(8U)) << "homing has ended";
  ask(20.0, 1.0);
  run(1);
  EXPECT_EQ(state(), kHoming) << "asked for by that one";
}

TEST_F(HomingJoint, WhatAnotherSaidMeanwhileMakesNoNewHomingOfAStreamThatGoesOn) {
  buildHoming();
  homeOnce();
  module_->changeSender();
  ask(-10.0);
  run(5);
  module_->changeSender();
  ask(-10.0, 1.0);
  run(10);
  EXPECT_EQ(state(), kFollowing);
  EXPECT_TRUE(robot_.motor(0).feedback.zeroed);
}

TEST_F(HomingJoint, AHomingThatAGapInterruptsBeginsAnewAndOneThatFailedDoesNot) {
  buildHoming();
  ask(kNoSignal, 1.0);
  run(200);
  fallSilent(60);
  EXPECT_EQ(state(), kIdle);
  ask(kNoSignal, 1.0);
  run(1);
  EXPECT_EQ(state(), kHoming);
  blocked_ = true;
  run(5100);
  ASSERT_EQ(state(), kHomingFailed);
  fallSilent(60);
  ask(kNoSignal, 1.0);
  run(10);
  EXPECT_EQ(state(), kHomingFailed);
}

TEST_F(HomingJoint, AMotorThatIsStoppedAndEnabledAgainInTheMiddleOfAHomingRests) {
  for (const int ticks : {1, 60, 300, 700, 850, 950, 1100}) {
    buildHoming();
    robot_.motor(0).feedback.total_angle_deg = 0.0;
    robot_.motor(0).feedback.zeroed = true;
    rpm_ = flows_a_ = 0.0;
    events_.clear();
    ask(kNoSignal, 1.0);
    run(ticks);
    ASSERT_EQ(state(), kHoming) << ticks;
    robot_.motor(0).status = MotorStatus::kReady;
    run(1);
    EXPECT_EQ(state(), kIdle);
    EXPECT_FALSE(robot_.motor(0).target.has_value());
    EXPECT_THAT(events_, ElementsAre(8U));
    robot_.motor(0).status = MotorStatus::kActive;
    ask(20.0, 1.0);
    run(50);
    EXPECT_EQ(state(), kIdle);
    EXPECT_FALSE(robot_.motor(0).target.has_value());
    EXPECT_EQ(module_->outputs()[4], 0.0) << "what it is counted from is in doubt";
    ask(20.0, 0.0);
    run(1);
    ask(20.0, 1.0);
    run(1);
    EXPECT_EQ(state(), kHoming);
  }
}

TEST_F(HomingJoint, SaysThatItCannotHomeAMotorThatDoesNotObey) {
  buildHoming();
  robot_.motor(0).status = MotorStatus::kReady;
  ask(kNoSignal, 1.0);
  run(10);
  EXPECT_THAT(events_, ElementsAre(8U));
  robot_.motor(0).status = MotorStatus::kActive;
  run(10);
  EXPECT_EQ(state(), kIdle) << "it asks no more: it went on asking";
}

TEST_F(HomingJoint, ThatFailsLeavesAnAxisWithoutAReference) {
  buildHoming();
  robot_.motor(0).feedback.zeroed = true;
  blocked_ = true;
  ask(kNoSignal, 1.0);
  run(5100);
  ASSERT_EQ(state(), kHomingFailed);
  robot_.motor(0).status = MotorStatus::kReady;
  run(1);
  robot_.motor(0).status = MotorStatus::kActive;
  ask(20.0);
  run(10);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

TEST_F(HomingJoint, FindsTheStopFromItsFarEnd) {
  buildHoming();
  far_deg_ = robot_.motor(0).feedback.total_angle_deg = 40.0;
  homeOnce();
  EXPECT_NEAR(angle(), -30.0, 0.01);
}

TEST_F(HomingJoint, ABeltThatIsTornIsNoWayWithoutEnd) {
  buildHoming();
  stop_deg_ = -1e6;
  auto own = jointSettings();
  ask(kNoSignal, 1.0);
  run(5100);  // the timeout is 5 s: 150 deg
  EXPECT_THAT(events_, ElementsAre(1U));
  own.own.set("homing", std::string{"stop"});
  own.own.set("homing_timeout_s", 60.0);
  build(own);
  events_.clear();
  const double start_deg = angle();
  ask(kNoSignal, 1.0);
  run(30'000);
  EXPECT_THAT(events_, ElementsAre(5U));
  EXPECT_GT(angle(), start_deg - 220.0) << "its travel is 210 deg";
}

TEST_F(HomingJoint, ASwitchThatStaysClosedIsFoundByTheFarStopAndNotPressedUntilTheTimeout) {
  buildHoming("switch");
  stuck_ = true;
  far_deg_ = 20.0;
  ask(kNoSignal, 1.0);
  run(2000);
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(events_, ElementsAre(1U));
}

TEST_F(HomingJoint, AStopBeforeTheSwitchIsNoEnd) {
  buildHoming("switch");
  stop_deg_ = -1e6;
  far_deg_ = 1e6;
  ask(kNoSignal, 1.0);
  run(1);
  for (int i = 0; i < 4000 && state() == kHoming; ++i) {
    run(1);
    blocked_ = angle() < -10.0;
  }
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(events_, ElementsAre(5U));
}

TEST_F(HomingJoint, OneWrongSampleOfTheSwitchIsNoHome) {
  buildHoming("switch");
  ask(kNoSignal, 1.0);
  run(400);
  robot_.setOutput({.module = 0, .signal = 0}, 1.0);
  run(3000);
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_FALSE(robot_.motor(0).feedback.zeroed);
}

TEST_F(HomingJoint, ACurrentThatRisesSlowlyIsWaitedFor) {
  buildHoming("stop", 20.0);
  slew_a_ = 0.0005;  // 0.5 A/s: a second to the stop's whole current
  friction_a_ = 0.1;
  homeOnce();
  EXPECT_NEAR(angle(), -30.0, 0.01);
}

TEST_F(HomingJoint, AStiffPlaceIsNoStopHoweverItsCurrentRisesAndWhoeverKnowsIt) {
  struct Case {
    bool told;
    double share;  ///< Share of the current; a half does not pass the place.
    double slew_a;
  };
  for (const double slew_a : {0.0005, 1e6}) {
    for (const auto& each : {Case{true, 1.0, slew_a}, Case{true, 0.5, slew_a}, Case{false, 1.0, slew_a},
                             Case{false, 0.5, slew_a}}) {
      SCOPED_TRACE(::testing::Message() << each.told << ", share " << each.share << ", slew " << slew_a);
      buildHoming("stop", 30.0);
      events_.clear();
      rpm_ = flows_a_ = 0.0;
      robot_.motor(0).feedback.total_angle_deg = 40.0;
      stop_deg_ = 0.0;
      stiff_deg_ = 20.0;
      stiff_a_ = 0.3;
      slew_a_ = each.slew_a;
      gets_ = each.share;
      tells_current_ = each.told;
      ask(kNoSignal, 1.0);
      run(1);
      for (int i = 0; i < 31'000 && state() == kHoming; ++i) run(1);
      const bool found = each.told && each.share == 1.0;
      EXPECT_EQ(state(), found ? kFollowing : kHomingFailed);
      EXPECT_THAT(events_, ElementsAre(found ? 0U : 5U));
      EXPECT_EQ(robot_.motor(0).feedback.zeroed, found);
      if (found) {
        EXPECT_NEAR(stop_deg_, -30.0, 0.01) << "the end, and not the place before it";
      }
    }
  }
}

TEST_F(HomingJoint, FindsASwitchFromItsFarEndWithADriveThatTellsNoCurrent) {
  buildHoming("switch", 10.0);
  tells_current_ = false;
  far_deg_ = robot_.motor(0).feedback.total_angle_deg = 40.0;
  homeOnce();
  EXPECT_NEAR(angle(), -30.0, 0.6);
}

TEST(JointHoming, TheSpeedOfReducedModeIsNoStandstillAndIsNotPushedAgainst) {
  JointHoming homing{
      {.velocity_rpm = -10.0, .current_a = 0.5, .away_deg = 20.0, .stopped = 200ms, .timeout = 10s}};
  JointHoming::Measured measured{.velocity_rpm = 0.5, .current_a = 0.5, .speed_ceiling_rpm = 0.5};
  measured.received = measured.now = MonotonicTime{1s};
  homing.start(measured);
  for (int i = 0; i < 2000; ++i) {
    measured.total_angle_deg += 0.5 * 6.0 * 0.001;
    measured.received = measured.now += 1ms;
    ASSERT_EQ(homing.step(measured), JointHoming::Progress::kUnderWay);
    ASSERT_EQ(homing.current(), 0.0) << "after " << i << " ms";
  }
}

TEST(JointHoming, AGapOfTheFeedbackWhereItTurnsRoundIsNoStandstill) {
  JointHoming homing(
      {.velocity_rpm = -5.0, .current_a = 1.0, .away_deg = 3.0, .stopped = 100ms, .timeout = 10s});
  JointHoming::Measured measured{.current_a = std::numeric_limits<double>::quiet_NaN()};
  const auto sample = [&](double deg, double rpm) {
    measured.now += 1ms;
    measured.received = measured.now;
    measured.total_angle_deg = deg;
    measured.velocity_rpm = rpm;
    return homing.step(measured);
  };
  homing.start(measured);
  EXPECT_EQ(sample(1.0, 5.0), JointHoming::Progress::kUnderWay);
  EXPECT_EQ(sample(3.1, 0.0), JointHoming::Progress::kUnderWay);
  for (int i = 0; i < 500; ++i) {
    measured.now += 1ms;  // no sample comes
    ASSERT_EQ(homing.step(measured), JointHoming::Progress::kUnderWay);
  }
  EXPECT_EQ(sample(-20.0, -5.0), JointHoming::Progress::kUnderWay);
}

/// A rotor without friction, far from a stop on one side: 40 deg.
struct LightAxis {
  double deg = 0.0;
  double rpm = 0.0;
  double fastest_rpm = 0.0;
  static constexpr double kRpmPerSPerA = 800.0;  // 0.05 Nm/A on 6e-4 kg m^2
  void step(double current_a) {
    rpm += current_a * kRpmPerSPerA * 0.001;
    deg = std::max(deg + rpm * 0.006, -40.0);
    if (deg == -40.0) rpm = std::max(rpm, 0.0);
    fastest_rpm = std::max(fastest_rpm, std::fabs(rpm));
  }
};

/// Homes the axis. A sample comes every `every_ms`, with the current that `told` makes of the time and the
/// true one.
template <typename Told>
JointHoming::Progress home(LightAxis& axis, Duration stopped, int every_ms, Told told) {
  JointHoming homing(
      {.velocity_rpm = -10.0, .current_a = 4.0, .away_deg = 5.0, .stopped = stopped, .timeout = 10s});
  JointHoming::Measured measured;
  homing.start(measured);
  auto progress = JointHoming::Progress::kUnderWay;
  for (int ms = 1; progress == JointHoming::Progress::kUnderWay; ++ms) {
    axis.step(homing.current());
    measured.now += 1ms;
    if (ms % every_ms == 0) {
      measured.received = measured.now;
      measured.total_angle_deg = axis.deg;
      measured.velocity_rpm = axis.rpm;
      measured.current_a = told(ms, homing.current());
    }
    progress = homing.step(measured);
  }
  return progress;
}

TEST(JointHoming, ALightAxisIsNotThrownByFeedbackThatComesSlowly) {
  for (const int every_ms : {1, 2, 5, 10, 20, 50}) {
    LightAxis axis;
    const auto progress = home(axis, 200ms, every_ms, [](int, double current_a) { return current_a; });
    EXPECT_EQ(progress, JointHoming::Progress::kFound) << every_ms << " ms";
    EXPECT_LT(axis.fastest_rpm, 20.0) << every_ms << " ms";
  }
}

TEST(JointHoming, AGapOfTheCurrentIsWaitedForAndIsNoFullCurrent) {
  LightAxis axis;
  int told = 0;
  const auto progress = home(axis, 100ms, 1, [&](int ms, double current_a) {
    if (ms % 800 != 0) return std::numeric_limits<double>::quiet_NaN();
    if (axis.deg == -40.0) ++told;
    return current_a;
  });
  EXPECT_EQ(progress, JointHoming::Progress::kFound);
  EXPECT_GE(told, 2) << "once for each meeting with the end";
}

TEST_F(HomingJoint, AZeroThatItsMotorRefusesIsNoHome) {
  auto own = jointSettings();
  own.own.set("homing", std::string{"stop"});
  for (const bool known : {true, false}) {
    build(own);
    events_.clear();
    robot_.motor(0).feedback.zeroed = known;
    robot_.motor(0).feedback.total_angle_deg = 1000.0;
    stop_deg_ = 980.0;
    zeroes_ = false;
    ask(kNoSignal, 1.0);
    run(5100);
    EXPECT_EQ(state(), kHomingFailed);
    EXPECT_THAT(events_, ElementsAre(7U));
    EXPECT_FALSE(robot_.motor(0).target.has_value());
  }
}

TEST_F(HomingJoint, AZeroThatIsSureToBeRefusedBeginsNoHomingAndKeepsTheAngle) {
  for (const bool known : {true, false}) {
    buildWithStop();
    events_.clear();
    const int forgotten = robot_.forgotten();
    robot_.motor(0).feedback.zeroed = known;
    robot_.motor(0).feedback.bounds_only = !known;
    robot_.motor(0).feedback.zero_refused = true;
    ask(kNoSignal, 1.0);
    for (int i = 0; i < 200; ++i) {
      run(1);
      ASSERT_FALSE(robot_.motor(0).target.has_value()) << "nothing is pressed";
    }
    EXPECT_EQ(robot_.forgotten(), forgotten);
    EXPECT_EQ(robot_.motor(0).feedback.zeroed, known);
    EXPECT_EQ(state(), known ? kIdle : kHomingFailed);
    EXPECT_THAT(events_, ElementsAre(7U));
    robot_.motor(0).feedback.zero_refused = false;  // it was enabled anew
    ask(kNoSignal, 0.0);
    run(1);
    ask(kNoSignal, 1.0);
    run(1);
    EXPECT_EQ(state(), kHoming);
  }
}

TEST_F(HomingJoint, AStandstillThatGravityMakesIsNotTheStop) {
  buildWithStop();
  robot_.motor(0).feedback.zeroed = false;
  robot_.motor(0).feedback.total_angle_deg = 40.0;
  stop_deg_ = 0.0;
  gravity_a_ = 0.499;  // of 0.5: it creeps towards the stop more slowly than a standstill
  ask(kNoSignal, 1.0);
  run(5100);
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(events_, ElementsAre(5U));
  EXPECT_FALSE(robot_.motor(0).feedback.zeroed);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

TEST_F(HomingJoint, AStopThatIsMetAtTwoPlacesIsNone) {
  buildWithStop();
  robot_.motor(0).feedback.zeroed = false;
  robot_.motor(0).feedback.total_angle_deg = 10.0;
  stop_deg_ = 0.0;
  int pressed = 0;
  ask(kNoSignal, 1.0);
  run(1);
  for (int i = 0; i < 5100 && state() == kHoming; ++i) {
    run(1);
    if (state() == kHoming && angle() == 0.0 && ++pressed > 110)
      stop_deg_ = -2.0;  // something soft lay before it
  }
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(events_, ElementsAre(5U));
}

TEST_F(HomingJoint, AStopBeyondTheTravelIsNone) {
  auto own = jointSettings();
  own.own.set("homing", std::string{"stop"});
  own.own.set("homing_timeout_s", 60.0);
  build(own);
  robot_.motor(0).feedback.zeroed = false;
  robot_.motor(0).feedback.total_angle_deg = 230.0;  // the travel is 210 deg from the stop
  stop_deg_ = 0.0;
  ask(kNoSignal, 1.0);
  run(30'000);
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(events_, ElementsAre(5U));
}

TEST_F(HomingJoint, AMotorThatGetsLessThanTheHomingCurrentDoesNotFindTheStop) {
  buildWithStop();
  robot_.motor(0).feedback.zeroed = false;
  robot_.motor(0).feedback.total_angle_deg = 10.0;
  stop_deg_ = 0.0;
  gets_ = 0.5;
  ask(kNoSignal, 1.0);
  run(5100);
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(events_, ElementsAre(5U));
}

TEST_F(HomingJoint, AnAxisThatBeginsAtItsStopIsHomed) {
  buildWithStop();
  robot_.motor(0).feedback.zeroed = false;
  stop_deg_ = robot_.motor(0).feedback.total_angle_deg = 7.0;
  ask(kNoSignal, 1.0);
  run(4000);
  EXPECT_THAT(events_, ElementsAre(0U));
  EXPECT_NEAR(angle(), -30.0, 0.01);
}

TEST_F(HomingJoint, FindsItsReferenceAtASwitch) {
  buildHoming("switch");
  ask(kNoSignal, 1.0);
  run(3000);
  EXPECT_THAT(events_, ElementsAre(0U));
  EXPECT_NEAR(angle(), -30.0, 0.6);
}

TEST_F(HomingJoint, DoesNotLookForASwitchThatNobodyHears) {
  buildHoming("switch");
  ask(kNoSignal, 1.0);
  run(100);
  ASSERT_EQ(state(), kHoming);
  switch_heard_ = false;
  showSwitch();
  run(1);
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  EXPECT_THAT(events_, ElementsAre(4U));
}

TEST_F(HomingJoint, GivesUpNoAngleForASwitchThatNobodyHears) {
  buildHoming("switch");
  robot_.motor(0).feedback.zeroed = true;
  switch_heard_ = false;
  showSwitch();
  ask(20.0, 0.0);
  run(500);
  ASSERT_EQ(state(), kFollowing);
  ask(20.0, 1.0);
  run(2);
  EXPECT_EQ(state(), kFollowing);
  EXPECT_EQ(mode(), ControlMode::kTotalAngle);
  EXPECT_TRUE(robot_.motor(0).feedback.zeroed);
  EXPECT_THAT(events_, ElementsAre(4U)) << "it is told";
  robot_.motor(0).feedback.zeroed = false;
  ask(20.0, 0.0);
  run(2);
  ask(20.0, 1.0);
  run(2);
  EXPECT_EQ(state(), kHomingFailed) << "it has none";
}

TEST_F(HomingJoint, AnAxisThatDoesNotMoveIsNotHomed) {
  buildWithStop();
  robot_.motor(0).feedback.zeroed = false;
  blocked_ = true;
  ask(kNoSignal, 1.0);
  run(5100);
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(events_, ElementsAre(1U));
  EXPECT_FALSE(robot_.motor(0).feedback.zeroed);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

TEST_F(HomingJoint, AHomingThatNobodyWatchesEnds) {
  buildWithStop();
  ask(kNoSignal, 1.0);
  run(10);
  module_->clearInputs();
  run(1);
  EXPECT_EQ(state(), kIdle);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

}  // namespace
}  // namespace rc10::test::joint_homing_test
