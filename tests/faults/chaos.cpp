#include "faults/chaos.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "faults/robots.hpp"

namespace rc10::test {
namespace {

using namespace std::chrono_literals;

constexpr std::array<std::string_view, static_cast<std::size_t>(Chaos::Action::kCount)> kNames{
    "nothing",      "command",    "program",        "enable",    "enable alone", "disable",    "clear",
    "zero",         "estop",      "repair",         "silence",   "lose",         "stall",      "heat",
    "encoder",      "load",       "freeze bus",     "block bus", "hold echoes",  "link",       "controller",
    "e-stop input", "mode input", "foreign frames", "flood bus", "fill rings",   "miss ticks", "scan",
    "modules",      "stop",       "crash"};

// Weights of the actions: what brings a robot to work more often than what stops it.
constexpr std::array<std::uint8_t, static_cast<std::size_t>(Chaos::Action::kCount)> kWeights{
    9, 24, 50, 38, 2, 4, 26, 5, 2, 36, 4, 3, 4, 3, 4, 4, 2, 2, 4, 3, 3, 3, 3, 4, 1, 1, 5, 3, 2, 1, 1};

// A home near the far soft limit of the joint, which is at 150 degrees.
constexpr double kNearHomeDeg = 135.0;

[[nodiscard]] Chaos::Action choose(Choices& choices) {
  constexpr std::uint32_t kSum = [] {
    std::uint32_t sum = 0;
    for (const auto weight : kWeights) sum += weight;
    return sum;
  }();
  static_assert(kSum <= 256);  // one byte of a fuzzer
  std::uint32_t left = choices.next(kSum);
  for (std::size_t i = 0; i < kWeights.size(); ++i) {
    if (left < kWeights[i]) return static_cast<Chaos::Action>(i);
    left -= kWeights[i];
  }
  return Chaos::Action::kNothing;
}

}  // namespace

Chaos::Chaos(Choices& choices, std::optional<Lie> lie)
    : choices_(choices), lie_(lie), starts_(choices.next(static_cast<std::uint32_t>(kRobotCount))) {
  constexpr std::array<const char*, 3> kClients{"planner", "remote", "planner"};
  for (std::size_t i = 0; i < clients_.size(); ++i) {
    clients_[i].name = kClients[i];
    clients_[i].priority = i == 1 ? 10 : 0;
    clients_[i].session = i + 1;
  }
  start();
}

// The file of the robot, as the lie has it.
RobotConfig Chaos::believed(const Lie& lie) const {
  RobotConfig config = config_;
  for (auto& module : config.modules) {
    auto& own = module.settings.own;
    const bool homes = module.type->name() == "joint";
    if (homes && lie.kind == Lie::Kind::kHoming)
      own.set("homing_velocity_rpm", 0.25 * own.number("homing_velocity_rpm"));
    const bool holds = homes || module.type->name() == "gimbal";
    if (holds && lie.kind == Lie::Kind::kSilence)
      own.set("silence_max_s", 0.25 * own.number("silence_max_s"));
    if (homes && lie.kind == Lie::Kind::kTravel) own.set("home_angle_deg", kNearHomeDeg);
  }
  auto& motor = config.buses[places_[lie.motor].first].motors[places_[lie.motor].second];
  if (lie.kind == Lie::Kind::kSoftStart) motor.shaping.soft_start_s *= 4.0F;
  if (lie.kind == Lie::Kind::kReduced) {
    motor.reduced.velocity_rpm *= 0.25F;
    motor.reduced.tolerance_rpm *= 0.25F;
  }
  if (lie.kind == Lie::Kind::kReducedEffort) motor.reduced.effort_share *= 0.25F;
  if (lie.kind == Lie::Kind::kFallback || lie.kind == Lie::Kind::kOnDisable ||
      lie.kind == Lie::Kind::kOnEstop) {
    const auto& [bus, drive] = places_[lie.motor];
    motor.fallback = robotOf(lie.robot).buses[bus].motors[drive].fallback;
  }
  if (lie.kind == Lie::Kind::kFallbackTime) {
    motor.fallback.hold_max /= 4;
    motor.fallback.brake_max /= 4;
    motor.fallback.ramp /= 4;
  }
  if (lie.kind == Lie::Kind::kSoftLimit) {
    // About its middle: with the same gap on both sides it is on the same turn.
    const double eighth_deg = (motor.shaping.angle_max_deg - motor.shaping.angle_min_deg) / 8.0;
    motor.shaping.angle_min_deg += 3.0 * eighth_deg;
    motor.shaping.angle_max_deg -= 3.0 * eighth_deg;
  }
  if (lie.kind == Lie::Kind::kFirstStep) motor.shaping.max_first_step_deg *= 0.1;
  if (lie.kind == Lie::Kind::kTurn) {
    motor.shaping.angle_min_deg += 360.0;
    motor.shaping.angle_max_deg += 360.0;
  }
  if (lie.kind == Lie::Kind::kGroup) config.groups.front().motors.push_back(lie.motor);
  if (lie.kind == Lie::Kind::kSlew) {
    motor.shaping.velocity_slew_rpm_per_s *= 0.25F;
    motor.shaping.angle_slew_deg_per_s *= 0.25F;
    motor.shaping.effort_slew_per_s *= 0.25F;
  }
  auto& settings = motor.settings;
  if (lie.kind == Lie::Kind::kEffort) {
    if (settings.effort_limit <= 0.0F) settings.effort_limit = motor.traits().effort_full_scale;
    settings.effort_limit *= 0.25F;
  }
  if (lie.kind == Lie::Kind::kSpeed) settings.velocity_limit_rpm *= 0.25F;
  // A smaller limit would make a soft start slower than it is.
  if (lie.kind == Lie::Kind::kEffort || lie.kind == Lie::Kind::kSpeed) motor.shaping.soft_start_s = 0.0F;
  return config;
}

// A new process, on drives that were just switched on: the next robot.
void Chaos::start() {
  if (oracle_) visits_.add(oracle_->visits());
  config_ = robotOf(lie_ ? lie_->robot : starts_++ % kRobotCount);
  places_.clear();
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    for (std::size_t drive = 0; drive < config_.buses[bus].motors.size(); ++drive)
      places_.emplace_back(bus, drive);
  }
  if (lie_) {
    const auto& [bus, drive] = places_[lie_->motor];
    auto& fallback = config_.buses[bus].motors[drive].fallback;
    if (lie_->kind == Lie::Kind::kFallback) fallback.on_timeout = FallbackAction::kCoast;
    if (lie_->kind == Lie::Kind::kOnDisable) fallback.on_disable = FallbackAction::kCoast;
    if (lie_->kind == Lie::Kind::kOnEstop) fallback.on_estop = FallbackAction::kCoast;
  }
  standSomewhere();
  robot_ = std::make_unique<VirtualRobot>(config_);
  robot_->freezeSimulation(true);  // stepped here, so that every frame is seen
  oracle_ = std::make_unique<Oracle>(lie_ ? believed(*lie_) : config_);
  if (lie_ && lie_->kind == Lie::Kind::kStuck) oracle_->deafen(lie_->motor);
  if (lie_ && lie_->kind == Lie::Kind::kZero) oracle_->misreadZeros(lie_->motor);
  if (lie_ && lie_->kind == Lie::Kind::kValidity) oracle_->hasten();
  if (lie_ && lie_->kind == Lie::Kind::kForeign) oracle_->suspect(lie_->motor);
  if (lie_ && lie_->kind == Lie::Kind::kHold) oracle_->misplaceHold(lie_->motor);
  wires_.clear();
  for (auto& port : robot_->robot().simPorts()) wires_.emplace_back(port->descriptor());
  frozen_.reset();
  blocked_.reset();
  behind_.reset();
  seen_count_ = 0;
  contact_open_ = mode_open_ = false;
  queues_ = {};
  echoed_.reset();
  for (auto& inbox : robot_->inboxes()) inbox.echo_reads.store(1);
  for (auto& client : clients_) client.motors.reset();
  inputs_.assign(config_.modules.size(), {});
  describe();
  desk_.emplace(description_, robot_->exchange().scan);
  scan_at_desk_ = 0;
  tick_ = 0;
}

// At power-up a shaft with limits stands anywhere.
void Chaos::standSomewhere() {
  for (const auto& [bus, drive] : places_) {
    auto& motor = config_.buses[bus].motors[drive];
    auto& load = motor.simulated;
    const bool limited =
        std::isfinite(motor.shaping.angle_min_deg) && std::isfinite(motor.shaping.angle_max_deg);
    if (!limited || !motor.traits().absolute || std::isfinite(load.stop_min_deg)) continue;
    load.initial_angle_deg = choices_.of<float>({0.0F, 0.0F, 40.0F, -80.0F, 130.0F, 178.0F, -178.0F, 240.0F});
  }
}

void Chaos::step() {
  const auto action = choose(choices_);
  ++done_[static_cast<std::size_t>(action)];
  act(action);
  if (lie_ && lie_->kind == Lie::Kind::kForeign && choices_.oneIn(4)) secondController();
  constexpr std::array<std::uint64_t, 8> kPauses{1, 1, 2, 3, 10, 30, 60, 400};
  ticks(kPauses[choices_.next(8)]);
}

void Chaos::tick(std::uint64_t periods) {
  for (const auto& client : clients_) {
    if (client.motors.any() && tick_ % client.every_ticks == 0) command(client);
  }
  sendInputs();
  judgeScan();
  showContact();
  const Duration dt = config_.period() * static_cast<std::int64_t>(periods);
  simulate(dt);
  oracle_->echoed(std::exchange(echoed_, {}));
  for (std::size_t bus = 0; bus < wires_.size(); ++bus) counters_before_[bus] = counters(bus);
  robot_->tick(periods);
  readBuses();
  robot_time_ += dt;
  ++tick_;
  OrderResult result;
  while (robot_->exchange().results.pop(result)) {
    oracle_->answered(result);
    endScan(result);
  }
  Event event;
  while (robot_->exchange().events.pop(event)) {
  }
  oracle_->judge(robot_->snapshot(), periods, ~(blocked_ | behind_), robot_->scheduler().stopped());
  behind_ &= blocked_;
}

void Chaos::ticks(std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) tick();
}

void Chaos::simulate(Duration dt) {
  const auto next = robot_->now() + dt;
  for (std::size_t bus = 0; bus < wires_.size(); ++bus) {
    const auto count = robot_->simBus(bus).step(next, dt, feedback_);
    if (frozen_.test(bus)) continue;
    for (std::size_t i = 0; i < count; ++i) {
      feedback_[i].received = next - config_.period() / 2;
      deliver(bus, feedback_[i]);
    }
  }
}

void Chaos::deliver(std::size_t bus, CanFrame frame) {
  if (robot_->inboxes()[bus].frames.push(frame)) oracle_->heard(bus, frame);
}

// Frames of the daemon on each bus in this tick.
void Chaos::readBuses() {
  const WakeUp wake{
      .now = robot_->now(), .previous = robot_->now(), .realtime_offset = {}, .previous_offset = {}};
  for (std::size_t bus = 0; bus < wires_.size(); ++bus) {
    const auto& before = counters_before_[bus];
    if (counters(bus).tx_frames != before.tx_frames) oracle_->taken(bus);
    if (counters(bus).tx_watched_refused != before.tx_watched_refused) oracle_->refused(bus);
    if (blocked_.test(bus)) {
      behind_.set(bus);
      if (counters(bus).tx_watched != counters_before_[bus].tx_watched) oracle_->watched(bus);
      continue;
    }
    std::size_t count = 0;
    do {
      count = wires_[bus].receive(wake, batch_).frame_count;
      for (std::size_t i = 0; i < count; ++i) {
        oracle_->sent(bus, batch_[i]);
        seen_[seen_count_++ % seen_.size()] = {bus, batch_[i]};
        if (isWatched(bus, batch_[i])) oracle_->watched(bus);
        carry(bus, batch_[i]);
      }
    } while (count == batch_.size());
    auto& queue = queues_[bus];
    if (queue.stuck_ticks > 0 && --queue.stuck_ticks == 0) leaveQueue(bus);
  }
}

const BusCounters& Chaos::counters(std::size_t bus) const {
  return robot_->robot().buses()[bus].bus->counters();
}

bool Chaos::isWatched(std::size_t bus, const CanFrame& frame) const {
  const auto& watched = robot_->robot().buses()[bus].watched;
  return std::find(watched.begin(), watched.end(), frame.id) != watched.end();
}

// From the kernel, which has taken it, to the drives; its echo, if it is watched, back to the daemon.
void Chaos::carry(std::size_t bus, const CanFrame& frame) {
  auto& queue = queues_[bus];
  const bool stuck = queue.stuck_ticks > 0;
  if (stuck && !queue.on_wire) {
    queue.frames.push_back(frame);
    return;
  }
  robot_->simBus(bus).receive(frame);
  if (stuck) return;
  if (!isWatched(bus, frame)) return;
  robot_->inboxes()[bus].confirmed.fetch_add(1);
  echoed_.set(bus);
}

// Waiting frames leave before new ones. Echoes that nobody heard stay lost.
void Chaos::leaveQueue(std::size_t bus) {
  auto& queue = queues_[bus];
  queue.stuck_ticks = 0;
  const auto frames = std::exchange(queue.frames, {});
  for (const auto& frame : frames) carry(bus, frame);
}

void Chaos::holdEchoes(std::size_t bus, std::uint64_t ticks, bool on_wire) {
  leaveQueue(bus);
  queues_[bus].stuck_ticks = ticks;
  queues_[bus].on_wire = on_wire;
}

void Chaos::note(Action action, MotorSet motors, double value) {
  history_[noted_++ % history_.size()] = {tick_, action, motors.to_ullong(), value};
}

std::string Chaos::history() const {
  std::string out;
  const auto first = noted_ > history_.size() ? noted_ - history_.size() : 0;
  for (auto i = first; i < noted_; ++i) {
    const auto& done = history_[i % history_.size()];
    out += fmt::format("  before tick {}: {}, motors {:08b}, value {}\n", done.tick,
                       kNames[static_cast<std::size_t>(done.action)], done.motors, done.value);
  }
  return out;
}

std::string Chaos::actionsText() const {
  std::string out = "done:";
  for (std::size_t i = 0; i < done_.size(); ++i)
    out += fmt::format("{} {} {}", i > 0 ? "," : "", kNames[i], done_[i]);
  return out + "\n";
}

Visits Chaos::visits() const {
  Visits all = visits_;
  all.add(oracle_->visits());
  return all;
}

MotorSet Chaos::someMotors() {
  const auto which = choices_.next(10);
  MotorSet motors;
  if (which < 6) {
    motors.set(choices_.next(static_cast<std::uint32_t>(places_.size())));
  } else if (which < 9) {
    motors = MotorSet{choices_.next(1U << places_.size())};
  } else {
    for (std::size_t i = 0; i < places_.size(); ++i) motors.set(i);
  }
  return motors;
}

Chaos::Client& Chaos::someClient() {
  return clients_[choices_.next(static_cast<std::uint32_t>(clients_.size()))];
}
sim::SimBus& Chaos::busOf(std::size_t motor) { return robot_->simBus(places_[motor].first); }
std::size_t Chaos::driveOf(std::size_t motor) const { return places_[motor].second; }

Target Chaos::randomTarget(std::size_t motor) {
  constexpr auto kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr auto kInfinity = std::numeric_limits<double>::infinity();
  // Mostly what works: any mode, but those of the motor more often.
  using enum ControlMode;
  Target target;
  const auto any = [this] {
    return choices_.of<ControlMode>({kVelocity, kVelocity, kVelocity, kCurrent, kCurrent, kTotalAngle, kAngle,
                                     kBrake, kCoast, kVoltage, kTotalAngle, kAngle, kDuty, kImpedance});
  };
  const auto modes = robot_->robot().motors()[motor].motor->modes();
  target.mode = any();
  for (int i = 0; i < 3 && !modes.contains(target.mode); ++i) target.mode = any();
  // A spring is often followed by another one: softer, stiffer, elsewhere.
  if (robot_->motor(motor).target.mode == kImpedance && choices_.oneIn(2)) target.mode = kImpedance;
  const auto& feedback = robot_->motor(motor).feedback;
  switch (choices_.next(8)) {
    case 0: target.value = choices_.of<double>({1e9, -1e300, kNan, kInfinity, -1e9, 1e300}); break;
    case 1: target.value = 0.0; break;
    default: target.value = static_cast<double>(choices_.next(256)) - 128.0;
  }
  if (target.mode == kCurrent || target.mode == kVoltage) target.value *= 0.1;
  if (target.mode == kVelocity) target.value *= 4.0;
  // Near the measured angle, or it is refused.
  const bool of_angle = target.mode == kTotalAngle || target.mode == kAngle || target.mode == kImpedance;
  if (of_angle && std::isfinite(feedback.total_angle_deg))
    target.value = feedback.total_angle_deg + target.value * choices_.of<double>({0.1, 0.2, 1.0, 10.0});
  if (target.mode == kDuty) target.value *= 0.01;
  if (target.mode == kImpedance) {
    target.stiffness_nm_per_rad = choices_.of<float>({0.0F, 1.0F, 20.0F, 1e30F, -1.0F});
    target.damping_nms_per_rad = choices_.of<float>({0.0F, 0.1F, 2.0F, 1e30F, -1.0F});
  }
  if (choices_.oneIn(8)) target.torque_ff_nm = choices_.of<float>({1.0F, -1.0F, 1e30F, -1e30F});
  if (choices_.oneIn(8)) target.velocity_ff_rpm = choices_.of<float>({20.0F, -20.0F, 1e30F, -1e30F});
  return target;
}

void Chaos::command(const Client& client) {
  Command command;
  command.client = client.name;
  command.session = client.session;
  command.priority = client.priority;
  command.received = command.said = robot_->now();
  command.deadline = command.received + client.validity;
  for (std::size_t motor = 0; motor < places_.size(); ++motor) {
    if (!client.motors.test(motor)) continue;
    command.setpoints[command.count++] = {static_cast<std::uint16_t>(motor), client.targets[motor]};
  }
  if (robot_->exchange().commands.push(command)) oracle_->commanded(command);
}

// Inputs of one module: none any more, or what it can do, and beyond.
void Chaos::chooseInputs() {
  auto& inputs = inputs_[choices_.next(static_cast<std::uint32_t>(inputs_.size()))];
  inputs.given = !choices_.oneIn(3);
  inputs.values.fill(kNoSignal);
  for (std::size_t i = 0; i < 4; ++i)
    inputs.values[i] = choices_.of<double>({0.0, 1.0, -1.0, 0.3, 30.0, -200.0, 1e9, kNoSignal});
}

void Chaos::sendInputs() {
  constexpr std::uint64_t kEveryTicks = 10;
  if (tick_ % kEveryTicks != 0) return;
  for (std::size_t module = 0; module < inputs_.size(); ++module) {
    if (!inputs_[module].given) continue;
    SignalMessage message;
    message.client = link::Name{"driver"};
    message.session = 9;
    message.module = static_cast<std::uint16_t>(module);
    message.received = robot_->now();
    message.deadline = robot_->now() + 50ms;
    message.values = inputs_[module].values;
    if (robot_->exchange().signals.push(message)) oracle_->signalled(message);
  }
}

void Chaos::order(Operation operation, MotorSet motors, double value) {
  if (oracle_->open() >= kMostOpen) return;
  Order order;
  order.id = ++orders_;
  order.operation = operation;
  order.motors = motors;
  order.value = value;
  order.whole_robot = motors.count() == places_.size() && !choices_.oneIn(4);
  if (robot_->exchange().orders.push(order)) oracle_->ordered(order);
}

}  // namespace rc10::test
