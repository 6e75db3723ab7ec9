// RobStride_Motor::update(): the command of a tick.
#include <algorithm>
#include <cmath>

#include "app/limits.hpp"
#include "app/units.hpp"
#include "drives/robstride/robstride_motor.hpp"

namespace rc10 {
namespace {

// A float keeps 0.01 rad up to here.
constexpr double kFarthestReferenceRad = 1e5;
// Share of the braking torque.
constexpr double kOperationDampShare = 0.2;
constexpr double kScaleEndSlackRad = 1e-3;

}  // namespace

bool RobStride_Motor::positionOnScale() const noexcept {
  return std::abs(position_rad_ + scale_offset_rad_) <= scaleEndRad() + kScaleEndSlackRad;
}

double RobStride_Motor::positionRadFor(double total_angle_deg) const noexcept {
  return drivePositionFor(total_angle_deg) / kDegPerRad + scale_offset_rad_;
}

void RobStride_Motor::update(const Tick& tick) noexcept {
  limits_ = 0;
  Target target = wanted();
  if (enabling() && begins()) {
    enabling_.begin();
    angles_in_doubt_ = false;
  }
  if (!std::isfinite(target.value)) target = Target{};
  if (target.mode != ControlMode::kBrake) brake_held_ = false;
  operation_ = {};
  reference_ = {};
  switch (control_) {
    case RobstrideControl::kOperation: followOperation(target, tick.now); break;
    case RobstrideControl::kCurrent: followCurrent(target); break;
    case RobstrideControl::kVelocity: followVelocity(target); break;
    case RobstrideControl::kPosition: followAngle(target); break;
  }
}

double RobStride_Motor::clampVelocity(double rad_s) noexcept {
  const double limit = limitRadS();
  const double clamped = std::clamp(rad_s, -limit, limit);
  if (clamped != rad_s) limits_ |= kLimitVelocity;
  return clamped;
}

void RobStride_Motor::followOperation(const Target& target, MonotonicTime now) noexcept {
  SpringLaw wanted;
  const double square = ratio() * ratio();
  const bool knows_itself = feedback_.samples > 0;
  const auto take_feed_forward = [&] {
    wanted.torque_nm = torqueToDrive(static_cast<double>(target.torque_ff_nm));
    wanted.velocity_rad_s =
        clampVelocity(toDrive(static_cast<double>(target.velocity_ff_rpm)) / kRpmPerRadPerS);
  };
  switch (target.mode) {
    case ControlMode::kCurrent:
      wanted.torque_nm = torqueToDrive(target.value * static_cast<double>(torqueNmPerA()) +
                                       static_cast<double>(target.torque_ff_nm));
      break;
    case ControlMode::kVelocity:
      take_feed_forward();
      wanted.velocity_rad_s = clampVelocity(toDrive(target.value) / kRpmPerRadPerS);
      wanted.damping_nms_per_rad = velocity_gain_;
      break;
    case ControlMode::kBrake: wanted = resistance(velocity_gain_); break;
    case ControlMode::kTotalAngle:
      take_feed_forward();
      wanted.position_rad = positionRadFor(target.value);
      wanted.stiffness_nm_per_rad = angle_stiffness_;
      wanted.damping_nms_per_rad = angle_damping_;
      break;
    case ControlMode::kImpedance:
      take_feed_forward();
      wanted.position_rad = positionRadFor(target.value);
      wanted.stiffness_nm_per_rad = std::max(static_cast<double>(target.stiffness_nm_per_rad), 0.0) / square;
      wanted.damping_nms_per_rad = std::max(static_cast<double>(target.damping_nms_per_rad), 0.0) / square;
      break;
    default:
      if (ordered() == FrameKind::kDamp) wanted = resistance(kOperationDampShare * velocity_gain_);
      break;
  }
  // Without feedback nothing that depends on where it is can be kept within the limits.
  if (!knows_itself && (wanted.stiffness_nm_per_rad > 0.0 || wanted.damping_nms_per_rad > 0.0)) wanted = {};
  const bool follows_angle = wanted.stiffness_nm_per_rad > 0.0;
  if (follows_angle && (placeUnknown() || !positionOnScale())) {
    limits_ |= kLimitAngle;
    wanted = dampOnly(wanted, angle_damping_);
  }
  if (wanted.stiffness_nm_per_rad > 0.0) {
    const double reach = springReachRad(scaleEndRad(), limitNm(), wanted.stiffness_nm_per_rad);
    const double end = std::min(reach_.step(reach, position_rad_ + scale_offset_rad_), scaleEndRad());
    if (std::abs(wanted.position_rad) > end) limits_ |= kLimitAngle;
    wanted.position_rad = std::clamp(wanted.position_rad, -end, end);
  } else {
    reach_.release();
  }
  if (target.mode == ControlMode::kTotalAngle)
    limitApproach(wanted, now);
  else
    lead_.release();
  limitTorque(wanted);
  operation_ = wanted;
  setCommand(torqueToOutput(torqueNm(wanted, measured())) / static_cast<double>(torqueNmPerA()),
             CommandUnit::kAmpere);
}

void RobStride_Motor::limitApproach(SpringLaw& wanted, MonotonicTime now) noexcept {
  if (velocityLimitRpm() <= 0.0F) return;
  if (lead_.apply(wanted, measured(), limitRadS(), limitNm(), now)) limits_ |= kLimitVelocity;
}

void RobStride_Motor::dropWindup(float /*least_rpm*/) noexcept {
  lead_.dropWindup(measured().velocity_rad_s, limitRadS(), limitNm());
}

void RobStride_Motor::limitTorque(SpringLaw& wanted) noexcept {
  const double limit = limitNm();
  // The gains as they arrive: on a coarse scale they differ enough to matter.
  const auto arriving = codec_.operation(codec_.operate(wanted));
  wanted.stiffness_nm_per_rad = arriving.stiffness_nm_per_rad;
  wanted.damping_nms_per_rad = arriving.damping_nms_per_rad;
  const double feed_forward = finiteOr0(std::clamp(wanted.torque_nm, -limit, limit));
  if (feed_forward != wanted.torque_nm) limits_ |= kLimitCurrent;
  wanted.torque_nm = feed_forward;
  if (boundTorque(wanted, measured(), limit, SpringYield::kTarget)) limits_ |= kLimitCurrent;
  // A target that its field cannot say would be cut there, and the torque with it: the gains yield.
  wanted.position_rad =
      std::clamp(wanted.position_rad, -codec_.position_range_rad, codec_.position_range_rad);
  wanted.velocity_rad_s =
      std::clamp(wanted.velocity_rad_s, -model_->velocity_range_rad_s, model_->velocity_range_rad_s);
  if (boundTorque(wanted, measured(), limit, SpringYield::kGains)) limits_ |= kLimitCurrent;
  keepResisting(wanted, codec_.dampingStep());
}

void RobStride_Motor::followCurrent(const Target& target) noexcept {
  if (target.mode == ControlMode::kCurrent) {
    reference_.value = static_cast<float>(currentWithinLimit(target)) * direction();
  }
  setCommand(static_cast<double>(reference_.value * direction()), CommandUnit::kAmpere);
}

// A limit of 0 lets go.
void RobStride_Motor::limitLoop(bool acts) noexcept {
  reference_.current_limit_a = acts ? effortLimit() : 0.0F;
  if (acts && currentAtLimit(0.0)) limits_ |= kLimitCurrent;
}

void RobStride_Motor::followVelocity(const Target& target) noexcept {
  if (target.mode == ControlMode::kVelocity) {
    reference_.value = static_cast<float>(clampVelocity(toDrive(target.value) / kRpmPerRadPerS));
  }
  const bool acts = target.mode == ControlMode::kVelocity || target.mode == ControlMode::kBrake;
  limitLoop(acts);
  setCommand(toOutput(static_cast<double>(reference_.value)) * kRpmPerRadPerS, CommandUnit::kNative);
}

// The place of a brake: that of the drive's own count, which a zero does not move. It gives way to a hand,
// and does not come back.
double RobStride_Motor::brakeDeg() noexcept {
  constexpr double kSlipDeg = 3.0;  // at the output shaft
  const double slip_rad = std::abs(toDrive(kSlipDeg)) * kRadPerDeg;
  const double here_rad = positionRadFor(feedback_.total_angle_deg);
  brake_rad_ = brake_held_ ? std::clamp(brake_rad_, here_rad - slip_rad, here_rad + slip_rad) : here_rad;
  brake_held_ = true;
  return feedback_.total_angle_deg + toOutput((brake_rad_ - here_rad) * kDegPerRad);
}

void RobStride_Motor::followAngle(const Target& target) noexcept {
  const bool follows = target.mode == ControlMode::kTotalAngle || target.mode == ControlMode::kBrake;
  double wanted_deg = feedback_.total_angle_deg;
  if (target.mode == ControlMode::kTotalAngle) wanted_deg = target.value;
  if (feedback_.samples == 0) return;
  if (target.mode == ControlMode::kBrake) wanted_deg = brakeDeg();
  const double here_rad = positionRadFor(feedback_.total_angle_deg);
  // From beyond what it can be told every place lies far back.
  const bool unreachable = placeUnknown() || !(std::abs(here_rad) <= kFarthestReferenceRad);
  if (follows && unreachable) limits_ |= kLimitAngle;
  const double position_rad = positionRadFor(wanted_deg);
  const double reachable = finiteOr0(std::clamp(position_rad, -kFarthestReferenceRad, kFarthestReferenceRad));
  if (reachable != position_rad) limits_ |= kLimitAngle;
  reference_.value = static_cast<float>(reachable);
  limitLoop(follows && !unreachable);
  setCommand(reachable == position_rad
                 ? wanted_deg
                 : feedback_.total_angle_deg + toOutput((reachable - here_rad) * kDegPerRad),
             CommandUnit::kNative);
}

}  // namespace rc10
