#include "module/synchronised_pair.hpp"

#include <array>
#include <limits>

#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace rc10::test::synchronised_pair_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ModuleSettings settings() {
  ModuleSettings settings;
  settings.name = "lift";
  settings.own.set("left", 0.0);
  settings.own.set("right", 1.0);
  settings.own.set("max_difference_deg", 10.0);
  settings.own.set("correction_rpm_per_deg", 2.0);
  settings.own.set("velocity_limit_rpm", 100.0);
  return settings;
}

class SynchronisedPair : public ::testing::Test {
 protected:
  void velocity(double rpm) { module_->setInputs(std::array{rpm, kNoSignal}); }
  void angle(double deg) { module_->setInputs(std::array{kNoSignal, deg}); }
  double target(std::size_t motor) {
    const auto& target = robot_.motor(motor).target;
    return target ? target->value : std::numeric_limits<double>::quiet_NaN();
  }

  FakeRobot robot_{2};
  std::unique_ptr<Module_Base> module_ =
      std::move(synchronisedPairType().build(settings(), outlineOf(2)).value());
};

TEST_F(SynchronisedPair, BothTurnAtTheVelocityThatIsGiven) {
  velocity(40.0);
  robot_.update(*module_);
  EXPECT_EQ(robot_.motor(0).target->mode, ControlMode::kVelocity);
  EXPECT_EQ(target(0), 40.0);
  EXPECT_EQ(target(1), 40.0);
}

TEST_F(SynchronisedPair, TheOneAheadTurnsSlowerAndTheOneBehindFaster) {
  robot_.motor(0).feedback.total_angle_deg = 6.0;
  velocity(40.0);
  robot_.update(*module_);
  EXPECT_EQ(target(0), 34.0);
  EXPECT_EQ(target(1), 46.0);
}

TEST_F(SynchronisedPair, AtTheLimitTheOneAheadIsStillSlowed) {
  robot_.motor(0).feedback.total_angle_deg = -6.0;
  velocity(1000.0);
  robot_.update(*module_);
  EXPECT_EQ(target(0), 100.0);
  EXPECT_EQ(target(1), 94.0);
  velocity(-1000.0);
  robot_.update(*module_);
  EXPECT_EQ(target(0), -94.0);
  EXPECT_EQ(target(1), -100.0);
}

TEST_F(SynchronisedPair, TheMotorsOwnLimitCountsAsWell) {
  auto faster = settings();
  faster.own.set("velocity_limit_rpm", 1000.0);
  module_ = std::move(synchronisedPairType().build(faster, outlineOf(2)).value());  // motors of 400 rpm
  robot_.motor(0).feedback.total_angle_deg = -6.0;
  velocity(1000.0);
  robot_.update(*module_);
  EXPECT_EQ(target(0), 400.0);
  EXPECT_EQ(target(1), 394.0);
}

TEST_F(SynchronisedPair, InReducedModeTheOneAheadIsSlowed) {
  robot_.motor(1).speed_ceiling_rpm = 10.0;
  robot_.motor(0).feedback.total_angle_deg = 2.0;
  velocity(60.0);
  robot_.update(*module_);
  EXPECT_EQ(target(0), 8.0);
  EXPECT_EQ(target(1), 10.0);
}

TEST_F(SynchronisedPair, BothFollowOneAngle) {
  angle(720.0);
  robot_.update(*module_);
  EXPECT_EQ(robot_.motor(1).target->mode, ControlMode::kTotalAngle);
  EXPECT_EQ(target(0), 720.0);
  EXPECT_EQ(target(1), 720.0);
}

TEST_F(SynchronisedPair, WithoutACommandNothingIsAsked) {
  robot_.update(*module_);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  velocity(40.0);
  module_->clearInputs();
  robot_.update(*module_);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

TEST_F(SynchronisedPair, RestsOnceItHasComeApartUntilItIsDisabled) {
  robot_.motor(0).feedback.total_angle_deg = 10.5;
  velocity(40.0);
  robot_.update(*module_);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  EXPECT_THAT(robot_.events(), ElementsAre(0U));
  EXPECT_EQ(module_->outputs()[2], 1.0);
  robot_.motor(0).feedback.total_angle_deg = 0.0;
  robot_.update(*module_);
  EXPECT_FALSE(robot_.motor(0).target.has_value()) << "coming together again by itself is no excuse";
  EXPECT_THAT(robot_.events(), IsEmpty()) << "said once";
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kReady;
  robot_.update(*module_);
  for (auto& motor : robot_.motors()) motor.status = MotorStatus::kActive;
  robot_.update(*module_);
  EXPECT_EQ(target(0), 40.0);
}

TEST_F(SynchronisedPair, IsNotApartWhereOneIsUnheardForAWhile) {
  velocity(60.0);
  for (const std::size_t motor : {0U, 1U}) robot_.motor(motor).feedback.velocity_rpm = 60.0F;
  robot_.update(*module_);
  robot_.motor(1).heard = false;
  for (int i = 0; i < 50; ++i) {
    robot_.motor(0).feedback.total_angle_deg += 0.36;
    robot_.update(*module_);
    ASSERT_NEAR(target(0), 60.0, 0.01) << i;
    ASSERT_NEAR(target(1), 60.0, 0.01) << i;
  }
}

TEST_F(SynchronisedPair, NeitherMovesWhileOneIsNotActiveOrNotReferenced) {
  velocity(40.0);
  robot_.motor(1).status = MotorStatus::kFault;
  robot_.update(*module_);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  robot_.motor(1).status = MotorStatus::kActive;
  robot_.motor(1).feedback.zeroed = false;
  robot_.update(*module_);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
  robot_.motor(1).feedback.zeroed = true;
  robot_.update(*module_);
  EXPECT_TRUE(robot_.motor(0).target.has_value());
}

TEST(SynchronisedPairType, RefusesOneMotorTwiceAndMotorsThatCannot) {
  auto twice = settings();
  twice.own.set("right", 0.0);
  EXPECT_THAT(synchronisedPairType().build(twice, outlineOf(2)).error().message,
              HasSubstr("right: is the same"));
  auto robot = outlineOf(2);
  robot.motors[1].modes = ModeSet{ControlMode::kCurrent};
  EXPECT_EQ(
      synchronisedPairType().build(settings(), robot).error().message,
      "right: motor 'motor1' takes no velocity targets; name another motor, or set up its drive for them");
}

}  // namespace
}  // namespace rc10::test::synchronised_pair_test
