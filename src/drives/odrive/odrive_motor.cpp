#include "drives/odrive/odrive_motor.hpp"

#include <algorithm>
#include <cmath>

#include "app/limits.hpp"
#include "app/units.hpp"
#include "motor/sample_spacing.hpp"

namespace rc10 {
namespace {

using std::chrono::milliseconds;

// Heartbeats come ten times a second by default, so an answer may take that long: a step is not asked again
// before one has certainly come.
constexpr Duration kAskAgain = milliseconds{120};
constexpr int kMostAsks = 5;
// A heartbeat this young says that the drive is idle now.
constexpr Duration kYoungHeartbeat = milliseconds{300};
// A restart cannot hide in a shorter silence: firmware 0.5 says for 1.5 s that it starts (its current sensors
// settle for 7.5 times dc_calib_tau, Firmware/MotorControl/motor.cpp), 0.6 says INITIALIZING.
constexpr Duration kOdriveRestartSilence = milliseconds{200};
constexpr int kRestartPeriods = 5;
// Telemetry may come once a second; what is older is not known any more.
constexpr Duration kTelemetryLife = milliseconds{2500};
constexpr int kTelemetryPeriods = 5;

Duration currentPatience(const OwnValues& own) noexcept {
  const int hz = own.integer("telemetry_hz");
  return hz > 0 ? std::max<Duration>(kTelemetryPeriods * periodOf(hz), kTelemetryLife) : Duration::zero();
}

constexpr int kModeRepeats = 3;
constexpr int kClearRepeats = 2;

// Spacing of changed and of unchanged limits: they are repeated, as a frame may be lost.
constexpr Duration kLimitsSpacing = milliseconds{20};
constexpr Duration kLimitsRefresh = milliseconds{500};

// A position in float32 turns is good to a hundredth of a turn up to here.
constexpr double kFarthestTurns = 100'000.0;
// Beyond what the speeds of two samples explain.
constexpr double kJumpTurns = 0.5;

bool isFinite(const odrive::Pair& pair) noexcept {
  return std::isfinite(pair.first) && std::isfinite(pair.second);
}

}  // namespace

ODrive_Motor::ODrive_Motor(const MotorSettings& settings, const MotorTraits& traits)
    : SoloMotor(settings, traits, gearRatioOf(settings, traits)),
      node_(settings.id),
      firmware_(findOdriveModel(settings.model) != nullptr ? findOdriveModel(settings.model)->firmware
                                                           : OdriveFirmware::k06),
      iq_sign_(settings.own.flag("iq_reversed") ? -1.0F : 1.0F),
      filter_count_(firmware_ == OdriveFirmware::k06 ? 5 : 4),
      current_patience_(currentPatience(settings.own)),
      enabling_(kAskAgain, kMostAsks),
      input_(odrive::setInputTorque(node_, 0.0F)) {
  using enum odrive::Message;
  const bool v05 = firmware_ == OdriveFirmware::k05;
  const std::array heard{kHeartbeat, kEncoderEstimates, kBusVoltage, v05 ? kIq : kTorques, kTemperature};
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    filters_[i] = {.id = odrive::canId(node_, heard[i]), .mask = kStandardIdMask};
  }
  const std::array said{kSetAxisState,   kSetControllerMode, kSetInputPos, kSetInputVel,
                        kSetInputTorque, kSetLimits,         kClearErrors};
  std::transform(said.begin(), said.end(), command_ids_.begin(),
                 [&](odrive::Message message) { return odrive::canId(node_, message); });
}

// ---- Feedback

bool ODrive_Motor::matchesFrame(const CanFrame& frame) const noexcept {
  if (frame.fd || frame.type == FrameType::kError) return false;
  const auto mine = filters();
  return std::any_of(mine.begin(), mine.end(), [&](const auto& filter) { return filter.id == frame.id; });
}

FrameVerdict ODrive_Motor::updateFeedback(const CanFrame& frame) noexcept {
  switch (odrive::messageOf(frame.id)) {
    case odrive::Message::kHeartbeat: return takeHeartbeat(frame);
    case odrive::Message::kEncoderEstimates: return takeEstimates(frame);
    default: return takeTelemetry(frame);
  }
}

void ODrive_Motor::hear(MonotonicTime received) noexcept {
  const Duration longest = std::max<Duration>(kOdriveRestartSilence, kRestartPeriods * feedbackPeriod());
  const bool silent = heard_ && received - heard_at_ > longest;
  if (silent) forgetPosition();
  if (silent || !heard_) current_due_from_ = received;
  heard_ = true;
  heard_at_ = received;
}

// Without it no guard sees anything. By frames of the drive, so that a silence of the bus is none of it.
bool ODrive_Motor::lacksCurrent() const noexcept {
  return current_patience_ > Duration::zero() && heard_at_ - current_due_from_ > current_patience_;
}

void ODrive_Motor::forgetPosition() noexcept {
  loseReference();
  position_known_ = false;
}

FrameVerdict ODrive_Motor::takeHeartbeat(const CanFrame& frame) noexcept {
  const auto heartbeat = odrive::decodeHeartbeat(frame);
  if (!heartbeat) return FrameVerdict::kMalformed;
  hear(frame.received);
  starting_ = odriveStarting(firmware_, *heartbeat);
  if (starting_) forgetPosition();
  heartbeat_ = heartbeat;
  heartbeat_at_ = frame.received;
  return FrameVerdict::kAccepted;
}

bool ODrive_Motor::isJump(MonotonicTime received, double turns, double turns_per_s) const noexcept {
  if (!position_known_) return false;
  const auto dt_s =
      static_cast<double>(seconds(longestApart(received - feedback_.received, feedbackPeriod())));
  const double fastest = std::max(std::abs(turns_per_s), std::abs(turns_per_s_));
  return std::abs(turns - turns_) > kJumpTurns + 1.5 * fastest * dt_s;
}

FrameVerdict ODrive_Motor::takeEstimates(const CanFrame& frame) noexcept {
  const auto estimates = odrive::decodePair(frame);
  if (!estimates || !isFinite(*estimates)) return FrameVerdict::kMalformed;
  hear(frame.received);
  // A starting drive's position may still change without a movement.
  if (starting_) return FrameVerdict::kAccepted;
  const auto turns = static_cast<double>(estimates->first);
  const auto turns_per_s = static_cast<double>(estimates->second);
  const bool jumped = isJump(frame.received, turns, turns_per_s);
  if (jumped) loseReference();
  acceptSample(frame.received, turns * kDegPerTurn);
  if (jumped) ++feedback_.jumps;
  position_known_ = true;
  turns_ = turns;
  turns_per_s_ = turns_per_s;
  feedback_.velocity_rpm = saturate(static_cast<float>(toOutput(turns_per_s * kRpmPerTurnPerS)));

  if (frame.received - current_at_ > kTelemetryLife) {
    feedback_.current_a = kNotReported;
    feedback_.torque_nm = kNotReported;
  }
  if (frame.received - temperature_at_ > kTelemetryLife) feedback_.temperature_c = kNotReported;
  if (frame.received - voltage_at_ > kTelemetryLife) feedback_.voltage_v = kNotReported;
  return FrameVerdict::kAccepted;
}

FrameVerdict ODrive_Motor::takeTelemetry(const CanFrame& frame) noexcept {
  const auto pair = odrive::decodePair(frame);
  if (!pair) return FrameVerdict::kMalformed;
  const auto message = odrive::messageOf(frame.id);
  if (message == odrive::Message::kTemperature) {
    // The hotter of power stage and motor: a motor without a sensor has no number, or 0.
    const float celsius = std::fmax(pair->first, pair->second);
    if (!std::isfinite(celsius)) return FrameVerdict::kMalformed;
    hear(frame.received);
    feedback_.temperature_c = celsius;
    temperature_at_ = frame.received;
    return FrameVerdict::kAccepted;
  }
  if (!isFinite(*pair)) return FrameVerdict::kMalformed;
  hear(frame.received);
  if (message == odrive::Message::kBusVoltage) {
    feedback_.voltage_v = pair->first;
    voltage_at_ = frame.received;
    return FrameVerdict::kAccepted;
  }
  // Firmware 0.6 tells the torque, 0.5 the current. Of the second value in both: what is measured.
  const float measured = saturate(pair->second);
  feedback_.current_a =
      message == odrive::Message::kTorques
          ? saturate(static_cast<float>(torqueToOutput(static_cast<double>(measured))) / torqueNmPerA())
          : measured * iq_sign_ * direction();
  feedback_.torque_nm = saturate(feedback_.current_a * torqueNmPerA());
  current_at_ = frame.received;
  current_due_from_ = frame.received;
  return FrameVerdict::kAccepted;
}

// ---- Command

void ODrive_Motor::watchState() noexcept {
  if (!obeying()) {
    stopped_ = false;
  } else if (!heartbeat_ || heartbeat_->state != odrive::AxisState::kClosedLoop) {
    stopped_ = true;
  }
}

void ODrive_Motor::update(const Tick& tick) noexcept {
  limits_ = 0;
  const Target target = wanted();
  // Abandoned while a step was asked for: nothing of it may leave later.
  ask_ = false;
  if (enabling()) runEnabling(tick);
  watchState();
  if (obeying()) {
    follow(target);
    refreshLimits(tick);
  } else {
    mode_known_ = false;
    input_ = odrive::setInputTorque(node_, 0.0F);
    setCommand(0.0, CommandUnit::kAmpere);
    if (ask_) {
      limits_sent_a_ = effortLimit();
      limits_sent_at_ = tick.now;
    }
  }
}

void ODrive_Motor::follow(const Target& target) noexcept {
  switch (target.mode) {
    case ControlMode::kVelocity: return followVelocity(target.value, target.torque_ff_nm);
    case ControlMode::kBrake: return followVelocity(0.0, 0.0F);
    case ControlMode::kTotalAngle: return followAngle(target);
    default: return followCurrent(target);
  }
}

void ODrive_Motor::followCurrent(const Target& target) noexcept {
  double nm = 0.0;
  if (target.mode == ControlMode::kCurrent) {
    nm = torqueWithinLimit(target.value * static_cast<double>(torqueNmPerA()) +
                           static_cast<double>(target.torque_ff_nm));
  }
  setInput(odrive::ControlMode::kTorque,
           odrive::setInputTorque(node_, saturate(static_cast<float>(torqueToDrive(nm)))));
  setCommand(nm / static_cast<double>(torqueNmPerA()), CommandUnit::kAmpere);
}

void ODrive_Motor::followVelocity(double rpm, float torque_ff_nm) noexcept {
  if (currentAtLimit(0.0)) limits_ |= kLimitCurrent;
  const double allowed_rpm = rpmWithinLimit(rpm);
  const double ff_nm = torqueWithinLimit(static_cast<double>(torque_ff_nm));
  setInput(odrive::ControlMode::kVelocity,
           odrive::setInputVel(node_, saturate(static_cast<float>(toDrive(allowed_rpm) / kRpmPerTurnPerS)),
                               saturate(static_cast<float>(torqueToDrive(ff_nm)))));
  setCommand(allowed_rpm, CommandUnit::kNative);
}

void ODrive_Motor::followAngle(const Target& target) noexcept {
  const double wanted_turns = drivePositionFor(target.value) / kDegPerTurn;
  if (std::isnan(wanted_turns)) return followCurrent(Target{});
  // From beyond what can be told every place lies far back.
  if (std::abs(drivePositionFor(feedback_.total_angle_deg)) / kDegPerTurn > kFarthestTurns) {
    limits_ |= kLimitAngle;
    return followVelocity(0.0, 0.0F);
  }
  const double turns = std::clamp(wanted_turns, -kFarthestTurns, kFarthestTurns);
  const bool reaches = turns == wanted_turns;
  if (!reaches) limits_ |= kLimitAngle;
  if (currentAtLimit(0.0)) limits_ |= kLimitCurrent;
  const double ff_rpm = rpmWithinLimit(static_cast<double>(target.velocity_ff_rpm));
  const double ff_nm = torqueWithinLimit(static_cast<double>(target.torque_ff_nm));
  setInput(odrive::ControlMode::kPosition,
           odrive::setInputPos(node_, static_cast<float>(turns),
                               saturate(static_cast<float>(toDrive(ff_rpm) / kRpmPerTurnPerS)),
                               saturate(static_cast<float>(torqueToDrive(ff_nm)))));
  const double told_deg = reaches ? target.value : toOutput(turns * kDegPerTurn - drivePositionFor(0.0));
  setCommand(told_deg, CommandUnit::kNative);
}

void ODrive_Motor::setInput(odrive::ControlMode mode, const CanFrame& input) noexcept {
  if (!mode_known_ || mode != mode_) mode_repeats_ = kModeRepeats;
  mode_known_ = true;
  mode_ = mode;
  input_ = input;
}

// Set_Limits is the only current limit that acts inside the drive's velocity and position loops.
void ODrive_Motor::refreshLimits(const Tick& tick) noexcept {
  const Duration age = tick.now - limits_sent_at_;
  const bool changed = std::abs(effortLimit() - limits_sent_a_) > 0.01F * traits().effort_full_scale;
  limits_due_ = age >= kLimitsRefresh || (changed && age >= kLimitsSpacing);
}

CanFrame ODrive_Motor::limitsFrame() const noexcept {
  const double turns_per_s = std::abs(toDrive(static_cast<double>(velocityLimitRpm()))) / kRpmPerTurnPerS;
  return odrive::setLimits(node_, saturate(static_cast<float>(turns_per_s)), effortLimit());
}

// ---- Packing

std::size_t ODrive_Motor::packCommand(const Tick& tick, std::span<CanFrame> out) noexcept {
  FrameOutbox frames;
  if (enabling() && ask_ && enabling_.at(Step::kToClosedLoop)) {
    frames.add(odrive::setInputTorque(node_, 0.0F));
    frames.add(odrive::setControllerMode(node_, odrive::ControlMode::kTorque));
    frames.add(limitsFrame());
    frames.add(odrive::setAxisState(node_, odrive::AxisState::kClosedLoop));
    return frames.copyTo(out);
  }
  if (clear_repeats_ > 0) {
    --clear_repeats_;
    frames.add(odrive::clearErrors(node_));
  }
  if (!due(tick) && !ask_) return frames.copyTo(out);
  if (obeying()) {
    // The new mode's input before the mode, so that it never acts on an old one; and after it, because the
    // drive puts its own position there when position control begins.
    if (mode_repeats_ > 0) {
      --mode_repeats_;
      frames.add(input_);
      frames.add(odrive::setControllerMode(node_, mode_));
    } else if (limits_due_) {
      frames.add(limitsFrame());
      limits_due_ = false;
      limits_sent_a_ = effortLimit();
      limits_sent_at_ = tick.now;
      mode_repeats_ = 1;  // for a drive that has heard none of the frames of the switch
    }
    frames.add(input_);
  } else if (enabling() && (enabling_.at(Step::kToClosedLoop) || enabling_.done())) {
    frames.add(input_);  // 0 N·m: it also keeps the drive's watchdog content.
  } else {
    // While no torque is possible: a drive that misses the frames of closed loop follows no old input.
    if (enabling() && ask_) {
      frames.add(odrive::setInputVel(node_, 0.0F, 0.0F));
      frames.add(odrive::setControllerMode(node_, odrive::ControlMode::kTorque));
    }
    std::array<CanFrame, 2> rest{};
    for (const auto& frame : std::span{rest}.first(packRest(rest))) frames.add(frame);
  }
  return frames.copyTo(out);
}

std::size_t ODrive_Motor::packRest(std::span<CanFrame> out) const noexcept {
  FrameOutbox frames;
  frames.add(odrive::setInputTorque(node_, 0.0F));
  frames.add(odrive::setAxisState(node_, odrive::AxisState::kIdle));
  return frames.copyTo(out);
}

// ---- Enabling

bool ODrive_Motor::stateSince(odrive::AxisState state, MonotonicTime since) const noexcept {
  return heartbeat_ && heartbeat_->state == state && heartbeat_at_ >= since;
}

void ODrive_Motor::runEnabling(const Tick& tick) noexcept {
  if (begins()) enabling_.begin(Step::kToIdle);
  const bool well = !lacksCurrent() && (!heartbeat_ || odriveErrors(firmware_, *heartbeat_) == 0);
  if (enabling_.awaits(Step::kToIdle)) {
    if (!well) {
      enabling_.fail();
    } else if (stateSince(odrive::AxisState::kIdle, enabling_.askedFirst() - kYoungHeartbeat)) {
      enabling_.next(Step::kToClosedLoop);
    }
  }
  if (enabling_.awaits(Step::kToClosedLoop) && heartbeat_ && heartbeat_at_ >= enabling_.askedFirst()) {
    if (!well) {
      enabling_.fail();
    } else if (heartbeat_->state == odrive::AxisState::kClosedLoop) {
      enabling_.finish();
    }
  }
  ask_ = enabling_.asks(tick.now);
}

SequenceProgress ODrive_Motor::sequenceProgress() const noexcept { return progressOf(enabling_.progress()); }

// ---- Complaints

DriveComplaint ODrive_Motor::complaint() const noexcept {
  if (heartbeat_) {
    const auto reported = complaintOfBits(odriveFaults(firmware_), odriveErrors(firmware_, *heartbeat_));
    if (reported.fault != FaultCode::kNone) return reported;
  }
  if (stopped_) return {.fault = FaultCode::kDriveStopped, .native_code = 0};
  if ((obeying() || enabling()) && lacksCurrent())
    return {.fault = FaultCode::kDriveSetting, .native_code = kNoCurrentComplaint};
  return {};
}

void ODrive_Motor::clearComplaint() noexcept { clear_repeats_ = kClearRepeats; }

}  // namespace rc10
