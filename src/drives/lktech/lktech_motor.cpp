#include "drives/lktech/lktech_motor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/angle.hpp"
#include "app/saturated.hpp"
#include "app/units.hpp"
#include "drives/lktech/lktech_model.hpp"

namespace rc10 {

namespace {

constexpr double kLktechNoLimitDegS = 65535.0;

constexpr Duration kLktechStepPatience = std::chrono::milliseconds{50};
constexpr int kLktechStepTries = 5;
constexpr Duration kLktechQuerySpacing = std::chrono::milliseconds{50};
// A drive that is on has answered by then.
constexpr Duration kLktechCopyWithin = 2 * kLktechQuerySpacing;
constexpr Duration kLktechUrgentQuerySpacing = std::chrono::milliseconds{10};
/// A frame with the shape of a command is a reply only if the motor is known to be about so cold.
constexpr float kLktechNearZeroC = 2.0F;
constexpr int kZeroAnglesBelieved = 3;
/// Below this speed encoder and multi-turn angle are of the same moment.
constexpr float kStandingRpm = 1.0F;
/// By how much the two may differ for other reasons.
constexpr double kSameAngleDeg = 1.0;
constexpr double kShiftSeenDeg = 10.0;
// A drive that has just started counts less than a turn, to either side.
constexpr double kFreshCountDeg = kDegPerTurn + 1.0;
// Its count is heard within this of its start; until then a shaft turns on.
constexpr double kFreshForS = 0.1;
// Encoder and count are two answers.
constexpr double kInstantsApartS = 0.03;

[[nodiscard]] double amperesPerRaw(const std::string& model) {
  const LktechModel* const found = findLktechModel(model);
  return found != nullptr ? found->amperes_per_raw : LktechModel{}.amperes_per_raw;
}

}  // namespace

LKTech_Motor::LKTech_Motor(const MotorSettings& settings, const MotorTraits& traits)
    : SoloMotor(withFeedbackOfCommands(settings, 1), traits, driveTurns(settings, traits)),
      id_(settings.id),
      grouped_(settings.own.flag("group")),
      amperes_per_raw_(amperesPerRaw(settings.model)),
      encoder_mask_(static_cast<std::uint16_t>((1U << settings.own.integer("encoder_bits")) - 1U)),
      filters_{FrameFilter{.id = {lktech::kBaseId + static_cast<std::uint32_t>(id_), false},
                           .mask = kStandardIdMask}},
      command_ids_{filters_[0].id},
      enabling_(kLktechStepPatience, kLktechStepTries) {}

// ---- Feedback

bool LKTech_Motor::matchesFrame(const CanFrame& frame) const noexcept {
  return frame.id == filters_[0].id && !frame.fd && frame.type != FrameType::kError;
}

// Before the temperature is known a reply may look like a command.
FrameVerdict LKTech_Motor::verdictOnCommand() const noexcept {
  return std::isnan(feedback_.temperature_c) ? FrameVerdict::kAccepted : FrameVerdict::kForeign;
}

bool LKTech_Motor::isReply(const CanFrame& frame) const noexcept {
  if (!lktech::looksLikeCommand(frame.payload())) return true;
  return !frame.sent_here && std::abs(feedback_.temperature_c) <= kLktechNearZeroC;
}

FrameVerdict LKTech_Motor::updateFeedback(const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.fd || frame.length != lktech::kLength) {
    return FrameVerdict::kMalformed;
  }
  switch (lktech::codeOf(frame.payload())) {
    case lktech::Code::kReading:
    case lktech::Code::kCurrent:
    case lktech::Code::kVelocity:
    case lktech::Code::kPosition:
      if (!isReply(frame)) return verdictOnCommand();
      takeReading(frame);
      break;
    case lktech::Code::kStatus:
    case lktech::Code::kClear:
      if (!isReply(frame)) return verdictOnCommand();
      takeStatus(frame);
      break;
    case lktech::Code::kAngle: takeTurns(frame); break;
    case lktech::Code::kOn: return copiesOurs(frame) ? FrameVerdict::kAccepted : verdictOnCommand();
    // Frames that rc10d never sends: another controller's command or question, and the drive's copy of it or
    // answer.
    default: return lktech::looksLikeCommand(frame.payload()) ? verdictOnCommand() : FrameVerdict::kAccepted;
  }
  return FrameVerdict::kAccepted;
}

bool LKTech_Motor::copiesOurs(const CanFrame& frame) const noexcept {
  return !frame.sent_here && switched_on_ && frame.received - *switched_on_ <= kLktechCopyWithin;
}

double LKTech_Motor::encoderDeg(std::uint16_t raw) const noexcept {
  return static_cast<double>(raw & encoder_mask_) * kDegPerTurn / (static_cast<double>(encoder_mask_) + 1.0);
}

void LKTech_Motor::takeReading(const CanFrame& frame) noexcept {
  const auto reading = lktech::decodeReading(frame.payload());
  const Duration silence = heard_ ? frame.received - *heard_ : Duration::max();
  heard_ = frame.received;
  const float rpm_before = feedback_.velocity_rpm;
  feedback_.temperature_c = static_cast<float>(reading.temperature_c);
  feedback_.current_a = static_cast<float>(reading.current_raw * amperes_per_raw_) * direction();
  if (torqueNmPerA() > 0.0F) feedback_.torque_nm = feedback_.current_a * torqueNmPerA();
  feedback_.velocity_rpm =
      static_cast<float>(toOutput(reading.rotor_deg_s / traits().gear_ratio) / kDegPerSPerRpm);
  if (silence > traits().restart_silence) doubtCount();
  if (counted_ && encoder_) {
    // Way at the mean of the speeds before and now; the turn is that of the nearest such angle.
    const float mean_rpm =
        0.5F * (std::isnan(rpm_before) ? feedback_.velocity_rpm : rpm_before) + 0.5F * feedback_.velocity_rpm;
    const double expected_deg = position_deg_ + toDrive(static_cast<double>(mean_rpm)) * kDegPerSPerRpm *
                                                    static_cast<double>(seconds(silence));
    position_deg_ = expected_deg + shortestAngle(expected_deg, encoderDeg(reading.encoder));
  }
  encoder_ = reading.encoder;
  if (counted_) acceptSample(frame.received, position_deg_);
  if (lktech::codeOf(frame.payload()) == lktech::Code::kCurrent) answered(Step::kObey);
}

void LKTech_Motor::takeStatus(const CanFrame& frame) noexcept {
  const auto status = lktech::decodeStatus(frame.payload());
  feedback_.temperature_c = static_cast<float>(status.temperature_c);
  feedback_.voltage_v = static_cast<float>(status.voltage_v);
  errors_ = status.errors;
  off_ = status.off;
  answered(off_ ? Step::kStatus : Step::kTurnOn);
  if (!off_) answered(Step::kStatus);
}

// The turns are asked for at once.
void LKTech_Motor::doubtCount() noexcept {
  if (!std::exchange(counted_, false)) return;
  next_query_ = {};
  ask_turns_ = false;
}

// The drive may have started just now.
bool LKTech_Motor::countsAfresh(double angle_deg) const noexcept {
  const double deg_s = std::abs(toDrive(static_cast<double>(feedback_.velocity_rpm))) * kDegPerSPerRpm;
  return std::abs(angle_deg) < kFreshCountDeg + deg_s * kFreshForS;
}

void LKTech_Motor::takeTurns(const CanFrame& frame) noexcept {
  const std::int64_t raw = lktech::decodeAngle(frame.payload());
  // A copy of a request has the angle 0. A drive at 0 sends it in every reply, a copy comes once.
  zero_angles_ = lktech::looksLikeCommand(frame.payload()) ? zero_angles_ + 1 : 0;
  if (zero_angles_ > 0 && zero_angles_ < kZeroAnglesBelieved) return;
  if (!encoder_) return;
  const double angle_deg = static_cast<double>(raw) * lktech::kDegPerRaw / traits().gear_ratio;
  // Firmware that counts in 32 bits goes round at their end.
  const double reach_deg = 4294967296.0 * lktech::kDegPerRaw / traits().gear_ratio;
  const double off_deg = shortestWay(position_deg_ + shift_deg_, angle_deg, reach_deg);
  if (!counted_ || std::abs(off_deg) > 180.0) {
    // A drive that went on through a silence may have turned as far.
    const bool afresh = countsAfresh(shortestWay(0.0, angle_deg, reach_deg));
    const bool lost = was_counted_ && std::abs(off_deg) > 180.0 && (counted_ || afresh);
    if (lost) {
      loseReference();
      restarted_ = restarted_ || obeying();
      if (enabling()) beginEnabling();
    }
    if (lost || !was_counted_) {
      position_deg_ = angle_deg + shortestAngle(angle_deg, encoderDeg(*encoder_));
      // While it turns, the two are of different instants: what is less may be the way between them.
      const double between_deg =
          std::abs(toDrive(static_cast<double>(feedback_.velocity_rpm))) * kDegPerSPerRpm * kInstantsApartS;
      const double shift_deg = shortestWay(position_deg_, angle_deg, reach_deg);
      shift_known_ = std::abs(shift_deg) > std::max(kShiftSeenDeg, between_deg);
      shift_deg_ = shift_known_ ? shift_deg : 0.0;
    } else {
      position_deg_ += off_deg;
      position_deg_ += shortestAngle(position_deg_, encoderDeg(*encoder_));
      // Within half a turn of its last count it may have been restarted all the same.
      if (afresh) doubtTurn();
    }
    counted_ = true;
    was_counted_ = true;
  }
  // Some firmware may count from another zero than its encoder's. Seen while it stands.
  if (std::abs(feedback_.velocity_rpm) < kStandingRpm) {
    const double shift_deg = shortestWay(position_deg_, angle_deg, reach_deg);
    // A step of the target is none that a reading at the edge makes again and again.
    const double least_deg = shift_deg_ != 0.0 ? kSameAngleDeg / 2.0 : kSameAngleDeg;
    shift_deg_ = std::abs(shift_deg) > least_deg ? shift_deg : 0.0;
    shift_known_ = true;
  }
  answered(Step::kTurns);
}

// ---- Command

void LKTech_Motor::update(const Tick& tick) noexcept {
  outbox_.clear();
  const Target target = wanted();
  if (enabling() && begins()) beginEnabling();
  if (std::exchange(clear_, false)) outbox_.add(lktech::request(id_, lktech::Code::kClear));
  // A drive that has just started must get no target in turns that it counted before.
  if (!heard_ || tick.now - *heard_ > traits().restart_silence) doubtCount();
  due_ = due(tick);
  if (!due_) return;

  limits_ = 0;  // of its turn: between turns what acts goes on
  switch (ordered()) {
    case FrameKind::kRest:
    case FrameKind::kDisable: return release();
    case FrameKind::kPoll: release(); break;
    case FrameKind::kEnable: runEnabling(tick); break;
    default: follow(target); break;
  }
  sendQueries(tick);
}

void LKTech_Motor::sendQueries(const Tick& tick) noexcept {
  if (tick.now < next_query_) return;
  next_query_ = tick.now + (counted_ ? kLktechQuerySpacing : kLktechUrgentQuerySpacing);
  // An angle is not accepted before the temperature is known.
  ask_turns_ = std::isnan(feedback_.voltage_v) ? false : !ask_turns_;
  outbox_.add(lktech::request(id_, ask_turns_ ? lktech::Code::kAngle : lktech::Code::kStatus));
}

void LKTech_Motor::release() noexcept {
  setCommand(0.0, CommandUnit::kAmpere);
  sendCurrent(0);
}

int LKTech_Motor::rawOf(double amperes) const noexcept {
  const int limit = grouped_ ? lktech::kRawGroupCurrentMax : lktech::kRawCurrentMax;
  return std::clamp(static_cast<int>(saturatedRound<std::int32_t>(amperes / amperes_per_raw_)), -limit,
                    limit);
}

void LKTech_Motor::follow(const Target& target) noexcept {
  // A drive that has stopped stays so until the client enables it.
  if (!counted_ || complaint().fault != FaultCode::kNone) return release();
  // A group carries currents alone. No loop of the drive may run while no current is allowed.
  const bool loops = !grouped_ && effortLimit() > 0.0F;
  switch (loops ? target.mode : ControlMode::kCurrent) {
    case ControlMode::kCurrent: return followCurrent(target);
    case ControlMode::kVelocity: return followVelocity(target.value);
    case ControlMode::kTotalAngle: return followAngle(target.value);
    case ControlMode::kBrake: return followVelocity(0.0);
    default: return release();
  }
}

void LKTech_Motor::followCurrent(const Target& target) noexcept {
  const double current_a = currentWithinLimit(target);
  setCommand(current_a, CommandUnit::kAmpere);
  sendCurrent(rawOf(current_a * static_cast<double>(direction())));
}

void LKTech_Motor::followVelocity(double output_rpm) noexcept {
  constexpr double kFastestDegS = 2147483647.0 * lktech::kDegPerRaw;
  const double deg_s_per_rpm = std::abs(toDrive(1.0)) * traits().gear_ratio * kDegPerSPerRpm;
  const double rpm = rpmWithinLimit(output_rpm, kFastestDegS / deg_s_per_rpm);
  if (currentAtLimit(amperes_per_raw_)) limits_ |= kLimitCurrent;
  setCommand(rpm, CommandUnit::kNative);
  // 0 would be no bound.
  const int limit_raw = std::max(rawOf(static_cast<double>(effortLimit())), 1);
  outbox_.add(lktech::velocityCommand(id_, toDrive(rpm) * traits().gear_ratio * kDegPerSPerRpm, limit_raw));
}

void LKTech_Motor::followAngle(double total_angle_deg) noexcept {
  if (feedback_.samples == 0 || !std::isfinite(total_angle_deg)) return release();
  // It has turned since it was first heard: told a place now, it might go to another one.
  if (!shift_known_) return followVelocity(0.0);
  const auto rotor_deg_of = [this](double output_deg) {
    return (drivePositionFor(output_deg) + shift_deg_) * traits().gear_ratio;
  };
  constexpr double kReachDeg = 2147483647.0 * lktech::kDegPerRaw;
  // From beyond what can be told every place lies far back.
  if (std::abs(rotor_deg_of(feedback_.total_angle_deg)) > kReachDeg) {
    limits_ |= kLimitAngle;
    return followVelocity(0.0);
  }
  const double wanted_deg = rotor_deg_of(total_angle_deg);
  const double rotor_deg = std::clamp(wanted_deg, -kReachDeg, kReachDeg);
  const bool reaches = rotor_deg == wanted_deg;
  if (!reaches) limits_ |= kLimitAngle;
  if (ownLoopAtLimit(amperes_per_raw_)) limits_ |= kLimitCurrent;
  const auto limit_rpm = static_cast<double>(velocityLimitRpm());
  const double limit_deg_s = limit_rpm > 0.0
                                 ? std::abs(toDrive(limit_rpm)) * traits().gear_ratio * kDegPerSPerRpm
                                 : kLktechNoLimitDegS;
  const double away_deg = (rotor_deg - rotor_deg_of(feedback_.total_angle_deg)) / traits().gear_ratio;
  setCommand(reaches ? total_angle_deg : feedback_.total_angle_deg + toOutput(away_deg),
             CommandUnit::kNative);
  outbox_.add(lktech::positionCommand(id_, rotor_deg, limit_deg_s));
}

void LKTech_Motor::sendCurrent(int raw) noexcept {
  raw_current_ = raw;
  if (!grouped_) outbox_.add(lktech::currentCommand(id_, raw));
}

// ---- Packing

std::size_t LKTech_Motor::packCommand(const Tick& /*tick*/, std::span<CanFrame> out) noexcept {
  return outbox_.copyTo(out);
}

// The group's frame contains it.
std::size_t LKTech_Motor::packRest(std::span<CanFrame> out) const noexcept {
  if (out.empty() || grouped_) return 0;
  out.front() = lktech::currentCommand(id_, 0);
  return 1;
}

// ---- Enabling

void LKTech_Motor::beginEnabling() noexcept {
  enabling_.begin(Step::kStatus);
  restarted_ = false;
}

void LKTech_Motor::sendStep() noexcept {
  switch (enabling_.step()) {
    case Step::kStatus: return outbox_.add(lktech::request(id_, lktech::Code::kStatus));
    case Step::kTurnOn:
      outbox_.add(lktech::request(id_, lktech::Code::kOn));
      return outbox_.add(lktech::request(id_, lktech::Code::kStatus));
    case Step::kTurns: return outbox_.add(lktech::request(id_, lktech::Code::kAngle));
    case Step::kObey: break;  // the current of 0 that it is told anyway
  }
}

void LKTech_Motor::runEnabling(const Tick& tick) noexcept {
  release();
  if (!enabling_.asks(tick.now)) return;
  if (enabling_.at(Step::kTurnOn)) switched_on_ = tick.now;
  sendStep();
}

void LKTech_Motor::answered(Step step) noexcept {
  if (!sequenceRuns() || !enabling_.awaits(step)) return;
  switch (step) {
    case Step::kStatus:
      if (errors_ != 0) return enabling_.fail();
      return enabling_.next(off_ ? Step::kTurnOn : Step::kTurns);
    case Step::kTurnOn: return enabling_.next(Step::kTurns);
    case Step::kTurns: return enabling_.next(Step::kObey);
    case Step::kObey: return enabling_.finish();
  }
}

SequenceProgress LKTech_Motor::sequenceProgress() const noexcept { return progressOf(enabling_.progress()); }

// ---- Complaints

DriveComplaint LKTech_Motor::complaint() const noexcept {
  if (errors_ != 0) return complaintOfBits(lktechFaults(), errors_);
  if (restarted_ || (off_ && obeying())) {
    return {.fault = FaultCode::kDriveStopped, .native_code = off_ ? 0x10U : 0U};
  }
  return {};
}

void LKTech_Motor::clearComplaint() noexcept {
  clear_ = clear_ || errors_ != 0;
  restarted_ = false;
  next_query_ = {};
  ask_turns_ = true;  // the status is the next question
}

}  // namespace rc10
