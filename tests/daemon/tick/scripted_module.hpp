#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "daemon/tick/module_runner.hpp"
#include "daemon/virtual_robot.hpp"

namespace rc10::test::module_runner_test {

using ::testing::IsEmpty;
using namespace std::chrono_literals;

using Body = std::function<void(const Tick&, ModuleRobot&)>;

/// A module that does what the test says.
class Scripted : public Module_Base {
 public:
  explicit Scripted(Body body)
      : Module_Base({.inputs = {"speed_rpm", "other"},
                     .outputs = {"seen_rpm", "senders"},
                     .events = {{.text = "something"}, {.text = "as expected", .expected = true}}}),
        body_(std::move(body)) {}

  void update(const Tick& tick, ModuleRobot& robot) noexcept override {
    setOutput(0, commanded() ? input(0) : kNoSignal);
    setOutput(1, senderCount());
    if (body_) body_(tick, robot);
  }

 private:
  Body body_;
};

class ScriptedType : public ModuleType {
 public:
  explicit ScriptedType(Body body = {}) : body_(std::move(body)) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "scripted"; }
  [[nodiscard]] std::string_view about() const noexcept override { return "What a test says."; }
  [[nodiscard]] std::span<const OwnKey> keys() const noexcept override { return {}; }
  [[nodiscard]] Result<std::unique_ptr<Module_Base>> build(const ModuleSettings&,
                                                           const RobotOutline&) const override {
    return std::make_unique<Scripted>(body_);
  }

 private:
  Body body_;
};

inline Target rpm(double value) { return {.mode = ControlMode::kVelocity, .value = value}; }

class ModuleRunnerTest : public ::testing::Test {
 protected:
  void start(const std::vector<std::pair<const ModuleType*, int>>& types, FlightRecorder* recorder = nullptr,
             RobotConfig config = twoWheelsAndYaw()) {
    for (const auto& [type, priority] : types) {
      ModuleConfig module;
      module.type = type;
      module.settings.name = "module" + std::to_string(config.modules.size());
      module.settings.priority = priority;
      config.modules.push_back(module);
    }
    robot_ = std::make_unique<VirtualRobot>(config, recorder);
    robot_->run(10);
  }
  void enable() { (void)robot_->order(Operation::kEnable); }
  void signal(const char* client, int priority, double value, Duration validity = 50ms, Duration later = {}) {
    SignalMessage message;
    message.client = client;
    message.session = 7;
    message.priority = priority;
    message.received = robot_->now() + later;
    message.deadline = message.received + validity;
    message.values.fill(kNoSignal);
    message.values[0] = value;
    ASSERT_TRUE(robot_->exchange().signals.push(message));
  }
  /// Message of the client library when its program leaves; in the middle of a period, so that it is still
  /// valid in the tick.
  void end(const char* client, int priority, double value) { signal(client, priority, value, 1ms, 500us); }
  /// One module, to which this client gives 12 for a second.
  void startFor(const char* client, const ModuleType& type) {
    start({{&type, 0}});
    signal(client, 0, 12.0, Duration{std::chrono::seconds{1}});
    robot_->tick();
  }
  double senders() { return robot_->snapshot().modules[0].outputs[1]; }
  double seen(std::size_t module = 0) { return robot_->snapshot().modules[module].outputs[0]; }

  std::unique_ptr<VirtualRobot> robot_;
  /// Module that turns motor 0, while `turns_` says so.
  bool turns_ = true;
  ScriptedType turning_{[this](const Tick&, ModuleRobot& robot) {
    if (turns_) robot.setTarget(0, rpm(50.0));
  }};
  /// Module that turns motors 0 and 1 as its input says.
  ScriptedType following_{[](const Tick&, ModuleRobot& robot) {
    const double asked_rpm = robot.read({.module = 0, .signal = 0});
    if (std::isnan(asked_rpm)) return;
    for (const std::size_t motor : {0U, 1U}) robot.setTarget(motor, rpm(asked_rpm));
  }};

  bool follows() { return robot_->motor(0).acting == Acting::kTarget; }
  /// Nothing acts until the next message, which does.
  void expectNothingUntilANewerMessage() {
    ASSERT_EQ(robot_->motor(0).status, MotorStatus::kActive);
    (void)robot_->events();
    for (int i = 0; i < 100; ++i) {
      robot_->tick();
      ASSERT_FALSE(follows()) << "after " << i << " ticks";
      ASSERT_EQ(robot_->motor(0).owner.view(), "");
      ASSERT_FALSE(std::isnan(seen())) << "it is still valid";
    }
    EXPECT_THAT(robot_->events(), IsEmpty()) << "no mistake of the module";
    signal("planner", 0, 2.0);
    robot_->run(2);
    EXPECT_TRUE(follows());
  }
};

}  // namespace rc10::test::module_runner_test
