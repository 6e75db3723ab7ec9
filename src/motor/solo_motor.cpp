#include "motor/solo_motor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/angle.hpp"
#include "app/limits.hpp"
#include "motor/saturated_speed.hpp"

namespace rc10 {
namespace {

// Noise of a measured current, and error of a torque constant by which it is reckoned.
constexpr double kCurrentErrorShare = 0.05;

}  // namespace

double driveTurns(const MotorSettings& settings, const MotorTraits& traits) noexcept {
  return gearRatioOf(settings, traits) / traits.gear_ratio;
}

SpringRange springRangeOf(const MotorSettings& settings, const MotorTraits& traits) noexcept {
  const double turns = driveTurns(settings, traits);
  return {.stiffness_nm_per_rad = turns * turns * traits.spring_range.stiffness_nm_per_rad,
          .damping_nms_per_rad = turns * turns * traits.spring_range.damping_nms_per_rad};
}

MotorSettings withFeedbackOfCommands(MotorSettings settings, int commands) {
  const int divider = std::max(settings.command_divider, 1) * std::max(commands, 1);
  settings.feedback_hz = std::max(settings.tick_hz / divider, 1);
  return settings;
}

SoloMotor::SoloMotor(const MotorSettings& settings, const MotorTraits& traits, double drive_turns)
    : Motor_Base(settings.name),
      model_(settings.model),
      traits_(traits),
      gear_ratio_(gearRatioOf(settings, traits)),
      drive_per_output_(settings.direction < 0 ? -drive_turns : drive_turns),
      effort_limit_(effortLimitOf(settings, traits.effort_full_scale)),
      own_limit_a_(settings.own_limit_a),
      velocity_limit_rpm_(settings.velocity_limit_rpm),
      torque_nm_per_a_(traits.torque_nm_per_a * static_cast<float>(gear_ratio_ / traits.gear_ratio)),
      tick_period_(periodOf(settings.tick_hz)),
      feedback_period_(periodOf(settings.feedback_hz > 0 ? settings.feedback_hz : traits.feedback_hz)),
      divider_(static_cast<std::uint64_t>(std::max(settings.command_divider, 1))),
      phase_(static_cast<std::uint64_t>(std::max(settings.command_phase, 0))),
      reference_({.absolute = traits.absolute && gear_ratio_ == traits.gear_ratio,
                  .zero_deg = settings.zero_deg,
                  .zero_at_power_on = settings.zero_at_power_on,
                  .travel = settings.travel}),
      speed_scale_(settings.scale_error) {}

void SoloMotor::acceptSample(MonotonicTime received, double drive_position_deg, bool tells_angle) noexcept {
  takeAngle(drive_position_deg, tells_angle);
  if (traits_.scaled_speed && obeying()) {
    const auto rpm = static_cast<double>(feedback_.velocity_rpm);
    const bool at_end =
        std::fabs(std::fabs(toDrive(rpm)) - speed_field_end_rpm_) <= kHalfStepOfSpeed * speed_field_end_rpm_;
    speed_scale_.add(received, toOutput(drive_position_deg),
                     at_end ? std::numeric_limits<double>::quiet_NaN() : rpm);
  }
  feedback_.received = received;
  ++feedback_.samples;
}

void SoloMotor::takeAngle(double drive_position_deg, bool tells_angle) noexcept {
  // An angle that is followed must not leap to the turn of its travel: it stays lost.
  const bool was_known = reference_.known();
  if (tells_angle)
    reference_.update(toOutput(drive_position_deg), !obeying(), !obeying() || !follows_angle_);
  else
    reference_.drift(toOutput(drive_position_deg));
  // A place that is held was told in the angle of before.
  if (!was_known && reference_.known()) holding_ = false;
  feedback_.total_angle_deg = reference_.totalAngleDeg();
  feedback_.angle_deg = wrapDegreesToFloat(feedback_.total_angle_deg);
  feedback_.zeroed = reference_.known();
  feedback_.turn_unclear = reference_.turnUnclear();
}

DriveComplaint SoloMotor::scaleComplaint() const noexcept {
  if (speed_scale_.verdict() != SpeedScaleCheck::Verdict::kWrong) return {};
  return {.fault = FaultCode::kDriveSetting,
          .native_code =
              kSpeedScaleComplaint + static_cast<std::uint32_t>(std::lround(100.0 * speed_scale_.ratio()))};
}

void SoloMotor::loseReference() noexcept {
  const bool was_known = reference_.known();
  reference_.lose();
  noteLoss(was_known);
}

void SoloMotor::forgetReference() noexcept {
  reference_.forget();
  noteLoss(false);
}

void SoloMotor::doubtTurn() noexcept {
  const bool was_known = reference_.known();
  reference_.doubtTurn();
  noteLoss(was_known);
}

void SoloMotor::noteLoss(bool was_known) noexcept {
  feedback_.zeroed = reference_.known();
  feedback_.turn_unclear = reference_.turnUnclear();
  if (reference_.known()) return;
  if (was_known) ++feedback_.losses;
  holding_ = false;
}

bool SoloMotor::setZero(double angle_deg) noexcept {
  if (feedback_.angle_at_end) return false;  // nobody knows where the shaft is
  const double before_deg = feedback_.total_angle_deg;
  if (!reference_.setZero(angle_deg)) return false;
  feedback_.total_angle_deg = reference_.totalAngleDeg();
  hold_deg_ += feedback_.total_angle_deg - before_deg;  // a load that is held stays where it is
  feedback_.angle_deg = wrapDegreesToFloat(feedback_.total_angle_deg);
  feedback_.zeroed = true;
  feedback_.turn_unclear = false;
  return true;
}

Target SoloMotor::wanted() noexcept {
  const Target target = resolved();
  follows_angle_ = needsReference(target.mode);
  return target;
}

Target SoloMotor::resolved() noexcept {
  const FrameKind kind = ordered();
  begins_ = std::exchange(told_, kind) != kind;
  const bool led = kind == FrameKind::kCommand && this->target().mode == ControlMode::kCoast;
  const bool other = std::exchange(led_, led) != led || begins_;
  out_of_turn_ = std::exchange(unsent_, false) || other;
  if (!obeying()) speed_scale_.reset();
  if (kind != FrameKind::kHold) holding_ = false;
  if (kind == FrameKind::kBrake) return Target{.mode = ControlMode::kBrake};
  if (kind == FrameKind::kHold) {
    if (feedback_.samples == 0) return Target{};
    if (!holding_) hold_deg_ = feedback_.total_angle_deg;
    holding_ = true;
    return holdInForce(hold_deg_);
  }
  if (kind != FrameKind::kCommand) return Target{};
  Target target = targetInForce();
  if (target.mode == ControlMode::kAngle) {
    target.mode = ControlMode::kTotalAngle;
    target.value = feedback_.total_angle_deg + shortestAngle(feedback_.total_angle_deg, target.value);
  }
  return target;
}

double SoloMotor::reportable(float limit_a) const noexcept {
  return static_cast<double>(traits_.signed_a > 0.0F ? std::min(limit_a, traits_.signed_a) : limit_a);
}

bool SoloMotor::currentAtLimit(double count_a) const noexcept {
  return currentAtLimit(reportable(effortLimit()), count_a);
}

bool SoloMotor::ownLoopAtLimit(double count_a) const noexcept {
  return own_limit_a_ > 0.0F && currentAtLimit(reportable(own_limit_a_), count_a);
}

bool SoloMotor::currentAtLimit(double limit_a, double count_a) const noexcept {
  const double margin_a = std::max(count_a, kCurrentErrorShare * limit_a);
  return std::abs(static_cast<double>(feedback_.current_a)) >= limit_a - margin_a;
}

double SoloMotor::currentWithinLimit(const Target& target) noexcept {
  const auto limit_a = static_cast<double>(effortLimit());
  double wanted_a = target.mode == ControlMode::kCurrent ? finiteOr0(target.value) : 0.0;
  // In double, where neither the quotient nor the sum of two floats overflows.
  if (torqueNmPerA() > 0.0F) {
    wanted_a += static_cast<double>(target.torque_ff_nm) / static_cast<double>(torqueNmPerA());
  }
  const double current_a = std::clamp(wanted_a, -limit_a, limit_a);
  if (current_a != wanted_a) limits_ |= kLimitCurrent;
  return current_a;
}

double SoloMotor::torqueWithinLimit(double nm) noexcept {
  const double limit_nm = torqueLimitNm();
  if (std::abs(nm) > limit_nm) limits_ |= kLimitCurrent;
  return std::isnan(nm) ? 0.0 : std::clamp(nm, -limit_nm, limit_nm);
}

double SoloMotor::rpmWithinLimit(double output_rpm) noexcept {
  return rpmWithinLimit(output_rpm, std::numeric_limits<double>::infinity());
}

double SoloMotor::rpmWithinLimit(double output_rpm, double drive_limit_rpm) noexcept {
  const double wanted_rpm = finiteOr0(output_rpm);
  const auto own_limit_rpm = static_cast<double>(velocityLimitRpm());
  const double limit_rpm = own_limit_rpm > 0.0 ? std::min(own_limit_rpm, drive_limit_rpm) : drive_limit_rpm;
  const double rpm = std::clamp(wanted_rpm, -limit_rpm, limit_rpm);
  if (rpm != wanted_rpm) limits_ |= kLimitVelocity;
  return rpm;
}

// The first frame of another order does not wait for its turn: an e-stop, the end of a target, also in a
// ramp. Nor does the frame after one that was not sent.
bool SoloMotor::due(const Tick& tick) const noexcept {
  return out_of_turn_ || tick.index % divider_ == phase_ % divider_;
}

}  // namespace rc10
