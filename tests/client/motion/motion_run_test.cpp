#include "client/motion/motion_run.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gmock/gmock.h>

#include "app/event_code.hpp"
#include "client/motion/motion_report.hpp"

namespace rc10::client::test::motion_run_test {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

link::Welcome welcomeOfTwo() {
  link::Welcome welcome;
  welcome.rate_hz = 1000;
  welcome.motor_count = 2;
  welcome.motors[0].name = "other";
  welcome.motors[1].name = "wheel";
  for (auto& motor : welcome.motors)
    motor.modes = ModeSet(ControlMode::kVelocity, ControlMode::kTotalAngle).bits();
  return welcome;
}

/// rc10d with one motor that follows with a time constant, in virtual time: ticks of a millisecond, rows and
/// states every ten.
class Robot {
 public:
  explicit Robot(MotionRun test) : test_(std::move(test)) {}

  /// Until it is over, or so long. `tick` is called in each, before rc10d acts.
  void run(Duration time, const std::function<void(Robot&)>& tick = {}) {
    for (const auto end = now_ + time; now_ < end && !test_.over(); now_ += 1ms) {
      ++tick_;
      if (now_ >= asleep_until) {
        if (const auto order = test_.order(now_)) obey(*order);
      }
      if (now_ >= until_ && owner == "tester") owner = "";
      if (tick) tick(*this);
      advance();
      rows_.rows[rows_.row_count++] = row();
      if (tick_ % 10 == 0 && !silent && now_ >= asleep_until) publish();
      if (tick_ % 10 == 0) rows_.row_count = 0;
    }
  }

  MotionRun& test() { return test_; }
  std::int64_t ticks() const { return tick_; }

  // Disturbed by the tests.
  std::string owner;
  double time_constant_s = 0.03;
  double angle_deg = 500.0;
  double velocity_rpm = 0.0;
  double current_a = 0.5;
  double age_us = 700.0;
  double limits = 0.0;
  MotorStatus status = MotorStatus::kActive;
  RobotStatus robot = RobotStatus::kRun;
  std::int32_t fault = 0;
  double target = 0.0;
  bool silent = false;
  bool obeys = true;
  std::int32_t last_validity_ms = 0;
  int orders_after_abort = 0;
  int orders = 0;
  MonotonicTime asleep_until{};
  MonotonicTime now() const { return now_; }

 private:
  void obey(const MotionRun::Order& order) {
    ++orders;
    if (test_.aborted()) ++orders_after_abort;
    last_validity_ms = order.validity_ms;
    if (!obeys) return;
    mode_ = order.target.mode;
    target = order.target.value;
    owner = "tester";
    until_ = now_ + std::chrono::milliseconds{order.validity_ms};
  }

  void advance() {
    const double share = -std::expm1(-1e-3 / time_constant_s);
    if (owner.empty()) return;
    if (mode_ == ControlMode::kVelocity) {
      velocity_rpm += (target - velocity_rpm) * share;
      angle_deg += velocity_rpm * 6.0 * 1e-3;
    } else {
      angle_deg += (target - angle_deg) * share;
    }
  }

  link::TraceRow row() const {
    link::TraceRow row{
        .mono_us = std::chrono::duration_cast<std::chrono::microseconds>(now_.time_since_epoch()).count(),
        .tick = tick_};
    const double acting = static_cast<double>(owner.empty() ? Acting::kNothing : Acting::kTarget);
    row.values = {7.0,       target,       target,
                  angle_deg, velocity_rpm, current_a,
                  age_us,    limits,       static_cast<double>(status),
                  acting};
    return row;
  }

  void publish() {
    const auto choice = test_.choice();
    // Another client has chosen a signal before.
    rows_.signals[0] = {link::TraceSource::kMotor, 0, 0};
    std::copy_n(choice.signals.begin(), choice.signal_count, rows_.signals.begin() + 1);
    rows_.signal_count = choice.signal_count + 1;
    test_.take(rows_);
    state_.tick = tick_;
    state_.motor_count = 2;
    state_.robot_state = robot;
    state_.motors[1].status = status;
    state_.motors[1].fault = fault;
    state_.motors[1].owner = owner;
    test_.take(state_);
  }

  MotionRun test_;
  MonotonicTime now_{1000s};
  MonotonicTime until_{};
  std::int64_t tick_ = 0;
  ControlMode mode_{};
  link::Trace rows_;
  link::State state_;
};

MotionSettings stepTo(double amplitude) {
  return {.client = "tester",
          .motor = "wheel",
          .mode = ControlMode::kVelocity,
          .excitation = {.kind = ExcitationKind::kStep, .amplitude = amplitude, .time_s = 1.0},
          .criteria = {.velocity_max_rpm = 100.0, .current_max_a = 3.0}};
}

Robot robotFor(const MotionSettings& settings) {
  auto test = MotionRun::of(welcomeOfTwo(), settings);
  EXPECT_TRUE(test) << test.error().message;
  return Robot(*test);
}

/// The abort of a step that this disturbs when the motor turns; the motor has been let go.
Abort disturbed(const std::function<void(Robot&)>& disturb, MotionSettings settings = stepTo(60.0)) {
  auto robot = robotFor(settings);
  robot.run(6s, [&](Robot& r) {
    if (r.velocity_rpm > 50.0) disturb(r);
  });
  EXPECT_TRUE(robot.test().over());
  EXPECT_EQ(robot.last_validity_ms == 1, robot.orders_after_abort == 1);
  EXPECT_LE(robot.orders_after_abort, 1);
  return robot.test().aborted().value_or(Abort{});
}

TEST(MotionRun, AStepOfAFirstOrderMotorHasItsNumbers) {
  auto robot = robotFor(stepTo(60.0));
  robot.run(5s);
  ASSERT_TRUE(robot.test().over());
  EXPECT_FALSE(robot.test().aborted());
  EXPECT_EQ(robot.last_validity_ms, 1);
  const auto report = reportOf(robot.test());
  ASSERT_TRUE(report.step);
  EXPECT_NEAR(report.step->rise_s, 0.03 * std::log(9.0), 2e-3);
  EXPECT_NEAR(report.step->settling_s, 0.03 * std::log(50.0), 3e-3);
  EXPECT_EQ(report.following.max, 60.0 * std::exp(-1e-3 / 0.03));
  EXPECT_THAT(text(report, robot.test()), HasSubstr("settling (to 2 %)     0.11"));
}

TEST(MotionRun, AnAngleCountsFromWhereTheMotorStands) {
  auto settings = stepTo(30.0);
  settings.mode = ControlMode::kTotalAngle;
  settings.criteria.angle_min_deg = -5.0;
  settings.criteria.angle_max_deg = 40.0;
  auto robot = robotFor(settings);
  robot.run(5s);
  EXPECT_FALSE(robot.test().aborted());
  EXPECT_NEAR(robot.angle_deg, 530.0, 0.1);
  EXPECT_EQ(robot.test().curve().front().target, 500.0);
}

TEST(MotionRun, AMultisineFindsTheBandwidthOfAFirstOrderMotor) {
  auto settings = stepTo(20.0);
  settings.excitation = {.kind = ExcitationKind::kMultisine, .base = 60.0, .amplitude = 20.0, .time_s = 12.0};
  auto robot = robotFor(settings);
  robot.run(20s);
  ASSERT_FALSE(robot.test().aborted()) << robot.test().aborted()->text;
  const auto report = reportOf(robot.test());
  EXPECT_NEAR(report.bandwidth_hz, 5.3, 0.15);
  EXPECT_NEAR(report.margins.phase_deg, 90.0, 3.0);
  EXPECT_EQ(report.response.size(), 20U);
  EXPECT_THAT(bodeCsv(report.response), HasSubstr("frequency_hz,gain_db,phase_deg,coherence\n"));
}

TEST(MotionRun, EachCriterionLetsTheMotorGo) {
  EXPECT_EQ(disturbed([](Robot& r) { r.current_a = 3.5; }).criterion, Criterion::kCurrent);
  EXPECT_EQ(disturbed([](Robot& r) { r.velocity_rpm = 120.0; }).criterion, Criterion::kVelocity);
  EXPECT_EQ(disturbed([](Robot& r) { r.age_us = 300'000.0; }).criterion, Criterion::kFeedbackAge);
  auto settings = stepTo(60.0);
  settings.criteria.angle_max_deg = 20.0;
  EXPECT_EQ(disturbed([](Robot&) {}, settings).criterion, Criterion::kAngle);
  settings = stepTo(60.0);
  settings.criteria.limits_abort = true;
  EXPECT_EQ(disturbed([](Robot& r) { r.limits = kLimitCurrent; }, settings).criterion, Criterion::kLimit);
}

TEST(MotionRun, ALimitThatActsInTheLeadIsASoftStart) {
  auto settings = stepTo(60.0);
  settings.criteria.limits_abort = true;
  auto robot = robotFor(settings);
  robot.run(5s, [](Robot& r) { r.limits = r.ticks() < 300 ? double{kLimitSlew} : 0.0; });
  EXPECT_FALSE(robot.test().aborted());
  EXPECT_EQ(reportOf(robot.test()).limits, 0U);
}

TEST(MotionRun, AMotorThatTurnsIsBroughtToTheBaseFirst) {
  auto robot = robotFor(stepTo(60.0));
  robot.velocity_rpm = 80.0;
  robot.run(5s);
  ASSERT_FALSE(robot.test().aborted());
  EXPECT_EQ(robot.test().curve().front().target, 80.0);
  EXPECT_NEAR(reportOf(robot.test()).step->rise_s, 0.03 * std::log(9.0), 2e-3);
}

TEST(MotionRun, ACriterionIsJudgedInEachTick) {
  // One tick between two states.
  int count = 0;
  const auto abort = disturbed([&](Robot& r) { r.current_a = ++count == 3 ? 3.5 : 0.5; });
  EXPECT_EQ(abort.value, 3.5);
  EXPECT_EQ(abort.limit, 3.0);
}

TEST(MotionRun, AnotherOwnerEndsItAndIsNamed) {
  const auto abort = disturbed([](Robot& r) {
    r.obeys = false;
    r.owner = "teleop";
    r.target = 12.0;
  });
  EXPECT_EQ(abort.criterion, Criterion::kOwnership);
  EXPECT_THAT(abort.text, HasSubstr("held by 'teleop'"));
}

TEST(MotionRun, ATargetThatLapsesEndsIt) {
  const auto abort = disturbed([](Robot& r) {
    r.obeys = false;
    r.owner = "";
  });
  EXPECT_EQ(abort.criterion, Criterion::kOwnership);
  EXPECT_THAT(abort.text, HasSubstr("too busy"));
}

TEST(MotionRun, AFaultEndsItAndIsTold) {
  const auto abort = disturbed([](Robot& r) {
    r.status = MotorStatus::kFault;
    r.fault = 3;
    r.owner = "";
  });
  EXPECT_EQ(abort.criterion, Criterion::kStatus);
  EXPECT_THAT(abort.text, HasSubstr("motor 'wheel' is FAULT"));
}

TEST(MotionRun, SilenceOfRc10dEndsIt) {
  const auto abort = disturbed([](Robot& r) { r.silent = true; });
  EXPECT_EQ(abort.criterion, Criterion::kFeedbackAge);
  EXPECT_GT(abort.value, 200.0);
}

TEST(MotionRun, CtrlCLetsTheMotorGo) {
  const auto abort = disturbed([](Robot& r) { r.test().end(Criterion::kInterrupted, "interrupted"); });
  EXPECT_EQ(abort.criterion, Criterion::kInterrupted);
  EXPECT_EQ(abort.text, "interrupted");
}

TEST(MotionRun, AMotorThatIsHeldByAnotherIsNotMoved) {
  auto robot = robotFor(stepTo(60.0));
  robot.obeys = false;
  robot.owner = "teleop";
  robot.run(5s);
  ASSERT_TRUE(robot.test().over());
  EXPECT_EQ(robot.test().aborted()->criterion, Criterion::kOwnership);
  EXPECT_THAT(robot.test().aborted()->text, HasSubstr("'teleop'"));
  EXPECT_EQ(robot.orders_after_abort, 0);
}

TEST(MotionRun, AnEstopBeforeTheFirstTargetIsTakenIsToldAsOne) {
  for (const bool traced : {true, false}) {
    auto robot = robotFor(stepTo(60.0));
    robot.obeys = false;
    robot.run(5s, [&](Robot& r) {
      if (r.ticks() != 45) return;
      r.robot = RobotStatus::kEstop;
      if (traced) r.status = MotorStatus::kReady;
    });
    ASSERT_TRUE(robot.test().over());
    EXPECT_EQ(robot.test().aborted()->criterion, Criterion::kStatus);
    EXPECT_THAT(robot.test().aborted()->text, HasSubstr("the robot is in ESTOP: `rc10ctl clear`"));
    EXPECT_EQ(robot.orders_after_abort, 0);
  }
}

TEST(MotionRun, ARefusalIsGivenAsTheReason) {
  auto robot = robotFor(stepTo(60.0));
  robot.obeys = false;
  link::Event event;
  event.source = "wheel";
  event.code = static_cast<std::int32_t>(EventCode::kSetpointSkipped);
  event.text = "the angle has no reference";
  robot.test().take(event);
  robot.run(5s);
  ASSERT_TRUE(robot.test().aborted());
  EXPECT_THAT(robot.test().aborted()->text, HasSubstr("(the angle has no reference)"));
}

TEST(MotionRun, AMotorThatIsNotActiveIsSentNothing) {
  auto robot = robotFor(stepTo(60.0));
  robot.status = MotorStatus::kReady;
  robot.run(5s);
  ASSERT_TRUE(robot.test().over());
  EXPECT_EQ(robot.test().aborted()->criterion, Criterion::kStatus);
  EXPECT_THAT(robot.test().aborted()->text, HasSubstr("`rc10ctl enable wheel`"));
  EXPECT_EQ(robot.last_validity_ms, 0);
}

TEST(MotionRun, WithoutItsSignalsNothingIsSent) {
  auto robot = robotFor(stepTo(60.0));
  link::Trace others;
  others.signal_count = 1;
  robot.test().take(others);
  robot.silent = true;
  robot.run(5s);
  ASSERT_TRUE(robot.test().over());
  EXPECT_EQ(robot.test().aborted()->criterion, Criterion::kConnection);
  EXPECT_THAT(robot.test().aborted()->text, HasSubstr("32 signals at most"));
  EXPECT_EQ(robot.last_validity_ms, 0);
}

TEST(MotionRun, APauseOfTheClientChangesNothing) {
  auto robot = robotFor(stepTo(60.0));
  bool paused = false;
  robot.run(5s, [&](Robot& r) {
    // rc10d goes on, and the last target acts, while nobody calls order().
    if (r.velocity_rpm > 50.0 && !paused) {
      paused = true;
      r.obeys = false;
    }
    if (paused && !r.obeys && r.velocity_rpm > 55.0) r.obeys = true;
  });
  EXPECT_FALSE(robot.test().aborted());
}

TEST(MotionRun, ATargetThatLapsedWhileTheClientStoodIsNotSentOnceMore) {
  // Within the time of the test, and beyond it.
  for (const auto pause : {500ms, 5000ms}) {
    auto settings = stepTo(60.0);
    settings.criteria.feedback_age_max_us = 1e7;
    auto robot = robotFor(settings);
    int before = 0;
    robot.run(10s, [&](Robot& r) {
      if (r.velocity_rpm < 50.0 || before != 0) return;
      before = r.orders;
      r.asleep_until = r.now() + pause;
    });
    ASSERT_TRUE(robot.test().over());
    EXPECT_GT(before, 0);
    EXPECT_EQ(robot.orders, before) << pause.count();
  }
}

TEST(MotionRun, AfterAPauseItBeginsWithWhatIsKnownSince) {
  auto robot = robotFor(stepTo(60.0));
  robot.run(10ms);  // a state and rows have come, and no order has gone out
  robot.asleep_until = robot.now() + 1500ms;
  robot.run(1501ms);
  EXPECT_EQ(robot.orders, 0) << "its motor may have been stopped, turned and enabled meanwhile";
  robot.run(100ms);
  EXPECT_GT(robot.orders, 0);
}

TEST(MotionRun, AfterAPauseNothingIsSentOnceMore) {
  auto settings = stepTo(60.0);
  settings.validity_ms = 1000;
  auto robot = robotFor(settings);
  int before = 0;
  robot.run(10s, [&](Robot& r) {
    if (r.velocity_rpm < 50.0 || before != 0) return;
    before = r.orders;
    r.asleep_until = r.now() + 800ms;  // its last target is still valid
  });
  EXPECT_TRUE(robot.test().aborted());
  EXPECT_EQ(robot.orders, before);
}

TEST(MotionRun, NoTargetOutlivesAPulseByMoreThan200Ms) {
  auto pulse = stepTo(60.0);
  pulse.excitation.time_s = 0.12;
  pulse.validity_ms = 1000;
  auto robot = robotFor(pulse);
  std::int64_t begin = 0;
  std::int64_t end = 0;
  robot.run(5s, [&](Robot& r) {
    if (begin == 0 && r.owner == "tester") begin = r.ticks();
    if (begin != 0) end = std::max(end, r.ticks() + r.last_validity_ms);
  });
  EXPECT_FALSE(robot.test().aborted());
  // An order lasts for two ticks.
  EXPECT_LE(end - begin, 1120 + 200 + 2);
  EXPECT_GE(end - begin, 1120 + 200 - 2);
}

TEST(MotionRun, WhatCannotBeTestedIsRefusedBefore) {
  const auto refusal = [](const std::function<void(MotionSettings&)>& change) {
    auto settings = stepTo(60.0);
    change(settings);
    const auto test = MotionRun::of(welcomeOfTwo(), settings);
    return test ? "" : test.error().message;
  };
  EXPECT_THAT(refusal([](auto& s) { s.motor = "whel"; }), HasSubstr("wheel"));
  EXPECT_THAT(refusal([](auto& s) {
                s.mode = ControlMode::kCurrent;
                s.excitation.amplitude = 1.0;
              }),
              HasSubstr("has no mode current"));
  EXPECT_THAT(refusal([](auto& s) { s.excitation.amplitude = 101.0; }), HasSubstr("beyond its limits"));
  EXPECT_THAT(refusal([](auto& s) {
                s.mode = ControlMode::kTotalAngle;
                s.excitation.base = 5.0;
              }),
              HasSubstr("leave the base out"));
}

TEST(MotionRun, ACommandThatIsNotPermittedIsNamedWithTheLineThatGrantsIt) {
  auto robot = robotFor(stepTo(60.0));
  robot.obeys = false;
  link::Event event;
  event.code = static_cast<std::int32_t>(EventCode::kCommandRefused);
  event.source = "robot";
  event.client = "another";
  event.text = "somebody else's";
  robot.run(3s, [&](Robot& r) {
    event.client = r.ticks() == 100 ? "tester" : "another";
    event.text = r.ticks() == 100 ? "add it to `motors` at robot.yaml:12" : "somebody else's";
    r.test().take(event);
  });
  ASSERT_TRUE(robot.test().aborted());
  EXPECT_EQ(robot.test().aborted()->criterion, Criterion::kOwnership);
  EXPECT_THAT(robot.test().aborted()->text, HasSubstr("robot.yaml:12"));
}

TEST(MotionRun, ASilenceIsNamed) {
  const auto abort = disturbed([](Robot& r) { r.test().end(Criterion::kSilence, "no word"); });
  EXPECT_STREQ(toString(abort.criterion), "silence");
  EXPECT_EQ(abort.text, "no word");
}

TEST(MotionReport, AStepOfTheCurrentHasTheAccelerationOnceItHasRisen) {
  auto settings = stepTo(2.0);
  settings.mode = ControlMode::kCurrent;
  settings.excitation.time_s = 0.12;
  settings.criteria.velocity_max_rpm = 1000.0;
  auto welcome = welcomeOfTwo();
  welcome.motors[1].modes = ModeSet(ControlMode::kCurrent).bits();
  auto test = MotionRun::of(welcome, settings);
  ASSERT_TRUE(test) << test.error().message;
  Robot robot(*test);
  // It rises for 15 ms, and then gains 172 rpm/s for each ampere.
  int ticks = 0;
  robot.run(5s, [&](Robot& r) {
    r.time_constant_s = std::numeric_limits<double>::infinity();
    if (r.target == 2.0 && ++ticks > 15) r.velocity_rpm += 2.0 * 0.172;
  });
  ASSERT_FALSE(robot.test().aborted()) << robot.test().aborted()->text;
  const auto report = reportOf(robot.test());
  EXPECT_NEAR(report.acceleration_rpm_per_s, 344.0, 0.1);
  EXPECT_THAT(text(report, robot.test()), HasSubstr("acceleration          344.0 rpm/s\n"));
  EXPECT_EQ(jsonOf(report, robot.test())["acceleration_rpm_per_s"], report.acceleration_rpm_per_s);
}

TEST(MotionReport, AnAbortIsTheFirstThingThatJsonTells) {
  auto settings = stepTo(60.0);
  settings.criteria.velocity_max_rpm = 60.0;
  auto robot = robotFor(settings);
  robot.run(3s, [](Robot& r) {
    if (r.velocity_rpm > 50.0) r.velocity_rpm = 70.0;
  });
  const auto json = jsonOf(reportOf(robot.test()), robot.test());
  EXPECT_EQ(json["abort"]["criterion"], "velocity");
  EXPECT_EQ(json["abort"]["limit"], 60.0);
  EXPECT_TRUE(json["step"].is_null());
  EXPECT_EQ(curveCsv(robot.test().curve()).find("time_s,target,"), 0U);
}

}  // namespace
}  // namespace rc10::client::test::motion_run_test
