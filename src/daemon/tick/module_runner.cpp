#include "daemon/tick/module_runner.hpp"

#include <algorithm>

#include "daemon/exchange/events.hpp"

namespace rc10 {
namespace {

// Modules run in every tick: what one has asked for holds over ticks that come late, and no longer.
constexpr Duration kLeastValidity = std::chrono::milliseconds{20};
constexpr int kLeastTicks = 5;
// Session of all modules; those of clients are random, and not 0.
constexpr std::uint64_t kModuleSession = 0;

[[nodiscard]] constexpr Operation operationOf(RobotRequest request) noexcept {
  switch (request) {
    case RobotRequest::kEnable: return Operation::kEnable;
    case RobotRequest::kDisable:
    case RobotRequest::kDisableUnasked: return Operation::kDisable;
    case RobotRequest::kEstop: return Operation::kEstop;
    case RobotRequest::kClear: return Operation::kClear;
    case RobotRequest::kZero: return Operation::kZero;
  }
  return Operation::kDisable;
}

}  // namespace

ModuleRunner::ModuleRunner(Robot& robot, Supervisor& supervisor, LinkExchange& link, FlightRecorder* recorder)
    : robot_(robot),
      supervisor_(supervisor),
      link_(link),
      recorder_(recorder),
      controls_(robot.modules().size()),
      validity_(std::max(kLeastValidity, kLeastTicks * robot.period())) {}

void ModuleRunner::update(const Tick& tick) noexcept {
  tick_ = tick;
  receive(tick);
  if (supervisor_.robotState() == RobotStatus::kStopping) {
    for (auto& entry : robot_.modules()) entry.module->rest(tick);
    return;
  }
  for (current_ = 0; current_ < controls_.size(); ++current_) {
    auto& module = *robot_.modules()[current_].module;
    auto& lease = controls_[current_].lease;
    if (lease.taken() && !lease.held(tick.now)) {
      lease.release();
      module.clearInputs();
    }
    said_ = lease.taken() ? controls_[current_].said : tick.now;
    command_.count = 0;
    commanded_.reset();
    sent_.fill(false);
    module.update(tick, *this);
    handOver(tick);
  }
}

void ModuleRunner::receive(const Tick& tick) noexcept {
  // Only what is there now, as with commands.
  for (auto n = link_.signals.read_available(); n > 0; --n) {
    link_.signals.consume_one([&](const SignalMessage& message) { take(message, message.received, tick); });
  }
}

// From a client or another module: the same rules.
void ModuleRunner::take(const SignalMessage& message, MonotonicTime said, const Tick& tick) noexcept {
  auto& control = controls_[message.module];
  const Lease::Holder sender{message.client, message.session, message.priority};
  const Lease::Term term{message.received, message.deadline};
  if (message.session != kModuleSession) supervisor_.hearClient();
  auto verdict = blackbox::Verdict::kApplied;
  if (!control.lease.allows(sender, term, tick.now)) verdict = blackbox::Verdict::kNotOwner;
  if (tick.now >= message.deadline) verdict = blackbox::Verdict::kExpired;
  if (recorder_ != nullptr) recorder_->signals(message, verdict);
  if (verdict != blackbox::Verdict::kApplied) {
    ++refused_signals_;
    // The newest message counts, and this one's time is over.
    if (verdict == blackbox::Verdict::kExpired) control.lease.shorten(sender, message.deadline);
    return;
  }
  auto& module = *robot_.modules()[message.module].module;
  if (sender.session != control.sender.session || sender.client.view() != control.sender.client.view())
    module.changeSender();
  control.sender = sender;
  if (!term.ends()) control.said = said;
  control.lease.take(sender, term);
  module.setInputs(message.values);
}

void ModuleRunner::handOver(const Tick& tick) noexcept {
  auto& control = controls_[current_];
  const auto from = sender();
  if (command_.count > 0) {
    command_.client = from.client;
    command_.session = from.session;
    command_.priority = from.priority;
    command_.received = tick.now;
    command_.deadline = tick.now + validity_;
    command_.said = said_;
    const bool refused = !supervisor_.takeModuleCommand(command_, tick);
    if (refused && !control.refused && tick.now - control.last_refusal_report >= kReportInterval) {
      control.last_refusal_report = tick.now;
      supervisor_.report({EventCode::kModuleRefused, Severity::kWarning, static_cast<std::int16_t>(current_),
                          0, 0, tick.now});
    }
    control.refused = refused;
  }
  for (std::size_t module = 0; module < controls_.size(); ++module) {
    if (!sent_[module]) continue;
    auto& message = messages_[module];
    message.client = from.client;
    message.session = from.session;
    message.priority = from.priority;
    message.module = static_cast<std::uint16_t>(module);
    message.received = tick.now;
    message.deadline = tick.now + validity_;
    take(message, said_, tick);
  }
}

Lease::Holder ModuleRunner::sender() const noexcept {
  const auto& entry = robot_.modules()[current_];
  return {link::Name{entry.name}, kModuleSession, entry.priority};
}

const MotorFeedback& ModuleRunner::feedback(std::size_t motor) const noexcept {
  return robot_.motors()[motor].motor->feedback();
}

MotorStatus ModuleRunner::status(std::size_t motor) const noexcept { return supervisor_.status(motor); }

bool ModuleRunner::obeys(std::size_t motor) const noexcept {
  return supervisor_.wouldObey(motor, sender(), said_, tick_);
}

void ModuleRunner::setTarget(std::size_t motor, const Target& target) noexcept {
  // A second target for the same motor replaces the first.
  if (commanded_.test(motor)) {
    const auto used = command_.setpoints.begin() + static_cast<std::ptrdiff_t>(command_.count);
    std::find_if(command_.setpoints.begin(), used, [motor](const auto& s) {
      return s.motor == motor;
    })->target = target;
    return;
  }
  commanded_.set(motor);
  command_.setpoints[command_.count++] = {.motor = static_cast<std::uint16_t>(motor), .target = target};
}

Order ModuleRunner::orderOf(RobotRequest request) const noexcept {
  Order order;
  order.operation = operationOf(request);
  order.client = sender().client;
  if (request == RobotRequest::kDisableUnasked) order.asked = Asked::kUnasked;
  return order;
}

void ModuleRunner::ask(RobotRequest request, std::size_t motor, double angle_deg) noexcept {
  if (request == RobotRequest::kEstop) return askAll(request);
  Order order = orderOf(request);
  order.motors.set(motor);
  order.value = angle_deg;
  supervisor_.takeModuleOrder(order, tick_);
}

void ModuleRunner::ask(RobotRequest request, std::span<const std::size_t> motors) noexcept {
  Order order = orderOf(request);
  for (const auto motor : motors) order.motors.set(motor);
  supervisor_.takeModuleOrder(order, tick_);
}

void ModuleRunner::askAll(RobotRequest request) noexcept {
  Order order = orderOf(request);
  for (std::size_t motor = 0; motor < motorCount(); ++motor) order.motors.set(motor);
  order.whole_robot = true;
  supervisor_.takeModuleOrder(order, tick_);
}

double ModuleRunner::read(SignalPlace output) const noexcept {
  return robot_.modules()[output.module].module->outputs()[output.signal];
}

void ModuleRunner::send(SignalPlace input, double value) noexcept {
  auto& message = messages_[input.module];
  if (!sent_[input.module]) message.values.fill(kNoSignal);
  sent_[input.module] = true;
  message.values[input.signal] = value;
}

void ModuleRunner::report(std::size_t event) noexcept {
  const auto& events = robot_.modules()[current_].module->signals().events;
  const auto severity = events[event].expected ? Severity::kInfo : Severity::kWarning;
  supervisor_.report({EventCode::kModule, severity, static_cast<std::int16_t>(current_),
                      static_cast<std::int32_t>(event), 0, tick_.now});
}

void ModuleRunner::fillSnapshot(Snapshot& snapshot) const noexcept {
  snapshot.refused_signals = refused_signals_;
  snapshot.module_count = controls_.size();
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    auto& out = snapshot.modules[i];
    out.owner = controls_[i].lease.client();
    out.inputs_received = controls_[i].lease.received();
    const auto outputs = robot_.modules()[i].module->outputs();
    std::copy(outputs.begin(), outputs.end(), out.outputs.begin());
  }
}

}  // namespace rc10
