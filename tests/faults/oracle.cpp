#include "faults/oracle.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "link/words.hpp"

#include "drives/dji/dji_family.hpp"

namespace rc10::test {
namespace {

using namespace std::chrono_literals;

// A stop lets fallbacks act for so long (docs/safety.md), then rests, and ends at the latest after so many
// ticks of rest.
constexpr Duration kLongestFallback = 1s;
constexpr std::uint64_t kMostRestTicks = 50;
// One rearms or answers at the latest after so many ticks: an enable request waits for half a second.
constexpr std::uint64_t kLongestAnswerTicks = 600;
// So many ticks without an echo are a stall, and a stalled bus is probed so often (docs/can-setup.md).
constexpr std::uint64_t kStalledTicks = 5;
constexpr Duration kProbeInterval = 50ms;
// A loop may take so long to turn its effort round: it starts without a jump.
constexpr int kUnbrakedTicks = 300;
constexpr double kFast = 0.3;  ///< Of the no-load speed: a brake must oppose this.

[[nodiscard]] std::int16_t int16At(const CanFrame& frame, std::size_t at) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(frame.data[at] << 8U | frame.data[at + 1]));
}

[[nodiscard]] const char* name(FallbackAction action) {
  switch (action) {
    case FallbackAction::kCoast: return "coast";
    case FallbackAction::kDamp: return "damp";
    case FallbackAction::kBrake: return "brake";
    case FallbackAction::kHold: return "hold";
  }
  return "?";
}

[[nodiscard]] bool lost(MotorStatus status) {
  return status == MotorStatus::kOffline || status == MotorStatus::kFault;
}

}  // namespace

void Visits::add(const Visits& other) {
  const auto sum = [](auto& to, const auto& from) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
  };
  ticks += other.ticks;
  stops += other.stops;
  stalls += other.stalls;
  probes += other.probes;
  unread_after_pauses += other.unread_after_pauses;
  slewed += other.slewed;
  bounded += other.bounded;
  driven += other.driven;
  alone += other.alone;
  rearmed += other.rearmed;
  sum(robot, other.robot);
  sum(status, other.status);
  sum(faults, other.faults);
  sum(fallbacks, other.fallbacks);
}

std::string Visits::text() const {
  const auto millions = [](std::uint64_t n) { return static_cast<double>(n) / 1e6; };
  std::string out = "robot, ticks:";
  for (std::size_t i = 0; i < robot.size(); ++i)
    out += fmt::format(" {} {}", toString(static_cast<RobotState>(i)), robot[i]);
  out += "\nmotors, million ticks:";
  for (std::size_t i = 0; i < status.size(); ++i)
    out += fmt::format(" {} {:.3f}", toString(static_cast<MotorStatus>(i)), millions(status[i]));
  out += fmt::format("\nmoved by, million ticks: a target {:.3f}", millions(driven));
  for (std::size_t i = 0; i < fallbacks.size(); ++i)
    out += fmt::format(", {} {:.3f}", name(static_cast<FallbackAction>(i)), millions(fallbacks[i]));
  out += "\nfaults:";
  for (std::size_t i = 1; i < faults.size(); ++i)
    out +=
        fmt::format("{} {} {}", i > 1 ? "," : "", link::faultText(static_cast<std::int32_t>(i)), faults[i]);
  out += fmt::format("\njudged, ticks: slew limits {}, soft limits {}", slewed, bounded);
  out += fmt::format("\nenabled alone, ticks: {}", alone);
  out += fmt::format("\nbuses without echoes: {}, probed {} times", stalls, probes);
  out += fmt::format("\nticks of motors that only a pause made stale: {}", unread_after_pauses);
  out += fmt::format("\ngroups enabled again by themselves: {}; orderly ends: {}\n", rearmed, stops);
  return out;
}

Oracle::Oracle(const RobotConfig& config) : config_(config) {
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    for (const auto& entry : config_.buses[bus].motors) {
      const DjiMotorConfig dji = djiConfig(entry.settings);
      const auto& table = dji.model->command(dji.command);
      const double gear = dji.gear_ratio > 0.0 ? dji.gear_ratio : dji.model->gear_ratio;
      const auto limit = static_cast<double>(dji.effort_limit > 0.0F ? dji.effort_limit : table.full_scale);
      Motor motor;
      motor.config = &entry;
      motor.bus = bus;
      motor.command_id = {table.command_ids[dji.id > 4 ? 1 : 0], false};
      motor.slot = static_cast<std::size_t>((dji.id - 1) % 4);
      motor.feedback_id = {static_cast<std::uint32_t>(dji.model->feedback_id_base + dji.id), false};
      motor.raw_per_effort =
          dji.direction * static_cast<double>(table.raw_full_scale) / static_cast<double>(table.full_scale);
      motor.raw_limit = static_cast<int>(std::lround(limit * std::fabs(motor.raw_per_effort)));
      motor.rpm_per_raw = static_cast<float>(dji.direction / gear);
      if (dji.command == DjiCommand::kCurrent) {
        motor.damping_per_rpm = static_cast<double>(table.full_scale) * gear / dji.model->gear_ratio /
                                static_cast<double>(dji.model->no_load_rpm);
      }
      motors_.push_back(motor);
      auto& frames = frames_[bus];
      auto found = std::find_if(frames.begin(), frames.end(),
                                [&](const Expected& frame) { return frame.id == motor.command_id; });
      if (found == frames.end()) found = frames.insert(frames.end(), Expected{motor.command_id, 0, 0});
      found->used_slots = static_cast<std::uint8_t>(found->used_slots | 1U << motor.slot);
    }
  }
  for (const auto& entry : config_.groups) {
    Group group;
    group.rearms = entry.on_return == GroupConfig::Return::kRearmAtRest;
    for (const auto member : entry.motors) {
      group.members.set(member);
      motors_[member].group = groups_.size();
    }
    groups_.push_back(group);
  }
}

void Oracle::fail(const std::string& what) const { throw Violation(fmt::format("tick {}: {}", tick_, what)); }

void Oracle::fail(std::size_t motor, const std::string& what) const {
  using Ms = std::chrono::duration<double, std::milli>;
  const auto& known = motors_[motor];
  throw Violation(fmt::format(
      "tick {}, motor {} ({}): {}; raw {} of {}, {:.1f} rpm, {:.0f} C, feedback {:.1f} ms old, may do {} for "
      "{:.1f} ms, driven for {:.1f} ms more",
      tick_, known.config->name(), toString(known.status), what, known.raw, known.raw_limit,
      static_cast<double>(known.velocity_rpm), static_cast<double>(known.temperature_c),
      Ms(now_ - known.reported_at).count(), known.actions.to_string(), Ms(now_ - known.acts_since).count(),
      Ms(known.driven_until - now_).count()));
}

// What the drive has told, if this is one of its frames.
void Oracle::heard(std::size_t bus, const CanFrame& frame) {
  if (frame.type != FrameType::kData || frame.fd || frame.length != 8 || frame.id.extended) return;
  for (auto& motor : motors_) {
    if (motor.bus != bus || frame.id != motor.feedback_id) continue;
    if (int16At(frame, 0) < 0 || int16At(frame, 0) >= 8192) continue;
    motor.reported = true;
    motor.new_sample = true;
    motor.reported_at = frame.received;
    motor.velocity_rpm = static_cast<float>(int16At(frame, 2)) * motor.rpm_per_raw;
    motor.temperature_c = static_cast<float>(frame.data[6]);
  }
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
  if (order.operation == Operation::kClear && order.motors.count() == motors_.size()) clear_all_asked_ = true;
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
  for (auto& expected : frames_[bus]) {
    if (frame.id != expected.id) continue;
    if (frame.length != 8 || frame.fd || frame.type != FrameType::kData)
      fail("a command frame of another form");
    ++expected.seen;
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (((static_cast<unsigned>(expected.used_slots) >> slot) & 1U) == 0 && int16At(frame, 2 * slot) != 0)
        fail("a slot that belongs to nobody is not zero");
    }
    for (auto& motor : motors_) {
      if (motor.bus == bus && motor.command_id == frame.id) motor.raw = int16At(frame, 2 * motor.slot);
    }
    return;
  }
  fail(fmt::format("a frame that nobody should send: {}", describe(frame.id)));
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

void Oracle::followFeedback() {
  for (auto& motor : motors_) {
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
  motor.unbraked_ticks = 0;
  motor.ends_at_standstill = false;
}

void Oracle::judge(const Snapshot& snapshot, std::uint64_t periods, std::bitset<kMaxBuses> read,
                   bool stopped) {
  now_ = snapshot.time;
  periods_ = periods;
  followFeedback();
  judgeSnapshot(snapshot, periods);
  judgeFrames(read);
  judgeRobotState(snapshot);
  for (std::size_t i = 0; i < motors_.size(); ++i) judgeStatus(i, snapshot.motors[i], snapshot.state);
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
      echoes.awaited = !held_.test(bus);  // what was held back has none
    } else if (++echoes.ticks == kStalledTicks) {
      stalled_.set(bus);
      echoes.next_probe = now_ + kProbeInterval;
      ++visits_.stalls;
    }
    const bool told = snapshot.buses[bus].state == BusState::kStalled;
    if (told != stalled_.test(bus)) {
      fail(fmt::format("bus {} is told to be {}, {} ticks after the last echo", config_.buses[bus].name,
                       link::busStateWord(static_cast<std::uint8_t>(snapshot.buses[bus].state)),
                       echoes.ticks));
    }
  }
  echoed_.reset();
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
    require(i, std::isfinite(feedback.total_angle_deg) && std::isfinite(feedback.current_a), "no reading");
    require(i, std::fabs(feedback.velocity_rpm - motor.velocity_rpm) <= 0.01F, "another speed than reported");
    require(i, feedback.received == motor.reported_at, "another time than received");
  }
}

void Oracle::judgeRobotState(const Snapshot& snapshot) {
  if (stop_asked_ && snapshot.state != RobotState::kStopping) fail("it does not stop");
  if (estop_asked_ && !clear_all_asked_ && snapshot.state == RobotState::kRun) fail("an e-stop was lost");
  const bool released = state_ == RobotState::kEstop && snapshot.state == RobotState::kRun;
  if (released && !clear_all_asked_) fail("an e-stop ended by itself");
  if (contact_open_ && snapshot.state == RobotState::kRun) fail("it runs although the e-stop input is open");
  if (!released) return;
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    require(i, overdue(motors_[i]) || std::fabs(motors_[i].velocity_rpm) <= motors_[i].config->standstill_rpm,
            "an e-stop was cleared while it turns");
  }
}

void Oracle::judgeFrames(std::bitset<kMaxBuses> read) {
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    const bool carries = !known_down_.test(bus) && !off_.test(bus);
    const bool probed = carries && stalled_.test(bus) && now_ >= echoes_[bus].next_probe;
    if (probed) echoes_[bus].next_probe = now_ + kProbeInterval;
    for (auto& expected : frames_[bus]) {
      const int wanted = held_.test(bus) && !probed ? 0 : 1;
      const bool rests = held_.test(bus) && stop_asked_;  // even there, as well as it can
      if (read.test(bus) && !rests && expected.seen != wanted) {
        fail(fmt::format("bus {} got {} frames of {}", config_.buses[bus].name, expected.seen,
                         describe(expected.id)));
      }
      expected.seen = 0;
    }
    if (probed && read.test(bus) && !stop_asked_) judgeProbe(bus);
  }
}

void Oracle::judgeProbe(std::size_t bus) {
  ++visits_.probes;
  for (std::size_t i = 0; i < motors_.size(); ++i)
    require(i, motors_[i].bus != bus || motors_[i].raw == 0,
            "a stalled bus is probed with something else than rest");
}

void Oracle::judgeStatus(std::size_t index, const MotorSnapshot& seen, RobotState robot) {
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
    require(index, robot == RobotState::kRun, "enabled although the robot is stopped");
  if (seen.target.mode != ControlMode::kCoast) {
    require(index, after == MotorStatus::kActive, "a target although it is not ACTIVE");
    require(index, now_ < motor.driven_until, "a target without a valid command");
  }
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
  if (alone_ && !isOn(snapshot.motors[*alone_].status)) alone_.reset();
  if (!alone_) return;
  was_alone_ = true;
  ++visits_.alone;
  for (std::size_t i = 0; i < motors_.size(); ++i)
    require(i, i == *alone_ || !isOn(snapshot.motors[i].status),
            "enabled beside a motor that is enabled alone");
}

void Oracle::judgeGroups(const Snapshot& snapshot) {
  for (auto& group : groups_) {
    bool fault = false;
    group.stops_now = false;
    bool stops = false;
    bool disabled = false;
    MotorSet active;
    MotorSet rearmed;
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      if (!group.members.test(i)) continue;
      const auto before = motors_[i].status;
      const auto after = snapshot.motors[i].status;
      if (before == MotorStatus::kActive) active.set(i);
      stops |= before == MotorStatus::kActive && lost(after);
      // Perhaps it was ACTIVE within the tick.
      group.stops_now |= before == MotorStatus::kEnabling && lost(after);
      fault |= after == MotorStatus::kFault;
      disabled |= motors_[i].disables_asked > 0;
      if (after == MotorStatus::kEnabling && !motors_[i].enable_asked && before != MotorStatus::kEnabling)
        rearmed.set(i);
    }
    if (rearmed.any()) {
      for (std::size_t i = 0; i < motors_.size(); ++i) {
        const bool left_out = group.may_rearm.test(i) && snapshot.motors[i].status == MotorStatus::kReady;
        require(i, !left_out, "its group was enabled again without it");
      }
      group.may_rearm.reset();
      ++visits_.rearmed;
    }
    group.stops_now |= stops;
    if (stops) {
      for (std::size_t i = 0; i < motors_.size(); ++i) {
        if (!group.members.test(i)) continue;
        require(i, snapshot.motors[i].status != MotorStatus::kActive,
                "ACTIVE although its group has stopped");
      }
      if (group.rearms) group.may_rearm = active;
    }
    if (fault || disabled || was_alone_ || estop_asked_ || snapshot.state != RobotState::kRun)
      group.may_rearm.reset();
  }
}

// What a motor without a target may do from now on.
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
    const bool asked = motor.disables_asked > 0 || stop_asked_;
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
  const bool stopped_with_group = motor.group != kNoGroup && groups_[motor.group].stops_now;
  if (before == MotorStatus::kEnabling && stopped_with_group) motor.actions |= only(fallback.on_estop);
  if (motor.mode != ControlMode::kCoast) {  // its target has just gone
    auto actions = only(fallback.on_timeout);
    if (motor.coast_asked) actions |= coast;
    return setActions(motor, actions);
  }
  if (motor.coast_asked || motor.disables_asked > 0) motor.actions |= coast;
  // A target that came and went within the tick cannot be; one that was taken back by COAST can.
  if (after == MotorStatus::kReady && motor.disables_asked > 0 && motor.disables_asked < 2 &&
      before == MotorStatus::kReady && !motor.enable_asked) {
    setActions(motor, coast);
  }
}

bool Oracle::matchesDamp(const Motor& motor) const {
  const double wanted =
      -static_cast<double>(motor.velocity_rpm) * motor.damping_per_rpm * motor.raw_per_effort;
  const double bounded =
      std::clamp(wanted, -static_cast<double>(motor.raw_limit), static_cast<double>(motor.raw_limit));
  const auto raw = static_cast<double>(motor.raw);
  if (std::fabs(raw - bounded) <= 1.5) return true;
  // A hot motor gets less.
  return motor.was_hot && raw * bounded >= 0.0 && std::fabs(raw) <= std::fabs(bounded) + 1.5;
}

void Oracle::judgeCommand(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& guard = motor.config->guard;
  const bool watched =
      guard.temperature_trip_c > 0.0F && djiConfig(motor.config->settings).model->reports_temperature;
  // In the tick in which the drive says that it is cool the limit is back as a whole: a step, too.
  motor.cooled = motor.was_hot;
  if (watched && motor.temperature_c > guard.temperature_derate_c) motor.was_hot = true;
  if (motor.temperature_c <= guard.temperature_derate_c && seen.status == MotorStatus::kActive)
    motor.was_hot = false;
  motor.cooled = motor.cooled && !motor.was_hot;
  require(index, std::abs(motor.raw) <= motor.raw_limit, "beyond its limit");
  const double told = static_cast<double>(seen.command_value) * motor.raw_per_effort;
  require(index, std::fabs(told - motor.raw) <= 1.0, "the snapshot says another command than the frame");
  judgeSlew(index, seen);
  if (lost(seen.status)) {
    require(index, motor.raw == 0, "a command that is not rest");
    return;
  }
  judgeSoftLimits(index, seen);
  if (watched && motor.temperature_c >= guard.temperature_trip_c)
    require(index, motor.raw == 0, "driven although it is too hot");
  if (seen.target.mode == ControlMode::kCoast) judgeFallback(index);
}

// A current or a voltage changes no faster than allowed, whatever is asked. Fallbacks and loops may.
void Oracle::judgeSlew(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const bool follows = seen.status == MotorStatus::kActive && (seen.target.mode == ControlMode::kCurrent ||
                                                               seen.target.mode == ControlMode::kVoltage);
  const auto per_s = static_cast<double>(motor.config->shaping.effort_slew_per_s);
  constexpr std::uint64_t kMostPeriods = 5;  // what a tick counts for at most
  const double dt_s =
      static_cast<double>(seconds(config_.period())) * static_cast<double>(std::min(periods_, kMostPeriods));
  const double most = per_s * dt_s * std::fabs(motor.raw_per_effort) + 2.0;
  if (per_s > 0.0 && follows && motor.followed_effort && !motor.was_hot && !motor.cooled) {
    require(index, std::abs(motor.raw - motor.raw_before) <= most, "its effort changes too fast");
    ++visits_.slewed;
  }
  motor.followed_effort = follows;
  motor.raw_before = motor.raw;
}

// Beyond a soft limit, and not on its way back, no current or voltage pushes on.
void Oracle::judgeSoftLimits(std::size_t index, const MotorSnapshot& seen) {
  auto& motor = motors_[index];
  const auto& shaping = motor.config->shaping;
  const bool follows = seen.status == MotorStatus::kActive && (seen.target.mode == ControlMode::kCurrent ||
                                                               seen.target.mode == ControlMode::kVoltage);
  const double effort = motor.raw / motor.raw_per_effort;
  const double step = 1.0 / std::fabs(motor.raw_per_effort);
  const double angle_deg = seen.feedback.total_angle_deg;
  const bool above = angle_deg >= shaping.angle_max_deg && seen.feedback.velocity_rpm >= 0.0F;
  const bool below = angle_deg <= shaping.angle_min_deg && seen.feedback.velocity_rpm <= 0.0F;
  const bool judged = follows && seen.feedback.zeroed && (above || below);
  if (judged) ++visits_.bounded;
  const bool pushed = judged && ((above && effort > step) || (below && effort < -step));
  require(index, !pushed, "it is pushed on beyond a soft limit");
}

void Oracle::judgeFallback(std::size_t index) {
  auto& motor = motors_[index];
  const auto& fallback = motor.config->fallback;
  auto actions = motor.actions;
  if (motor.ends_at_standstill) actions |= only(FallbackAction::kCoast);
  const auto hold = static_cast<std::size_t>(FallbackAction::kHold);
  if (actions.test(hold) && now_ - motor.acts_since >= fallback.hold_max) {
    actions |= only(FallbackAction::kDamp);
    if (now_ - motor.acts_since >= fallback.hold_max + 60ms) actions.reset(hold);
  }
  if (state_ == RobotState::kStopping && now_ - stopping_since_ >= kLongestFallback)
    actions = only(FallbackAction::kCoast);
  const auto coast = static_cast<std::size_t>(FallbackAction::kCoast);
  const auto brake = static_cast<std::size_t>(FallbackAction::kBrake);
  bool fits = actions.test(hold) || actions.test(brake);
  fits = fits || (actions.test(coast) && motor.raw == 0);
  fits = fits || (actions.test(static_cast<std::size_t>(FallbackAction::kDamp)) && matchesDamp(motor));
  if (!fits) {
    std::string words;
    for (std::size_t i = 0; i < actions.size(); ++i) {
      if (actions.test(i)) words += fmt::format(" {}", name(static_cast<FallbackAction>(i)));
    }
    fail(index, "nobody commands it, and its command is not that of its fallback:" + words);
  }
  const double speed = static_cast<double>(motor.velocity_rpm) * motor.raw_per_effort;
  const bool fast = std::fabs(static_cast<double>(motor.velocity_rpm)) >
                    kFast * static_cast<double>(djiConfig(motor.config->settings).model->no_load_rpm);
  const bool must_brake = actions == only(FallbackAction::kBrake) && !motor.was_hot;
  const bool opposes = static_cast<double>(motor.raw) * speed < 0.0;
  // Its loop runs on new samples only.
  if (!must_brake || !fast || opposes) motor.unbraked_ticks = 0;
  if (must_brake && fast && !opposes && motor.new_sample) ++motor.unbraked_ticks;
  require(index, motor.unbraked_ticks < kUnbrakedTicks, "its brake does not act");
}

void Oracle::judgeStop(std::bitset<kMaxBuses> read, bool stopped) {
  if (!stop_asked_) return;
  if (ticks_stopping_++ == 0) stopping_since_ = now_;
  bool all_rest = true;
  for (const auto& motor : motors_) all_rest = all_rest && (motor.raw == 0 || !read.test(motor.bus));
  const bool over = now_ - stopping_since_ >= kLongestFallback;
  if (over && !all_rest) fail("something else than rest after the end of the fallbacks");
  if (stopped && !all_rest) fail("stopped, and not at rest");
  if (rested_ && !all_rest) fail("something else than rest after the last rest");
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
    if (motor.raw == 0) continue;
    if (seen.target.mode != ControlMode::kCoast) ++visits_.driven;
    for (std::size_t action = 1; action < motor.actions.size(); ++action) {
      const bool acts = seen.target.mode == ControlMode::kCoast && motor.actions.test(action);
      if (acts) ++visits_.fallbacks[action];
    }
  }
}

}  // namespace rc10::test
