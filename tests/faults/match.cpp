#include "faults/match.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/angle.hpp"
#include "app/target.hpp"
#include "app/units.hpp"
#include "app/vocabulary.hpp"
#include "daemon/exchange/events.hpp"
#include "faults/robots.hpp"

namespace rc10::test {
namespace {

using namespace std::chrono_literals;

enum Module : std::uint16_t { kBase, kGun, kLift };

/// One motor's program, and the push against it: a share of what the motor can do, so that the motor wins.
struct Role {
  std::string_view name;
  ControlMode mode;
  double reach;       ///< deg or rpm, both ways.
  double most_per_s;  ///< Change of the target.
  double push_nm;
};
constexpr auto kByModule = ControlMode::kCoast;
constexpr std::array<Role, 19> kRoles{{{"front_left", kByModule, 0, 0, 1.5},
                                       {"front_right", kByModule, 0, 0, 1.5},
                                       {"rear_left", kByModule, 0, 0, 1.5},
                                       {"rear_right", kByModule, 0, 0, 1.5},
                                       {"loader", kByModule, 0, 0, 0.3},
                                       {"yaw", ControlMode::kTotalAngle, 150, 200, 0.5},
                                       {"pitch", ControlMode::kTotalAngle, 25, 100, 0.3},
                                       {"flywheel_left", ControlMode::kVelocity, 2500, 2000, 0.1},
                                       {"flywheel_right", ControlMode::kVelocity, 2500, 2000, 0.1},
                                       {"belt", ControlMode::kVelocity, 400, 400, 0.2},
                                       {"shoulder", ControlMode::kTotalAngle, 80, 120, 3},
                                       {"elbow", ControlMode::kTotalAngle, 90, 150, 1},
                                       {"wrist", ControlMode::kImpedance, 90, 150, 2},
                                       {"finger", ControlMode::kTotalAngle, 60, 150, 2},
                                       {"lift_left", kByModule, 0, 0, 1.5},
                                       {"lift_right", kByModule, 0, 0, 1.5},
                                       {"pan", ControlMode::kTotalAngle, 120, 150, 0.5},
                                       {"leg_left", ControlMode::kTotalAngle, 90, 200, 0.3},
                                       {"leg_right", ControlMode::kTotalAngle, 90, 200, 0.3}}};

constexpr std::array<const char*, 10> kTroubleNames{"shove", "hand", "slope", "heat", "loose plug",
                                                    "plug",  "bus",  "pause", "gap",  "e-stop"};
// Weight of each in per cent.
constexpr std::array<std::uint8_t, 10> kTroubleWeights{30, 18, 8, 8, 8, 8, 2, 8, 8, 2};

// Time after a plug or the button in which a group's stop and a run-down follow.
constexpr auto kAftermath = 500ms;
// From the operator's `enable` until every motor obeys.
constexpr auto kBackWithin = 8s;
// A person turns a shaft back so slowly, so hard and once in so long: longer than kBackWithin, which judges
// the rest.
constexpr double kBackRpm = 30.0;
constexpr double kBackNm = 5.0;
constexpr auto kBackOnceIn = 20s;
// Half of the pair's max_difference_deg.
constexpr double kTogetherDeg = 5.0;
// Share of the push that a motor withstands; and a spring that it cannot bend far.
constexpr double kHelpShare = 0.1;
constexpr float kStiffness = 20.0F;
constexpr float kDamping = 1.0F;
constexpr auto kRecentLines = std::size_t{12};

}  // namespace

Match::Match(Choices& choices) : choices_(choices), config_(matchRobot()), robot_(config_) {
  static_assert(kTroubleNames.size() == kTroubles);
  std::size_t motor = 0;
  for (std::size_t bus = 0; bus < config_.buses.size(); ++bus) {
    for (std::size_t drive = 0; drive < config_.buses[bus].motors.size(); ++drive, ++motor) {
      const auto& role = kRoles.at(motor);
      const auto& name = config_.buses[bus].motors[drive].settings.name;
      if (role.name != name) throw std::runtime_error("match: no role for " + name);
      Player player;
      player.motor = motor;
      player.bus = bus;
      player.drive = drive;
      player.target.mode = role.mode;
      players_.push_back(player);
    }
  }
  phase_ends_ = robot_.now() + 3s;
  next_trouble_ = robot_.now() + 5s;
}

Duration Match::between(int least_ms, int most_ms) {
  return std::chrono::milliseconds{least_ms} +
         std::chrono::milliseconds{choices_.next(static_cast<std::uint32_t>(most_ms - least_ms + 1))};
}

Match::Player& Match::somebody() {
  return players_[choices_.next(static_cast<std::uint32_t>(players_.size()))];
}

void Match::tick() {
  std::uint64_t periods = 1;
  if (robot_.now() >= next_trouble_) {
    next_trouble_ = robot_.now() + between(200, 2500);
    std::uint32_t left = choices_.next(100);
    std::size_t which = 0;
    while (left >= kTroubleWeights.at(which)) left -= kTroubleWeights.at(which++);
    const auto trouble = static_cast<Trouble>(which);
    if (trouble == Trouble::kPause) {
      note("pause");
      // In a longer pause the drives' own watchdogs act, as they are to.
      periods = choices_.of<std::uint64_t>({2, 3, 5, 10, 20, 30, 40});
      lately_.push_back(fmt::format("{}: pause of {} ms", tick_, periods));
      // A shaking contact does not wait for the daemon: a gap that ends within the pause ends here.
      const auto back = robot_.now() + config_.period() * static_cast<std::int64_t>(periods);
      for (auto& player : players_) {
        if (player.unplugged_until != MonotonicTime{} && player.unplugged_until < back)
          player.unplugged_until = robot_.now();
      }
    } else {
      begin(trouble);
    }
  }
  end();
  operate();
  drive();
  robot_.exchange().estop_contact.show(robot_.now() < pressed_until_ ? ContactState::kOpen
                                                                     : ContactState::kClosed);
  robot_.tick(periods);
  robot_time_ += config_.period() * static_cast<std::int64_t>(periods);
  ++tick_;
  OrderResult answer;
  while (robot_.exchange().results.pop(answer)) {
    std::string refused;
    // A shaft that a slope or a hand still turns keeps the e-stop, as it is to.
    if (std::any_of(answer.motors.begin(), answer.motors.end(),
                    [](Refusal refusal) { return refusal == Refusal::kMoving; }))
      all_well_ = {};
    for (auto& player : players_) {
      const auto refusal = answer.motors.at(player.motor);
      if (refusal == Refusal::kTurnUnclear) turnBack(player);
      if (refusal != Refusal::kNone)
        refused += fmt::format(" {} {},", kRoles.at(player.motor).name, static_cast<int>(refusal));
    }
    if (!refused.empty())
      lately_.push_back(fmt::format("{}: request {} is refused, by Refusal:{}", tick_, answer.id, refused));
  }
  judge();
  if (lately_.size() > 4 * kRecentLines) lately_.erase(lately_.begin(), lately_.end() - kRecentLines);
}

void Match::load(Player& player, double torque_nm, Duration time) {
  auto load = config_.buses[player.bus].motors[player.drive].simulated;
  load.load_torque_nm = static_cast<float>(torque_nm);
  // setLoad() replaces all faults.
  load.silent = robot_.now() < player.unplugged_until;
  busOf(player).setLoad(player.drive, load);
  player.loaded_until = robot_.now() + time;
}

void Match::excuse(std::size_t motor, MonotonicTime until) {
  const auto name = [&](std::size_t m) -> Player& { return players_[m]; };
  name(motor).excused_until = std::max(name(motor).excused_until, until);
  for (const auto& group : config_.groups) {
    if (std::find(group.motors.begin(), group.motors.end(), motor) == group.motors.end()) continue;
    for (const auto other : group.motors)
      name(other).excused_until = std::max(name(other).excused_until, until);
  }
}

void Match::unplug(std::size_t index, Duration time) {
  auto& player = players_[index];
  player.unplugged_until = std::max(player.unplugged_until, robot_.now() + time);
  busOf(player).silence(player.drive, true);
  excuse(index, player.unplugged_until + kAftermath);
}

void Match::unplugUnnoticed(std::size_t motor) {
  busOf(players_[motor]).silence(players_[motor].drive, true);
}

void Match::leadAstray(std::size_t motor) {
  auto& player = players_[motor];
  const double deg = wrapHalfTurn(static_cast<double>(robot_.snapshot().motors[motor].feedback.angle_deg));
  unplug(motor, 3s);
  busOf(player).turnByHand(
      player.drive,
      {.by_deg = kDegPerTurn / 2.0 - deg, .speed_rpm = kBackRpm, .torque_nm = kBackNm, .hold = 0s});
}

// A hand on one motor of the lift turns the other, too: they move one thing.
std::vector<std::size_t> Match::oneThing(std::size_t motor) const {
  if (kRoles.at(motor).name != "lift_left" && kRoles.at(motor).name != "lift_right") return {motor};
  std::vector<std::size_t> both;
  for (std::size_t i = 0; i < kRoles.size(); ++i)
    if (kRoles.at(i).name.substr(0, 5) == "lift_") both.push_back(i);
  return both;
}

void Match::begin(Trouble trouble) {
  auto& player = somebody();
  const auto& role = kRoles.at(player.motor);
  const double push = role.push_nm * static_cast<double>(50 + choices_.next(51)) / 100.0;
  const double sign = choices_.oneIn(2) ? 1.0 : -1.0;
  const auto name = kTroubleNames.at(static_cast<std::size_t>(trouble));
  note(name);
  std::string of{role.name};
  switch (trouble) {
    case Trouble::kShove:
      // A motor at rest is a free wheel, which would turn on for long.
      if (player.was_active) {
        const auto time = between(50, 500);
        for (const auto motor : oneThing(player.motor)) load(players_[motor], sign * push, time);
      }
      break;
    case Trouble::kHand: {
      const sim::Hand turn{.by_deg = sign * static_cast<double>(10 + choices_.next(170)),
                           .speed_rpm = static_cast<double>(5 + choices_.next(26)),
                           .torque_nm = push,
                           .hold = between(0, 1000)};
      for (const auto motor : oneThing(player.motor))
        busOf(players_[motor]).turnByHand(players_[motor].drive, turn);
      break;
    }
    case Trouble::kSlope: {
      const auto time = between(5000, 30'000);
      for (std::size_t wheel = 0; wheel < 4; ++wheel) load(players_[wheel], sign * push * 0.3, time);
      of = "all wheels";
      break;
    }
    case Trouble::kHeat:
      busOf(player).setTemperature(player.drive, static_cast<double>(60 + choices_.next(33)));
      break;
    case Trouble::kLoose: player.loose_until = robot_.now() + between(500, 5000); break;
    case Trouble::kPlug: unplug(player.motor, between(1, 3000)); break;
    case Trouble::kBus: {
      const auto time = between(100, 2000);
      for (const auto& other : players_) {
        if (other.bus == player.bus) unplug(other.motor, time);
      }
      of = config_.buses[player.bus].name;
      break;
    }
    case Trouble::kGap:
      silent_until_ = robot_.now() + between(30, 2500);
      of = "programs";
      break;
    case Trouble::kEstop:
      pressed_until_ = robot_.now() + between(200, 3000);
      estop_excused_until_ = pressed_until_ + kAftermath;
      of = "button";
      break;
    case Trouble::kPause:
    case Trouble::kCount: break;
  }
  lately_.push_back(fmt::format("{}: {} of {}", tick_, name, of));
}

void Match::end() {
  const auto now = robot_.now();
  for (auto& player : players_) {
    if (player.loaded_until != MonotonicTime{} && now >= player.loaded_until) {
      load(player,
           static_cast<double>(config_.buses[player.bus].motors[player.drive].simulated.load_torque_nm), 0s);
      player.loaded_until = {};
    }
    // A shaking contact loses frames in gaps or not at all: CAN repeats disturbed ones.
    if (now < player.loose_until && now >= player.next_gap && player.unplugged_until == MonotonicTime{}) {
      player.unplugged_until = now + between(1, 10);
      player.next_gap = player.unplugged_until + between(30, 300);
      busOf(player).silence(player.drive, true);
    }
    if (player.unplugged_until != MonotonicTime{} && now >= player.unplugged_until) {
      player.unplugged_until = {};
      busOf(player).silence(player.drive, false);
    }
  }
}

// No motors: the whole robot.
void Match::order(Operation operation, MotorSet motors) {
  Order order;
  order.id = ++orders_;
  order.operation = operation;
  order.motors = motors;
  for (std::size_t i = 0; i < players_.size() && motors.none(); ++i) order.motors.set(i);
  order.whole_robot = motors.none();
  order.client = link::Name{"operator"};
  (void)robot_.exchange().orders.push(order);
}

// Angle references that a gap has cost are set again, as long as the motor rests; those of the lift together.
void Match::reference() {
  const auto& state = robot_.snapshot();
  MotorSet lost;
  for (const auto& player : players_) {
    const auto both = oneThing(player.motor);
    const auto& motor = state.motors[player.motor];
    if (!needsReference(player.target.mode) && both.size() == 1) continue;
    if (motor.feedback.zeroed || motor.status != MotorStatus::kReady) continue;
    // One that knows its place is turned back into its travel.
    if (config_.buses[player.bus].motors[player.drive].traits().absolute) continue;
    for (const auto one : both) lost.set(one);
  }
  if (lost.any()) {
    note("reference set");
    order(Operation::kZero, lost);
  }
  bringTogether();
}

// Nothing couples the shafts of the lift here: a shove while it rests may lead them apart, and rc10d rightly
// asks for a person (modules.md).
void Match::bringTogether() {
  MotorSet pair;
  double low_deg = std::numeric_limits<double>::infinity();
  double high_deg = -low_deg;
  for (std::size_t i = 0; i < players_.size(); ++i) {
    if (oneThing(i).size() == 1) continue;
    const auto& motor = robot_.snapshot().motors[players_[i].motor];
    if (motor.status != MotorStatus::kReady || !motor.feedback.zeroed) return;
    pair.set(players_[i].motor);
    low_deg = std::min(low_deg, motor.feedback.total_angle_deg);
    high_deg = std::max(high_deg, motor.feedback.total_angle_deg);
  }
  if (!(high_deg - low_deg > kTogetherDeg)) return;
  note("brought together");
  order(Operation::kZero, pair);
}

// A hand has led the shaft out of its travel while its plug was out: rc10d rightly asks for a person
// (safety.md).
void Match::turnBack(Player& player) {
  const auto now = robot_.now();
  if (now < player.turned_back_until) return;
  const double deg =
      wrapHalfTurn(static_cast<double>(robot_.snapshot().motors[player.motor].feedback.angle_deg));
  busOf(player).turnByHand(player.drive,
                           {.by_deg = -deg, .speed_rpm = kBackRpm, .torque_nm = kBackNm, .hold = 0s});
  player.turned_back_until = now + kBackOnceIn;
  all_well_ = {};
  note("turned back");
  lately_.push_back(
      fmt::format("{}: {} is turned back from {:.0f} deg", tick_, kRoles.at(player.motor).name, deg));
}

// The operator: starts a match, ends it, and brings back what a plug or the button has stopped.
void Match::operate() {
  const auto now = robot_.now();
  if (now >= phase_ends_) {
    if (phase_ == Phase::kPit) {
      note("match");
      phase_ = Phase::kPlay;
      phase_ends_ = now + 180s;
      reference();
      ask_again_ = now;
      all_well_ = {};
    } else {
      phase_ = Phase::kPit;
      phase_ends_ = now + between(5'000, 30'000);
      order(Operation::kDisable);
      for (auto& player : players_) excuse(player.motor, now + kAftermath);
    }
    lately_.push_back(fmt::format("{}: {}", tick_, phase_ == Phase::kPlay ? "play" : "pit"));
  }
  if (phase_ != Phase::kPlay || now < ask_again_) return;
  ask_again_ = now + 1s;
  const auto& state = robot_.snapshot();
  bool plugged = now >= pressed_until_;
  bool obey = state.state == RobotStatus::kRun;
  for (const auto& player : players_) {
    plugged = plugged && player.unplugged_until == MonotonicTime{};
    obey = obey && state.motors[player.motor].status == MotorStatus::kActive;
  }
  if (!plugged || obey) {
    all_well_ = {};
    return;
  }
  if (all_well_ == MonotonicTime{}) all_well_ = now;
  if (now - all_well_ > kBackWithin) {
    std::string who;
    for (const auto& player : players_) {
      if (state.motors[player.motor].status != MotorStatus::kActive)
        who +=
            fmt::format(" {} {}", kRoles.at(player.motor).name, toString(state.motors[player.motor].status));
    }
    nuisance("does not come back by clear and enable:" + who);
    all_well_ = now;
  }
  order(Operation::kClear);
  reference();
  order(Operation::kEnable);
}

// Goals within reach, and a target on its way there.
void Match::aim(Player& player) {
  const auto& role = kRoles.at(player.motor);
  const auto now = robot_.now();
  if (now >= player.next_goal) {
    player.next_goal = now + between(300, 3000);
    player.goal = role.reach * (static_cast<double>(choices_.next(201)) - 100.0) / 100.0;
  }
  constexpr double kEverySeconds = 0.02;
  const double most = role.most_per_s * kEverySeconds;
  const double step = std::clamp(player.goal - player.target.value, -most, most);
  player.target.value += step;
  if (!needsReference(player.target.mode)) return;
  // As a program that plans its way: the speed of the trajectory, and a torque that helps along.
  player.target.velocity_ff_rpm = static_cast<float>(step / kEverySeconds / kDegPerSPerRpm);
  player.target.torque_ff_nm = static_cast<float>(std::copysign(kHelpShare * role.push_nm, step));
  if (player.target.mode != ControlMode::kImpedance) return;
  player.target.stiffness_nm_per_rad = kStiffness;
  player.target.damping_nms_per_rad = kDamping;
}

void Match::drive() {
  const auto now = robot_.now();
  if (now < next_drive_) return;
  next_drive_ = now + 20ms;
  if (phase_ != Phase::kPlay || now < silent_until_ || lets_all_stand_) return;
  const auto& state = robot_.snapshot();
  Command command;
  command.client = link::Name{"program"};
  command.session = 1;
  command.received = command.said = now;
  command.deadline = now + 100ms;
  for (auto& player : players_) {
    if (player.target.mode == kByModule) continue;
    const auto& feedback = state.motors[player.motor].feedback;
    // A program starts from the measured value.
    if (state.motors[player.motor].status != MotorStatus::kActive) {
      const bool angle = needsReference(player.target.mode);
      player.target.value = angle && std::isfinite(feedback.total_angle_deg) ? feedback.total_angle_deg : 0.0;
      continue;
    }
    aim(player);
    command.setpoints.at(command.count++) = {static_cast<std::uint16_t>(player.motor), player.target};
  }
  (void)robot_.exchange().commands.push(command);

  if (choices_.oneIn(50)) {
    for (auto& share : chassis_) share = (static_cast<double>(choices_.next(201)) - 100.0) / 100.0;
    lift_rpm_ = (static_cast<double>(choices_.next(61)) - 30.0);
    feed_rpm_ = choices_.oneIn(2) ? 0.0 : 60.0;
  }
  const auto signal = [&](Module module, std::initializer_list<double> values) {
    SignalMessage message;
    message.client = link::Name{"program"};
    message.session = 1;
    message.module = module;
    message.received = now;
    message.deadline = now + 100ms;
    message.values.fill(kNoSignal);
    std::copy(values.begin(), values.end(), message.values.begin());
    (void)robot_.exchange().signals.push(message);
  };
  signal(kBase, {chassis_[0] * 1.5, chassis_[1] * 1.5, chassis_[2] * 120.0});
  signal(kGun, {feed_rpm_});
  signal(kLift, {lift_rpm_});
}

void Match::nuisance(const std::string& what) {
  std::string text = fmt::format("tick {}: {}", tick_, what);
  const auto first = lately_.size() > kRecentLines ? lately_.size() - kRecentLines : 0;
  for (auto i = first; i < lately_.size(); ++i) text += "\n    before it, tick " + lately_[i];
  nuisances_.push_back(std::move(text));
}

void Match::judge() {
  const auto now = robot_.now();
  const auto& state = robot_.snapshot();
  const bool stopped = now < estop_excused_until_;
  for (const auto& event : robot_.events()) {
    if (event.severity != Severity::kInfo) lately_.push_back(fmt::format("{}: {}", tick_, describe(event)));
  }
  if (state.state != RobotStatus::kRun && !stopped && state.stop.cause != StopCause::kInput)
    nuisance(fmt::format("the robot is in {}: {}", toString(state.state), toString(state.stop.cause)));
  for (auto& player : players_) {
    const auto& motor = state.motors[player.motor];
    const bool active = motor.status == MotorStatus::kActive;
    const bool excused = stopped || now < player.excused_until;
    if (player.was_active && !active) {
      note(excused ? "stop that was asked for" : "NUISANCE");
      if (!excused)
        nuisance(fmt::format("{} is {}: {}", kRoles.at(player.motor).name, toString(motor.status),
                             toString(motor.stop.cause)));
    }
    const bool faulted = motor.status == MotorStatus::kFault;
    // A fault at rest counts, too: the operator would have to clear it. Silence is not a fault.
    if (faulted && !player.faulted && !player.was_active)
      nuisance(fmt::format("{}, at rest, has a fault", kRoles.at(player.motor).name));
    player.faulted = faulted;
    player.was_active = active;
    if (phase_ == Phase::kPlay) {
      ++wanted_ticks_;
      active_ticks_ += active ? 1 : 0;
    }
    if (phase_ == Phase::kPlay && active && now >= silent_until_) {
      ++player.asked_ticks;
      player.followed_ticks += motor.acting == Acting::kTarget ? 1 : 0;
    }
  }
}

std::uint64_t Match::times(const std::string& what) const {
  const auto found = counts_.find(what);
  return found == counts_.end() ? 0 : found->second;
}

double Match::activeShare() const noexcept {
  return wanted_ticks_ == 0 ? 0.0 : static_cast<double>(active_ticks_) / static_cast<double>(wanted_ticks_);
}

std::string Match::idlers(double least_share) const {
  std::string out;
  for (const auto& player : players_) {
    const double share = player.asked_ticks == 0 ? 0.0
                                                 : static_cast<double>(player.followed_ticks) /
                                                       static_cast<double>(player.asked_ticks);
    if (share < least_share) out += fmt::format(" {} {:.0f} %,", kRoles.at(player.motor).name, 100.0 * share);
  }
  return out;
}

std::string Match::text() const {
  std::string out = "happened:";
  for (const auto& [what, times] : counts_) out += fmt::format(" {} {},", what, times);
  out.back() = '\n';
  return out +
         fmt::format("motors obeyed for {:.2f} % of the time that they were to\n", 100.0 * activeShare());
}

}  // namespace rc10::test
