#include "faults/oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "link/words.hpp"

namespace rc10::test {
namespace {

using namespace std::chrono_literals;

// Ticks of rest after the fallbacks of a stop, at the most (docs/safety.md).
constexpr std::uint64_t kMostRestTicks = 50;
// Ticks until a request is answered at the latest: an enable request waits two seconds for the
// drives.
constexpr std::uint64_t kLongestAnswerTicks = 2'100;
// Ticks without an echo that are a stall, and the period of probes of a stalled bus (docs/can-setup.md).
constexpr std::uint64_t kStalledTicks = 5;
constexpr Duration kProbeInterval = 50ms;
// Share of the speed of standstill: a sample or two may be missed.
constexpr double kSlow = 1.5;
[[nodiscard]] std::string describe(const Told& told) {
  return fmt::format(
      "{}: effort {:.3f}, sum {:.3f}, {:.2f} rpm, {:.2f} deg ahead, {}{}at most {:.3f} and {:.1f} rpm",
      wordOf(told.law), told.effort, told.sum, told.velocity_rpm, told.ahead_deg, told.stiff ? "stiff, " : "",
      told.damped ? "damped, " : "", told.most_effort, told.most_rpm);
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
      motor.visits =
          &visits_.motors[fmt::format("{} {} of {}", entry.family->name(), entry.name(), config_.robot)];
      motor.visits->supported = traits.modes;
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
  for (std::size_t module = 0; module < config_.modules.size(); ++module) {
    const auto& own = config_.modules[module].settings.own;
    const bool gimbal = config_.modules[module].type->name() == "gimbal";
    const bool joint_holds =
        config_.modules[module].type->name() == "joint" && own.text("on_silence") == "hold";
    if (gimbal || joint_holds) {
      const std::chrono::duration<double> silence_s{own.number("silence_max_s")};
      Holder holder{.module = module,
                    .motors = {},
                    .silence_max = std::chrono::duration_cast<Duration>(silence_s),
                    .any_client = joint_holds};
      for (const char* const key : {"yaw", "pitch"})
        if (gimbal) holder.motors.push_back(own.motor(key));
      if (joint_holds) holder.motors.push_back(own.motor("motor"));
      holders_.push_back(holder);
    }
    if (config_.modules[module].type->name() != "joint" || own.text("homing") == "none") continue;
    Joint joint;
    joint.module = module;
    joint.motor = own.motor("motor");
    joint.velocity_rpm = std::fabs(own.number("homing_velocity_rpm"));
    joint.current_a = own.number("homing_current_a");
    const auto& shaping = motors_[joint.motor].config->shaping;
    const double far_deg =
        own.number("homing_velocity_rpm") < 0.0 ? shaping.angle_max_deg : shaping.angle_min_deg;
    joint.way_deg = std::fabs(far_deg - own.number("home_angle_deg")) + own.number("homing_away_deg") +
                    own.number("homing_tolerance_deg");
    joints_.push_back(joint);
  }
}

namespace {

// Validity of what modules ask for, anew in each tick.
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

// A frame that its drive reads may be a command; one that makes it move is.
void Oracle::foreign(std::size_t bus, const CanFrame& frame) {
  for (auto& motor : motors_) {
    if (motor.bus != bus) continue;
    bool read = true;
    try {
      read = motor.strangers_wire->said(frame) != 0 || motor.wire->obeys(frame);
    } catch (const Violation&) {  // forbidden to rc10d, not to others
    }
    const bool steered = frame.type == FrameType::kData && motor.wire->steeredBy(frame);
    if (read || steered) motor.perhaps_foreign.push_back(frame.received);
    if (steered && !saidLately(motor, frame)) motor.foreign.push_back(frame.received);
  }
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
  client_heard_ = true;
  const auto valid_for = (command.deadline - command.received) / (hasty_ ? 4 : 1);
  for (std::size_t i = 0; i < command.count; ++i) {
    auto& motor = motors_[command.setpoints[i].motor];
    motor.owned_until = std::max(motor.owned_until, command.deadline);
    motor.track.expect(command.deadline);
    motor.track.came.push_back(command.setpoints[i].target);
    if (command.setpoints[i].target.mode == ControlMode::kCoast) {
      motor.coast_asked = true;
    } else {
      motor.driven_until = std::max(motor.driven_until, command.received + valid_for);
    }
  }
}

void Oracle::ordered(const Order& order) {
  client_heard_ = true;
  unanswered_[order.id] = tick_;
  if (order.operation == Operation::kScan) scans_asked_.push_back(order);
  if (order.operation == Operation::kZero) zeros_asked_[order.id] = order;
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
    if (order.operation == Operation::kZero) motor.zero_asked = true;
    if (order.operation != Operation::kDisable) continue;
    ++motor.disables_asked;
  }
}

void Oracle::answered(const OrderResult& result) {
  if (unanswered_.erase(result.id) == 0) fail(fmt::format("order {} was answered twice", result.id));
  if (const auto zero = zeros_asked_.find(result.id); zero != zeros_asked_.end()) {
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      const bool accepted = !result.refused && result.motors[i] == Refusal::kNone;
      const double value_deg = zero->second.value + (misread_ == i ? 1.0 : 0.0);
      if (zero->second.motors.test(i)) motors_[i].zeros.push_back({value_deg, accepted});
    }
    zeros_asked_.erase(zero);
  }
  const bool of_scan = (scan_ && scan_->id == result.id) ||
                       std::any_of(scans_asked_.begin(), scans_asked_.end(),
                                   [&](const auto& each) { return each.id == result.id; });
  if (of_scan) scan_results_.push_back(result);
}

void Oracle::sent(std::size_t bus, const CanFrame& frame) {
  if (isQuestionOfScan(frame)) {
    questions_.emplace_back(bus, frame);
    return;
  }
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

// By the clock, and without pauses: what came meanwhile has not been read.
bool Oracle::overdue(const Motor& motor) const {
  if (fresh(motor)) return false;
  const Duration timeout = motor.config->feedback_timeout;
  const Duration patience = std::max(timeout / 2, timeout - 2 * config_.period());
  return held_.test(motor.bus) || !motor.reported || motor.unheard > patience;
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
    // A sample that is old on arrival is no evidence of the present, unless nobody ran to hear it.
    const bool young = now_ - motor.reported_at <= motor.config->feedback_timeout / 2;
    const bool of_pause = motor.new_sample && !young && motor.reported_at > before_last_;
    const bool heard = motor.new_sample && (young || (of_pause && !motor.pause_forgiven));
    motor.pause_forgiven = !(motor.new_sample && young) && (motor.pause_forgiven || of_pause);
    const Duration ran = std::min(now_ - before_, 2 * config_.period());
    const auto most_rpm = kSlow * static_cast<double>(motor.config->standstill_rpm);
    const auto& measured = motor.wire->measured();
    if (std::fabs(measured.velocity_rpm) > most_rpm + measured.velocity_step_rpm) motor.fast_at = now_;
    motor.stood = motor.stood || motor.reported_at - std::max(motor.fast_at, motor.acts_since) >= kSettled;
    motor.unheard = !heard ? motor.unheard + ran : young ? now_ - motor.reported_at : Duration{};
    if (!fresh(motor) && !overdue(motor)) ++visits_.unread_after_pauses;
  }
}

Oracle::Actions Oracle::only(FallbackAction action) { return Actions{1ULL << static_cast<unsigned>(action)}; }

void Oracle::setActions(Motor& motor, Actions actions) {
  motor.actions = actions;
  motor.acts_since = now_;
  motor.rpm_when_it_began = motor.wire->measured().velocity_rpm;
  motor.began_unmeasured = !fresh(motor);
  motor.acts_since_tick = tick_;
  motor.unbraked_ticks = 0;
  motor.ends_at_standstill = motor.stood = motor.of_estop = false;
}

void Oracle::judge(const Snapshot& snapshot, std::uint64_t periods, std::bitset<kMaxBuses> read,
                   bool stopped) {
  before_last_ = std::exchange(before_, std::exchange(now_, snapshot.time));
  periods_ = periods;
  for (auto& motor : motors_) motor.told = motor.wire->told();  // a drive may have switched itself off
  followModules(snapshot);
  judgeJoints(snapshot);
  judgeHolders(snapshot);
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
    followTargets(i, snapshot.motors[i]);
    judgeTurn(i, snapshot.motors[i]);
    judgeZero(i, snapshot.motors[i]);
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
    if (seen) continue;
    motors_[i].followed_effort = false;
    for (auto& field : motors_[i].track.fields) field.forget();
  }
  state_ = snapshot.state;
  estop_in_force_ =
      state_ != RobotStatus::kRun && (estop_in_force_ || estop_asked_ || state_ == RobotStatus::kEstop);
  judgeScans(snapshot, read);
  judgeStop(read & ~held_, stopped);
  judgeAnswers();
  count(snapshot);
  for (auto& motor : motors_) {
    motor.coast_asked = motor.enable_asked = motor.alone_asked = motor.clear_asked = motor.zero_asked = false;
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

// A bus whose frames are not echoed is stalled: after kStalledTicks, until an echo comes or it was taken
// down.
void Oracle::followEchoes(const Snapshot& snapshot) {
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    auto& echoes = echoes_[bus];
    // A queue that takes frames again was full for a moment.
    if (echoes.of_a_full_queue && taken_.test(bus) && !stalled_.test(bus)) echoes = {};
    if (echoed_.test(bus) || down_.test(bus) || off_.test(bus)) {
      echoes = {};
      stalled_.reset(bus);
    } else if (!echoes.awaited) {
      // Frames that were held back have none.
      echoes.awaited = (watched_.test(bus) || refused_.test(bus)) && !held_.test(bus);
      echoes.of_a_full_queue = echoes.awaited && !watched_.test(bus);
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
  refused_.reset();
  taken_.reset();
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
    const bool in_circle = feedback.angle_deg >= 0.0F && feedback.angle_deg < 360.0F;
    const bool tells_none = !motor.config->traits().modes.contains(ControlMode::kTotalAngle);
    require(i, in_circle || (tells_none && std::isnan(feedback.angle_deg)), "an angle beyond the circle");
    require(i, tells_none || std::isfinite(feedback.total_angle_deg), "no reading");
    require(i, feedback.received == motor.reported_at, "another time than received");
    const double apart_rpm = static_cast<double>(feedback.velocity_rpm) - motor.wire->measured().velocity_rpm;
    const double wrap_rpm = motor.wire->measured().velocity_wrap_rpm;
    const double off_rpm = std::fabs(wrap_rpm > 0.0 ? std::remainder(apart_rpm, wrap_rpm) : apart_rpm);
    const bool told = motor.wire->samplesAlways() || std::isfinite(feedback.velocity_rpm);
    const bool compared = told && feedback.received == motor.heard_at;
    // A shaft that a load spins up is told in float: 0.01 rpm is below its resolution then.
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
    // docs/safety.md: one that its fallback still resists after its time to run down is pulled, by a slope or
    // a load, and does not keep the e-stop.
    const auto acting = snapshot.motors[i].acting;
    const bool resisted = acting == Acting::kDamp || acting == Acting::kBrake || acting == Acting::kHold;
    const bool pulled = resisted && now_ - motors_[i].acts_since >= motors_[i].config->run_down;
    require(i,
            overdue(motors_[i]) || pulled ||
                std::fabs(measured.velocity_rpm) <= most_rpm + measured.velocity_step_rpm,
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
    if (scan_ && id == scan_->id) continue;  // judgeScans()
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
    ++kind.modes[static_cast<std::size_t>(seen.target.mode)];
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
