#include "drives/dji/dji_motor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/angle.hpp"
#include "app/units.hpp"
#include "drives/dji/dji_frames.hpp"

namespace rc10 {
namespace {

// Host loops must not act on old feedback even if nobody else notices. Far above any spacing that
// the supervisor accepts as fresh.
constexpr float kLongestSilenceSeconds = 0.1F;

bool isAngle(ControlMode mode) noexcept {
  return mode == ControlMode::kAngle || mode == ControlMode::kTotalAngle;
}

}  // namespace

DJI_Motor::DJI_Motor(const MotorSettings& settings, const DjiModel& model)
    : Motor_Base(settings.name),
      model_(&model),
      id_(settings.id),
      command_(djiSettings(settings.own).command),
      gear_ratio_(gearRatioOf(settings, *model_)),
      direction_(settings.direction < 0 ? -1 : 1),
      effort_limit_(effortLimitOf(settings, table().full_scale)),
      absolute_(model_->absolute_output && gear_ratio_ == model_->gear_ratio),
      zero_at_power_on_(settings.zero_at_power_on),
      zero_deg_(settings.zero_deg),
      travel_(settings.travel),
      filters_{FrameFilter{.id = djiFeedbackId(*model_, id_), .mask = kStandardIdMask}},
      encoder_(model_->encoder),
      loops_(settings.loops),
      spacing_(std::chrono::milliseconds{1}),
      degrees_per_count_(direction_ * kDegPerTurn / (dji::kCountsPerTurn * gear_ratio_)),
      rpm_per_raw_(static_cast<float>(direction_ / gear_ratio_)),
      amperes_per_raw_(static_cast<float>(direction_) * model_->feedback_full_scale_a /
                       static_cast<float>(model_->feedback_raw_full_scale)),
      torque_nm_per_a_(model_->rotor_torque_nm_per_a * static_cast<float>(gear_ratio_)),
      raw_per_effort_(static_cast<float>(direction_ * table().raw_full_scale) / table().full_scale),
      raw_full_scale_(static_cast<float>(table().raw_full_scale)),
      damping_a_per_rpm_(command_ == DjiCommand::kCurrent
                             ? table().full_scale * static_cast<float>(gear_ratio_ / model_->gear_ratio) /
                                   model_->no_load_rpm
                             : 0.0F) {
  command_unit_ = command_ == DjiCommand::kCurrent ? CommandUnit::kAmpere : CommandUnit::kVolt;
}

bool DJI_Motor::matchesFrame(const CanFrame& frame) const noexcept {
  return frame.id == filters_[0].id && !frame.fd && frame.type != FrameType::kError;
}

FrameVerdict DJI_Motor::updateFeedback(const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.fd || frame.length != dji::kLength) {
    return FrameVerdict::kMalformed;
  }
  const auto told = dji::decodeFeedback(frame.payload());
  if (!encoder_.update(told.encoder, told.rotor_rpm, frame.received)) return FrameVerdict::kMalformed;

  const bool first = feedback_.samples == 0;
  spacing_.add(first ? Duration{0} : frame.received - feedback_.received);
  feedback_.received = frame.received;
  ++feedback_.samples;
  feedback_.jumps = encoder_.jumps();
  feedback_.velocity_rpm = static_cast<float>(told.rotor_rpm) * rpm_per_raw_;
  feedback_.current_a = static_cast<float>(told.current_raw) * amperes_per_raw_;
  feedback_.torque_nm = feedback_.current_a * torque_nm_per_a_;
  if (model_->reports_temperature) feedback_.temperature_c = static_cast<float>(told.temperature_c);

  if (first) {
    if (absolute_ && !zero_at_power_on_) {
      findTurn(shortestAngle(zero_deg_, reportedAngleDeg()), 0.0);
    } else {
      setReference(0.0);
      feedback_.zeroed = zero_at_power_on_;
    }
  }
  if (encoder_.referenceLost()) {
    if (feedback_.zeroed) ++feedback_.losses;
    feedback_.zeroed = false;
  }
  updateAngles();
  // Turned by hand to where its turn is clear.
  if (!first && feedback_.turn_unclear && dutyOf(ordered()) != DriveDuty::kObey) {
    findTurn(feedback_.total_angle_deg, feedback_.total_angle_deg);
    updateAngles();
  }
  return FrameVerdict::kAccepted;
}

void DJI_Motor::findTurn(double angle_deg, double near_deg) noexcept {
  const auto first_deg = firstAngle(angle_deg, travel_, near_deg);
  setReference(first_deg.value_or(angle_deg));
  feedback_.zeroed = first_deg.has_value();
  feedback_.turn_unclear = !first_deg;
}

void DJI_Motor::setReference(double total_angle_deg) noexcept {
  reference_counts_ = encoder_.totalCounts();
  reference_deg_ = total_angle_deg;
}

void DJI_Motor::updateAngles() noexcept {
  // Counts are subtracted as integers: in double the result is exact up to 2^53 counts.
  const auto counts = static_cast<double>(encoder_.totalCounts() - reference_counts_);
  feedback_.total_angle_deg = reference_deg_ + counts * degrees_per_count_;
  feedback_.angle_deg = wrapDegreesToFloat(feedback_.total_angle_deg);
}

bool DJI_Motor::setZero(double angle_deg) noexcept {
  if (feedback_.samples == 0 || !std::isfinite(angle_deg)) return false;
  const double before_deg = feedback_.total_angle_deg;
  setReference(angle_deg);
  encoder_.acknowledgeLoss();
  forgotten_ = false;
  feedback_.zeroed = true;
  feedback_.turn_unclear = false;
  updateAngles();
  loops_.reset();
  hold_deg_ += feedback_.total_angle_deg - before_deg;  // a load that is held stays where it is
  return true;
}

// A place that it was pushed away from is let go, too.
void DJI_Motor::dropWindup(float least_rpm) noexcept {
  if (!loops_.dropWindup(command_value_, feedback_.velocity_rpm, least_rpm)) return;
  command_value_ = 0.0F;
  holding_ = false;
}

double DJI_Motor::zeroForFile() const noexcept {
  if (!absolute_ || zero_at_power_on_ || feedback_.samples == 0)
    return std::numeric_limits<double>::quiet_NaN();
  return shortestAngle(feedback_.total_angle_deg, reportedAngleDeg());
}

void DJI_Motor::forgetReference() noexcept {
  forgotten_ = true;
  feedback_.zeroed = false;
  feedback_.turn_unclear = false;
  holding_ = false;
}

void DJI_Motor::restoreReference(ControlMode followed) noexcept {
  // Without a travel its turn is that of before: no jump.
  const bool would_jump = isAngle(followed) && travel_.bothEnds();
  const bool tells_it = absolute_ && !zero_at_power_on_;
  if (!tells_it || forgotten_ || !encoder_.referenceLost() || would_jump) return;
  findTurn(feedback_.total_angle_deg, feedback_.total_angle_deg);
  encoder_.acknowledgeLoss();
  updateAngles();
}

// Host loops must not act on old feedback.
bool DJI_Motor::silent() const noexcept {
  return feedback_.samples == 0 || silence_s_ > kLongestSilenceSeconds;
}

Target DJI_Motor::damped() const noexcept {
  const auto mode = command_ == DjiCommand::kCurrent ? ControlMode::kCurrent : ControlMode::kVoltage;
  const float effort = silent() ? 0.0F : -feedback_.velocity_rpm * damping_a_per_rpm_;
  return Target{.mode = mode, .value = static_cast<double>(effort)};
}

Target DJI_Motor::held() noexcept {
  if (feedback_.samples == 0) return Target{};
  // Where it is now, if turns may have gone uncounted: never back by a turn.
  if (!holding_ || encoder_.losses() != hold_losses_) hold_deg_ = feedback_.total_angle_deg;
  hold_losses_ = encoder_.losses();
  holding_ = true;
  return holdInForce(hold_deg_);
}

const Target& DJI_Motor::wantedTarget() noexcept {
  const FrameKind kind = ordered();
  if (kind != FrameKind::kHold) holding_ = false;
  switch (kind) {
    case FrameKind::kCommand:
      if (targetInForce().mode != ControlMode::kBrake) return targetInForce();
      own_ = Target{.mode = ControlMode::kVelocity};
      break;
    case FrameKind::kDamp: own_ = damped(); break;
    case FrameKind::kBrake: own_ = Target{.mode = ControlMode::kVelocity}; break;
    case FrameKind::kHold: own_ = held(); break;
    default: own_ = Target{}; break;
  }
  return own_;
}

void DJI_Motor::update(const Tick& tick) noexcept {
  const float sample_dt_s = spacing_.take();
  silence_s_ = sample_dt_s > 0.0F ? 0.0F : std::min(silence_s_ + tick.dt_s, 1.0F);
  limits_ = 0;
  const Target& wanted = wantedTarget();
  if (encoder_.referenceLost()) restoreReference(wanted.mode);
  const float limit = effort_limit_ * derating();

  switch (wanted.mode) {
    case ControlMode::kCurrent:
    case ControlMode::kVoltage: {
      loops_.reset();
      const float ff = command_ == DjiCommand::kCurrent ? wanted.torque_ff_nm / torque_nm_per_a_ : 0.0F;
      const float effort = saturate(nearFloat(wanted.value)) + saturate(ff);
      command_value_ = std::clamp(effort, -limit, limit);
      if (command_value_ != effort) limits_ |= kLimitCurrent;
      break;
    }
    case ControlMode::kVelocity:
    case ControlMode::kAngle:
    case ControlMode::kTotalAngle: runLoops(wanted, sample_dt_s, limit); break;
    default: releaseEffort(); break;
  }
}

void DJI_Motor::runLoops(const Target& target, float sample_dt_s, float limit) noexcept {
  if (silent()) {
    releaseEffort();
    return;
  }
  if (sample_dt_s > 0.0F) {
    const Cascade::Measured measured{.angle_deg = feedback_.angle_deg,
                                     .total_angle_deg = feedback_.total_angle_deg,
                                     .velocity_rpm = feedback_.velocity_rpm};
    const float ff = command_ == DjiCommand::kCurrent ? target.torque_ff_nm / torque_nm_per_a_ : 0.0F;
    command_value_ = loops_.step(target, measured, sample_dt_s, limit, command_value_, saturate(ff));
  } else {  // the limit may have come down since the last sample
    command_value_ = std::clamp(command_value_, -limit, limit);
  }
  if (loops_.effortLimited()) limits_ |= kLimitCurrent;
  if (loops_.velocityLimited()) limits_ |= kLimitVelocity;
}

void DJI_Motor::releaseEffort() noexcept {
  loops_.reset();
  command_value_ = 0.0F;
}

ModeSet DJI_Motor::modes() const noexcept {
  const auto direct = command_ == DjiCommand::kCurrent ? ControlMode::kCurrent : ControlMode::kVoltage;
  return ModeSet{ControlMode::kCoast,      direct,
                 ControlMode::kVelocity,   ControlMode::kAngle,
                 ControlMode::kTotalAngle, ControlMode::kBrake};
}

const DriveFrames& DJI_Motor::driveFrames() const noexcept { return kDjiFrames; }

CanId DJI_Motor::commandId() const noexcept { return djiCommandId(*model_, command_, id_); }

std::int16_t DJI_Motor::rawCommand() const noexcept {
  const float raw = std::clamp(command_value_ * raw_per_effort_, -raw_full_scale_, raw_full_scale_);
  return static_cast<std::int16_t>(raw + (raw < 0.0F ? -0.5F : 0.5F));
}

}  // namespace rc10
