#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "module/module_base.hpp"
#include "module/module_type.hpp"

namespace rc10::test {

/// A robot as a module sees it: what the test says, and what the module asked for in its last update.
class FakeRobot : public ModuleRobot {
 public:
  struct Motor {
    MotorFeedback feedback;
    MotorStatus status = MotorStatus::kActive;
    bool obeys = true;
    double speed_ceiling_rpm = std::numeric_limits<double>::infinity();
    bool heard = true;             ///< A sample comes with each update.
    std::optional<Target> target;  ///< Target of the last update; empty: none.
  };
  struct Asked {
    RobotRequest request{};
    std::optional<std::size_t> motor;  ///< Empty: all.
    double angle_deg = 0.0;
  };

  explicit FakeRobot(std::size_t motor_count) : motors_(motor_count) {
    for (auto& motor : motors_) {
      motor.feedback.samples = 1;
      motor.feedback.zeroed = true;
      motor.feedback.angle_deg = 0.0F;
      motor.feedback.total_angle_deg = 0.0;
      motor.feedback.velocity_rpm = 0.0F;
      motor.feedback.current_a = 0.0F;
    }
  }

  /// One tick of the module, 1 ms after the last; every motor has fresh feedback.
  void update(Module_Base& module) {
    tick_.now += std::chrono::milliseconds{1};
    ++tick_.index;
    for (auto& motor : motors_) {
      motor.target.reset();
      if (!motor.heard) continue;
      motor.feedback.received = tick_.now;
      ++motor.feedback.samples;
    }
    asked_.clear();
    sent_.clear();
    events_.clear();
    client_heard_ = false;
    module.update(tick_, *this);
  }

  /// The process stands still before the next update.
  void pause(Duration time) { tick_.now += time; }
  /// Silence of all clients from now on.
  void silenceClients(Duration silent) { clients_silent_s_ = static_cast<double>(seconds(silent)); }
  [[nodiscard]] std::size_t largestRequest() const { return largest_request_; }
  /// In the last update.
  [[nodiscard]] bool clientHeard() const { return client_heard_; }
  [[nodiscard]] MonotonicTime clientSaid() const { return client_said_; }
  [[nodiscard]] Motor& motor(std::size_t index) { return motors_.at(index); }
  [[nodiscard]] std::vector<Motor>& motors() { return motors_; }
  [[nodiscard]] const std::vector<Asked>& asked() const { return asked_; }
  /// Messages to inputs of other modules.
  [[nodiscard]] const std::map<std::pair<std::size_t, std::size_t>, double>& sent() const { return sent_; }
  [[nodiscard]] const std::vector<std::size_t>& events() const { return events_; }
  [[nodiscard]] MonotonicTime now() const { return tick_.now; }
  /// References that it was to forget.
  [[nodiscard]] int forgotten() const { return forgotten_; }
  /// Somebody asks for a disable.
  void disable() { ++disables_; }
  void setState(RobotStatus state) { state_ = state; }

  [[nodiscard]] RobotStatus state() const noexcept override { return state_; }
  [[nodiscard]] std::size_t motorCount() const noexcept override { return motors_.size(); }
  [[nodiscard]] const MotorFeedback& feedback(std::size_t motor) const noexcept override {
    return motors_[motor].feedback;
  }
  [[nodiscard]] std::uint32_t disables() const noexcept override { return disables_; }
  [[nodiscard]] double speedCeilingRpm(std::size_t motor) const noexcept override {
    return motors_[motor].speed_ceiling_rpm;
  }
  [[nodiscard]] MotorStatus status(std::size_t motor) const noexcept override {
    return motors_[motor].status;
  }
  [[nodiscard]] bool obeys(std::size_t motor) const noexcept override {
    return motors_[motor].obeys && motors_[motor].status == MotorStatus::kActive;
  }
  void setTarget(std::size_t motor, const Target& target) noexcept override {
    motors_[motor].target = target;
  }
  void ask(RobotRequest request, std::size_t motor, double angle_deg) noexcept override {
    asked_.push_back({request, motor, angle_deg});
  }
  void ask(RobotRequest request, std::span<const std::size_t> motors) noexcept override {
    largest_request_ = std::max(largest_request_, motors.size());
    for (const auto motor : motors) ask(request, motor, 0.0);
  }
  void forgetReference(std::size_t motor) noexcept override {
    motors_[motor].feedback.zeroed = false;
    ++forgotten_;
  }
  [[nodiscard]] double clientsSilentSeconds() const noexcept override { return clients_silent_s_; }
  void hearClient(MonotonicTime said) noexcept override {
    client_heard_ = true;
    client_said_ = said;
  }
  void askAll(RobotRequest request) noexcept override { asked_.push_back({request, std::nullopt, 0.0}); }
  [[nodiscard]] double read(SignalPlace output) const noexcept override {
    const auto found = outputs_.find({output.module, output.signal});
    return found != outputs_.end() ? found->second : kNoSignal;
  }
  /// An output of another module, from now on.
  void setOutput(SignalPlace output, double value) { outputs_[{output.module, output.signal}] = value; }
  void send(SignalPlace input, double value) noexcept override {
    sent_[{input.module, input.signal}] = value;
  }
  void report(std::size_t event) noexcept override { events_.push_back(event); }

 private:
  Tick tick_{.index = 0, .now = MonotonicTime{std::chrono::seconds{1000}}, .dt_s = 0.001F};
  double clients_silent_s_ = 0.0;
  bool client_heard_ = false;
  MonotonicTime client_said_{};
  std::uint32_t disables_ = 0;
  int forgotten_ = 0;
  std::size_t largest_request_ = 0;  ///< Motors of one request.
  std::vector<Motor> motors_;
  std::vector<Asked> asked_;
  std::map<std::pair<std::size_t, std::size_t>, double> sent_;
  std::map<std::pair<std::size_t, std::size_t>, double> outputs_;
  std::vector<std::size_t> events_;
  RobotStatus state_ = RobotStatus::kRun;
};

/// A robot whose motors take every mode.
inline RobotOutline outlineOf(std::size_t motor_count) {
  RobotOutline outline;
  for (std::size_t i = 0; i < motor_count; ++i) {
    outline.motors.push_back({.name = "motor" + std::to_string(i),
                              .modes = ModeSet{ControlMode::kCurrent, ControlMode::kVelocity,
                                               ControlMode::kAngle, ControlMode::kTotalAngle},
                              .velocity_limit_rpm = 400.0F,
                              .angle_min_deg = -std::numeric_limits<double>::infinity(),
                              .angle_max_deg = std::numeric_limits<double>::infinity()});
  }
  return outline;
}

}  // namespace rc10::test
