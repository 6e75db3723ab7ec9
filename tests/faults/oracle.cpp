#include "faults/oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "link/words.hpp"

namespace rc10::test {
namespace {

using namespace std::chrono_literals;

// A stop lets fallbacks act for so long (docs/safety.md), then rests, and ends at the latest after so many
// ticks of rest.
constexpr Duration kLongestFallback = 1s;
constexpr std::uint64_t kMostRestTicks = 50;
// Requests are answered at the latest after so many ticks: an enable request waits two seconds for the
// drives.
constexpr std::uint64_t kLongestAnswerTicks = 2'100;
// So many ticks without an echo are a stall, and a stalled bus is probed so often (docs/can-setup.md).
constexpr std::uint64_t kStalledTicks = 5;
constexpr Duration kProbeInterval = 50ms;
[[nodiscard]] std::string describe(const Told& told) {
  return fmt::format(
      "{}: effort {:.3f}, sum {:.3f}, {:.2f} rpm, {:.2f} deg ahead, {}{}at most {:.3f} and {:.1f} rpm",
      wordOf(told.law), told.effort, told.sum, told.velocity_rpm, told.ahead_deg, told.stiff ? "stiff, " : "",
      told.damped ? "damped, " : "", told.most_effort, told.most_rpm);
}

[[nodiscard]] bool lost(MotorStatus status) {
  return status == MotorStatus::kOffline || status == MotorStatus::kFault;
}

}  // namespace

Oracle::Oracle(const RobotConfig& config) : config_(config) {
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    for (const auto& entry : config_.buses[bus].motors) {
      const auto traits = entry.traits();
      Motor motor;
      motor.config = &entry;
      motor.bus = bus;
      motor.wire = makeWire(entry);
      motor.strangers_wire = makeWire(entry);
      motor.told = motor.wire->told();
      motor.limit = static_cast<double>(entry.settings.effort_limit > 0.0F ? entry.settings.effort_limit
                                                                           : traits.effort_full_scale);
      motor.host_holds = traits.frames.hold == Provision::kHostLoop;
      motor.host_brakes = traits.frames.brake == Provision::kHostLoop;
      motor.visits = &visits_.motors[fmt::format("{} {}", entry.family->name(), entry.name())];
      motors_.push_back(std::move(motor));
    }
  }
  for (const auto& entry : config_.groups) {
    Group group;
    group.rearms = entry.on_return == GroupConfig::Return::kRearmAtRest;
    group.together = entry.together;
    for (const auto member : entry.motors) {
      group.members.set(member);
      group.required.set(member, !motors_[member].config->optional);
      motors_[member].group = groups_.size();
    }
    groups_.push_back(group);
  }
}

namespace {

// Modules ask anew in each tick, and what they ask for is valid for so long.
constexpr Duration kModuleValidity = 20ms;

[[nodiscard]] bool isModule(const RobotConfig& config, std::string_view name) {
  return std::any_of(config.modules.begin(), config.modules.end(),
                     [name](const ModuleConfig& module) { return module.settings.name == name; });
}

}  // namespace

void Oracle::fail(const std::string& what) const { throw Violation(fmt::format("tick {}: {}", tick_, what)); }

void Oracle::fail(std::size_t motor, const std::string& what) const {
  using Ms = std::chrono::duration<double, std::milli>;
  const auto& known = motors_[motor];
  std::string frames;
  for (auto i = known.last_count - std::min(known.last_count, known.last.size()); i < known.last_count; ++i) {
    const auto& [tick, frame] = known.last[i % known.last.size()];
    frames += fmt::format("\n  in tick {}: {},", tick, rc10::describe(frame.id));
    for (const auto byte : frame.payload()) frames += fmt::format(" {:02X}", byte);
  }
  throw Violation(fmt::format(
      "tick {}, motor {} ({}, {}): {}; told {}, of {:.3f}; {:.1f} rpm, {:.0f} C, feedback {:.1f} ms old, may "
      "do {} "
      "for {:.1f} ms, driven for {:.1f} ms more{}",
      tick_, known.config->name(), known.config->settings.model, toString(known.status), what,
      describe(known.told), known.limit, known.wire->measured().velocity_rpm,
      known.wire->measured().temperature_c, Ms(now_ - known.reported_at).count(), known.actions.to_string(),
      Ms(now_ - known.acts_since).count(), Ms(known.driven_until - now_).count(), frames));
}

// The drive's report, if this is one of its frames.
void Oracle::heard(std::size_t bus, const CanFrame& frame) {
  for (auto& motor : motors_) {
    if (motor.bus != bus || !motor.wire->heard(frame)) continue;
    motor.heard = true;
    motor.heard_at = frame.received;
    motor.new_sample = motor.wire->samplesAlways();
  }
}

// Of drives that are told something once a tick every frame is a command; in others there are questions, too.
void Oracle::foreign(std::size_t bus, const CanFrame& frame) {
  std::vector<Motor*> readers;
  bool command = false;
  for (auto& motor : motors_) {
    if (motor.bus != bus) continue;
    bool read = true;
    bool moves = false;
    try {
      read = motor.strangers_wire->said(frame) != 0;
      moves = read && frame.type == FrameType::kData && !motor.strangers_wire->told().rests();
      read |= motor.wire->obeys(frame);
    } catch (const Violation&) {  // forbidden to rc10d, not to others
    }
    if (!read) continue;
    motor.perhaps_foreign.push_back(frame.received);
    readers.push_back(&motor);
    command |= moves && motor.wire->toldOnceATick();
  }
  for (auto* motor : readers)
    if (command && !saidLately(*motor, frame)) motor->foreign.push_back(frame.received);
}

// A frame of ours that comes twice may be the wire's doing.
bool Oracle::saidLately(const Motor& motor, const CanFrame& frame) {
  const auto said = std::span{motor.last}.first(std::min(motor.last_count, motor.last.size()));
  return std::any_of(said.begin(), said.end(), [&frame](const auto& before) {
    const auto ours = before.second.payload();
    return before.second.id == frame.id &&
           std::equal(ours.begin(), ours.end(), frame.payload().begin(), frame.payload().end());
  });
}

void Oracle::commanded(const Command& command) {
  for (std::size_t i = 0; i < command.count; ++i) {
    auto& motor = motors_[command.setpoints[i].motor];
    motor.owned_until = std::max(motor.owned_until, command.deadline);
    if (command.setpoints[i].target.mode == ControlMode::kCoast) {
      motor.coast_asked = true;
    } else {
      motor.driven_until = std::max(motor.driven_until, command.deadline);
    }
  }
}

void Oracle::ordered(const Order& order) {
  unanswered_[order.id] = tick_;
  if (order.operation == Operation::kEstop) estop_asked_ = true;
  if (order.operation == Operation::kClear && order.whole_robot) clear_all_asked_ = true;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    if (!order.motors.test(i)) continue;
    auto& motor = motors_[i];
    if (order.operation == Operation::kEnableAlone) motor.alone_asked = !motor.enable_asked;
    if (order.operation == Operation::kEnable) motor.alone_asked = false;
    if (order.operation == Operation::kEnable || order.operation == Operation::kEnableAlone)
      motor.enable_asked = true;
    if (order.operation == Operation::kClear) motor.clear_asked = true;
    if (order.operation != Operation::kDisable) continue;
    ++motor.disables_asked;
  }
}

void Oracle::answered(const OrderResult& result) {
  if (unanswered_.erase(result.id) == 0) fail(fmt::format("order {} was answered twice", result.id));
}

void Oracle::sent(std::size_t bus, const CanFrame& frame) {
  std::uint64_t read = 0;
  for (auto& motor : motors_) {
    if (motor.bus != bus) continue;
    const bool deaf =
        deaf_ == static_cast<std::size_t>(&motor - motors_.data()) && !motor.wire->told().rests();
    const auto bytes = deaf ? ~std::uint64_t{0} : motor.wire->said(frame);
    if (bytes == 0) continue;
    read |= bytes;
    ++motor.frames;
    motor.last[motor.last_count++ % motor.last.size()] = {tick_ + 1, frame};
    motor.told = motor.wire->told();
  }
  if (read == 0) fail(fmt::format("a frame that nobody should send: {}", describe(frame.id)));
  for (std::size_t i = 0; i < frame.length; ++i) {
    if ((read >> i & 1U) == 0 && frame.data[i] != 0) fail("a byte that belongs to nobody is not zero");
  }
}

bool Oracle::fresh(const Motor& motor) const {
  return !held_.test(motor.bus) && motor.reported &&
         now_ - motor.reported_at <= motor.config->feedback_timeout;
}

// By the clock, and by ticks that ran: after a pause what came meanwhile has not been read.
bool Oracle::overdue(const Motor& motor) const {
  if (fresh(motor)) return false;
  const auto patience_ticks =
      static_cast<std::uint64_t>(motor.config->feedback_timeout / 2 / config_.period());
  return held_.test(motor.bus) || !motor.reported || motor.unheard_ticks > patience_ticks;
}

// A module that has a motor has commanded it in this tick, or a few before; it may let go of it at any time.
void Oracle::followModules(const Snapshot& snapshot) {
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    auto& motor = motors_[i];
    const bool owned = isModule(config_, snapshot.motors[i].owner.view());
    if (owned) {
      motor.driven_until = std::max(motor.driven_until, now_ + kModuleValidity);
      motor.owned_until = std::max(motor.owned_until, now_ + kModuleValidity);
      ++visits_.by_modules;
    }
    motor.coast_asked |= owned || motor.of_module;
    motor.of_module = owned;
  }
}

// A sample is a frame that could be one, and was one to rc10d: some motors wait for more before they
// believe an angle.
void Oracle::followFeedback(const Snapshot& snapshot) {
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    auto& motor = motors_[i];
    const auto& feedback = snapshot.motors[i].feedback;
    if (motor.wire->samplesAlways()) {
      motor.reported = motor.heard;
      motor.reported_at = motor.heard_at;
    } else {
      require(i, feedback.samples == 0 || motor.heard, "feedback from nowhere");
      require(i, feedback.samples == 0 || feedback.received <= motor.heard_at, "feedback of another time");
      motor.reported = feedback.samples > 0;
      motor.reported_at = feedback.received;
      motor.new_sample = feedback.samples != motor.samples;
    }
    motor.samples = feedback.samples;
    // A sample that is old on arrival is no evidence of the present.
    const bool heard = motor.new_sample && now_ - motor.reported_at <= motor.config->feedback_timeout / 2;
    motor.unheard_ticks = heard ? 0 : motor.unheard_ticks + 1;
    if (!fresh(motor) && !overdue(motor)) ++visits_.unread_after_pauses;
  }
}

Oracle::Actions Oracle::only(FallbackAction action) { return Actions{1ULL << static_cast<unsigned>(action)}; }

void Oracle::setActions(Motor& motor, Actions actions) {
  motor.actions = actions;
  motor.acts_since = now_;
  motor.rpm_when_it_began = motor.wire->measured().velocity_rpm;
  motor.acts_since_tick = tick_;
  motor.unbraked_ticks = 0;
  motor.ends_at_standstill = false;
}

void Oracle::judge(const Snapshot& snapshot, std::uint64_t periods, std::bitset<kMaxBuses> read,
                   bool stopped) {
  now_ = snapshot.time;
  periods_ = periods;
  for (auto& motor : motors_) motor.told = motor.wire->told();  // a drive may have switched itself off
  followModules(snapshot);
  followFeedback(snapshot);
  judgeSnapshot(snapshot, periods);
  judgeFrames(read);
  judgeRobotState(snapshot);
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    judgeStatus(i, snapshot.motors[i], snapshot.state);
    judgeForeign(i, snapshot.motors[i]);
    judgeRest(i, snapshot.motors[i]);
  }
  judgeAlone(snapshot);
  judgeGroups(snapshot);
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    followActions(i, snapshot.motors[i]);
    motors_[i].status = snapshot.motors[i].status;
    if (snapshot.motors[i].fault != motors_[i].fault)
      ++visits_.faults[static_cast<std::size_t>(snapshot.motors[i].fault)];
    motors_[i].fault = snapshot.motors[i].fault;
    motors_[i].mode = snapshot.motors[i].target.mode;
    const bool seen = read.test(motors_[i].bus) && !held_.test(motors_[i].bus);
    motors_[i].carried_ticks = seen ? motors_[i].carried_ticks + 1 : 0;
    motors_[i].lost_ticks = lost(snapshot.motors[i].status) ? motors_[i].lost_ticks + 1 : 0;
    if (seen) judgeCommand(i, snapshot.motors[i]);
    if (!seen) motors_[i].followed_effort = false;
  }
  state_ = snapshot.state;
  judgeStop(read & ~held_, stopped);
  judgeAnswers();
  count(snapshot);
  for (auto& motor : motors_) {
    motor.coast_asked = motor.enable_asked = motor.alone_asked = motor.clear_asked = false;
    motor.new_sample = false;
    motor.disables_asked = 0;
    motor.frames = 0;
  }
  estop_asked_ = clear_all_asked_ = false;
  off_ &= ~(known_down_ & ~down_);  // a controller that was brought up is not bus-off
  followEchoes(snapshot);
  known_down_ = down_;
  held_ = known_down_ | off_ | stalled_;
}

// A bus whose frames are not echoed is stalled: after so many ticks, until an echo comes or it was taken
// down.
void Oracle::followEchoes(const Snapshot& snapshot) {
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    auto& echoes = echoes_[bus];
    if (echoed_.test(bus) || down_.test(bus) || off_.test(bus)) {
      echoes = {};
      stalled_.reset(bus);
    } else if (!echoes.awaited) {
      echoes.awaited = watched_.test(bus) && !held_.test(bus);  // what was held back has none
    } else if (++echoes.ticks == kStalledTicks) {
      stalled_.set(bus);
      echoes.next_probe = now_ + kProbeInterval;
      ++visits_.stalls;
    }
    const bool told = snapshot.buses[bus].state == BusState::kStalled;
    if (told != stalled_.test(bus)) {
      fail(fmt::format("bus {} is told to be {}, {} ticks after the last echo", config_.buses[bus].name,
                       toString(snapshot.buses[bus].state), echoes.ticks));
    }
  }
  echoed_.reset();
  watched_.reset();
}

void Oracle::judgeSnapshot(const Snapshot& snapshot, std::uint64_t periods) {
  if (begun_ && snapshot.tick != tick_ + 1) fail("the ticks are not counted one by one");
  begun_ = true;
  tick_ = snapshot.tick;
  missed_ += periods - 1;
  if (snapshot.missed_ticks != missed_) fail("missed ticks are not counted");
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const auto& seen = snapshot.motors[i];
    const auto& feedback = seen.feedback;
    const auto& motor = motors_[i];
    require(i, std::isfinite(seen.command_value) && std::isfinite(seen.target.value), "not a number");
    require(i, (feedback.samples > 0) == motor.reported, "feedback from nowhere, or none");
    require(i, (seen.status == MotorStatus::kFault) == (seen.fault != FaultCode::kNone),
            "a fault without its reason, or a reason without the fault");
    if (!motor.reported) continue;
    require(i, feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F, "an angle beyond the circle");
    require(i, std::isfinite(feedback.total_angle_deg), "no reading");
    require(i, feedback.received == motor.reported_at, "another time than received");
    const double off_rpm =
        std::fabs(static_cast<double>(feedback.velocity_rpm) - motor.wire->measured().velocity_rpm);
    const bool told = motor.wire->samplesAlways() || std::isfinite(feedback.velocity_rpm);
    const bool compared = told && feedback.received == motor.heard_at;
    // A shaft that a load spins up is told in float: so many rpm that 0.01 is below its resolution.
    const double rounded_rpm = std::fabs(motor.wire->measured().velocity_rpm) *
                               static_cast<double>(std::numeric_limits<float>::epsilon());
    require(i, !compared || off_rpm <= 0.01 + rounded_rpm + motor.wire->measured().velocity_step_rpm,
            "another speed than reported");
  }
}

// It turned when it was last heard, and that is not long ago.
bool Oracle::mayTurn(std::size_t index, const MotorFeedback& feedback) const {
  const auto& config = *motors_[index].config;
  return feedback.samples > 0 && std::fabs(feedback.velocity_rpm) >= config.standstill_rpm &&
         now_ - feedback.received < config.run_down;
}

void Oracle::judgeRobotState(const Snapshot& snapshot) {
  if (stop_asked_ && snapshot.state != RobotStatus::kStopping) fail("it does not stop");
  if (estop_asked_ && snapshot.state == RobotStatus::kRun) fail("an e-stop was lost");
  const bool released = state_ == RobotStatus::kEstop && snapshot.state == RobotStatus::kRun;
  if (released && !clear_all_asked_) fail("an e-stop ended by itself");
  if (contact_open_ && snapshot.state == RobotStatus::kRun) fail("it runs although the e-stop input is open");
  if (!released) return;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const auto most_rpm = static_cast<double>(motors_[i].config->standstill_rpm);
    const auto& measured = motors_[i].wire->measured();
    require(i,
            overdue(motors_[i]) || std::fabs(measured.velocity_rpm) <= most_rpm + measured.velocity_step_rpm,
            "an e-stop was cleared while it turns");
    require(i, !overdue(motors_[i]) || !mayTurn(i, snapshot.motors[i].feedback),
            "an e-stop was cleared while it may still turn");
  }
}

void Oracle::judgeFrames(std::bitset<kMaxBuses> read) {
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    const bool carries = !known_down_.test(bus) && !off_.test(bus);
    const bool probed = carries && stalled_.test(bus) && now_ >= echoes_[bus].next_probe;
    if (probed) echoes_[bus].next_probe = now_ + kProbeInterval;
    const bool rests = held_.test(bus) && stop_asked_;  // even there, as well as it can
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      const auto& motor = motors_[i];
      if (motor.bus != bus || !read.test(bus) || rests) continue;
      if (held_.test(bus) && !probed) require(i, motor.frames == 0, "frames on a bus that carries none");
      if (!motor.wire->toldOnceATick()) continue;
      require(i, motor.frames == (held_.test(bus) && !probed ? 0 : 1), "not one frame in a tick");
    }
    if (probed && read.test(bus) && !stop_asked_) judgeProbe(bus);
  }
}

void Oracle::judgeProbe(std::size_t bus) {
  ++visits_.probes;
  for (std::size_t i = 0; i < motors_.size(); ++i)
    require(i, motors_[i].bus != bus || motors_[i].told.rests(),
            "a stalled bus is probed with something else than rest");
}

void Oracle::judgeStatus(std::size_t index, const MotorSnapshot& seen, RobotStatus robot) {
  const auto& motor = motors_[index];
  const auto before = motor.status;
  const auto after = seen.status;
  require(index, !overdue(motor) || lost(after), "stale feedback, and neither OFFLINE nor FAULT");
  require(index, !fresh(motor) || after != MotorStatus::kOffline, "OFFLINE with fresh feedback");
  const bool between = !fresh(motor) && !overdue(motor);
  require(index, !between || after != MotorStatus::kOffline || lost(before),
          "OFFLINE before its feedback could be read");
  require(index, !between || before != MotorStatus::kOffline || lost(after), "back without feedback");
  if (before == MotorStatus::kFault && after != MotorStatus::kFault) {
    require(index, motor.clear_asked, "left FAULT unasked");
  }
  if (after == MotorStatus::kActive && before != MotorStatus::kActive) {
    require(index, before == MotorStatus::kEnabling, "ACTIVE without enabling");
  }
  if (after == MotorStatus::kEnabling && before != MotorStatus::kEnabling && !motor.enable_asked) {
    const bool rearms = motor.group != kNoGroup && groups_[motor.group].may_rearm.test(index);
    require(index, rearms, "enabled itself");
  }
  if (now_ >= motor.owned_until) require(index, seen.owner.view().empty(), "owned by a client that is gone");
  if (after == MotorStatus::kActive || after == MotorStatus::kEnabling)
    require(index, robot == RobotStatus::kRun, "enabled although the robot is stopped");
  if (seen.target.mode != ControlMode::kCoast) {
    require(index, after == MotorStatus::kActive, "a target although it is not ACTIVE");
    require(index, now_ < motor.driven_until, "a target without a valid command");
  }
}

// Three within the time end ACTIVE, READY and ENABLING, and fewer do not.
void Oracle::judgeForeign(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& limit = config_.buses[motor.bus].foreign;
  const auto enough = [&limit](const std::deque<MonotonicTime>& times) {
    const auto frames = static_cast<std::size_t>(limit.frames);
    for (std::size_t i = frames - 1; i < times.size(); ++i)
      if (times[i] - times[i - frames + 1] <= limit.within) return true;
    return false;
  };
  const bool newly = seen.fault == FaultCode::kForeignCommands && motor.fault != seen.fault;
  require(index, !newly || enough(motor.perhaps_foreign), "in FAULT for commands that nobody has sent");
  const bool there = !lost(motor.status) && seen.status != MotorStatus::kOffline;
  require(index, !there || !enough(motor.foreign) || seen.status == MotorStatus::kFault,
          "somebody else commands its drive, and it is not in FAULT");
  const auto forget = [&](std::deque<MonotonicTime>& times) {
    while (!times.empty() && now_ - times.front() > limit.within) times.pop_front();
  };
  forget(motor.perhaps_foreign);
  forget(motor.foreign);
  if (lost(seen.status)) motor.foreign.clear();  // what it was told meanwhile counts, or not
}

// Reports of its drive while nothing is asked of it, against the thresholds of the configuration.
void Oracle::judgeRest(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& rest = motor.config->rest;
  const auto& feedback = seen.feedback;
  const bool rested =
      std::exchange(motor.rests, seen.acting == Acting::kNothing && seen.status != MotorStatus::kEnabling &&
                                     (motor.wire->idlesAtRest() || seen.status != MotorStatus::kActive)) &&
      fresh(motor);
  const bool newly = seen.fault == FaultCode::kNotAtRest && motor.fault != seen.fault;
  double sign = 0.0;
  if (rested && std::fabs(feedback.current_a) > rest.current_a && rest.current_a > 0.0F) {
    const bool stands = std::fabs(feedback.velocity_rpm) < motor.config->standstill_rpm;
    if (stands || feedback.current_a * feedback.velocity_rpm > 0.0F)
      sign = std::copysign(1.0, static_cast<double>(feedback.current_a));
  }
  if (sign != motor.torque_sign) {
    motor.torque_sign = sign;
    motor.torque_since = motor.torque_counts_since = feedback.received;
    motor.torque_samples = 0;
  }
  if (motor.new_sample && sign != 0.0) ++motor.torque_samples;
  // A clear forgives what was before it.
  if (motor.clear_asked) motor.torque_counts_since = feedback.received;
  const auto lasting = feedback.received - motor.torque_since;
  // The first sample may have come with the order.
  const auto slack = motor.config->feedback_timeout / 2 + 2 * config_.period();
  require(index, !newly || (sign != 0.0 && lasting >= rest.time - slack),
          "in FAULT for torque at rest that it does not report");
  const auto counts = feedback.received - motor.torque_counts_since;
  const bool proven = sign != 0.0 && motor.torque_samples > 4 && counts > rest.time + slack;
  require(index, !proven || !fresh(motor) || lost(seen.status),
          "its drive reports torque at rest, and it is not in FAULT");
}

// As long as a motor that was enabled alone is ENABLING or ACTIVE, no other is.
void Oracle::judgeAlone(const Snapshot& snapshot) {
  const bool stopped = estop_asked_ || stop_asked_;
  was_alone_ = alone_.has_value();
  // It may have ended within the tick, and begun anew as one of many.
  if (alone_ && (stopped || motors_[*alone_].disables_asked > 0)) alone_.reset();
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const auto& motor = motors_[i];
    const bool rearms = motor.group != kNoGroup && groups_[motor.group].may_rearm.test(i);
    const bool begun = !isOn(motor.status) && isOn(snapshot.motors[i].status);
    if (begun && motor.alone_asked && !rearms) alone_ = i;
  }
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    auto& motor = motors_[i];
    motor.perhaps_alone = (motor.perhaps_alone || motor.alone_asked) && isOn(snapshot.motors[i].status);
  }
  if (alone_ && !isOn(snapshot.motors[*alone_].status)) alone_.reset();
  if (!alone_) return;
  was_alone_ = true;
  ++visits_.alone;
  for (std::size_t i = 0; i < motors_.size(); ++i)
    require(i, i == *alone_ || !isOn(snapshot.motors[i].status),
            "enabled beside a motor that is enabled alone");
}

// All or none: while a required member is missing, and in the tick in which one leaves, none is on. A motor
// that is enabled alone needs no group.
void Oracle::judgeGroups(const Snapshot& snapshot) {
  for (auto& group : groups_) {
    bool missing = false;
    bool newly_lost = false;
    bool refused = false;
    bool leaves = false;
    bool disable_asked = false;
    bool faulted = false;
    group.stops_now = group.disabled_now = false;
    MotorSet active;
    MotorSet enabling;  // it may have become ACTIVE within the tick
    MotorSet rearmed;
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      if (!group.members.test(i)) continue;
      const auto& motor = motors_[i];
      const auto before = motor.status;
      const auto after = snapshot.motors[i].status;
      if (before == MotorStatus::kActive) active.set(i);
      if (before == MotorStatus::kEnabling) enabling.set(i);
      disable_asked |= motor.disables_asked > 0;
      if (after == MotorStatus::kEnabling && !motor.enable_asked && before != MotorStatus::kEnabling)
        rearmed.set(i);
      if (!group.required.test(i)) continue;
      missing |= lost(after);
      faulted |= after == MotorStatus::kFault;
      newly_lost |= lost(after) && !lost(before);
      refused |= before == MotorStatus::kEnabling && !isOn(after) && motor.disables_asked == 0;
      leaves |= isOn(before) && (!isOn(after) || motor.disables_asked > 0);
      group.disabled_now |= motor.disables_asked > 0 && (isOn(before) || motor.enable_asked);
    }
    bool alone = alone_ && group.members.test(*alone_);
    for (std::size_t i = 0; i < motors_.size(); ++i)
      alone |= group.members.test(i) && motors_[i].perhaps_alone;
    group.stops_now = newly_lost || refused;
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      if (!group.members.test(i) || alone || !isOn(snapshot.motors[i].status)) continue;
      require(i, !missing, "enabled although a motor of its group is missing");
      require(i, !leaves || was_alone_, "enabled although its group has stopped");
    }
    if (group.together && !alone) judgeTogether(group, snapshot);
    if (rearmed.any()) {
      for (std::size_t i = 0; i < motors_.size(); ++i) {
        const bool left_out = group.must_rearm.test(i) && snapshot.motors[i].status == MotorStatus::kReady;
        require(i, !left_out, "its group was enabled again without it");
      }
      group.may_rearm.reset();
      ++visits_.rearmed;
    }
    if (newly_lost && group.rearms && (active | enabling).any()) {
      group.may_rearm = active | enabling | (active.any() ? MotorSet{} : group.may_rearm);
      group.must_rearm = active;
    }
    if (faulted || disable_asked || was_alone_ || estop_asked_ || snapshot.state != RobotStatus::kRun)
      group.may_rearm.reset();
  }
}

void Oracle::judgeTogether(const Group& group, const Snapshot& snapshot) {
  bool whole = true;
  bool asked = true;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    if (!group.required.test(i)) continue;
    whole = whole && snapshot.motors[i].status == MotorStatus::kActive;
    asked = asked && (motors_[i].enable_asked || isOn(motors_[i].status) || group.may_rearm.test(i));
  }
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    if (!group.members.test(i)) continue;
    require(i, whole || snapshot.motors[i].target.mode == ControlMode::kCoast,
            "a target although its group is not enabled as a whole");
    const bool begun = !isOn(motors_[i].status) && isOn(snapshot.motors[i].status);
    require(i, asked || !begun, "enabled without its group");
  }
}

// Permitted action of a motor without a target, from now on.
void Oracle::followActions(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& fallback = motor.config->fallback;
  const auto coast = only(FallbackAction::kCoast);
  const auto before = motor.status;
  const auto after = seen.status;
  if (lost(after) || lost(before)) return setActions(motor, coast);
  if (seen.target.mode != ControlMode::kCoast) return setActions(motor, only(fallback.on_timeout));
  if (before == MotorStatus::kActive && after != MotorStatus::kActive) {
    Actions actions;
    const bool with_group = motor.group != kNoGroup && groups_[motor.group].disabled_now;
    const bool asked = motor.disables_asked > 0 || stop_asked_ || with_group;
    motor.rests_with_group = with_group && (motor.disables_asked == 0 || motor.enable_asked);
    if (asked) actions |= only(fallback.on_disable);
    if (motor.disables_asked > 1 || (motor.disables_asked > 0 && estop_asked_)) actions |= coast;
    if (estop_asked_ || (motor.group != kNoGroup && groups_[motor.group].stops_now))
      actions |= only(fallback.on_estop);
    require(index, actions.any(), "no longer ACTIVE for no reason");
    setActions(motor, actions);
    motor.ends_at_standstill = asked;
    return;
  }
  // Enabled and stopped within a tick.
  const bool stopped_with_group =
      motor.group != kNoGroup && (groups_[motor.group].stops_now || groups_[motor.group].disabled_now);
  if (before == MotorStatus::kEnabling && stopped_with_group) {
    setActions(motor, motor.actions | only(fallback.on_estop) | only(fallback.on_disable));
    motor.ends_at_standstill = true;
    motor.rests_with_group = groups_[motor.group].disabled_now && motor.disables_asked == 0;
  }
  if (motor.mode != ControlMode::kCoast) {  // its target has just gone
    auto actions = only(fallback.on_timeout);
    if (motor.coast_asked) actions |= coast;
    return setActions(motor, actions);
  }
  if (motor.coast_asked || motor.disables_asked > 0) motor.actions |= coast;
  // A target that came and went within the tick cannot be; one that was taken back by COAST can.
  if (after == MotorStatus::kReady && motor.disables_asked > 0 && motor.disables_asked < 2 &&
      before == MotorStatus::kReady && !motor.enable_asked) {
    if (std::exchange(motor.rests_with_group, false)) {
      motor.actions |= coast;
    } else {
      setActions(motor, coast);
    }
  }
}

void Oracle::judgeStop(std::bitset<kMaxBuses> read, bool stopped) {
  if (!stop_asked_) return;
  if (ticks_stopping_++ == 0) stopping_since_ = now_;
  const bool over = now_ - stopping_since_ >= kLongestFallback;
  if (over) ++ticks_over_;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const auto& motor = motors_[i];
    const bool rests = motor.told.rests() || !read.test(motor.bus);
    require(i, !over || mayLag(motor, ticks_over_) || rests,
            "something else than rest after the end of the fallbacks");
    require(i, !stopped || rests, "stopped, and not at rest");
    require(i, !rested_ || rests, "something else than rest after the last rest");
  }
  if (stopped && !rested_) ++visits_.stops;
  if (stopped) rested_ = true;
  const auto most = static_cast<std::uint64_t>(kLongestFallback / config_.period()) + kMostRestTicks + 2;
  if (!stopped && ticks_stopping_ > most) fail("the stop does not end");
}

void Oracle::judgeAnswers() {
  for (const auto& [id, tick] : unanswered_) {
    if (tick_ - tick > kLongestAnswerTicks) fail(fmt::format("order {} was never answered", id));
  }
}

void Oracle::count(const Snapshot& snapshot) {
  ++visits_.ticks;
  ++visits_.robot[static_cast<std::size_t>(snapshot.state)];
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const auto& seen = snapshot.motors[i];
    const auto& motor = motors_[i];
    ++visits_.status[static_cast<std::size_t>(seen.status)];
    auto& kind = *motor.visits;
    if (seen.status == MotorStatus::kActive) ++kind.active;
    if (motor.told.rests()) continue;
    ++kind.laws[static_cast<std::size_t>(motor.told.law)];
    if (seen.target.mode != ControlMode::kCoast) ++visits_.driven;
    for (std::size_t action = 1; action < motor.actions.size(); ++action) {
      const bool acts = seen.target.mode == ControlMode::kCoast && motor.actions.test(action);
      if (acts) ++visits_.fallbacks[action];
    }
  }
}

}  // namespace rc10::test
