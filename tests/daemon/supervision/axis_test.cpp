#include "daemon/supervision/axis.hpp"

#include <gtest/gtest.h>

#include <memory>

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
    if (speaks) (void)axis_.motor().updateFeedback(makeDjiFeedback(kM3508, 1, {}, now_));
    const Tick tick = this->now();
    axis_.listen(tick, {.before = now_ - 1ms, .ran = 1ms});
    if (axis_.fresh(tick)) (void)axis_.take(MotorEvent::kFeedbackFresh, RobotStatus::kRun, {}, tick);
    if (axis_.lost(tick)) (void)axis_.take(MotorEvent::kFeedbackLost, RobotStatus::kRun, {}, tick);
    if (const auto end = axis_.endsEnabling(tick)) (void)axis_.take(*end, RobotStatus::kRun, {}, tick);
    (void)axis_.trips(false, tick);
    lapsed_ = axis_.lapses(tick);
    axis_.order(RobotStatus::kRun, tick);
    axis_.motor().update(tick);
  }
  void activate() {
    tick();
    axis_.prepareEnabling(now());
    (void)axis_.take(MotorEvent::kEnable, RobotStatus::kRun, {}, now());
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
  EXPECT_EQ(axis_.take(kTurn, kPlanner, {now_, now_ + 50ms}), SkipReason::kNotActive);
  activate();
  EXPECT_EQ(axis_.take(kTurn, kPlanner, {now_, now_ + 50ms}), std::nullopt);
  EXPECT_EQ(axis_.take({.mode = ControlMode::kVoltage}, kPlanner, {now_, now_ + 50ms}), SkipReason::kRefused);
}

TEST_F(AxisTest, RefusesAnAngleThatNoDoubleTellsExactly) {
  activate();
  for (const double far_deg : {1.1e12, -1e17, 1e300}) {
    for (const auto mode : {ControlMode::kTotalAngle, ControlMode::kAngle})
      EXPECT_EQ(axis_.take({.mode = mode, .value = far_deg}, kPlanner, {now_, now_ + 50ms}),
                SkipReason::kTooFar);
  }
}

TEST_F(AxisTest, ObeysOneClientUntilItsCommandLapsesOrAHigherPriorityTakesOver) {
  activate();
  (void)axis_.take(kTurn, kPlanner, {now_, now_ + 50ms});
  EXPECT_TRUE(axis_.obeys(kRemote, now_));
  (void)axis_.take(kTurn, kRemote, {now_, now_ + 50ms});
  EXPECT_FALSE(axis_.obeys(kPlanner, now_));
  EXPECT_TRUE(axis_.obeys(kPlanner, now_ + 50ms));
}

TEST_F(AxisTest, BeginsItsFallbackInTheTickInWhichTheCommandLapses) {
  activate();
  (void)axis_.take(kTurn, kPlanner, {now_, now_ + 2ms});
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
  (void)axis_.take(MotorEvent::kFault, RobotStatus::kRun, {}, now());
  EXPECT_FALSE(axis_.fallbackActs()) << "a fault coasts";
  EXPECT_EQ(axis_.status(), MotorStatus::kFault);
}

TEST_F(AxisTest, ReportsASkippedTargetOnceASecond) {
  EXPECT_TRUE(axis_.mayReportSkip(now_));
  EXPECT_FALSE(axis_.mayReportSkip(now_ + 999ms));
  EXPECT_TRUE(axis_.mayReportSkip(now_ + 1s));
}

}  // namespace axis_test
}  // namespace rc10::test
