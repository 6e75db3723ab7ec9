#include "daemon/supervision/axis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "daemon/one_motor_robot.hpp"
#include "daemon/virtual_robot.hpp"
#include "support/dji_frames.hpp"

namespace rc10::test {
namespace axis_test {

using namespace std::chrono_literals;

Lease::Holder holderOf(const char* client, std::uint64_t session, int priority) {
  Lease::Holder holder{.client = {}, .session = session, .priority = priority};
  holder.client = client;
  return holder;
}
const Lease::Holder kPlanner = holderOf("planner", 1, 0);
const Lease::Holder kRemote = holderOf("remote", 2, 10);
constexpr Target kTurn{.mode = ControlMode::kVelocity, .value = 30.0};

/// One M3508 that brakes when its command lapses.
class AxisTest : public ::testing::Test {
 protected:
  static RobotConfig configOf() {
    RobotConfig config = twoWheelsAndYaw();
    config.buses[0].motors[0].fallback.on_timeout = FallbackAction::kBrake;
    return config;
  }
  /// One tick with a sample, or without; what the supervisor would do of it.
  void tick(bool speaks = true) {
    now_ += 1ms;
    if (speaks) hear();
    const Tick tick = this->now();
    axis_.listen(tick, {.before = now_ - 1ms, .ran = 1ms});
    if (axis_.fresh(tick)) (void)axis_.handle(MotorEvent::kFeedbackFresh, RobotStatus::kRun, {}, tick);
    if (axis_.lost(tick)) (void)axis_.handle(MotorEvent::kFeedbackLost, RobotStatus::kRun, {}, tick);
    if (const auto end = axis_.endsEnabling(tick)) (void)axis_.handle(*end, RobotStatus::kRun, {}, tick);
    (void)axis_.trips(false, tick);
    lapsed_ = axis_.lapses(tick);
    axis_.order(RobotStatus::kRun, tick);
    axis_.motor().update(tick);
  }
  void hear(std::int16_t rotor_rpm = 0) {
    (void)axis_.motor().updateFeedback(makeDjiFeedback(kM3508, 1, {.rpm = rotor_rpm}, now_));
  }
  void activate() {
    tick();
    axis_.prepareEnabling(now());
    (void)axis_.handle(MotorEvent::kEnable, RobotStatus::kRun, {}, now());
    tick();
    tick();
    ASSERT_EQ(axis_.status(), MotorStatus::kActive);
  }
  [[nodiscard]] Tick now() const { return {.index = 1, .now = now_, .dt_s = 0.001F}; }

  std::unique_ptr<Robot> robot_ = std::move(Robot::build(configOf()).value());
  MonotonicTime now_{1s};
  Axis axis_{robot_->motors()[0], robot_->buses()[0]};
  bool lapsed_ = false;
};

TEST_F(AxisTest, IsReadyWithFreshFeedbackAndOfflineWithoutForItsTimeout) {
  tick(false);
  EXPECT_EQ(axis_.status(), MotorStatus::kOffline);
  tick();
  EXPECT_EQ(axis_.status(), MotorStatus::kReady);
  for (auto i = robot_->motors()[0].feedback_timeout / 1ms; i > 0; --i) tick(false);
  EXPECT_EQ(axis_.status(), MotorStatus::kReady);
  tick(false);
  EXPECT_EQ(axis_.status(), MotorStatus::kOffline);
}

TEST_F(AxisTest, SaysWhyATargetDoesNotAct) {
  tick();
  const auto before = now_;
  EXPECT_EQ(axis_.follow(kTurn, now_, kPlanner, {now_, now_ + 50ms}), SkipReason::kNotActive);
  activate();
  EXPECT_EQ(axis_.follow(kTurn, now_, kPlanner, {now_, now_ + 50ms}), std::nullopt);
  EXPECT_EQ(axis_.follow({.mode = ControlMode::kVoltage}, now_, kPlanner, {now_, now_ + 50ms}),
            SkipReason::kRefused);
  EXPECT_EQ(axis_.follow(kTurn, before, kPlanner, {now_, now_ + 50ms}), SkipReason::kNotActive)
      << "then it was not";
}

TEST_F(AxisTest, RefusesAnAngleThatNoDoubleTellsExactly) {
  activate();
  for (const double far_deg : {1.1e12, -1e17, 1e300}) {
    for (const auto mode : {ControlMode::kTotalAngle, ControlMode::kAngle})
      EXPECT_EQ(axis_.follow({.mode = mode, .value = far_deg}, now_, kPlanner, {now_, now_ + 50ms}),
                SkipReason::kTooFar);
  }
}

TEST_F(AxisTest, ObeysOneClientUntilItsCommandLapsesOrAHigherPriorityTakesOver) {
  activate();
  (void)axis_.follow(kTurn, now_, kPlanner, {now_, now_ + 50ms});
  EXPECT_TRUE(axis_.obeys(kRemote, now_));
  (void)axis_.follow(kTurn, now_, kRemote, {now_, now_ + 50ms});
  EXPECT_FALSE(axis_.obeys(kPlanner, now_));
  EXPECT_TRUE(axis_.obeys(kPlanner, now_ + 50ms));
}

TEST_F(AxisTest, BeginsItsFallbackInTheTickInWhichTheCommandLapses) {
  activate();
  (void)axis_.follow(kTurn, now_, kPlanner, {now_, now_ + 2ms});
  tick();
  EXPECT_FALSE(lapsed_);
  EXPECT_EQ(axis_.motor().ordered(), FrameKind::kCommand);
  tick();
  EXPECT_TRUE(lapsed_);
  EXPECT_EQ(axis_.motor().ordered(), FrameKind::kBrake);
  tick();
  EXPECT_FALSE(lapsed_) << "told once";
}

TEST_F(AxisTest, WhatEndsActiveDecidesAboutTheFallback) {
  activate();
  (void)axis_.handle(MotorEvent::kFault, RobotStatus::kRun, {}, now());
  EXPECT_FALSE(axis_.fallbackActs()) << "a fault coasts";
  EXPECT_EQ(axis_.status(), MotorStatus::kFault);
}

TEST_F(AxisTest, FillsItsSnapshot) {
  activate();
  MotorSnapshot seen;
  axis_.fill(seen);
  EXPECT_EQ(seen.status, MotorStatus::kActive);
  EXPECT_EQ(seen.acting, Acting::kNothing);
  EXPECT_TRUE(std::isnan(seen.target_shaped));
  EXPECT_EQ(seen.command_received, MonotonicTime{});
  EXPECT_TRUE(seen.owner.view().empty());
  (void)axis_.follow(kTurn, now_, kPlanner, {now_, now_ + 50ms});
  const auto received = now_;
  tick();
  axis_.fill(seen);
  EXPECT_EQ(seen.feedback.samples, axis_.motor().feedback().samples);
  EXPECT_EQ(seen.target.mode, ControlMode::kVelocity);
  EXPECT_EQ(seen.target.value, 30.0);
  EXPECT_EQ(seen.command_value, axis_.motor().commandValue());
  EXPECT_EQ(seen.command_unit, CommandUnit::kAmpere);
  EXPECT_EQ(seen.limits, axis_.motor().limits());
  EXPECT_EQ(seen.acting, Acting::kTarget);
  EXPECT_EQ(seen.target_shaped, 30.0);
  EXPECT_EQ(seen.command_received, received);
  EXPECT_EQ(seen.owner.view(), "planner");
  EXPECT_EQ(seen.fault, FaultCode::kNone);
  EXPECT_EQ(seen.stop.cause, StopCause::kNone);
  now_ += 60ms;
  tick();
  axis_.fill(seen);
  EXPECT_EQ(seen.acting, Acting::kBrake);
  EXPECT_TRUE(std::isnan(seen.target_shaped));
  EXPECT_EQ(seen.stop.cause, StopCause::kTimeout);
  EXPECT_TRUE(seen.owner.view().empty());
}

TEST_F(AxisTest, ADriveThatIsNotThereIsMissedOnceThreeSecondsAfterTheFirstTick) {
  const auto missed = [this](Duration after) {
    return axis_.missesDrive({.index = 1, .now = MonotonicTime{10s} + after, .dt_s = 0.001F});
  };
  EXPECT_FALSE(missed(0s));
  EXPECT_FALSE(missed(3s - Duration{1}));
  robot_->buses()[0].held = true;
  EXPECT_FALSE(missed(4s)) << "its bus is the news";
  robot_->buses()[0].held = false;
  EXPECT_TRUE(missed(4s));
  EXPECT_FALSE(missed(5s)) << "told once";
}

TEST_F(AxisTest, ADriveIsMissedToTheTickAndNotOnceItHasAnswered) {
  EXPECT_FALSE(axis_.missesDrive(now()));
  now_ += 3s;
  EXPECT_TRUE(axis_.missesDrive(now()));
  Axis other{robot_->motors()[0], robot_->buses()[0]};
  EXPECT_FALSE(other.missesDrive(now()));
  tick();
  now_ += 4s;
  EXPECT_FALSE(other.missesDrive(now()));
}

TEST_F(AxisTest, IsOfflineAtOnceWhereItsBusCarriesNothing) {
  tick();
  ASSERT_EQ(axis_.status(), MotorStatus::kReady);
  robot_->buses()[0].held = true;
  EXPECT_FALSE(axis_.fresh(now()));
  tick();
  EXPECT_EQ(axis_.status(), MotorStatus::kOffline);
}

TEST_F(AxisTest, StandsStillBelowItsSpeedOfStandstill) {
  robot_->motors()[0].standstill_rpm = 10.0F;
  const auto stands = [this](int rotor_rpm) {
    hear(static_cast<std::int16_t>(rotor_rpm));
    const float rpm = axis_.motor().feedback().velocity_rpm;
    robot_->motors()[0].standstill_rpm = std::fabs(rpm);
    const bool at_it = axis_.standsStill();
    robot_->motors()[0].standstill_rpm = std::fabs(rpm) + 0.01F;
    return !at_it && axis_.standsStill();
  };
  EXPECT_TRUE(stands(200));
  EXPECT_TRUE(stands(-200));
}

TEST_F(AxisTest, ASampleIsHeardUpToTheAgeOfItsMotor) {
  const auto& entry = robot_->motors()[0];
  for (const Duration more : {Duration{0}, Duration{1}}) {
    Axis axis{entry, robot_->buses()[0]};
    hear();
    (void)axis.listen(now(), {.before = now_, .ran = 1ms});
    now_ += 100ms;
    hear();
    now_ += entry.oldest_heard + more;
    (void)axis.listen(now(), {.before = now_, .ran = entry.most_unheard});
    now_ += entry.feedback_timeout;
    (void)axis.listen(now(), {.before = now_, .ran = entry.most_unheard - entry.oldest_heard});
    EXPECT_EQ(axis.lost(now()), more > Duration{0});
  }
}

TEST_F(AxisTest, OneThatIsTooHotTripsFromItsEnablingOn) {
  robot_->motors()[0].guard = {.temperature_derate_c = 60.0F, .temperature_trip_c = 80.0F};
  Axis axis{robot_->motors()[0], robot_->buses()[0]};
  const auto hear_hot = [&] {
    now_ += 1ms;
    (void)axis.motor().updateFeedback(makeDjiFeedback(kM3508, 1, {.temperature_c = 90}, now_));
    (void)axis.listen(now(), {.before = now_ - 1ms, .ran = 1ms});
  };
  hear_hot();
  (void)axis.handle(MotorEvent::kFeedbackFresh, RobotStatus::kRun, {}, now());
  EXPECT_EQ(axis.trips(false, now()), Axis::Trip::kNone) << "at rest it cools down";
  axis.prepareEnabling(now());
  (void)axis.handle(MotorEvent::kEnable, RobotStatus::kRun, {}, now());
  hear_hot();
  EXPECT_EQ(axis.trips(false, now()), Axis::Trip::kFault);
  EXPECT_EQ(axis.fault(), FaultCode::kOverheated);
}

TEST_F(AxisTest, AnotherSenderStopsOneThatIsThereAndInNoFault) {
  EXPECT_FALSE(axis_.yields());
  EXPECT_EQ(axis_.fault(), FaultCode::kNone);
  activate();
  EXPECT_TRUE(axis_.yields());
  EXPECT_EQ(axis_.fault(), FaultCode::kForeignCommands);
  (void)axis_.handle(MotorEvent::kFault, RobotStatus::kRun, {}, now());
  EXPECT_FALSE(axis_.yields());
}

TEST_F(AxisTest, AStopSaysWhyUntilItIsEnabledAgain) {
  activate();
  EXPECT_EQ(axis_.stop().cause, StopCause::kNone);
  (void)axis_.handle(MotorEvent::kDisable, RobotStatus::kRun, {StopCause::kRequest}, now());
  EXPECT_EQ(axis_.stop().cause, StopCause::kRequest);
  (void)axis_.handle(MotorEvent::kFeedbackLost, RobotStatus::kRun, {StopCause::kSilence}, now());
  EXPECT_EQ(axis_.stop().cause, StopCause::kRequest) << "it was not on";
  tick();
  (void)axis_.handle(MotorEvent::kFault, RobotStatus::kRun, {StopCause::kFault}, now());
  EXPECT_EQ(axis_.stop().cause, StopCause::kFault) << "a fault is news all the same";
  (void)axis_.handle(MotorEvent::kClear, RobotStatus::kRun, {}, now());
  tick();
  EXPECT_EQ(axis_.stop().cause, StopCause::kFault);
  activate();
  EXPECT_EQ(axis_.stop().cause, StopCause::kNone);
}

TEST_F(AxisTest, OnlyARequestOrTheEndOfTheProcessDisables) {
  robot_->motors()[0].fallback.on_disable = FallbackAction::kDamp;
  robot_->motors()[0].fallback.on_estop = FallbackAction::kBrake;
  const auto after = [this](MotorEvent event, RobotStatus robot) {
    activate();
    (void)axis_.handle(event, robot, {}, now());
    axis_.order(robot, now());
    const auto kind = axis_.motor().ordered();
    axis_.endFallback();
    return kind;
  };
  EXPECT_EQ(after(MotorEvent::kDisable, RobotStatus::kRun), FrameKind::kDamp);
  EXPECT_EQ(after(MotorEvent::kEstop, RobotStatus::kStopping), FrameKind::kDamp);
  EXPECT_EQ(after(MotorEvent::kEstop, RobotStatus::kEstop), FrameKind::kBrake);
  EXPECT_EQ(after(MotorEvent::kGroupStop, RobotStatus::kRun), FrameKind::kBrake);
}

TEST_F(AxisTest, ReportsASkippedTargetOnceASecond) {
  EXPECT_TRUE(axis_.mayReportSkip(now_));
  EXPECT_FALSE(axis_.mayReportSkip(now_ + 999ms));
  EXPECT_TRUE(axis_.mayReportSkip(now_ + 1s));
}

// A slew that ran on behind the limit would hold the effort there long after less was asked for.
TEST(AxisSlew, OfAnEffortGoesOnFromTheLimitThatItHasReached) {
  VirtualRobot robot{
      oneMotorRobot("model: M3508, id: 1, zero: power_on, current_limit_a: 2, current_slew_a_per_s: 100, "
                    "soft_start_ms: 0")};
  robot.run(50);
  robot.order(Operation::kEnable);
  ASSERT_EQ(robot.motor(0).status, MotorStatus::kActive);
  robot.hold(0, {.mode = ControlMode::kCurrent, .value = 15.0}, 300);
  ASSERT_EQ(robot.motor(0).command_value, 2.0F);
  robot.hold(0, {.mode = ControlMode::kCurrent}, 10);
  EXPECT_NEAR(robot.motor(0).command_value, 1.0F, 0.2F);
}

}  // namespace axis_test
}  // namespace rc10::test
