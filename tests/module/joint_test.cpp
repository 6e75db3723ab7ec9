#include "module/joint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include <gmock/gmock.h>

#include "joint_bench.hpp"

namespace rc10::test::joint_test {
namespace {

using namespace joint_bench;
using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Joint : public JointBench {};

TEST_F(Joint, MovesOnAProfileAndSaysWhenItIsDone) {
  build(jointSettings());
  ask(90.0);
  run(1);
  EXPECT_LT(target(), 0.01) << "it begins where it is";
  EXPECT_EQ(moved(), kUnderWay);
  double fastest_deg_s = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double before_deg = angle();
    run(1);
    fastest_deg_s = std::max(fastest_deg_s, (angle() - before_deg) * 1000.0);
  }
  EXPECT_NEAR(fastest_deg_s, 90.0, 0.1);
  EXPECT_EQ(angle(), 90.0);
  EXPECT_EQ(moved(), kDone);
  EXPECT_EQ(state(), kFollowing);
}

TEST_F(Joint, FeedsTheVelocityForward) {
  build(jointSettings());
  ask(90.0);
  run(500);
  EXPECT_NEAR(robot_.motor(0).target->velocity_ff_rpm, 15.0F, 0.1F);
}

TEST_F(Joint, StopsAtTheSoftLimitAndSaysSoOnce) {
  build(jointSettings());
  ask(270.0);
  run(4000);
  EXPECT_EQ(angle(), 180.0);
  EXPECT_EQ(moved(), kDone);
  EXPECT_THAT(events_, ElementsAre(3U));
}

TEST_F(Joint, AMoveThatDoesNotGetThereHasFailed) {
  build(jointSettings());
  blocked_ = true;
  ask(90.0);
  run(2000);
  EXPECT_EQ(moved(), kFailed);
  EXPECT_THAT(events_, ElementsAre(2U));
}

TEST_F(Joint, ANewTargetInTheMiddleOfAMoveIsReachedWithoutAJump) {
  auto own = jointSettings();
  own.own.set("max_jerk_deg_s3", 5000.0);
  build(own);
  ask(170.0);
  run(700);
  ask(0.0);
  double last_deg_s = 90.0;
  for (int i = 0; i < 4000; ++i) {
    const double before_deg = angle();
    run(1);
    const double now_deg_s = (angle() - before_deg) * 1000.0;
    EXPECT_LE(std::fabs(now_deg_s - last_deg_s), 0.361 + 1e-9) << "of 360 deg/s^2 in a millisecond";
    last_deg_s = now_deg_s;
  }
  EXPECT_EQ(angle(), 0.0);
  EXPECT_EQ(moved(), kDone);
}

TEST_F(Joint, HoldsWhenItsClientFallsSilent) {
  build(jointSettings());
  ask(90.0);
  run(500);
  module_->clearInputs();
  run(1000);
  const double held_deg = target();
  EXPECT_LT(held_deg, 90.0);
  run(1000);
  EXPECT_EQ(target(), held_deg);
}

TEST_F(Joint, HoldsAsLongAsAnyClientOfTheRobotIsHeard) {
  build(jointSettings());
  ask(90.0);
  run(500);
  module_->clearInputs();
  robot_.silenceClients(59s);
  run(1);
  EXPECT_TRUE(robot_.motor(0).target.has_value());
  robot_.silenceClients(60s);
  run(1);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  EXPECT_THAT(robot_.events(), ::testing::ElementsAre(6U));
  run(1);
  EXPECT_THAT(robot_.events(), ::testing::IsEmpty()) << "told once";
  robot_.silenceClients(0s);
  run(1);
  EXPECT_FALSE(robot_.motor(0).target.has_value()) << "another client is no reason to hold again";
}

TEST_F(Joint, LetsGoWhenItIsToldToDoSo) {
  auto own = jointSettings();
  own.own.set("on_silence", std::string{"let_go"});
  build(own);
  ask(90.0);
  run(500);
  ASSERT_TRUE(robot_.motor(0).target.has_value());
  module_->clearInputs();
  run(1);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

TEST_F(Joint, AsksForNothingBeforeSomebodyCommandsIt) {
  build(jointSettings());
  run(10);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  EXPECT_EQ(state(), kIdle);
}

TEST_F(Joint, WithoutAReferenceItGoesNowhere) {
  build(jointSettings());
  robot_.motor(0).feedback.zeroed = false;
  ask(90.0);
  run(10);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  robot_.motor(0).feedback.zeroed = true;
  run(10);
  EXPECT_TRUE(robot_.motor(0).target.has_value());
}

TEST_F(Joint, AfterItWasDisabledItBeginsWhereItIs) {
  build(jointSettings());
  ask(90.0);
  run(2000);
  robot_.motor(0).status = MotorStatus::kReady;
  run(1);
  EXPECT_EQ(moved(), kNone);
  robot_.motor(0).feedback.total_angle_deg = 40.0;
  robot_.motor(0).status = MotorStatus::kActive;
  run(1);
  EXPECT_NEAR(target(), 40.0, 0.01);
}

// In each of its phases: what ends it also ends what was asked, and the reference is not back.

TEST_F(Joint, TheReferenceWaitsForAMotorThatIsHeldAndGoesOnWithIt) {
  build(jointSettings());
  blocked_ = true;
  ask(90.0);
  run(2000);
  EXPECT_NEAR(target(), 10.0, 0.2) << "10 times the tolerance";
  EXPECT_EQ(moved(), kFailed);
  const double led_deg = target();
  blocked_ = false;
  run(1);
  for (int i = 0; i < 2000; ++i) {
    const double before_deg = angle();
    run(1);
    ASSERT_LE(angle() - before_deg, 0.0901) << "no faster than 90 deg/s";
  }
  EXPECT_GT(led_deg, 9.0);
  EXPECT_EQ(angle(), 90.0);
}

TEST_F(Joint, APauseOfTheSchedulerIsNoTimeInWhichAMoveCouldSettle) {
  build(jointSettings());
  blocked_ = true;
  ask(5.0);
  for (int i = 0; i < 1000 && target() != 5.0; ++i) run(1);
  ASSERT_EQ(target(), 5.0);
  run(100);
  robot_.pause(std::chrono::seconds{1});
  run(50);
  EXPECT_EQ(moved(), kUnderWay) << "of 200 ms it was watched for 150";
  run(100);
  EXPECT_EQ(moved(), kFailed);
}

TEST_F(Joint, AMoveOfAHeldShaftThatShakesHasFailed) {
  for (const double amplitude_deg : {0.9, 1.2, 3.0, 6.0}) {
    for (const double hz : {0.5, 2.0, 10.0}) {
      SCOPED_TRACE(::testing::Message() << amplitude_deg << " deg, " << hz << " Hz");
      build(jointSettings());
      events_.clear();
      blocked_ = true;
      ask(90.0);
      for (int i = 0; i < 10'000 && (i == 0 || moved() == kUnderWay); ++i) {
        run(1);
        auto& feedback = robot_.motor(0).feedback;
        const double before_deg = feedback.total_angle_deg;
        feedback.total_angle_deg = amplitude_deg * std::sin(2.0 * std::numbers::pi * hz * 0.001 * i);
        feedback.velocity_rpm = static_cast<float>((feedback.total_angle_deg - before_deg) / 0.006);
      }
      EXPECT_EQ(moved(), kFailed);
      EXPECT_THAT(events_, ElementsAre(2U));
    }
  }
}

TEST_F(Joint, AMotorThatIsPushedBackForAMomentHasNotFailed) {
  build(jointSettings());
  ask(90.0);
  run(700);
  ASSERT_GT(angle(), 30.0);
  blocked_ = true;
  for (int i = 0; i < 150; ++i) {
    run(1);
    robot_.motor(0).feedback.total_angle_deg -= 0.2;
  }
  blocked_ = false;
  run(3000);
  EXPECT_EQ(moved(), kDone);
  EXPECT_THAT(events_, IsEmpty());
}

TEST_F(Joint, AMotorThatIsOnlySlowHasNotFailed) {
  build(jointSettings());
  blocked_ = true;
  ask(90.0);
  for (int i = 0; i < 10'000 && moved() != kDone; ++i) {
    run(1);
    auto& deg = robot_.motor(0).feedback.total_angle_deg;
    deg += std::clamp(target() - deg, -0.02, 0.02);  // 20 deg/s, as in reduced mode
    ASSERT_LT(target() - deg, 10.2);
  }
  EXPECT_EQ(moved(), kDone);
  EXPECT_THAT(events_, IsEmpty());
}

TEST_F(Joint, SlowsAShaftThatTurnsAlongItsProfile) {
  build(jointSettings());
  robot_.motor(0).feedback.velocity_rpm = 10.0F;
  blocked_ = true;
  ask(0.0);
  run(1);
  EXPECT_NEAR(robot_.motor(0).target->velocity_ff_rpm, 10.0F, 0.1F);
  EXPECT_NEAR(target(), 0.06, 0.001);
}

TEST_F(Joint, IsUnderWayNoMoreOnceItLetsGo) {
  build(jointSettings());
  ask(90.0);
  run(500);
  module_->clearInputs();
  robot_.silenceClients(60s);
  run(1);
  EXPECT_EQ(state(), kIdle);
  EXPECT_EQ(moved(), kNone);
}

TEST_F(Joint, TellsOnceOfAllTargetsOfAStickBeyondTheLimit) {
  build(jointSettings());
  for (int i = 0; i < 2000; ++i) {
    ask(181.0 + 20.0 * std::sin(0.01 * i));  // in between within it, for less than a second
    run(1);
  }
  EXPECT_THAT(events_, ElementsAre(3U));
}

TEST(JointType, RefusesAStopWhoseCurrentIsNotSeen) {
  auto own = jointSettings();
  auto robot = outlineOf(1);
  const auto refusal = [&] {
    const auto built = jointType().build(own, robot);
    return built ? std::string{} : built.error().message;
  };
  robot.motors[0].unreported_current_remedy = "write telemetry_hz";
  EXPECT_EQ(refusal(), "") << "it does not home";
  own.own.set("homing", std::string{"stop"});
  EXPECT_EQ(refusal(),
            "homing: motor 'motor0' does not report its current, without which friction and gravity are not "
            "told from the stop; write telemetry_hz, or use homing: switch");
  own.own.set("homing", std::string{"switch"});
  own.own.set("switch", std::string{"limit.closed"});
  EXPECT_EQ(refusal(), "") << "the switch says where the end is";
  own = jointSettings();
  own.own.set("homing", std::string{"stop"});
  robot = outlineOf(1);
  robot.motors[0].current_period = 51ms;  // homing_stopped_ms is 100
  EXPECT_EQ(refusal(),
            "homing_stopped_ms: is shorter than two reports of the current of motor 'motor0'; write 102 or "
            "more, or let it come more often");
  robot.motors[0].current_period = 50ms;
  EXPECT_EQ(refusal(), "");
}

TEST(JointType, RefusesWhatCannotWork) {
  auto own = jointSettings();
  own.own.set("homing", std::string{"switch"});
  EXPECT_EQ(jointType().build(own, outlineOf(1)).error().message,
            "switch: is missing; name the output that is 1 while the switch is closed");
  own = jointSettings();
  own.own.set("homing", std::string{"stop"});
  own.own.set("homing_velocity_rpm", 0.0);
  EXPECT_EQ(jointType().build(own, outlineOf(1)).error().message,
            "homing_velocity_rpm: 0 finds nothing; its sign says where the end is");
  const auto refusalOf = [](std::string_view key, double value) {
    auto settings_of = jointSettings();
    settings_of.own.set("homing", std::string{"stop"});
    settings_of.own.set(key, value);
    auto robot = outlineOf(1);
    robot.motors[0].angle_min_deg = -20.0;
    robot.motors[0].angle_max_deg = 180.0;
    robot.motors[0].current_limit_a = 10.0F;
    const auto built = jointType().build(settings_of, robot);
    return built ? std::string{} : built.error().message;
  };
  EXPECT_EQ(refusalOf("homing_velocity_rpm", -5.0), "");
  EXPECT_EQ(
      refusalOf("homing_velocity_rpm", -401.0),
      "homing_velocity_rpm: is more than motor 'motor0' turns; use less, see its velocity_limit_rpm and "
      "gear_ratio");
  EXPECT_EQ(
      refusalOf("homing_current_a", 11.0),
      "homing_current_a: is more than current_limit_a of motor 'motor0'; the stop is pressed with all of "
      "it, so use less");
  EXPECT_EQ(refusalOf("homing_away_deg", 1.0),
            "homing_away_deg: must be more than homing_tolerance_deg, or a second meeting with the end shows "
            "nothing");
  EXPECT_EQ(refusalOf("home_angle_deg", 200.0),
            "home_angle_deg: no travel lies between it and angle_max_deg of motor 'motor0'; see the sign of "
            "homing_velocity_rpm, which says where the end is");
  EXPECT_EQ(refusalOf("homing_velocity_rpm", 5.0),
            "home_angle_deg: no travel lies between it and angle_min_deg of motor 'motor0'; see the sign of "
            "homing_velocity_rpm, which says where the end is");
  own = jointSettings();
  own.own.set("homing", std::string{"switch"});
  own.own.set("switch", std::string{"limit.open"});
  const auto module = std::move(jointType().build(own, outlineOf(1)).value());
  const LimitSwitch limit;
  EXPECT_EQ(module->connect(ModuleDirectory{{{"limit", &limit}}}).error().message,
            "switch: module 'limit' has no output 'open'; it has closed");
}

}  // namespace
}  // namespace rc10::test::joint_test
