// Rules for joints that home, and for modules that hold.
#include <algorithm>
#include <cmath>
#include <utility>

#include "faults/oracle.hpp"

namespace rc10::test {
namespace {

using namespace std::chrono_literals;

constexpr double kJointHomes = 1.0;  ///< Output `state`.
constexpr double kJointFollows = 2.0;
// A client that is silent for so long has let go: after that `home` counts as fallen.
constexpr Duration kJointLetGo = 1s;
// A module's targets act for this long when it commands no more.
constexpr Duration kLapse = 25ms;
// Messages come so often.
constexpr Duration kStillHeard = 50ms;
// Ticks within which `home` has begun a homing, or begins none.
constexpr int kRiseTicks = 3;
// Ticks within which another client's command has ended it.
constexpr int kOthersTicks = 3;

}  // namespace

void Oracle::signalled(const SignalMessage& message) {
  client_heard_ = true;
  for (auto& holder : holders_)
    if (holder.module == message.module && !holder.any_client) holder.valid_until = message.deadline;
  for (auto& joint : joints_) {
    if (joint.module != message.module) continue;
    const bool high = message.values[1] >= 0.5;
    joint.rises = joint.rises || (high && !joint.high);
    joint.told = true;
    joint.high = high;
    joint.valid_until = message.deadline;
  }
}

// A gimbal holds its direction for some time when nobody commands it, a joint its angle when no client of the
// robot is heard; and then for nobody.
void Oracle::judgeHolders(const Snapshot& snapshot) {
  const bool heard = std::exchange(client_heard_, false);
  // In a pause nobody can be heard: it counts as some periods at most.
  constexpr int kMostPeriodsOfATick = 5;
  const Duration unwatched =
      std::max(now_ - before_ - kMostPeriodsOfATick * config_.period(), Duration::zero());
  for (auto& holder : holders_) {
    holder.valid_until += unwatched;
    if (heard && holder.any_client) holder.valid_until = now_ + kStillHeard;
    const auto name = config_.modules[holder.module].settings.name;
    const bool over = now_ >= holder.valid_until + holder.silence_max + kLapse + 2 * (now_ - before_);
    for (const auto motor : holder.motors) {
      const bool holds = snapshot.motors[motor].owner.view() == name;
      if (holds && now_ >= holder.valid_until) ++visits_.held_for_nobody;
      require(motor, !over || !holds, "it holds for nobody, and does not end");
    }
  }
}

void Oracle::judgeJoints(const Snapshot& snapshot) {
  if (snapshot.state == RobotStatus::kStopping) return;  // modules stand still
  for (auto& joint : joints_) judgeJoint(joint, snapshot);
}

// `home` that has not fallen since begins no other homing, but for one that a gap of the stream has ended.
void Oracle::followMessages(Joint& joint, bool homes) {
  const Duration slack = 2 * static_cast<std::int64_t>(periods_) * config_.period();
  const bool heard = now_ < joint.valid_until;
  const bool gap = now_ + slack >= joint.valid_until;
  if (joint.told && !joint.high) joint.high_ticks = 0;
  if (!homes && joint.homes && gap) joint.high_ticks = 0;
  if (!heard && now_ + slack - joint.heard_at >= kJointLetGo) joint.high_ticks = 0;
  if (!heard) return;
  joint.heard_at = now_;
  if (joint.high) ++joint.high_ticks;
}

void Oracle::judgeJoint(Joint& joint, const Snapshot& snapshot) {
  const auto& outputs = snapshot.modules[joint.module].outputs;
  const auto& feedback = snapshot.motors[joint.motor].feedback;
  const bool homes = outputs[0] == kJointHomes;
  followMessages(joint, homes);
  const bool begins = homes && !joint.homes;
  if (begins) {
    require(joint.motor, joint.high_ticks <= kRiseTicks, "it homes though nobody has asked for it anew");
    joint.from_deg = joint.to_deg = feedback.total_angle_deg;
    joint.ticks = joint.others_ticks = 0;
  } else if (homes && joint.rises) {
    joint.from_deg = std::min(joint.from_deg, feedback.total_angle_deg);
    joint.to_deg = std::max(joint.to_deg, feedback.total_angle_deg);
  }
  const bool found = feedback.zeroed && !joint.zeroed;
  require(joint.motor, !found || motors_[joint.motor].zero_asked || joint.homes,
          "it has a reference, and nobody has given it one");
  if (homes) judgeHoming(joint, snapshot);
  if (joint.homes && outputs[0] == kJointFollows) ++visits_.homed;
  joint.homes = homes;
  joint.zeroed = feedback.zeroed;
  joint.told = joint.rises = false;
}

// Its current is bounded by its file, never pushes on beyond the homing velocity or farther than the travel,
// and ends with the e-stop, its motor's ACTIVE, its client and its lease.
void Oracle::judgeHoming(Joint& joint, const Snapshot& snapshot) {
  const auto motor = joint.motor;
  const auto& seen = snapshot.motors[motor];
  const auto& target = seen.target;
  const auto rpm = static_cast<double>(seen.feedback.velocity_rpm);
  ++visits_.homing;
  ++joint.ticks;
  require(motor, target.mode == ControlMode::kCoast || target.mode == ControlMode::kCurrent,
          "it homes by something else than a current");
  require(motor, std::fabs(target.value) <= joint.current_a, "it homes by more than its homing current");
  const bool pushes = target.mode == ControlMode::kCurrent && target.value != 0.0;
  const bool on = target.value * rpm > 0.0;
  require(motor, !pushes || !on || std::fabs(rpm) <= joint.velocity_rpm * (1.0 + 1e-6),
          "it is pushed on beyond its homing velocity");
  const double here_deg = seen.feedback.total_angle_deg;
  const bool near = here_deg >= joint.from_deg - joint.way_deg && here_deg <= joint.to_deg + joint.way_deg;
  // A load that pulls the shaft away is resisted.
  require(motor, !pushes || !on || near, "it homes farther than its travel");
  require(motor, !pushes || joint.ticks <= 1 || !seen.feedback.zeroed, "it homes with a reference");
  const bool stopped =
      estop_asked_ || (state_ == RobotStatus::kEstop && snapshot.state == RobotStatus::kEstop);
  require(motor, !stopped, "it homes in an e-stop");
  require(motor, motors_[motor].status == MotorStatus::kActive, "it homes though its motor was not ACTIVE");
  const Duration slack = (static_cast<std::int64_t>(periods_) + 1) * config_.period();
  require(motor, now_ < joint.valid_until + slack, "it homes for nobody");
  const auto owner = seen.owner.view();
  const bool others = !owner.empty() && owner != config_.modules[joint.module].settings.name;
  joint.others_ticks = others ? joint.others_ticks + 1 : 0;
  require(motor, joint.others_ticks <= kOthersTicks, "it homes though another client has its motor");
}

}  // namespace rc10::test
