#include "drives/vesc/vesc_motor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/angle.hpp"
#include "app/limits.hpp"
#include "app/units.hpp"
#include "drives/vesc/vesc_family.hpp"

namespace rc10 {
namespace {

using std::chrono::milliseconds;

// The stock watchdog of a drive, and a tenth.
constexpr Duration kWatchdogSilence = milliseconds{1100};
constexpr Duration kShortestPatience = milliseconds{100};
constexpr int kPatiencePeriods = 5;
// Electrical: from where the handbrake takes over, and from where it has lost.
constexpr std::int32_t kStillErpm = 150;
constexpr std::int32_t kSlippedErpm = 450;
// SET_POS goes the shortest way round from where the shaft is meanwhile: the drive is told no more than this
// ahead of the last sample, and nothing that may come to lie farther away, with 30 degrees for late samples
// and a speed that changes.
constexpr double kLeadDeg = 90.0;
constexpr double kFarthestDeg = 150.0;
// A shaft that is too fast for it is slowed to the speed of this way: a lead against it is near enough then.
constexpr double kSlowEnoughDeg = 30.0;

std::array<FrameFilter, 8> filtersOf(int id, const VescSettings& own) {
  const auto exactly = [id](vesc::Packet packet) { return FrameFilter{.id = vesc::canId(packet, id)}; };
  return {exactly(vesc::Packet::kStatus1), exactly(vesc::Packet::kStatus2), exactly(vesc::Packet::kStatus3),
          exactly(vesc::Packet::kStatus4), exactly(vesc::Packet::kStatus5), exactly(vesc::Packet::kStatus6),
          exactly(vesc::Packet::kNotifyBoot),
          // Every drive answers to the one host id, with its own in the first byte.
          FrameFilter{.id = vesc::canId(vesc::Packet::kProcessShortBuffer, own.host_id),
                      .discriminators = {PayloadDiscriminator{
                          .byte_index = 0, .mask = 0xFF, .value = static_cast<std::uint8_t>(id)}}}};
}

std::array<CanId, 10> commandIdsOf(int id) {
  return {vesc::canId(vesc::Packet::kSetCurrent, id),
          vesc::canId(vesc::Packet::kSetDuty, id),
          vesc::canId(vesc::Packet::kSetCurrentBrake, id),
          vesc::canId(vesc::Packet::kSetErpm, id),
          vesc::canId(vesc::Packet::kSetPosition, id),
          vesc::canId(vesc::Packet::kSetCurrentRelative, id),
          vesc::canId(vesc::Packet::kSetCurrentBrakeRelative, id),
          vesc::canId(vesc::Packet::kSetHandbrake, id),
          vesc::canId(vesc::Packet::kSetHandbrakeRelative, id),
          vesc::canId(vesc::Packet::kProcessShortBuffer, id)};
}

/// With a divider the drive's position loop counts turns of what stands behind that gear.
double reportedTurns(const MotorSettings& settings, const VescSettings& own) {
  const double gear = gearRatioOf(settings, vescTraits(own));
  return own.angle == VescAngle::kEncoder ? gear / own.position_divider : gear;
}

}  // namespace

VESC_Motor::VESC_Motor(const MotorSettings& settings)
    : SoloMotor(settings, vescTraits(vescSettings(settings.own)),
                reportedTurns(settings, vescSettings(settings.own))),
      own_(vescSettings(settings.own)),
      id_(settings.id),
      rotor_per_output_(get_GearRatio() * static_cast<double>(direction())),
      patience_(std::max(kShortestPatience, kPatiencePeriods * feedbackPeriod())),
      filters_(filtersOf(settings.id, own_)),
      command_ids_(commandIdsOf(settings.id)),
      inquiry_(kWatchdogSilence),
      loops_(settings.loops),
      angle_loop_(loops_.angle),
      spacing_(feedbackPeriod()) {}

void VESC_Motor::retune(const CascadeConfig& loops) noexcept {
  loops_ = loops;
  angle_loop_.retune(loops.angle);
}

bool VESC_Motor::setZero(double angle_deg) noexcept {
  looping_ = false;
  return SoloMotor::setZero(angle_deg);
}

// ---- Command

bool VESC_Motor::silent() const noexcept {
  return feedback_.samples == 0 || now_ - feedback_.received > patience_;
}

void VESC_Motor::update(const Tick& tick) noexcept {
  now_ = tick.now;
  limits_ = 0;
  const FrameKind kind = ordered();
  if (!obeying()) restarted_ = false;
  if (own_.ask_status) inquiry_.update(tick, kind);

  const Target target = wanted();
  const bool loops = own_.angle == VescAngle::kTachometer && (target.mode == ControlMode::kTotalAngle) &&
                     kind != FrameKind::kDamp;
  if (!loops || begins()) looping_ = false;
  const bool brakes = target.mode == ControlMode::kBrake || kind == FrameKind::kHold ||
                      (target.mode == ControlMode::kVelocity && own_.velocity_zero == VescStop::kBrake);
  if (!brakes) locked_ = false;

  if (kind == FrameKind::kDamp) {
    damp();
  } else if (kind == FrameKind::kHold && own_.angle == VescAngle::kNone) {
    brake();
  } else {
    follow(target);
  }
}

void VESC_Motor::follow(const Target& target) noexcept {
  // Too hot for any current: the drive's own loops cannot be given less.
  if (!(effortLimit() > 0.0F) && target.mode != ControlMode::kCoast) {
    limits_ |= kLimitCurrent;
    release();
    return;
  }
  switch (target.mode) {
    case ControlMode::kCurrent: followCurrent(target); return;
    case ControlMode::kVelocity: followVelocity(target); return;
    case ControlMode::kTotalAngle: followAngle(target); return;
    case ControlMode::kDuty: followDuty(target.value); return;
    case ControlMode::kBrake: brake(); return;
    default: release(); return;
  }
}

void VESC_Motor::release() noexcept {
  command_ = Command{};
  setCommand(0.0, CommandUnit::kAmpere);
}

VESC_Motor::Command VESC_Motor::currentCommand(vesc::Packet absolute, vesc::Packet relative,
                                               double drive_a) const noexcept {
  if (!own_.relative_current) return {absolute, vesc::toRaw(drive_a, vesc::kPerAmpere)};
  const double share = std::clamp(drive_a / static_cast<double>(own_.motor_current_max_a), -1.0, 1.0);
  return {relative, vesc::toRaw(share, vesc::kPerShare)};
}

void VESC_Motor::followCurrent(const Target& target) noexcept {
  if (!std::isfinite(target.value)) {
    release();
    return;
  }
  const double bounded = currentWithinLimit(target);
  command_ = currentCommand(vesc::Packet::kSetCurrent, vesc::Packet::kSetCurrentRelative,
                            bounded * static_cast<double>(direction()));
  setCommand(bounded, CommandUnit::kAmpere);
}

// The drive's loops know nothing of current_limit_a.
void VESC_Motor::seeOwnLimit() noexcept {
  if (ownLoopAtLimit(vesc::kAmperesPerCount)) limits_ |= kLimitCurrent;
}

void VESC_Motor::setVelocity(double rpm) noexcept {
  if (!std::isfinite(rpm)) {
    release();
    return;
  }
  const double raw_per_rpm = rotor_per_output_ * own_.pole_pairs * vesc::kPerErpm;
  const double bounded =
      rpmWithinLimit(rpm, std::numeric_limits<std::int32_t>::max() / std::abs(raw_per_rpm));
  seeOwnLimit();
  command_ = {vesc::Packet::kSetErpm,
              vesc::toRaw(bounded * rotor_per_output_ * own_.pole_pairs, vesc::kPerErpm)};
  setCommand(bounded, CommandUnit::kNative);
}

void VESC_Motor::followDuty(double duty) noexcept {
  if (!std::isfinite(duty)) {
    release();
    return;
  }
  seeOwnLimit();
  const double bounded = std::clamp(duty, -1.0, 1.0);
  command_ = {vesc::Packet::kSetDuty,
              vesc::toRaw(bounded * static_cast<double>(direction()), vesc::kPerShare)};
  setCommand(bounded, CommandUnit::kNative);
}

void VESC_Motor::followVelocity(const Target& target) noexcept {
  const double rpm = target.value;
  setVelocity(rpm);
  if (command_.packet != vesc::Packet::kSetErpm || command_.raw != 0) {
    locked_ = false;
    return;
  }
  if (own_.velocity_zero == VescStop::kCoast) release();
  if (own_.velocity_zero == VescStop::kBrake) brake();
}

void VESC_Motor::followAngle(const Target& target) noexcept {
  if (silent() || !std::isfinite(target.value)) {
    looping_ = false;
    release();
    return;
  }
  if (own_.angle == VescAngle::kEncoder) {
    setPosition(target.value);
    return;
  }
  const float dt_s = spacing_.take();
  const float ff = saturate(target.velocity_ff_rpm);
  if (!looping_) {
    angle_loop_.reset();
    loop_position_deg_ = feedback_.total_angle_deg;
  }
  if (!looping_ || dt_s > 0.0F) {
    const float error = nearFloat(target.value - feedback_.total_angle_deg);
    const float moved = nearFloat(feedback_.total_angle_deg - loop_position_deg_);
    loop_position_deg_ = feedback_.total_angle_deg;
    const float step_s = dt_s > 0.0F ? dt_s : spacing_.periodSeconds();
    const OutputRange limit = OutputRange{}.within(velocityLimitRpm());
    const OutputRange range{std::max(limit.low, speedBounds().low), std::min(limit.high, speedBounds().high)};
    const float rpm = angle_loop_.stepError(error, moved, step_s, range.shifted(-ff));
    limited_ = rpm + ff <= range.low || rpm + ff >= range.high;
    const auto stoppable_rpm = static_cast<double>(stoppableRpm(error));
    loop_rpm_ = std::clamp(static_cast<double>(rpm), -stoppable_rpm, stoppable_rpm);
  }
  looping_ = true;
  setVelocity(loop_rpm_ + static_cast<double>(ff));
  if (limited_) limits_ |= kLimitVelocity;
}

/// From this speed the drive's ramp stops the motor within the error, with half of it left for delays.
float VESC_Motor::stoppableRpm(float error_deg) const noexcept {
  const double ramp_rpm_per_s = own_.speed_ramp_erpm_per_s / (own_.pole_pairs * std::abs(rotor_per_output_));
  const double ramp_deg_per_s2 = 0.5 * ramp_rpm_per_s * kDegPerSPerRpm;
  return static_cast<float>(std::sqrt(2.0 * ramp_deg_per_s2 * std::abs(static_cast<double>(error_deg))) /
                            kDegPerSPerRpm);
}

double VESC_Motor::degUntilNextSample() const noexcept {
  const double encoder_rpm = static_cast<double>(status1_.erpm) / own_.pole_pairs / own_.position_divider;
  const Duration until = std::max(now_ - position_at_, feedbackPeriod()) + commandPeriod();
  return encoder_rpm * kDegPerSPerRpm * std::chrono::duration<double>(until).count();
}

void VESC_Motor::setPosition(double total_angle_deg) noexcept {
  const double way = drivePositionFor(total_angle_deg) - position_deg_;
  if (!std::isfinite(way)) {
    release();
    return;
  }
  const double lead_deg = std::clamp(way, -kLeadDeg, kLeadDeg);
  const double passed_deg = degUntilNextSample();
  if (std::abs(lead_deg - passed_deg) > kFarthestDeg) {
    // Not 0: below its minimum ERPM the drive would let go, and a load would go on.
    return setVelocity(static_cast<double>(feedback_.velocity_rpm) * kSlowEnoughDeg / std::abs(passed_deg));
  }
  seeOwnLimit();
  const double next_deg = wrapDegrees(position_deg_ + lead_deg);
  command_ = {vesc::Packet::kSetPosition, vesc::toRaw(next_deg, vesc::kPerDegree)};
  setCommand(lead_deg == way ? total_angle_deg : feedback_.total_angle_deg + toOutput(lead_deg),
             CommandUnit::kNative);
}

/// A brake current in proportion to the speed, as a shorted winding would make it. It never pushes.
void VESC_Motor::damp() noexcept {
  const float speed_rpm = std::abs(feedback_.velocity_rpm);
  const float no_load_rpm = traits().no_load_rpm / static_cast<float>(get_GearRatio());
  if (silent() || !std::isfinite(speed_rpm) || !(no_load_rpm > 0.0F)) {
    release();
    return;
  }
  const double amperes = static_cast<double>(effortLimit() * std::min(speed_rpm / no_load_rpm, 1.0F));
  command_ = currentCommand(vesc::Packet::kSetCurrentBrake, vesc::Packet::kSetCurrentBrakeRelative, amperes);
  setCommand(amperes, CommandUnit::kNative);  // of no direction: no guard may take it for a torque
}

bool VESC_Motor::standsStill() noexcept {
  if (!(own_.handbrake_current_a > 0.0F) || silent() || !status1_seen_) return false;
  const auto erpm = std::abs(static_cast<std::int64_t>(status1_.erpm));
  return erpm <= (locked_ ? kSlippedErpm : kStillErpm);
}

/// A brake current slows down and holds nothing; at standstill the handbrake holds, if there is one.
void VESC_Motor::brake() noexcept {
  locked_ = standsStill();
  const float wanted_a = locked_ ? own_.handbrake_current_a : own_.brake_current_a;
  const double amperes = static_cast<double>(std::min(wanted_a, effortLimit()));
  command_ =
      locked_
          ? currentCommand(vesc::Packet::kSetHandbrake, vesc::Packet::kSetHandbrakeRelative, amperes)
          : currentCommand(vesc::Packet::kSetCurrentBrake, vesc::Packet::kSetCurrentBrakeRelative, amperes);
  setCommand(amperes, CommandUnit::kNative);
}

// ---- Packing

std::size_t VESC_Motor::packCommand(const Tick& tick, std::span<CanFrame> out) noexcept {
  std::size_t count = 0;
  // Asked first: a drive that has timed out says so before the next command reaches it.
  if (own_.ask_status && inquiry_.question() != 0 && count < out.size()) {
    out[count++] = vesc::makeQuestion(id_, own_.host_id, inquiry_.question());
  }
  const bool silence = own_.ask_status && inquiry_.silence();
  if (!silence && due(tick) && count < out.size()) {
    out[count++] = vesc::makeCommand(command_.packet, id_, command_.raw);
    inquiry_.told();
  }
  return count;
}

std::size_t VESC_Motor::packRest(std::span<CanFrame> out) const noexcept {
  if (out.empty()) return 0;
  out[0] = vesc::makeCommand(vesc::Packet::kSetCurrent, id_, 0);
  return 1;
}

// ---- Enabling

SequenceProgress VESC_Motor::sequenceProgress() const noexcept {
  if (!own_.ask_status) return SequenceProgress::kDone;
  if (enabling()) return inquiry_.progress();
  // Told something all the time, it never shows its watchdog.
  return obeying() && !watchdogProven() ? SequenceProgress::kFailed : SequenceProgress::kDone;
}

// ---- Complaints

DriveComplaint VESC_Motor::complaint() const noexcept {
  if (inquiry_.fault() != 0) return {vescFault(inquiry_.fault()), inquiry_.fault()};
  if (!obeying()) return {};
  if (restarted_ || inquiry_.killed()) return {FaultCode::kDriveStopped, 0};
  if (inquiry_.deaf()) return {FaultCode::kDriveCommunication, 0};
  return {};
}

}  // namespace rc10
