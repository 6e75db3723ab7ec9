#include "drives/myactuator/myactuator_motor.hpp"

#include <algorithm>
#include <cmath>

#include "app/limits.hpp"
#include "app/units.hpp"
#include "drives/myactuator/myactuator_model.hpp"

namespace rc10 {

namespace {

/// Above this the drive limits itself: the field's end.
constexpr double kMyactuatorNoLimitDegS = 65535.0;

constexpr Duration kMyactuatorStepPatience = std::chrono::milliseconds{50};
constexpr int kMyactuatorStepTries = 5;
/// Errors and run time, in turns.
constexpr Duration kMyactuatorQuerySpacing = std::chrono::milliseconds{50};
constexpr Duration kMyactuatorUrgentQuerySpacing = std::chrono::milliseconds{10};
/// By how much the drive's clock may be behind ours.
constexpr std::int64_t kUptimeSlackMs = 250;
constexpr std::int64_t kUptimeRoundMs = std::int64_t{1} << 32;  ///< Its counter has 32 bits.
constexpr std::int64_t kUptimeDriftDivider = 200;               // 0.5 %
/// For a drive whose speed is not known, N·m·s/rad: as a small one of these.
constexpr double kUnknownDamping = 0.5;
/// Replies with all zeros are copies of requests unless the motor is about so cold.
constexpr float kMyactuatorNearZeroC = 2.0F;

[[nodiscard]] std::int64_t wholeMilliseconds(Duration duration) noexcept {
  return std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
}

[[nodiscard]] bool allZero(const CanFrame& frame) noexcept {
  return std::all_of(frame.data.begin() + 1, frame.data.begin() + frame.length,
                     [](std::uint8_t byte) { return byte == 0; });
}

}  // namespace

MyActuator_Motor::MyActuator_Motor(const MotorSettings& settings, const MotorTraits& traits)
    : SoloMotor(withFeedbackOfCommands(settings, settings.own.integer("angle_divider")), traits,
                driveTurns(settings, traits)),
      id_(settings.id),
      angle_divider_(std::max(settings.own.integer("angle_divider"), 1)),
      release_brake_(settings.own.flag("release_brake")),
      filters_{
          FrameFilter{.id = {myactuator::kReplyBase + static_cast<std::uint32_t>(id_), false},
                      .mask = kStandardIdMask},
          FrameFilter{.id = {myactuator::kMotionReplyBase + static_cast<std::uint32_t>(id_), false},
                      .mask = kStandardIdMask,
                      .discriminators = {PayloadDiscriminator{.value = static_cast<std::uint8_t>(id_)}}}},
      command_ids_{CanId{myactuator::kRequestBase + static_cast<std::uint32_t>(id_), false},
                   CanId{myactuator::kMotionBase + static_cast<std::uint32_t>(id_), false}},
      speed_(myactuator::kMotionVelocityRadS),
      enabling_(kMyactuatorStepPatience, kMyactuatorStepTries) {
  speedFieldEndsAt(myactuator::kMotionVelocityRadS);
}

// ---- Feedback

bool MyActuator_Motor::matchesFrame(const CanFrame& frame) const noexcept {
  return (frame.id == filters_[0].id || frame.id == filters_[1].id) && !frame.fd &&
         frame.type != FrameType::kError;
}

FrameVerdict MyActuator_Motor::updateFeedback(const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.fd || frame.length == 0) return FrameVerdict::kMalformed;
  if (frame.id == filters_[1].id) return takeMotion(frame);
  const myactuator::Code code = myactuator::codeOf(frame.payload());
  if (code == myactuator::Code::kSilenceStopped) {
    silence_stopped_ = silence_stopped_ || obeying();
    return FrameVerdict::kAccepted;
  }
  if (frame.length != myactuator::kLength) return FrameVerdict::kMalformed;
  configuring_.onFrame(frame);
  watchSilence(frame.received);
  switch (code) {
    case myactuator::Code::kReading:
    case myactuator::Code::kCurrent:
    case myactuator::Code::kVelocity:
    case myactuator::Code::kPosition: takeReading(frame); break;
    case myactuator::Code::kAngle: return takeAngleReply(frame);
    case myactuator::Code::kStatus: takeStatus(frame); break;
    case myactuator::Code::kUptime: takeUptime(frame); break;
    case myactuator::Code::kReleaseBrake: answered(Step::kReleaseBrake); break;
    case myactuator::Code::kShutdown: off_answered_ = polled_; break;
    default: break;  // the reply to another controller's question
  }
  return FrameVerdict::kAccepted;
}

// After a silence the drive may have been restarted, and its angle may mean something else.
void MyActuator_Motor::watchSilence(MonotonicTime received) noexcept {
  if (!heard_ || received - *heard_ > traits().restart_silence) {
    running_ = false;
    next_query_ = {};
  }
  heard_ = received;
}

bool MyActuator_Motor::isCopyOfRequest(const CanFrame& frame) const noexcept {
  if (std::abs(feedback_.temperature_c) <= kMyactuatorNearZeroC) return false;  // such a reply may be true
  if (myactuator::codeOf(frame.payload()) == myactuator::Code::kReading) return allZero(frame);
  return last_command_ &&
         std::equal(frame.data.begin(), frame.data.begin() + frame.length, last_command_->data.begin());
}

void MyActuator_Motor::takeReading(const CanFrame& frame) noexcept {
  if (isCopyOfRequest(frame)) {
    silence_stopped_ = silence_stopped_ || obeying();
    return;
  }
  const auto reading = myactuator::decodeReading(frame.payload());
  feedback_.temperature_c = static_cast<float>(reading.temperature_c);
  feedback_.current_a = static_cast<float>(reading.current_a) * direction();
  if (torqueNmPerA() > 0.0F) feedback_.torque_nm = feedback_.current_a * torqueNmPerA();
  takeSpeed(toOutput(reading.velocity_deg_s) / kDegPerSPerRpm, false);
  if (myactuator::codeOf(frame.payload()) == myactuator::Code::kCurrent) answered(Step::kObey);
}

void MyActuator_Motor::takeSpeed(double output_rpm, bool of_motion) noexcept {
  if (std::exchange(speed_of_motion_, of_motion) != of_motion) compareSpeedAnew();
  feedback_.velocity_rpm = static_cast<float>(output_rpm);
}

FrameVerdict MyActuator_Motor::takeAngleReply(const CanFrame& frame) noexcept {
  // A copy of the request has the angle 0; there are no two in a row.
  const bool zero = allZero(frame);
  if (zero && !std::exchange(zero_before_, true)) return FrameVerdict::kAccepted;
  zero_before_ = zero;
  if (!running_) return FrameVerdict::kAccepted;
  const std::int32_t raw = myactuator::decodeAngle(frame.payload());
  const bool follows = raw_angle_.has_value();
  if (!follows) {
    // After a restart a drive that knows its angle says it; another's angle goes on from where it was.
    const bool absolute = traits().absolute && get_GearRatio() == traits().gear_ratio;
    if (absolute || feedback_.samples == 0) angle_raw_ = raw;
  } else {
    // Modulo 2^32: a wheel gets there within hours.
    angle_raw_ +=
        static_cast<std::int32_t>(static_cast<std::uint32_t>(raw) - static_cast<std::uint32_t>(*raw_angle_));
  }
  raw_angle_ = raw;
  motion_rad_.reset();
  const double drive_deg = static_cast<double>(angle_raw_) * myactuator::kDegPerRaw;
  speed_.add(drive_deg * kRadPerDeg, follows, frame.received);
  acceptSample(frame.received, drive_deg);
  return FrameVerdict::kAccepted;
}

void MyActuator_Motor::takeStatus(const CanFrame& frame) noexcept {
  if (allZero(frame)) return;  // a copy: a drive that answers has a voltage
  const auto status = myactuator::decodeStatus(frame.payload());
  feedback_.temperature_c = static_cast<float>(status.temperature_c);
  feedback_.voltage_v = static_cast<float>(status.voltage_v);
  errors_ = status.errors;
  answered(Step::kStatus);
}

void MyActuator_Motor::takeUptime(const CanFrame& frame) noexcept {
  const std::uint32_t uptime_ms = myactuator::decodeUptimeMs(frame.payload());
  if (uptime_ms == 0) return;  // a copy
  if (uptime_ms_) {
    const std::int64_t elapsed_ms = wholeMilliseconds(frame.received - uptime_at_);
    const std::int64_t late_ms = *uptime_ms_ + elapsed_ms - uptime_ms;
    const std::int64_t slack_ms = kUptimeSlackMs + elapsed_ms / kUptimeDriftDivider;
    const bool goes_round = std::abs(late_ms - kUptimeRoundMs) <= slack_ms;
    if (late_ms > slack_ms && !goes_round) {
      loseReference();
      raw_angle_.reset();
      motion_rad_.reset();
      restarted_ = restarted_ || obeying();
      if (enabling()) beginEnabling();
    }
  }
  uptime_ms_ = uptime_ms;
  uptime_at_ = frame.received;
  running_ = true;
  answered(Step::kUptime);
}

FrameVerdict MyActuator_Motor::takeMotion(const CanFrame& frame) noexcept {
  if (frame.length != myactuator::kLength || frame.data[0] != id_) return FrameVerdict::kMalformed;
  watchSilence(frame.received);
  const auto reading = myactuator::decodeMotion(frame.payload());
  motion_rad_ = reading.angle_rad;
  takeSpeed(toOutput(reading.velocity_rad_s) / kRadPerSPerRpm, true);
  feedback_.torque_nm = static_cast<float>(torqueToOutput(reading.torque_nm));
  if (torqueNmPerA() > 0.0F) feedback_.current_a = feedback_.torque_nm / torqueNmPerA();
  return FrameVerdict::kAccepted;
}

// ---- Command

void MyActuator_Motor::update(const Tick& tick) noexcept {
  outbox_.clear();
  const Target target = wanted();
  if (enabling() && begins()) beginEnabling();
  if (std::exchange(reset_, false)) outbox_.add(myactuator::request(id_, myactuator::Code::kReset));
  // A drive that has just started must get no target in turns that it counted before.
  if (!heard_ || tick.now - *heard_ > traits().restart_silence) running_ = false;
  if (!due(tick)) return;

  limits_ = 0;  // of its turn: between turns what acts goes on
  const bool polled_before = std::exchange(polled_, ordered() == FrameKind::kPoll);
  const bool ask_angle = turns_due_++ % static_cast<std::uint64_t>(angle_divider_) == 0;
  switch (ordered()) {
    case FrameKind::kRest:
    case FrameKind::kDisable:
      setCommand(0.0, CommandUnit::kNone);
      outbox_.add(myactuator::request(id_, myactuator::Code::kShutdown));
      return;
    case FrameKind::kPoll: poll(polled_before); break;
    case FrameKind::kEnable:
      setCommand(0.0, CommandUnit::kNone);
      runEnabling(tick);
      break;
    default:
      // After a silence its angles may be unknown, and its last command may act on. A drive that has stopped
      // stays so until the client enables it.
      if (!running_ || restarted_ || silence_stopped_) {
        setCommand(0.0, CommandUnit::kNone);
        outbox_.add(myactuator::request(id_, myactuator::Code::kShutdown));
      } else {
        follow(target);
      }
      break;
  }
  if (ask_angle) outbox_.add(myactuator::request(id_, myactuator::Code::kAngle));
  sendQueries(tick);
}

// "Output off" until the drive has answered it, as either frame may be lost; then in turns with the
// question for its readings.
void MyActuator_Motor::poll(bool polled_before) noexcept {
  off_answered_ = off_answered_ && polled_before && running_;
  setCommand(0.0, CommandUnit::kNone);
  const bool reads = polled_before && turns_due_ % 2 != 0;
  if (!reads || !off_answered_) outbox_.add(myactuator::request(id_, myactuator::Code::kShutdown));
  if (reads) outbox_.add(myactuator::request(id_, myactuator::Code::kReading));
}

void MyActuator_Motor::sendQueries(const Tick& tick) noexcept {
  if (tick.now < next_query_) return;
  next_query_ = tick.now + (running_ ? kMyactuatorQuerySpacing : kMyactuatorUrgentQuerySpacing);
  ask_uptime_ = !running_ || !ask_uptime_;
  outbox_.add(myactuator::request(id_, ask_uptime_ ? myactuator::Code::kUptime : myactuator::Code::kStatus));
}

void MyActuator_Motor::follow(const Target& target) noexcept {
  if (ordered() == FrameKind::kDamp && torqueNmPerA() > 0.0F) return damp();
  // Nothing but a current can be bounded: no loop of the drive may run when none is allowed.
  const bool allowed = effortLimit() > 0.0F;
  switch (allowed ? target.mode : ControlMode::kCurrent) {
    case ControlMode::kCurrent: return followCurrent(target);
    case ControlMode::kVelocity: return followVelocity(target.value);
    case ControlMode::kTotalAngle: return followAngle(target.value);
    case ControlMode::kImpedance:
      return torqueNmPerA() > 0.0F ? followImpedance(target) : followCurrent(Target{});
    case ControlMode::kBrake: return followVelocity(0.0);
    default: return followCurrent(Target{.mode = ControlMode::kCurrent});
  }
}

void MyActuator_Motor::followCurrent(const Target& target) noexcept {
  const double current_a = currentWithinLimit(target);
  setCommand(current_a, CommandUnit::kAmpere);
  sendCommand(myactuator::currentCommand(id_, current_a * static_cast<double>(direction())));
}

void MyActuator_Motor::followVelocity(double output_rpm) noexcept {
  constexpr double kFastestDegS = 2147483647.0 * myactuator::kDegPerRaw;
  const double rpm = rpmWithinLimit(output_rpm, kFastestDegS / (std::abs(toDrive(1.0)) * kDegPerSPerRpm));
  if (ownLoopAtLimit(myactuator::kAmperesPerRaw)) limits_ |= kLimitCurrent;
  setCommand(rpm, CommandUnit::kNative);
  sendCommand(myactuator::velocityCommand(id_, toDrive(rpm) * kDegPerSPerRpm));
}

void MyActuator_Motor::followAngle(double total_angle_deg) noexcept {
  if (feedback_.samples == 0 || !std::isfinite(total_angle_deg)) return followCurrent(Target{});
  // The drive's angle is what 32 bits hold of ours.
  const auto drive_deg_of = [this](double output_deg) {
    return drivePositionFor(output_deg) -
           static_cast<double>(angle_raw_ - raw_angle_.value_or(0)) * myactuator::kDegPerRaw;
  };
  constexpr double kReachDeg = 2147483647.0 * myactuator::kDegPerRaw;
  const double wanted_deg = drive_deg_of(total_angle_deg);
  const double drive_deg = std::clamp(wanted_deg, -kReachDeg, kReachDeg);
  const bool reaches = drive_deg == wanted_deg;
  if (!reaches) limits_ |= kLimitAngle;
  const auto limit_rpm = static_cast<double>(velocityLimitRpm());
  const double limit_deg_s =
      limit_rpm > 0.0 ? std::abs(toDrive(limit_rpm)) * kDegPerSPerRpm : kMyactuatorNoLimitDegS;
  if (ownLoopAtLimit(myactuator::kAmperesPerRaw)) limits_ |= kLimitCurrent;
  const double away_deg = drive_deg - drive_deg_of(feedback_.total_angle_deg);
  setCommand(reaches ? total_angle_deg : feedback_.total_angle_deg + toOutput(away_deg),
             CommandUnit::kNative);
  sendCommand(myactuator::positionCommand(id_, drive_deg, limit_deg_s));
}

void MyActuator_Motor::followImpedance(const Target& target) noexcept {
  const double drive_deg = drivePositionFor(target.value) -
                           static_cast<double>(angle_raw_ - raw_angle_.value_or(0)) * myactuator::kDegPerRaw;
  const double turns = toDrive(1.0);
  const double per_drive = 1.0 / (turns * turns);
  SpringLaw motion{.position_rad = finiteOr0(drive_deg) * kRadPerDeg,
                   .velocity_rad_s = toDrive(static_cast<double>(target.velocity_ff_rpm)) * kRadPerSPerRpm,
                   .stiffness_nm_per_rad = static_cast<double>(target.stiffness_nm_per_rad) * per_drive,
                   .damping_nms_per_rad = static_cast<double>(target.damping_nms_per_rad) * per_drive,
                   .torque_nm = torqueToDrive(static_cast<double>(target.torque_ff_nm))};
  if (const double limit = std::abs(toDrive(static_cast<double>(velocityLimitRpm()))) * kRadPerSPerRpm;
      limit > 0.0) {
    const double bounded = std::clamp(motion.velocity_rad_s, -limit, limit);
    if (bounded != motion.velocity_rad_s) limits_ |= kLimitVelocity;
    motion.velocity_rad_s = bounded;
  }
  // Outside its range of angles the drive would pull towards the end of the range: then without a spring.
  const bool outside = feedback_.samples == 0 || !std::isfinite(drive_deg) ||
                       std::abs(motion.position_rad) > myactuator::kMotionAngleRad ||
                       std::abs(measuredDeg() * kRadPerDeg) > myactuator::kMotionAngleRad;
  if (outside) {
    limits_ |= kLimitAngle;
    // A load sinks then, and does not fall.
    if (motion.stiffness_nm_per_rad > 0.0)
      motion = dampOnly(motion, feedback_.samples > 0 ? dampingOf() : 0.0);
    motion.position_rad = 0.0;
    motion.stiffness_nm_per_rad = 0.0;
  }
  sendMotion(motion);
}

// As a shorted winding would: the full torque at the speed without load.
double MyActuator_Motor::dampingOf() const noexcept {
  const double no_load_rad_s = static_cast<double>(traits().no_load_rpm) * kRadPerSPerRpm;
  const double full_nm = static_cast<double>(traits().effort_full_scale * traits().torque_nm_per_a);
  return no_load_rad_s > 0.0 ? std::min(full_nm / no_load_rad_s, myactuator::kMotionDamping)
                             : kUnknownDamping;
}

void MyActuator_Motor::damp() noexcept { sendMotion(resistance(dampingOf())); }

void MyActuator_Motor::sendMotion(SpringLaw motion) noexcept {
  boundGains(motion, myactuator::kMotionStiffness, myactuator::kMotionDamping);
  motion.torque_nm = std::clamp(motion.torque_nm, -myactuator::kMotionTorqueNm, myactuator::kMotionTorqueNm);
  // A speed is cut by its field: before the sum is bounded.
  const double told_rad_s =
      std::clamp(motion.velocity_rad_s, -myactuator::kMotionVelocityRadS, myactuator::kMotionVelocityRadS);
  if (told_rad_s != motion.velocity_rad_s) limits_ |= kLimitVelocity;
  motion.velocity_rad_s = told_rad_s;
  // The answer to a motion command is younger than the last angle, which is asked for now and then. Within
  // its range both count from one zero.
  const double seen_rad_s = toDrive(finiteOr0(static_cast<double>(feedback_.velocity_rpm))) * kRadPerSPerRpm;
  const SpringState measured{.position_rad = motion_rad_.value_or(measuredDeg() * kRadPerDeg),
                             .velocity_rad_s = speed_of_motion_ ? speed_.of(seen_rad_s) : seen_rad_s};
  const double bound_nm = std::min(driveTorqueLimitNm(), myactuator::kMotionTorqueNm);
  if (boundTorque(motion, measured, bound_nm, SpringYield::kGains)) limits_ |= kLimitCurrent;
  setCommand(torqueToOutput(torqueNm(motion, measured)) / static_cast<double>(torqueNmPerA()),
             CommandUnit::kAmpere);
  last_command_.reset();
  outbox_.add(myactuator::motionCommand(id_, motion));
}

void MyActuator_Motor::sendCommand(const CanFrame& frame) noexcept {
  last_command_ = frame;
  outbox_.add(frame);
}

// ---- Packing

std::size_t MyActuator_Motor::packCommand(const Tick& tick, std::span<CanFrame> out) noexcept {
  const std::size_t count = outbox_.copyTo(out);
  if (obeying() || enabling()) return count;
  return count + configuring_.pack(tick.now, out.subspan(count));
}

std::size_t MyActuator_Motor::packRest(std::span<CanFrame> out) const noexcept {
  if (out.empty()) return 0;
  out.front() = myactuator::request(id_, myactuator::Code::kShutdown);
  return 1;
}

// ---- Enabling

void MyActuator_Motor::beginEnabling() noexcept {
  enabling_.begin(Step::kStatus);
  restarted_ = false;
  silence_stopped_ = false;
}

CanFrame MyActuator_Motor::stepFrame() const noexcept {
  switch (enabling_.step()) {
    case Step::kStatus: return myactuator::request(id_, myactuator::Code::kStatus);
    case Step::kUptime: return myactuator::request(id_, myactuator::Code::kUptime);
    case Step::kReleaseBrake: return myactuator::request(id_, myactuator::Code::kReleaseBrake);
    case Step::kObey: break;
  }
  return myactuator::currentCommand(id_, 0.0);
}

void MyActuator_Motor::runEnabling(const Tick& tick) noexcept {
  if (enabling_.failed()) return outbox_.add(myactuator::request(id_, myactuator::Code::kShutdown));
  // Until then it may be following what it was told last.
  const bool follows = enabling_.at(Step::kStatus) || enabling_.at(Step::kUptime);
  if (follows) outbox_.add(myactuator::request(id_, myactuator::Code::kShutdown));
  // Done: no torque until the first command.
  if (!enabling_.done() && !enabling_.asks(tick.now)) return;
  if (enabling_.step() == Step::kObey) return sendCommand(stepFrame());
  outbox_.add(stepFrame());
}

void MyActuator_Motor::answered(Step step) noexcept {
  if (!sequenceRuns() || !enabling_.awaits(step)) return;
  switch (step) {
    case Step::kStatus:
      if (errors_ != 0) return enabling_.fail();
      return enabling_.next(Step::kUptime);
    case Step::kUptime: return enabling_.next(release_brake_ ? Step::kReleaseBrake : Step::kObey);
    case Step::kReleaseBrake: return enabling_.next(Step::kObey);
    case Step::kObey: return enabling_.finish();
  }
}

SequenceProgress MyActuator_Motor::sequenceProgress() const noexcept {
  return progressOf(enabling_.progress());
}

// ---- Complaints

DriveComplaint MyActuator_Motor::complaint() const noexcept {
  if (errors_ != 0) return complaintOfBits(myactuatorFaults(), errors_);
  if (restarted_) return {.fault = FaultCode::kDriveStopped, .native_code = 0};
  if (silence_stopped_) {
    return {.fault = FaultCode::kDriveCommunication,
            .native_code = static_cast<std::uint32_t>(myactuator::Code::kSilenceStopped)};
  }
  return scaleComplaint();
}

void MyActuator_Motor::clearComplaint() noexcept {
  // "Level 1" errors end with a restart only; the output is off while they last. Others end by themselves.
  reset_ = reset_ || myactuatorNeedsReset(errors_);
  restarted_ = false;
  silence_stopped_ = false;
  next_query_ = {};
  ask_uptime_ = true;  // the status is the next question
}

}  // namespace rc10
