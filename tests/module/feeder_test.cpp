#include "module/feeder.hpp"

#include <array>

#include <gmock/gmock.h>

#include "fake_robot.hpp"

namespace rc10::test::feeder_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kIdle = 0.0;
constexpr double kFeeding = 1.0;
constexpr double kReversing = 2.0;
constexpr double kGivenUp = 3.0;

class Feeder : public ::testing::Test {
 protected:
  Feeder() {
    ModuleSettings settings;
    settings.name = "feeder";
    settings.own.set("motor", 0.0);
    settings.own.set("velocity_limit_rpm", 60.0);
    settings.own.set("deg_per_shot", 45.0);
    settings.own.set("jam_ms", 100.0);
    settings.own.set("reverse_rpm", 20.0);
    settings.own.set("reverse_ms", 50.0);
    settings.own.set("retries", 2.0);
    module_ = std::move(feederType().build(settings, outlineOf(1)).value());
  }

  void ask(double velocity_rpm, double shots = kNoSignal) {
    module_->setInputs(std::array{velocity_rpm, shots});
  }
  /// A motor that turns as it is told, or not at all.
  void run(int ticks, bool jammed = false) {
    for (int i = 0; i < ticks; ++i) {
      robot_.update(*module_);
      auto& motor = robot_.motor(0);
      const double rpm = motor.target && !jammed ? motor.target->value : 0.0;
      motor.feedback.velocity_rpm = static_cast<float>(rpm);
      motor.feedback.total_angle_deg += rpm * 6.0 * 0.001;
      events_.insert(events_.end(), robot_.events().begin(), robot_.events().end());
    }
  }
  double target() { return robot_.motor(0).target ? robot_.motor(0).target->value : kNoSignal; }
  double state() { return module_->outputs()[0]; }

  FakeRobot robot_{1};
  std::unique_ptr<Module_Base> module_;
  std::vector<std::size_t> events_;
};

TEST_F(Feeder, TheCountOfAnotherSenderBeginsAnew) {
  ask(kNoSignal, 3.0);
  run(10);
  ask(kNoSignal, 5.0);
  run(10);
  EXPECT_EQ(state(), kFeeding);
  module_->changeSender();
  ask(kNoSignal, 10.0);
  run(500);
  EXPECT_EQ(state(), kIdle) << "neither its own count nor what was left of the other's";
  ask(kNoSignal, 11.0);
  run(10);
  EXPECT_EQ(state(), kFeeding);
}

TEST_F(Feeder, TurnsAsItIsTold) {
  ask(30.0);
  run(500);
  EXPECT_EQ(target(), 30.0);
  EXPECT_EQ(state(), kFeeding);
  EXPECT_THAT(events_, IsEmpty());
  ask(1000.0);
  run(1);
  EXPECT_EQ(target(), 60.0);
  ask(0.0);
  run(1);
  EXPECT_EQ(target(), 0.0);
  EXPECT_EQ(state(), kIdle);
}

TEST_F(Feeder, FiresAsManyShotsAsTheCountRises) {
  ask(kNoSignal, 7.0);
  run(100);
  EXPECT_EQ(state(), kIdle) << "where the count begins nothing is fired";
  ask(kNoSignal, 9.0);
  run(1);
  EXPECT_EQ(module_->outputs()[1], 2.0);
  run(2000);
  EXPECT_EQ(state(), kIdle);
  EXPECT_NEAR(robot_.motor(0).feedback.total_angle_deg, 90.0, 1.0);
}

TEST_F(Feeder, TheSpeedOfReducedModeIsNoJam) {
  robot_.motor(0).speed_ceiling_rpm = 5.0;
  ask(60.0);
  run(1000);
  EXPECT_EQ(target(), 5.0);
  EXPECT_EQ(state(), kFeeding);
  EXPECT_THAT(events_, IsEmpty());
}

TEST_F(Feeder, ShotsInReducedModeAreFedAtItsSpeed) {
  robot_.motor(0).speed_ceiling_rpm = 5.0;
  ask(kNoSignal, 0.0);
  run(1);
  ask(kNoSignal, 1.0);
  run(1000);
  EXPECT_EQ(target(), 5.0);
  run(600);
  EXPECT_EQ(state(), kIdle);
  EXPECT_NEAR(robot_.motor(0).feedback.total_angle_deg, 45.0, 1.0);
  EXPECT_THAT(events_, IsEmpty());
}

TEST_F(Feeder, AJamInReducedModeIsAnsweredAtItsSpeed) {
  robot_.motor(0).speed_ceiling_rpm = 5.0;
  ask(30.0);
  run(101, true);
  ASSERT_EQ(state(), kReversing);
  EXPECT_EQ(target(), -5.0);
}

TEST_F(Feeder, AJamIsAnsweredByGoingBackAndFeedingGoesOnOnceItIsFree) {
  ask(30.0);
  run(50);
  run(101, true);
  EXPECT_EQ(state(), kReversing);
  EXPECT_EQ(target(), -20.0);
  run(50);
  EXPECT_EQ(state(), kFeeding);
  EXPECT_EQ(target(), 30.0);
  run(400);
  EXPECT_THAT(events_, ElementsAre(0U, 1U)) << "jammed, free again";
  EXPECT_EQ(module_->outputs()[2], 1.0);
}

TEST_F(Feeder, APauseOfTheSchedulerIsNoJam) {
  ask(30.0);
  run(50);
  run(50, true);
  robot_.pause(std::chrono::seconds{1});
  run(45, true);
  EXPECT_EQ(state(), kFeeding) << "it was seen to stand for 95 ms";
  run(10, true);
  EXPECT_EQ(state(), kReversing);
}

TEST_F(Feeder, AMotorHeardBeforeAndAfterAPauseIsNotYetFree) {
  ask(30.0);
  run(50);
  run(101, true);
  run(100);
  ASSERT_EQ(state(), kFeeding);
  robot_.pause(std::chrono::seconds{1});
  run(50);
  EXPECT_THAT(events_, ElementsAre(0U));
  run(150);
  EXPECT_THAT(events_, ElementsAre(0U, 1U));
}

TEST_F(Feeder, GivesUpAfterItsRetriesUntilNobodyAsksAnyMore) {
  ask(30.0);
  run(600, true);
  EXPECT_EQ(state(), kGivenUp);
  EXPECT_EQ(target(), 0.0);
  EXPECT_THAT(events_, ElementsAre(0U, 2U));
  run(500);
  EXPECT_EQ(state(), kGivenUp) << "still asked";
  ask(0.0);
  run(1);
  ask(30.0);
  run(5);
  EXPECT_EQ(state(), kFeeding);
}

TEST_F(Feeder, FiresNoMoreThanAThousandShotsAtOnce) {
  ask(kNoSignal, -1e308);
  run(1);
  for (const double shots : {1e308, 1.5e308, 1.7e308}) {
    ask(kNoSignal, shots);
    run(1);
    EXPECT_LE(module_->outputs()[1], 1000.0);
    EXPECT_GT(module_->outputs()[1], 990.0);
  }
}

TEST_F(Feeder, ShotsThatCannotBeFiredNowAreNotFiredLater) {
  ask(kNoSignal, 0.0);
  run(1);
  ask(kNoSignal, 5.0);
  run(10);
  robot_.motor(0).status = MotorStatus::kReady;
  run(1);
  EXPECT_EQ(module_->outputs()[1], 0.0);
  robot_.motor(0).status = MotorStatus::kActive;
  run(10);
  EXPECT_EQ(state(), kIdle);
}

TEST_F(Feeder, ShotsEndWhereTheMotorHasNoAngle) {
  auto& feedback = robot_.motor(0).feedback;
  feedback.total_angle_deg = kNoSignal;
  ask(kNoSignal, 7.0);
  run(2);
  ask(kNoSignal, 9.0);
  run(10);
  EXPECT_EQ(state(), kFeeding);
  run(300);
  EXPECT_EQ(state(), kIdle) << "90 degrees at 60 rpm take 250 ms";
}

TEST_F(Feeder, ShotsEndWhereTheFieldOfTheAngleEnds) {
  auto& motor = robot_.motor(0);
  ask(kNoSignal, 7.0);
  run(2);
  ask(kNoSignal, 9.0);
  motor.feedback.angle_at_end = true;
  for (int i = 0; i < 300; ++i) {
    motor.feedback.total_angle_deg = 3200.0;
    run(1);
  }
  EXPECT_EQ(state(), kIdle);
}

TEST_F(Feeder, ANewReferenceOfTheAngleIsNoShot) {
  auto& feedback = robot_.motor(0).feedback;
  feedback.total_angle_deg = 3600.0;
  ask(kNoSignal, 7.0);
  run(2);
  ask(kNoSignal, 9.0);
  run(10);
  feedback.total_angle_deg -= 3600.0;
  run(10);
  EXPECT_LE(module_->outputs()[1], 2.0);
  feedback.total_angle_deg += 3600.0;
  run(10);
  EXPECT_EQ(state(), kFeeding);
  run(300);
  EXPECT_EQ(state(), kIdle);
}

TEST_F(Feeder, SilenceAsksNothingOfTheMotor) {
  ask(30.0);
  run(10);
  ASSERT_TRUE(robot_.motor(0).target.has_value());
  module_->clearInputs();
  run(1);
  EXPECT_FALSE(robot_.motor(0).target.has_value());
}

}  // namespace
}  // namespace rc10::test::feeder_test
