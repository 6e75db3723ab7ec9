#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "module/fake_robot.hpp"
#include "module/joint.hpp"

namespace rc10::test::joint_bench {

inline constexpr double kIdle = 0.0;
inline constexpr double kHoming = 1.0;
inline constexpr double kFollowing = 2.0;
inline constexpr double kHomingFailed = 3.0;

inline constexpr double kNone = 0.0;
inline constexpr double kUnderWay = 1.0;
inline constexpr double kDone = 2.0;
inline constexpr double kFailed = 3.0;

inline ModuleSettings jointSettings() {
  ModuleSettings settings;
  settings.name = "arm";
  settings.own.set("motor", 0.0);
  settings.own.set("max_velocity_deg_s", 90.0);
  settings.own.set("max_acceleration_deg_s2", 360.0);
  settings.own.set("max_jerk_deg_s3", 0.0);
  settings.own.set("max_lead_deg", 0.0);
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

class LimitSwitch : public Module_Base {
 public:
  LimitSwitch() : Module_Base({.inputs = {}, .outputs = {"closed"}, .events = {}}) {}
  void update(const Tick&, ModuleRobot&) noexcept override {}
};

/// A joint on a motor that follows at once, between two stops.
class JointBench : public ::testing::Test {
 protected:
  void build(const ModuleSettings& settings) {
    auto robot = outlineOf(1);
    robot.motors[0].angle_min_deg = -20.0;
    robot.motors[0].angle_max_deg = 180.0;
    module_ = std::move(jointType().build(settings, robot).value());
    const LimitSwitch limit;
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
      flows_a_ += std::clamp(motor.target->value * gets_ - flows_a_, -slew_a_, slew_a_);
      feedback.current_a = tells_current_ ? static_cast<float>(flows_a_) : std::nanf("");
      rpm_ += ((flows_a_ + gravity_a_) * 400.0 - 5.0 * rpm_) * 0.001;
      if (std::fabs(flows_a_ + gravity_a_) < friction_a_) rpm_ = 0.0;
      const bool stuck_at_place = before_deg >= stiff_deg_ && flows_a_ > -stiff_a_;
      feedback.total_angle_deg =
          std::clamp(before_deg + rpm_ * 0.006, stuck_at_place ? stiff_deg_ : stop_deg_, far_deg_);
      if (feedback.total_angle_deg == stiff_deg_) rpm_ = std::max(rpm_, 0.0);
      if (feedback.total_angle_deg == stop_deg_ || feedback.total_angle_deg == far_deg_) rpm_ = 0.0;
    }
    feedback.velocity_rpm = static_cast<float>((feedback.total_angle_deg - before_deg) / 0.006);
    showSwitch();
  }
  void showSwitch() {
    const double closed = stuck_ || angle() <= stop_deg_ + 0.5 ? 1.0 : 0.0;
    robot_.setOutput({.module = 0, .signal = 0}, switch_heard_ ? closed : kNoSignal);
  }
  /// No target: kCoast.
  ControlMode mode() { return robot_.motor(0).target.value_or(Target{}).mode; }
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
  double flows_a_ = 0.0;
  double far_deg_ = 1e6;     ///< Its other stop.
  double slew_a_ = 1e6;      ///< Change of the current in a tick.
  double friction_a_ = 0.0;  ///< Less than this does not move it.
  double stiff_deg_ = -1e6;  ///< A place that it passes towards the stop
  double stiff_a_ = 0.0;     ///< by as much.
  bool tells_current_ = true;
  bool blocked_ = false;
  bool stuck_ = false;  ///< The switch stays closed.
  bool switch_heard_ = true;
};

}  // namespace rc10::test::joint_bench
