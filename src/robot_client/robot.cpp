#include "rc10/robot.hpp"

#include "robot_client/session/robot_session.hpp"

namespace rc10 {
inline namespace robot_client {

Robot::Robot(std::string name, RobotOptions options)
    : Robot(std::move(name), LcmLink{}, std::move(options)) {}

Robot::Robot(std::string name, const LcmLink& link, RobotOptions options)
    : session_(std::make_unique<RobotSession>(std::move(name), link, std::move(options))) {}

Robot::~Robot() = default;

const std::string& Robot::name() const noexcept { return session_->core().name; }
const LcmLink& Robot::link() const noexcept { return session_->core().link; }
Result<void> Robot::status() const { return session_->core().status; }

Result<void> Robot::command(const MotorSetpoints& setpoints) const {
  return session_->targets().command(setpoints);
}
void Robot::alive() const { session_->targets().alive(); }

Result<void> Robot::waitForState(Duration timeout) const { return session_->core().waitForState(timeout); }
std::shared_ptr<const RobotState> Robot::state() const { return session_->core().state(); }

void Robot::onState(std::function<void(const RobotState&)> callback) const {
  session_->onState(std::move(callback));
}
void Robot::onEvent(std::function<void(const Event&)> callback) const {
  session_->onEvent(std::move(callback));
}

RequestResult Robot::enable(const std::vector<std::string>& motors, Duration timeout) const {
  return session_->requests().enable(motors, timeout);
}
RequestResult Robot::disable(const std::vector<std::string>& motors, Duration timeout) const {
  return session_->requests().disable(motors, timeout);
}
RequestResult Robot::clear(const std::vector<std::string>& motors, Duration timeout) const {
  return session_->requests().request(Operation::kClear, motors, {}, timeout);
}
RequestResult Robot::request(const std::string& operation, const std::string& target,
                             const std::map<std::string, double>& values, Duration timeout) const {
  return session_->requests().request(operation, target, values, timeout);
}
Result<void> Robot::estop(Duration timeout) const { return session_->estop(timeout); }
Result<void> Robot::close() { return session_->close(); }

// ---- one module ------------------------------------------------------------------------------------------

Module Robot::module(std::string name) const {
  session_->modules().listenTo(name);
  return {*session_, std::move(name)};
}

Result<void> Module::send(const Signals& inputs, SendOptions options) const {
  return session_->modules().send(name_, inputs, options);
}
ModuleState Module::state() const { return session_->modules().state(name_); }
double Module::output(std::string_view name) const { return session_->modules().output(name_, name); }
Result<void> Module::waitForState(Duration timeout) const {
  return session_->modules().waitForState(name_, timeout);
}

// ---- one motor -------------------------------------------------------------------------------------------

Result<void> Motor::setTarget(const Setpoint& setpoint) const {
  return session_->targets().command({{name_, setpoint}});
}

std::future<MoveResult> Motor::moveTo(Degrees total_angle, Degrees tolerance, Duration timeout) const {
  return session_->targets().moveTo({name_, Mode::kTotalAngle, total_angle.value, tolerance.value, timeout});
}
std::future<MoveResult> Motor::moveToAngle(Degrees angle, Degrees tolerance, Duration timeout) const {
  return session_->targets().moveTo({name_, Mode::kAngle, angle.value, tolerance.value, timeout});
}

MotorState Motor::state() const {
  if (const auto state = session_->core().state()) {
    if (const auto* motor = state->find(name_)) return *motor;
  }
  MotorState unknown;
  unknown.name = name_;
  return unknown;
}

RequestResult Motor::enable(Duration timeout) const { return session_->requests().enable({name_}, timeout); }
RequestResult Motor::disable(Duration timeout) const {
  return session_->requests().disable({name_}, timeout);
}
RequestResult Motor::clear(Duration timeout) const {
  return session_->requests().request(Operation::kClear, std::vector{name_}, {}, timeout);
}
RequestResult Motor::zero(Degrees angle, Duration timeout) const {
  return session_->requests().request(Operation::kZero, std::vector{name_}, {{"angle_deg", angle.value}},
                                      timeout);
}
RequestResult Motor::gains(Duration timeout) const {
  return session_->requests().request(Operation::kGetConfig, std::vector{name_}, {}, timeout);
}
RequestResult Motor::setGains(const std::map<std::string, double>& gains, Duration timeout) const {
  return session_->requests().request(Operation::kSetGains, std::vector{name_}, gains, timeout);
}

}  // namespace robot_client
}  // namespace rc10
