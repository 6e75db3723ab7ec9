#include "drives/cubemars/cubemars_servo.hpp"

#include <algorithm>
#include <cmath>

#include "motor/position_reach.hpp"

namespace rc10 {
namespace {

using cubemars::ServoCommand;

// The feedback ends here: farther away nobody could see where the shaft is. The command reaches 36000.
constexpr double kLargestMessageDeg = 3'200.0;
constexpr double kMostDeg = 1e9;  // of a target or a zero, which may be any number
// Full scale of the fields of a planned motion.
constexpr double kLargestPlanErpm = 327'670.0;

}  // namespace

CubemarsServo::CubemarsServo(const MotorSettings& settings, const CubemarsSettings& own)
    : CubeMars_Motor(settings, own),
      filters_{FrameFilter{.id = cubemars::servoFeedbackId(settings.id)}},
      command_ids_{cubemars::servoId(ServoCommand::kCurrent, settings.id),
                   cubemars::servoId(ServoCommand::kDuty, settings.id),
                   cubemars::servoId(ServoCommand::kBrakeCurrent, settings.id),
                   cubemars::servoId(ServoCommand::kVelocity, settings.id),
                   cubemars::servoId(ServoCommand::kPosition, settings.id),
                   cubemars::servoId(ServoCommand::kPositionVelocity, settings.id)},
      brake_a_(settings.own.number("brake_current_a")),
      acceleration_rpm_per_s_(settings.own.number("acceleration_limit_rpm_per_s")),
      travel_(settings.travel),
      next_(cubemars::currentFrame(settings.id, 0.0)) {}

// ---- Feedback

bool CubemarsServo::matchesFrame(const CanFrame& frame) const noexcept {
  return isFrom(frame, filters_[0].id);
}

FrameVerdict CubemarsServo::updateFeedback(const CanFrame& frame) noexcept { return takeServoReport(frame); }

bool CubemarsServo::setZero(double angle_deg) noexcept {
  const bool limited = std::isfinite(travel_.min_deg) || std::isfinite(travel_.max_deg);
  const double reach_deg = kLargestMessageDeg / own().message_deg_per_deg;
  const bool reaches = reachesTravel(travel_, angle_deg, lastDriveDeg(), toDrive(1.0), reach_deg);
  return (!limited || reaches) && CubeMars_Motor::setZero(angle_deg);
}

// ---- Command

void CubemarsServo::update(const Tick& /*tick*/) noexcept {
  limits_ = 0;
  const Target target = wanted();
  const bool nothing_left = !(effortLimit() > 0.0F);
  if (ordered() == FrameKind::kDamp && !nothing_left) {
    damp();
  } else if (nothing_left || !std::isfinite(target.value)) {
    if (target.mode != ControlMode::kCoast) limits_ |= kLimitCurrent;
    release();
  } else {
    follow(target);
  }
}

void CubemarsServo::follow(const Target& target) noexcept {
  switch (target.mode) {
    case ControlMode::kCurrent: followCurrent(target); break;
    case ControlMode::kVelocity: followVelocity(target.value); break;
    case ControlMode::kTotalAngle: followAngle(target.value); break;
    case ControlMode::kDuty: followDuty(target.value); break;
    case ControlMode::kBrake: brake(); break;
    case ControlMode::kCoast:
    case ControlMode::kAngle:  // wanted() has made it a total angle
    case ControlMode::kImpedance:
    case ControlMode::kVoltage: release(); break;
  }
}

void CubemarsServo::release() noexcept {
  next_ = cubemars::currentFrame(driveId(), 0.0);
  setCommand(0.0, CommandUnit::kAmpere);
}

// Duty 0 shorts the winding: a torque against the motion, in proportion to the speed, without feedback.
void CubemarsServo::damp() noexcept {
  next_ = cubemars::dutyFrame(driveId(), 0.0);
  setCommand(0.0, CommandUnit::kNative);
}

void CubemarsServo::followCurrent(const Target& target) noexcept {
  const double amperes = currentWithinLimit(target);
  next_ = cubemars::currentFrame(driveId(), amperes * static_cast<double>(direction()));
  setCommand(amperes, CommandUnit::kAmpere);
}

void CubemarsServo::brake() noexcept {
  next_ = cubemars::brakeFrame(driveId(), std::min(brake_a_, static_cast<double>(effortLimit())));
  setCommand(0.0, CommandUnit::kNative);
}

double CubemarsServo::erpmOf(double output_rpm) const noexcept {
  return toDrive(output_rpm) * own().model->gear_ratio * std::max(own().pole_pairs, 1);
}

void CubemarsServo::followVelocity(double wanted_rpm) noexcept {
  const double rpm = rpmWithinLimit(wanted_rpm, cubemars::kLargestErpm / std::fabs(erpmOf(1.0)));
  next_ = cubemars::velocityFrame(driveId(), erpmOf(rpm));
  setCommand(rpm, CommandUnit::kNative);
}

// Without a limit the drive follows each new target at once, which is what a stream of targets wants. With
// one it plans its way to the target.
void CubemarsServo::followAngle(double total_angle_deg) noexcept {
  if (positionCutOff()) {  // any target would be a jump back
    brake_a_ > 0.0 ? brake() : damp();
    limits_ |= kLimitAngle;
    return;
  }
  const double target_deg = std::clamp(total_angle_deg, -kMostDeg, kMostDeg);
  const double wanted_deg = drivePositionFor(target_deg) * own().message_deg_per_deg;
  const double degrees = std::clamp(wanted_deg, -kLargestMessageDeg, kLargestMessageDeg);
  if (degrees != wanted_deg) limits_ |= kLimitAngle;
  const auto limit_rpm = static_cast<double>(velocityLimitRpm());
  if (limit_rpm > 0.0 || acceleration_rpm_per_s_ > 0.0) {
    const double erpm = limit_rpm > 0.0 ? std::fabs(erpmOf(limit_rpm)) : cubemars::kLargestErpm;
    const double erpm_per_s =
        acceleration_rpm_per_s_ > 0.0 ? std::fabs(erpmOf(acceleration_rpm_per_s_)) : kLargestPlanErpm;
    next_ = cubemars::positionVelocityFrame(driveId(), degrees, erpm, erpm_per_s);
  } else {
    next_ = cubemars::positionFrame(driveId(), degrees);
  }
  const double cut_off_deg = toOutput((wanted_deg - degrees) / own().message_deg_per_deg);
  setCommand(std::clamp(target_deg - cut_off_deg, -kMostDeg, kMostDeg), CommandUnit::kNative);
}

void CubemarsServo::followDuty(double duty) noexcept {
  const double bounded = std::clamp(duty, -1.0, 1.0);
  next_ = cubemars::dutyFrame(driveId(), bounded * static_cast<double>(direction()));
  setCommand(bounded, CommandUnit::kNative);
}

// ---- Packing

std::size_t CubemarsServo::packCommand(const Tick& tick, std::span<CanFrame> out) noexcept {
  if (!due(tick) || out.empty()) return 0;
  out[0] = next_;
  return 1;
}

std::size_t CubemarsServo::packRest(std::span<CanFrame> out) const noexcept {
  if (out.empty()) return 0;
  out[0] = cubemars::currentFrame(driveId(), 0.0);
  return 1;
}

}  // namespace rc10
