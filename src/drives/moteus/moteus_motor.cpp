#include "drives/moteus/moteus_motor.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "app/limits.hpp"
#include "app/units.hpp"

namespace rc10 {
namespace {

// Version that this driver was written for; the drive counts it up when a register changes its meaning.
// Source: fw/moteus_controller.cc, kRegisterMapVersion.
constexpr double kRegisterMapVersion = 5.0;

constexpr double kFarthestRev = 32000.0;  // from where it is
// The firmware's own servo.max_velocity.
constexpr double kFastestRevPerS = 500.0;

// In velocity mode the drive's controller holds the shaft to a moving point. The point stays this near: a
// shaft that was held up would race after it. Half a turn is 2 N·m with the vendor's gain of 4 N·m/rev.
constexpr double kSlipRev = 0.5;

constexpr Duration kMoteusStepPatience = std::chrono::milliseconds{250};  // repeated in each tick
constexpr Duration kFresh = std::chrono::milliseconds{100};

void askForReadings(moteus::Writer& writer) noexcept {
  writer.read(moteus::Type::kInt8, moteus::Register::kMode)
      .read(moteus::Type::kFloat, moteus::Register::kPosition, 3)
      .read(moteus::Type::kInt16, moteus::Register::kQCurrent)
      .read(moteus::Type::kInt8, moteus::Register::kVoltage, 3)
      .read(moteus::Type::kInt16, moteus::Register::kMilliseconds);
}

}  // namespace

Moteus_Motor::Moteus_Motor(const MotorSettings& settings, const MotorTraits& traits)
    : SoloMotor(settings, traits, driveTurns(settings, traits)),
      own_(moteusSettings(settings.own)),
      filters_{FrameFilter{.id = moteus::replyId(own_.can_prefix, static_cast<std::uint32_t>(settings.id))}},
      command_ids_{moteus::queryId(own_.can_prefix, static_cast<std::uint32_t>(settings.id))},
      watchdog_s_(static_cast<double>(own_.watchdog_ms) * 1e-3),
      slip_s_(0.002 + 2.0 * static_cast<double>(std::max(settings.command_divider, 1)) *
                          static_cast<double>(seconds(tickPeriod()))) {}

bool Moteus_Motor::matchesFrame(const CanFrame& frame) const noexcept {
  return frame.type == FrameType::kData && frame.id == filters_[0].id;
}

// ---- Command

void Moteus_Motor::update(const Tick& tick) noexcept {
  limits_ = mode_ == moteus::Mode::kFault ? 0 : moteusLimit(native_fault_);
  const Target target = wanted();
  const FrameKind kind = ordered();
  if (!enabling()) step_ = Step::kNone;
  if (kind != FrameKind::kCommand || target.mode != ControlMode::kVelocity) course_rev_.reset();
  setCommand(0.0, CommandUnit::kNone);
  if (enabling()) return runEnabling(tick);
  if (!obeying()) {
    engaged_ = false;
    lost_ = {};
    send_ = kind == FrameKind::kPoll ? restSend(tick) : Send::kStop;
    return;
  }
  if (!engaged_) {  // nothing but the sequence switches it on
    if (complaint().fault == FaultCode::kNone) {
      lost_ = {FaultCode::kDriveStopped, static_cast<std::uint32_t>(mode_)};
    }
    send_ = restSend(tick);
    return;
  }
  release();
  if (kind == FrameKind::kDamp) {
    motion_.damped = true;
  } else {
    follow(target, tick);
  }
}

// A stop clears faults: a drive with a fault, hence without torque, gets questions until clearComplaint().
Moteus_Motor::Send Moteus_Motor::restSend(const Tick& tick) const noexcept {
  const Duration fresh =
      std::max(kFresh, std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.5 * slip_s_)));
  const bool faulted =
      mode_ == moteus::Mode::kFault && answered_.has_value() && tick.now - *answered_ <= fresh;
  return faulted && !clearing_ ? Send::kQuery : Send::kStop;
}

/// Position mode without any torque. Its controller stays where the shaft is, so that the next target begins
/// there.
void Moteus_Motor::release() noexcept {
  send_ = Send::kMotion;
  motion_ = {};
  if (feedback_.samples > 0) motion_.position_rev = onWire(position_rev_);
  setCommand(0.0, CommandUnit::kAmpere);
}

void Moteus_Motor::follow(const Target& target, const Tick& tick) noexcept {
  if (target.mode == ControlMode::kBrake) {
    send_ = Send::kBrake;
    setCommand(0.0, CommandUnit::kNone);
    return;
  }
  if (feedback_.samples == 0 || std::isnan(target.value)) return;
  switch (target.mode) {
    case ControlMode::kCurrent: return followCurrent(target);
    case ControlMode::kVelocity: return followVelocity(target, tick);
    case ControlMode::kTotalAngle: return followAngle(target);
    default: return;
  }
}

double Moteus_Motor::boundedRpm(double rpm) noexcept {
  return rpmWithinLimit(rpm, std::abs(toOutput(kFastestRevPerS * kRpmPerTurnPerS)));
}

double Moteus_Motor::onWire(double position_rev) noexcept {
  const double away_rev = position_rev - position_rev_;
  if (!(std::abs(away_rev) <= kFarthestRev)) limits_ |= kLimitAngle;
  const double bounded_rev = position_rev_ + finiteOr0(std::clamp(away_rev, -kFarthestRev, kFarthestRev));
  return std::remainder(bounded_rev - wire_rev_, kRangeRev);
}

// Not the drive's current mode: its watchdog acts in position mode alone (fw/bldc_servo_control.h).
void Moteus_Motor::followCurrent(const Target& target) noexcept {
  const auto limit_a = static_cast<double>(effortLimit());
  const double wanted_a = std::clamp(target.value, -limit_a, limit_a);
  if (std::abs(target.value) > limit_a) limits_ |= kLimitCurrent;
  const auto nm_per_a = static_cast<double>(torqueNmPerA());
  const double torque_nm = torqueWithinLimit(wanted_a * nm_per_a + static_cast<double>(target.torque_ff_nm));
  motion_.torque_nm = torqueToDrive(torque_nm);
  setCommand(nm_per_a > 0.0 ? torque_nm / nm_per_a : 0.0, CommandUnit::kAmpere);
}

void Moteus_Motor::followVelocity(const Target& target, const Tick& tick) noexcept {
  const double rpm = boundedRpm(target.value);
  const double rev_s = toDrive(rpm) / kRpmPerTurnPerS;
  const double dt_s = std::clamp(static_cast<double>(tick.dt_s), 0.0, 0.01);
  double ahead_rev = course_rev_ ? *course_rev_ + rev_s * dt_s - position_rev_ : 0.0;
  const float rpm_before = std::exchange(last_rpm_, feedback_.velocity_rpm);
  const bool beyond =
      toOutput(ahead_rev) > 0.0 ? last_rpm_ > speedBounds().high : last_rpm_ < speedBounds().low;
  if (beyond && std::fabs(last_rpm_) > std::fabs(rpm_before)) ahead_rev *= 0.5;
  const double slip_rev = kSlipRev + std::abs(rev_s) * slip_s_;
  course_rev_ = position_rev_ + std::clamp(ahead_rev, -slip_rev, slip_rev);
  motion_.position_rev = onWire(*course_rev_);
  motion_.velocity_rev_s = rev_s;
  motion_.torque_nm = torqueToDrive(torqueWithinLimit(static_cast<double>(target.torque_ff_nm)));
  motion_.stiff = motion_.damped = true;
  setCommand(rpm, CommandUnit::kNative);
}

void Moteus_Motor::dropWindup(float least_rpm) noexcept {
  const auto asked_rpm = static_cast<double>(commandValue());
  const double along_rpm = std::copysign(1.0, asked_rpm) * static_cast<double>(feedback_.velocity_rpm);
  const bool asked = std::fabs(asked_rpm) > static_cast<double>(least_rpm);
  if (asked && !(along_rpm >= 0.5 * std::fabs(asked_rpm))) course_rev_.reset();
}

void Moteus_Motor::followAngle(const Target& target) noexcept {
  const double position_rev = drivePositionFor(target.value) / kDegPerTurn;
  motion_.position_rev = onWire(position_rev);
  motion_.velocity_rev_s = toDrive(boundedRpm(static_cast<double>(target.velocity_ff_rpm))) / kRpmPerTurnPerS;
  motion_.torque_nm = torqueToDrive(torqueWithinLimit(static_cast<double>(target.torque_ff_nm)));
  motion_.stiff = motion_.damped = motion_.profile = true;
  motion_.limit_rev_s = std::abs(toDrive(static_cast<double>(velocityLimitRpm()))) / kRpmPerTurnPerS;
  const double away_rev = position_rev - position_rev_;
  const double told_rev = std::clamp(away_rev, -kFarthestRev, kFarthestRev);
  setCommand(
      told_rev == away_rev ? target.value : feedback_.total_angle_deg + toOutput(told_rev * kDegPerTurn),
      CommandUnit::kNative);
}

// ---- Packing

moteus::Writer Moteus_Motor::writer() const noexcept { return {command_ids_[0], own_.bit_rate_switch}; }

CanFrame Moteus_Motor::motionFrame() const noexcept {
  using enum moteus::Register;
  moteus::Writer frame = writer();
  frame.write(moteus::Type::kInt8, kMode, {static_cast<double>(moteus::Mode::kPosition)})
      .write(moteus::Type::kFloat, kCommandPosition,
             {motion_.position_rev, motion_.velocity_rev_s, motion_.torque_nm});
  if (!motion_.stiff) {
    // The documents let the position gain bound the velocity gain; the firmware does not (fw/pid.h).
    frame.write(moteus::Type::kInt8, kKpScale, {0.0, motion_.damped ? 1.0 : 0.0})
        .write(moteus::Type::kInt8, kIlimitScale, {0.0});
  }
  frame.write(moteus::Type::kFloat, kMaxTorque, {driveTorqueLimitNm()})
      .write(moteus::Type::kInt16, kTimeout, {watchdog_s_});
  // Negative: without limits, position and velocity act at once. Not written: as configured in the drive.
  if (!motion_.profile) {
    frame.write(moteus::Type::kInt8, kVelocityLimit, {-1.0, -1.0});
  } else if (motion_.limit_rev_s > 0.0) {
    frame.write(moteus::Type::kFloat, kVelocityLimit, {motion_.limit_rev_s});
  }
  askForReadings(frame);
  return frame.frame();
}

std::size_t Moteus_Motor::packCommand(const Tick& tick, std::span<CanFrame> out) noexcept {
  if (out.empty() || (!enabling() && !due(tick))) return 0;
  const auto mode = [this](moteus::Mode value) {
    moteus::Writer frame = writer();
    frame.write(moteus::Type::kInt8, moteus::Register::kMode, {static_cast<double>(value)});
    askForReadings(frame);
    return frame;
  };
  switch (send_) {
    case Send::kStop: out[0] = mode(moteus::Mode::kStopped).frame(); break;
    case Send::kBrake: out[0] = mode(moteus::Mode::kBrake).frame(); break;
    case Send::kMotion: out[0] = motionFrame(); break;
    case Send::kIdentify:
      out[0] = mode(moteus::Mode::kStopped)
                   .read(moteus::Type::kInt32, moteus::Register::kRegisterMapVersion)
                   .read(moteus::Type::kInt8, moteus::Register::kHomeState)
                   .frame();
      break;
    case Send::kQuery:
    case Send::kVerify: {
      moteus::Writer frame = writer();
      askForReadings(frame);
      if (send_ == Send::kVerify) frame.read(moteus::Type::kInt16, moteus::Register::kTimeout);
      out[0] = frame.frame();
      break;
    }
  }
  return 1;
}

std::size_t Moteus_Motor::packRest(std::span<CanFrame> out) const noexcept {
  if (out.empty()) return 0;
  out[0] =
      writer()
          .write(moteus::Type::kInt8, moteus::Register::kMode, {static_cast<double>(moteus::Mode::kStopped)})
          .frame();
  return 1;
}

// ---- Enabling

void Moteus_Motor::enter(Step step, const Tick& tick) noexcept {
  step_ = step;
  step_began_ = tick.now;
}

void Moteus_Motor::fail(FaultCode why, std::uint32_t native) noexcept {
  step_ = Step::kFailed;
  refused_ = {why, native};
}

// No EnableSequence: every frame is a question, so only time ends a step.
void Moteus_Motor::runEnabling(const Tick& tick) noexcept {
  if (step_ == Step::kNone) {
    engaged_ = false;
    lost_ = {};
    refused_ = {};
    identity_.reset();
    verified_s_.reset();
    enter(Step::kIdentify, tick);
  }
  const bool busy = step_ != Step::kDone && step_ != Step::kFailed;
  if (busy && (mode_ == moteus::Mode::kFault || tick.now - step_began_ > kMoteusStepPatience)) {
    fail(FaultCode::kNone, 0);
  }
  if (step_ == Step::kDone && !engaged_) step_ = Step::kFailed;
  if (step_ == Step::kIdentify && identity_) {
    // 1: its rotor is known, 2: its output is. Behind a gear the rotor says little of the output.
    const double needed = own_.rotor_to_output_ratio == 1.0 ? 1.0 : 2.0;
    if (identity_->version != kRegisterMapVersion) {
      fail(FaultCode::kDriveSetting, static_cast<std::uint32_t>(std::max(identity_->version, 0.0)));
    } else if (traits().absolute && !(identity_->home_state >= needed)) {
      fail(FaultCode::kDriveSetting, static_cast<std::uint32_t>(moteus::Register::kHomeState));
    } else if (mode_ == moteus::Mode::kStopped) {
      enter(Step::kEngage, tick);
    }
  }
  if (step_ == Step::kEngage && mode_ == moteus::Mode::kPosition) enter(Step::kVerify, tick);
  if (step_ == Step::kVerify && verified_s_) {
    // The drive truncates its replies: 63 ms are told as 62.
    constexpr double kHalfCountSeconds = 0.0005;
    const double missing_s = watchdog_s_ - *verified_s_;
    if (missing_s > -kHalfCountSeconds && missing_s < 3.0 * kHalfCountSeconds) {
      engaged_ = true;
      enter(Step::kDone, tick);
    } else {
      fail(FaultCode::kDriveSetting, static_cast<std::uint32_t>(moteus::Register::kTimeout));
    }
  }
  release();
  if (step_ == Step::kIdentify) send_ = Send::kIdentify;
  if (step_ == Step::kFailed) send_ = restSend(tick);
  if (step_ == Step::kVerify && tick.index % 2 == 0) send_ = Send::kVerify;  // between: feeds the watchdog
}

SequenceProgress Moteus_Motor::sequenceProgress() const noexcept {
  if (!enabling()) return SequenceProgress::kDone;
  switch (step_) {
    case Step::kDone: return SequenceProgress::kDone;
    case Step::kFailed: return SequenceProgress::kFailed;
    default: return SequenceProgress::kPending;
  }
}

// ---- Complaints

DriveComplaint Moteus_Motor::complaint() const noexcept {
  if (mode_ == moteus::Mode::kFault) return {moteusFault(native_fault_), native_fault_};
  return lost_.fault != FaultCode::kNone ? lost_ : refused_;
}

void Moteus_Motor::clearComplaint() noexcept {
  clearing_ = true;
  refused_ = {};
}

}  // namespace rc10
