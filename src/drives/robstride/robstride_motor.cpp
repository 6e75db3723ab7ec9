#include "drives/robstride/robstride_motor.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "app/units.hpp"
#include "bus/byte_order.hpp"
#include "drives/robstride/robstride_family.hpp"
#include "motor/sample_spacing.hpp"

namespace rc10 {
namespace {

namespace parameter = robstride::parameter;

constexpr std::size_t kLength = 8;

// Between two samples it cannot have moved further than at this multiple of its highest speed, plus what the
// time stamps are wrong by.
constexpr double kJumpFactor = 1.2;
constexpr double kJumpSlackRad = 0.5;
constexpr double kWholeTurnsTolerance = 0.02;  // rad
// Wrap of the position: whole turns, whatever the rounding of full scale.
constexpr double kScaleRad = 4.0 * kRadPerTurn;
// No counted position is so far away.
constexpr double kFarthestCountedRad = 1e5;
// The supply voltage; also the frame whose echo tells that the bus is not stalled.
constexpr Duration kReadPeriod = std::chrono::milliseconds{40};
// A limit that got lost on the way is repeated.
constexpr Duration kLimitPeriod = std::chrono::milliseconds{100};
// A new one at once: a velocity of 0 without the limit of 0 behind it is a brake.
constexpr int kLimitRepeats = 3;
// Gains of a motor for which none are configured: full torque at half a radian and at 5 rad/s. Chosen.
constexpr double kStiffnessPerTorque = 2.0;
constexpr double kDampingPerStiffness = 0.035;
constexpr double kVelocityGainPerTorque = 0.2;

double orDefault(double value, double otherwise) noexcept { return value > 0.0 ? value : otherwise; }

bool allOf(const FrameFilter& filter, const CanFrame& frame) noexcept {
  return frame.id.extended == filter.id.extended &&
         (frame.id.value & filter.mask) == (filter.id.value & filter.mask);
}

FrameFilter fromDrive(robstride::Type type, int data, int addressee) noexcept {
  // Status bits or a result stand in bits 23 to 16.
  return {.id = robstride::canId(type, static_cast<std::uint32_t>(data), addressee), .mask = 0x1F00'FFFFU};
}

}  // namespace

RobstrideControl robstrideControlOf(const OwnValues& own) {
  const std::string text = own.text("control");
  if (text == "current") return RobstrideControl::kCurrent;
  if (text == "velocity") return RobstrideControl::kVelocity;
  if (text == "position") return RobstrideControl::kPosition;
  return RobstrideControl::kOperation;
}

RobStride_Motor::RobStride_Motor(const MotorSettings& settings)
    : SoloMotor(settings, robstrideFamily().traits(settings.model, settings.own),
                driveTurns(settings, robstrideFamily().traits(settings.model, settings.own))),
      model_(findRobstrideModel(settings.model)),
      codec_{.model = model_,
             .position_range_rad =
                 orDefault(settings.own.number("position_range_rad"), model_->position_range_rad),
             .drive_id = settings.id,
             .host_id = settings.own.integer("host_id")},
      control_(robstrideControlOf(settings.own)),
      filters_{fromDrive(robstride::Type::kFeedback, codec_.drive_id, codec_.host_id),
               fromDrive(robstride::Type::kReport, codec_.drive_id, codec_.host_id),
               fromDrive(robstride::Type::kReadParameter, codec_.drive_id, codec_.host_id),
               fromDrive(robstride::Type::kFault, codec_.drive_id, codec_.host_id),
               // The CyberGear's manual has the two ids of a fault frame the other way round.
               fromDrive(robstride::Type::kFault, codec_.host_id, codec_.drive_id)},
      command_ids_{codec_.read(0).id, codec_.write(0, 0.0F).id},
      speed_(model_->velocity_range_rad_s),
      travel_(settings.travel) {
  speedFieldEndsAt(model_->velocity_range_rad_s);
  const double square = ratio() * ratio();
  const double torque = model_->torque_range_nm;
  angle_stiffness_ = settings.own.number("angle_stiffness_nm_per_rad") / square;
  angle_stiffness_ = orDefault(angle_stiffness_, kStiffnessPerTorque * torque);
  angle_damping_ = settings.own.number("angle_damping_nms_per_rad") / square;
  angle_damping_ = orDefault(angle_damping_, std::min(kDampingPerStiffness * kStiffnessPerTorque * torque,
                                                      model_->damping_range_nms_per_rad));
  velocity_gain_ = settings.own.number("velocity_gain_nms_per_rad") / square;
  velocity_gain_ =
      orDefault(velocity_gain_, std::min(kVelocityGainPerTorque * torque, model_->damping_range_nms_per_rad));

  const auto add_run_mode = [this](std::uint8_t mode) {
    enabling_.add({.index = parameter::kRunMode, .bits = mode});
  };
  // No current before the first command: whatever reference the drive still has, it stays where it is.
  RobstrideSetting no_current = RobstrideSetting::limit(parameter::kCurrentLimit, 0.0F);
  no_current.rewritten = true;
  switch (control_) {
    case RobstrideControl::kOperation:
      add_run_mode(static_cast<std::uint8_t>(robstride::RunMode::kOperation));
      enabling_.add(RobstrideSetting::limit(parameter::kTorqueLimit, static_cast<float>(limitNm())));
      break;
    case RobstrideControl::kCurrent:
      add_run_mode(static_cast<std::uint8_t>(robstride::RunMode::kCurrent));
      enabling_.add({.index = parameter::kCurrentRef, .bits = 0, .rewritten = true});
      break;
    case RobstrideControl::kVelocity:
      add_run_mode(static_cast<std::uint8_t>(robstride::RunMode::kVelocity));
      enabling_.add(no_current);
      enabling_.add({.index = parameter::kVelocityRef, .bits = 0, .rewritten = true});
      break;
    case RobstrideControl::kPosition:
      add_run_mode(model_->position_run_mode);
      enabling_.add(no_current);
      enabling_.add(RobstrideSetting::limit(parameter::kVelocityLimit, static_cast<float>(limitRadS())));
      break;
  }
  // Where the scale wraps, the drive's own count of turns may be ahead of ours.
  if (wraps()) enabling_.readPosition();
  const int watchdog_ms = settings.own.integer("watchdog_ms");
  if (watchdog_ms > 0) {
    enabling_.add({.index = model_->watchdog_index,
                   .bits = static_cast<std::uint32_t>(watchdog_ms) * robstride::kTimeoutPerMs});
  }
}

double RobStride_Motor::ratio() const noexcept { return std::abs(toDrive(1.0)); }

double RobStride_Motor::limitNm() const noexcept {
  return std::min(driveTorqueLimitNm(), model_->torque_range_nm);
}

double RobStride_Motor::limitRadS() const noexcept {
  const double own = model_->velocity_range_rad_s;
  const double limit_rpm = static_cast<double>(velocityLimitRpm());
  return limit_rpm > 0.0 ? std::min(limit_rpm * ratio() / kRpmPerRadPerS, own) : own;
}

// Newer firmware goes on from the other end of its scale, two whole turns to each side; what has a scale
// of 12.5 rad is not known to.
bool RobStride_Motor::wraps() const noexcept {
  const double turns = 2.0 * codec_.position_range_rad / kRadPerTurn;
  return std::abs(turns - std::round(turns)) * kRadPerTurn < 2.0 * kWholeTurnsTolerance;
}

double RobStride_Motor::scaleEndRad() const noexcept {
  return wraps() ? std::min(codec_.position_range_rad, kScaleRad / 2) : codec_.position_range_rad;
}

// ---- Feedback

bool RobStride_Motor::matchesFrame(const CanFrame& frame) const noexcept {
  return frame.type != FrameType::kError && !frame.fd &&
         std::any_of(filters_.begin(), filters_.end(),
                     [&frame](const FrameFilter& filter) { return allOf(filter, frame); });
}

FrameVerdict RobStride_Motor::updateFeedback(const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.fd || frame.length != kLength) return FrameVerdict::kMalformed;
  configuring_.onFrame(frame);
  switch (static_cast<robstride::Type>(frame.id.value >> 24U & 0x1FU)) {
    case robstride::Type::kFeedback:
    case robstride::Type::kReport: takeFeedback(codec_.feedback(frame), frame.received); break;
    case robstride::Type::kReadParameter: takeParameter(frame); break;
    case robstride::Type::kFault: fault_word_ = readLittleEndian<std::uint32_t>(frame.payload(), 0); break;
    default: return FrameVerdict::kMalformed;
  }
  return FrameVerdict::kAccepted;
}

void RobStride_Motor::takeFeedback(const robstride::Feedback& seen, MonotonicTime received) noexcept {
  const bool stopped_itself = feedback_.samples > 0 && obeying() && seen_.mode == robstride::kRunning &&
                              seen.mode != robstride::kRunning;
  // A fault stops it where it is. Without one it may have been restarted.
  if (stopped_itself && seen.status_bits == 0 && fault_word_ == 0) doubtAngles();
  if (clear_sent_ && seen.status_bits == 0) {
    clear_sent_ = false;
    fault_word_ = 0;
  }
  trackPosition(seen, received);
  seen_ = seen;
  feedback_.velocity_rpm = static_cast<float>(toOutput(seen.velocity_rad_s * kRpmPerRadPerS));
  feedback_.torque_nm = static_cast<float>(torqueToOutput(seen.torque_nm));
  feedback_.current_a = feedback_.torque_nm / torqueNmPerA();
  feedback_.temperature_c = static_cast<float>(seen.temperature_c);
  acceptSample(received, position_rad_ * kDegPerRad);
  // acceptSample() finds an absolute reference again, even at the end of the scale.
  if (feedback_.angle_at_end) loseReference();
  // followOperation() and followAngle() follow no place until it is enabled anew.
  feedback_.zero_refused = refusesZeros();
  feedback_.bounds_only = feedback_.zeroed && feedback_.zero_refused;
  if (feedback_.bounds_only) feedback_.zeroed = false;
  enabling_.onFeedback(seen);
}

void RobStride_Motor::trackPosition(const robstride::Feedback& seen, MonotonicTime received) noexcept {
  // At its end a scale that does not wrap says no more than that.
  feedback_.angle_at_end = !wraps() && (seen.raw_position == 0 || seen.raw_position == 0xFFFF);
  if (feedback_.samples == 0) {
    position_rad_ = seen.position_rad;
    speed_.add(position_rad_, false, received);
    return;
  }
  double moved = seen.position_rad - seen_.position_rad;
  if (wraps() && moved > kScaleRad / 2) moved -= kScaleRad;
  if (wraps() && moved < -kScaleRad / 2) moved += kScaleRad;
  const Duration gap = std::max(received - feedback_.received, Duration::zero());
  const double reach = kJumpSlackRad + kJumpFactor * model_->velocity_range_rad_s *
                                           static_cast<double>(seconds(longestApart(gap, feedbackPeriod())));
  const bool jumped = std::abs(moved) > reach;
  if (jumped) ++feedback_.jumps;
  const bool follows = gap <= traits().restart_silence && !jumped;
  if (!follows) doubtAngles();
  // The way that was cut off at the end is made up for on the way back.
  position_rad_ += moved;
  speed_.add(position_rad_, follows && !feedback_.angle_at_end, received);
}

bool RobStride_Motor::setZero(double angle_deg) noexcept {
  if (refusesZeros()) return false;
  const double reach_rad = springReachRad(scaleEndRad(), limitNm(), angle_stiffness_);
  const double here_rad = position_rad_ + scale_offset_rad_;
  const bool reaches =
      control_ != RobstrideControl::kOperation ||
      reachesTravel(travel_, angle_deg, here_rad * kDegPerRad, toDrive(1.0), reach_rad * kDegPerRad);
  return reaches && SoloMotor::setZero(angle_deg);
}

void RobStride_Motor::doubtAngles() noexcept {
  angles_in_doubt_ = true;
  loseReference();
}

// The drive's own count of its whole turns.
void RobStride_Motor::takePosition(double rad) noexcept {
  if (!(std::abs(rad) < kFarthestCountedRad)) return doubtAngles();
  if (feedback_.samples == 0) return;
  // Rounded to whole scales: the two were read at different moments.
  scale_offset_rad_ = wraps() ? kScaleRad * std::round((rad - position_rad_) / kScaleRad) : 0.0;
}

void RobStride_Motor::takeParameter(const CanFrame& frame) noexcept {
  const auto index = readLittleEndian<std::uint16_t>(frame.payload(), 0);
  const auto bits = readLittleEndian<std::uint32_t>(frame.payload(), 4);
  const bool accepted = (frame.id.value >> 16U & 0xFFU) == 0;
  const auto value = static_cast<double>(std::bit_cast<float>(bits));
  if (accepted && index == parameter::kSupplyVoltage && value >= 0.0 && value < 1000.0) {
    feedback_.voltage_v = static_cast<float>(value);
  }
  if (accepted && index == parameter::kPosition) takePosition(value);
  // Settings of a drive at rest count when it is enabled.
  if (enabling() || obeying()) enabling_.onParameter(index, accepted, bits);
}

// ---- Packing

std::size_t RobStride_Motor::packReference(const Tick& tick, std::span<CanFrame> out) noexcept {
  switch (control_) {
    case RobstrideControl::kOperation: out[0] = codec_.operate(operation_); return 1;
    case RobstrideControl::kCurrent:
      out[0] = codec_.write(parameter::kCurrentRef, reference_.value);
      return 1;
    case RobstrideControl::kVelocity: out[0] = codec_.write(parameter::kVelocityRef, reference_.value); break;
    case RobstrideControl::kPosition: out[0] = codec_.write(parameter::kPositionRef, reference_.value); break;
  }
  if (limit_sent_a_ != reference_.current_limit_a) limit_repeats_ = kLimitRepeats;
  if (limit_repeats_ == 0 && tick.now - limit_sent_at_ < kLimitPeriod) return 1;
  limit_repeats_ = std::max(limit_repeats_ - 1, 0);
  // After the reference: it is never followed before it is the right one.
  out[1] = codec_.write(parameter::kCurrentLimit, reference_.current_limit_a);
  limit_sent_a_ = reference_.current_limit_a;
  limit_sent_at_ = tick.now;
  return 2;
}

std::size_t RobStride_Motor::packCommand(const Tick& tick, std::span<CanFrame> out) noexcept {
  if (out.size() < 3) return 0;
  if (enabling() && enabling_.progress() == SequenceProgress::kPending) {
    limit_sent_a_ = -1.0F;
    return enabling_.pack(tick.now, codec_, control_ == RobstrideControl::kOperation, out);
  }
  std::size_t count = enabling() || obeying() ? 0 : configuring_.pack(tick.now, out);
  const bool silent = !enabling() && !obeying() && configuring_.wantsSilence();
  if (silent || !due(tick)) return count;
  if (obeying() || (enabling() && enabling_.progress() == SequenceProgress::kDone)) {
    count += packReference(tick, out);
  } else {
    out[count++] = codec_.stop(clear_ordered_);
    clear_sent_ = clear_sent_ || clear_ordered_;
    clear_ordered_ = false;
  }
  if (tick.now - read_at_ >= kReadPeriod) {
    read_at_ = tick.now;
    out[count++] = codec_.read(parameter::kSupplyVoltage);
  }
  return count;
}

std::size_t RobStride_Motor::packRest(std::span<CanFrame> out) const noexcept {
  if (out.empty()) return 0;
  out[0] = codec_.stop();
  if (out.size() < 2) return 1;
  // The one id that is sent in every state: its echo tells that a stalled bus has come back.
  out[1] = codec_.read(parameter::kSupplyVoltage);
  return 2;
}

// ---- Enabling

SequenceProgress RobStride_Motor::sequenceProgress() const noexcept {
  return progressOf(enabling_.progress());
}

// ---- Complaints

DriveComplaint RobStride_Motor::complaint() const noexcept {
  const auto native = robstride::nativeCode(fault_word_, seen_.status_bits);
  if (native != 0) return {.fault = robstride::faultOf(native, model_->cyber_gear), .native_code = native};
  if (const auto index = enabling_.culprit()) {
    return {.fault = FaultCode::kDriveSetting, .native_code = kParameterComplaint + *index};
  }
  if (obeying() && feedback_.samples > 0 && seen_.mode != robstride::kRunning) {
    return {.fault = FaultCode::kDriveStopped, .native_code = 0};
  }
  return scaleComplaint();
}

void RobStride_Motor::clearComplaint() noexcept {
  clear_ordered_ = true;
  enabling_.forgive();
}

}  // namespace rc10
