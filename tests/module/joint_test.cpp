#include "module/joint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <gmock/gmock.h>

#include "fake_robot.hpp"
#include "module/joint_homing.hpp"

namespace rc10::test::joint_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using namespace std::chrono_literals;

constexpr double kIdle = 0.0;
constexpr double kHoming = 1.0;
constexpr double kFollowing = 2.0;
constexpr double kHomingFailed = 3.0;

constexpr double kNone = 0.0;
constexpr double kUnderWay = 1.0;
constexpr double kDone = 2.0;
constexpr double kFailed = 3.0;

ModuleSettings settings() {
  ModuleSettings settings;
  settings.name = "arm";
  settings.own.set("motor", 0.0);
  settings.own.set("max_velocity_deg_s", 90.0);
  settings.own.set("max_acceleration_deg_s2", 360.0);
  settings.own.set("max_jerk_deg_s3", 0.0);
  settings.own.set("tolerance_deg", 1.0);
  settings.own.set("settle_ms", 200.0);
  settings.own.set("homing", std::string{"none"});
  settings.own.set("home_angle_deg", -30.0);
  settings.own.set("homing_velocity_rpm", -5.0);
  settings.own.set("homing_current_a", 0.5);
  settings.own.set("homing_away_deg", 3.0);
  settings.own.set("homing_tolerance_deg", 1.0);
  settings.own.set("homing_stopped_ms", 100.0);
  settings.own.set("homing_timeout_s", 5.0);
  settings.own.set("on_silence", std::string{"hold"});
  settings.own.set("silence_max_s", 60.0);
  return settings;
}

class Other : public Module_Base {
 public:
  Other() : Module_Base({.inputs = {}, .outputs = {"closed"}, .events = {}}) {}
  void update(const Tick&, ModuleRobot&) noexcept override {}
};

/// A joint on a motor that follows at once, between two stops.
class Joint : public ::testing::Test {
 protected:
  void build(const ModuleSettings& settings) {
    auto robot = outlineOf(1);
    robot.motors[0].angle_min_deg = -20.0;
    robot.motors[0].angle_max_deg = 180.0;
    module_ = std::move(jointType().build(settings, robot).value());
    const Other limit;
    ASSERT_TRUE(module_->connect(ModuleDirectory{{{"limit", &limit}}}).has_value());
  }
  void ask(double angle_deg, double home = kNoSignal) { module_->setInputs(std::array{angle_deg, home}); }

  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      robot_.update(*module_);
      events_.insert(events_.end(), robot_.events().begin(), robot_.events().end());
      move();
    }
  }
  // An angle is there at once; a current makes it faster, until the stop.
  void move() {
    auto& motor = robot_.motor(0);
    auto& feedback = motor.feedback;
    for (const auto& asked : robot_.asked()) {
      if (asked.request != RobotRequest::kZero || !zeroes_) continue;
      stop_deg_ += asked.angle_deg - feedback.total_angle_deg;
      feedback.total_angle_deg = asked.angle_deg;
      feedback.zeroed = true;
    }
    const double before_deg = feedback.total_angle_deg;
    if (motor.target && motor.target->mode == ControlMode::kTotalAngle && !blocked_)
      feedback.total_angle_deg = motor.target->value;
    if (motor.target && motor.target->mode == ControlMode::kCurrent && !blocked_) {
      feedback.current_a = static_cast<float>(motor.target->value * gets_);
      const double push_a = motor.target->value * gets_ + gravity_a_;
      rpm_ += (push_a * 400.0 - 5.0 * rpm_) * 0.001;
      feedback.total_angle_deg = std::max(stop_deg_, before_deg + rpm_ * 0.006);
      if (feedback.total_angle_deg == stop_deg_) rpm_ = 0.0;
    }
    feedback.velocity_rpm = static_cast<float>((feedback.total_angle_deg - before_deg) / 0.006);
    showSwitch();
  }
  void showSwitch() {
    const double closed = angle() <= stop_deg_ + 0.5 ? 1.0 : 0.0;
    robot_.setOutput({.module = 0, .signal = 0}, switch_heard_ ? closed : kNoSignal);
  }
  double target() { return robot_.motor(0).target ? robot_.motor(0).target->value : kNoSignal; }
  double state() { return module_->outputs()[0]; }
  double moved() { return module_->outputs()[1]; }
  double angle() { return robot_.motor(0).feedback.total_angle_deg; }

  bool zeroes_ = true;
  FakeRobot robot_{1};
  std::unique_ptr<Module_Base> module_;
  std::vector<std::size_t> events_;
  double stop_deg_ = -1e6;
  double gravity_a_ = 0.0;  ///< Away from the stop.
  double gets_ = 1.0;       ///< Share of the current that it is told.
  double rpm_ = 0.0;
  bool blocked_ = false;
  bool switch_heard_ = true;
};

TEST_F(Joint, MovesOnAProfileAndSaysWhenItIsDone) {
  build(settings());
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
  build(settings());
  ask(90.0);
  run(500);
  EXPECT_NEAR(robot_.motor(0).target->velocity_ff_rpm, 15.0F, 0.1F);
}

TEST_F(Joint, StopsAtTheSoftLimitAndSaysSoOnce) {
  build(settings());
  ask(270.0);
  run(4000);
  EXPECT_EQ(angle(), 180.0);
  EXPECT_EQ(moved(), kDone);
  EXPECT_THAT(events_, ElementsAre(3U));
}

TEST_F(Joint, AMoveThatDoesNotGetThereHasFailed) {
  build(settings());
  blocked_ = true;
  ask(90.0);
  run(2000);
  EXPECT_EQ(moved(), kFailed);
  EXPECT_THAT(events_, ElementsAre(2U));
}

TEST_F(Joint, ANewTargetInTheMiddleOfAMoveIsReachedWithoutAJump) {
  auto own = settings();
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
  build(settings());
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
  build(settings());
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
  auto own = settings();
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
  build(settings());
  run(10);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  EXPECT_EQ(state(), kIdle);
}

TEST_F(Joint, WithoutAReferenceItGoesNowhere) {
  build(settings());
  robot_.motor(0).feedback.zeroed = false;
  ask(90.0);
  run(10);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  robot_.motor(0).feedback.zeroed = true;
  run(10);
  EXPECT_TRUE(robot_.motor(0).target.has_value());
}

TEST_F(Joint, AfterItWasDisabledItBeginsWhereItIs) {
  build(settings());
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

TEST_F(Joint, FindsItsReferenceAtAStop) {
  auto own = settings();
  own.own.set("homing", std::string{"stop"});
  build(own);
  robot_.motor(0).feedback.zeroed = false;
  robot_.motor(0).feedback.total_angle_deg = 1000.0;
  stop_deg_ = 980.0;
  ask(kNoSignal, 1.0);
  run(1);
  EXPECT_EQ(state(), kHoming);
  EXPECT_EQ(robot_.motor(0).target->mode, ControlMode::kCurrent);
  EXPECT_GT(target(), 0.0) << "away from the end first";
  double most_a = 0.0;
  for (int i = 0; i < 4000 && state() == kHoming; ++i) {
    run(1);
    if (robot_.motor(0).target->mode == ControlMode::kCurrent) most_a = std::max(most_a, std::fabs(target()));
  }
  EXPECT_LE(most_a, 0.5);
  EXPECT_THAT(events_, ElementsAre(0U));
  EXPECT_NEAR(angle(), -30.0, 0.01);
  ask(-10.0);
  run(3000);
  EXPECT_EQ(angle(), -10.0);
}

TEST_F(Joint, AZeroThatItsMotorRefusesIsNoHome) {
  auto own = settings();
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

TEST_F(Joint, AStandstillThatGravityMakesIsNotTheStop) {
  auto own = settings();
  own.own.set("homing", std::string{"stop"});
  build(own);
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

TEST_F(Joint, AStopThatIsMetAtTwoPlacesIsNone) {
  auto own = settings();
  own.own.set("homing", std::string{"stop"});
  build(own);
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

TEST_F(Joint, AStopBeyondTheTravelIsNone) {
  auto own = settings();
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

TEST_F(Joint, AMotorThatGetsLessThanTheHomingCurrentDoesNotFindTheStop) {
  auto own = settings();
  own.own.set("homing", std::string{"stop"});
  build(own);
  robot_.motor(0).feedback.zeroed = false;
  robot_.motor(0).feedback.total_angle_deg = 10.0;
  stop_deg_ = 0.0;
  gets_ = 0.5;
  ask(kNoSignal, 1.0);
  run(5100);
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(events_, ElementsAre(5U));
}

TEST_F(Joint, AnAxisThatBeginsAtItsStopIsHomed) {
  auto own = settings();
  own.own.set("homing", std::string{"stop"});
  build(own);
  robot_.motor(0).feedback.zeroed = false;
  stop_deg_ = robot_.motor(0).feedback.total_angle_deg = 7.0;
  ask(kNoSignal, 1.0);
  run(4000);
  EXPECT_THAT(events_, ElementsAre(0U));
  EXPECT_NEAR(angle(), -30.0, 0.01);
}

TEST_F(Joint, FindsItsReferenceAtASwitch) {
  auto own = settings();
  own.own.set("homing", std::string{"switch"});
  own.own.set("switch", std::string{"limit.closed"});
  build(own);
  robot_.motor(0).feedback.zeroed = false;
  stop_deg_ = -15.0;
  showSwitch();
  ask(kNoSignal, 1.0);
  run(3000);
  EXPECT_THAT(events_, ElementsAre(0U));
  EXPECT_NEAR(angle(), -30.0, 0.6);
}

TEST_F(Joint, DoesNotLookForASwitchThatNobodyHears) {
  auto own = settings();
  own.own.set("homing", std::string{"switch"});
  own.own.set("switch", std::string{"limit.closed"});
  build(own);
  robot_.motor(0).feedback.zeroed = false;
  showSwitch();
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

TEST_F(Joint, AnAxisThatDoesNotMoveIsNotHomed) {
  auto own = settings();
  own.own.set("homing", std::string{"stop"});
  build(own);
  robot_.motor(0).feedback.zeroed = false;
  blocked_ = true;
  ask(kNoSignal, 1.0);
  run(5100);
  EXPECT_EQ(state(), kHomingFailed);
  EXPECT_THAT(events_, ElementsAre(1U));
  EXPECT_FALSE(robot_.motor(0).feedback.zeroed);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

TEST_F(Joint, AHomingThatNobodyWatchesEnds) {
  auto own = settings();
  own.own.set("homing", std::string{"stop"});
  build(own);
  ask(kNoSignal, 1.0);
  run(10);
  module_->clearInputs();
  run(1);
  EXPECT_EQ(state(), kIdle);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

TEST(JointType, RefusesWhatCannotWork) {
  auto own = settings();
  own.own.set("homing", std::string{"switch"});
  EXPECT_EQ(jointType().build(own, outlineOf(1)).error().message,
            "switch: is missing; name the output that is 1 while the switch is closed");
  own = settings();
  own.own.set("homing", std::string{"stop"});
  own.own.set("homing_velocity_rpm", 0.0);
  EXPECT_EQ(jointType().build(own, outlineOf(1)).error().message,
            "homing_velocity_rpm: 0 finds nothing; its sign says where the end is");
  own = settings();
  own.own.set("homing", std::string{"switch"});
  own.own.set("switch", std::string{"limit.open"});
  const auto module = std::move(jointType().build(own, outlineOf(1)).value());
  const Other limit;
  EXPECT_EQ(module->connect(ModuleDirectory{{{"limit", &limit}}}).error().message,
            "switch: module 'limit' has no output 'open'; it has closed");
}

}  // namespace
}  // namespace rc10::test::joint_test
