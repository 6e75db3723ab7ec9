#include "drives/cubemars/cubemars_mit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "app/units.hpp"
#include "motor/frame_outbox.hpp"

namespace rc10 {
namespace {

using cubemars::MitOrder;
using cubemars::ServoCommand;

constexpr double kMostAmperes = 1e6;  // of a target: no sum overflows

constexpr Duration kMitStepPatience = std::chrono::milliseconds{50};
constexpr int kMitAttempts = 6;  // the first, and five more
// The answers to "no torque", "enter" and "no torque", and one that was under way before them.
constexpr std::uint64_t kAnswersToEnter = 4;
// Those to "no torque" and "leave", twice, and one that was under way before them.
constexpr std::uint64_t kAnswersToRest = 5;
constexpr double kMitDampShare = 0.25;  // of the damping of brake
// Share of the torque of a spring one turn of the field away (at most the whole range) that counts as a pull
// the other way: delay and resolution of the report hide the rest.
constexpr double kSpringMismatch = 0.6;
// An answer that came by a USB adapter may show a law that is this old: then it has that law's torque, up to
// this share of the same torque.
constexpr Duration kLongestAnswer = std::chrono::milliseconds{10};
constexpr double kSameTorque = 0.25;
// Samples in a row: a stiff damping pulls the other way for one sample alone.
constexpr int kSamplesAgainst = 4;
// Detail of kDriveSetting: the drive counts its turns otherwise.
constexpr std::uint32_t kOtherTurns = 0x4000'0000U;
// Two samples at the very end of a field: it does not go round, it is cut off.
constexpr int kSamplesAtEnd = 2;

}  // namespace

CubemarsMit::CubemarsMit(const MotorSettings& settings, const CubemarsSettings& own)
    : CubeMars_Motor(settings, own),
      v3_(own.protocol == CubemarsProtocol::kMitV3),
      angle_stiffness_(settings.own.number("angle_stiffness_nm_per_rad")),
      angle_damping_(settings.own.number("angle_damping_nms_per_rad")),
      velocity_gain_(settings.own.number("velocity_gain_nms_per_rad")),
      speed_(own.ranges.velocity_rad_s,
             std::max(own.ranges.velocity_rad_s, cubemarsFastestRpm(*own.model) * kRadPerSPerRpm)),
      cut_off_speed_(own.ranges.velocity_rad_s),
      travel_(settings.travel),
      enabling_(kMitStepPatience, kMitAttempts) {
  const auto id = static_cast<std::uint8_t>(settings.id);
  // In case a firmware cuts off what does not fit, unlike the Mini Cheetah's.
  if (!v3_) speedFieldEndsAt(own.ranges.velocity_rad_s);
  if (v3_) {
    filters_.fill(FrameFilter{.id = cubemars::servoFeedbackId(settings.id)});
    command_ids_ = {cubemars::servoId(ServoCommand::kMit, settings.id),
                    cubemars::servoId(ServoCommand::kCurrent, settings.id)};
  } else {
    // Which of the two ids answers come from depends on the firmware (cubemars_driver_node). The first
    // byte tells whose they are.
    const PayloadDiscriminator sender{.byte_index = 0, .mask = 0xFF, .value = id};
    filters_ = {
        FrameFilter{.id = {0, false}, .mask = kStandardIdMask, .discriminators = {sender}},
        FrameFilter{.id = cubemars::mitId(settings.id), .mask = kStandardIdMask, .discriminators = {sender}}};
    command_ids_.fill(cubemars::mitId(settings.id));
  }
}

std::span<const FrameFilter> CubemarsMit::filters() const noexcept {
  return std::span{filters_}.first(v3_ ? 1 : 2);
}

std::span<const CanId> CubemarsMit::commandIds() const noexcept {
  return std::span{command_ids_}.first(v3_ ? 2 : 1);
}

// ---- Feedback

bool CubemarsMit::matchesFrame(const CanFrame& frame) const noexcept {
  if (v3_) return isFrom(frame, filters_[0].id);
  // The drive's own id also carries commands of other programs on this computer.
  const bool addressed = isFrom(frame, filters_[0].id) || (isFrom(frame, filters_[1].id) && !frame.sent_here);
  return addressed && frame.length > 0 && frame.data[0] == static_cast<std::uint8_t>(driveId());
}

FrameVerdict CubemarsMit::updateFeedback(const CanFrame& frame) noexcept {
  if (!v3_) return takeMitReport(frame);
  const FrameVerdict verdict = takeServoReport(frame);
  if (verdict == FrameVerdict::kAccepted) {
    position_rad_ = lastDriveDeg() * kRadPerDeg;
    velocity_rad_s_ = driveRadS(static_cast<double>(feedback_.velocity_rpm));
    // Its feedback goes farther than its commands.
    turns_ = std::fabs(position_rad_) > own().ranges.position_rad ? 1 : 0;
  }
  return verdict;
}

FrameVerdict CubemarsMit::takeMitReport(const CanFrame& frame) noexcept {
  const auto report = cubemars::readMitReport(frame, own().ranges);
  if (!report) return FrameVerdict::kMalformed;
  const bool anew = feedback_.samples == 0 || noticeRestart(frame.received);
  const double drive_rad = unwrapped(report->position_rad, anew);
  const bool follows = !anew && reaches(frame.received, drive_rad / kRadPerDeg);
  velocity_rad_s_ = speed_.take(report->velocity_rad_s, drive_rad, follows, frame.received);
  cut_off_speed_.add(drive_rad, follows, frame.received);
  samples_at_speed_end_ = report->speed_at_end ? std::min(samples_at_speed_end_ + 1, kSamplesAtEnd) : 0;
  feedback_.velocity_rpm = static_cast<float>(toOutput(velocity_rad_s_ / kRadPerSPerRpm));
  watchSpring(*report, frame.received);
  takePosition(frame.received, drive_rad / kRadPerDeg);
  samples_at_end_ = report->at_end ? std::min(samples_at_end_ + 1, kSamplesAtEnd) : 0;
  feedback_.angle_at_end = samples_at_end_ == kSamplesAtEnd;
  if (feedback_.angle_at_end) loseReference();
  feedback_.zero_refused = refusesZeros();
  feedback_.torque_nm = static_cast<float>(torqueToOutput(report->torque_nm));
  feedback_.current_a = feedback_.torque_nm / torqueNmPerA();
  if (report->temperature_c) feedback_.temperature_c = static_cast<float>(*report->temperature_c);
  takeError(report->error);
  return FrameVerdict::kAccepted;
}

// The field goes round at its ends (TMotorCANControl and others count its turns). Half of it is far more
// than an output shaft turns between two answers.
double CubemarsMit::unwrapped(double position_rad, bool anew) noexcept {
  const double span_rad = cubemars::positionWrapRad(own().ranges);
  if (anew) {
    // A drive that was not restarted still counts the turns outside of the field.
    turns_unknown_ = turns_unknown_ || turns_ != 0;
    turns_ = 0;
  } else {
    const double step_rad = position_rad - position_rad_;
    if (step_rad > span_rad / 2.0) --turns_;
    if (step_rad < -span_rad / 2.0) ++turns_;
  }
  position_rad_ = position_rad;
  return position_rad + turns_ * span_rad;
}

// The drive reports its position modulo the field, but its spring acts on the whole position. The first
// sample does not tell on which turn the drive is; on another turn than the field's the spring pulls the
// other way with full torque.
void CubemarsMit::watchSpring(const cubemars::MitReport& report, MonotonicTime received) noexcept {
  const double most_nm = own().ranges.torque_nm;
  const double stiffness = sent_.last().stiffness_nm_per_rad;
  const double turn_nm = stiffness * cubemars::positionWrapRad(own().ranges);
  const double apart_nm = kSpringMismatch * std::min(most_nm, turn_nm);
  const auto told_nm = [&](const SpringLaw& law) {
    return std::clamp(torqueNm(law, measured()), -most_nm, most_nm);
  };
  int against = 0;
  if (obeying() && stiffness > 0.0 && std::fabs(report.torque_nm) > apart_nm) {
    // Too little torque is not torque the other way: near its no-load speed a drive gives less than it is
    // told.
    const auto [low_nm, high_nm] = std::minmax({told_nm(sent_.last()), told_nm(sent_.lastButOne()), 0.0});
    if (report.torque_nm > high_nm + apart_nm) against = 1;
    if (report.torque_nm < low_nm - apart_nm) against = -1;
  }
  const auto shows = [&](const SpringLaw& law) {
    return std::fabs(report.torque_nm - told_nm(law)) <= kSameTorque * std::min(most_nm, turn_nm);
  };
  if (against != 0 && sent_.anySince(received - kLongestAnswer, shows)) against = 0;
  const bool goes_on = against * samples_against_ > 0;
  samples_against_ =
      std::clamp(goes_on ? samples_against_ + against : against, -kSamplesAgainst, kSamplesAgainst);
  if (!pullsOtherwise()) return;
  turns_unknown_ = true;
  loseReference();
}

bool CubemarsMit::limited() const noexcept {
  return std::isfinite(travel_.min_deg) || std::isfinite(travel_.max_deg);
}

bool CubemarsMit::setZero(double angle_deg) noexcept {
  const double ratio = toDrive(1.0);
  const double reach_deg = springReach(angle_stiffness_) / kRadPerDeg;
  const bool reaches = reachesTravel(travel_, angle_deg, lastDriveDeg(), ratio, reach_deg);
  if (refusesZeros() || (limited() && !reaches)) return false;
  return CubeMars_Motor::setZero(angle_deg);
}

double CubemarsMit::springReach(double stiffness_nm_per_rad) const noexcept {
  return springReachRad(own().ranges.position_rad, std::min(driveTorqueLimitNm(), own().ranges.torque_nm),
                        stiffness_nm_per_rad);
}

// ---- Command

// The bounds of a command are computed from the feedback: it must not be old.
bool CubemarsMit::silent(const Tick& tick) const noexcept {
  return feedback_.samples == 0 || tick.now - feedback_.received > longestGap();
}

void CubemarsMit::update(const Tick& tick) noexcept {
  limits_ = 0;
  enter_now_ = false;
  const Target target = wanted();
  if (!v3_ && enabling()) runEnabling(tick);
  const bool damps = ordered() == FrameKind::kDamp;
  const bool coasts = target.mode == ControlMode::kCoast && !damps;
  if (target.mode != ControlMode::kTotalAngle && target.mode != ControlMode::kImpedance) reach_.release();
  if (target.mode != ControlMode::kTotalAngle) lead_.release();
  if (coasts || silent(tick) || !std::isfinite(target.value)) {
    release();
  } else {
    send(damps ? resistance(kMitDampShare * velocity_gain_) : lawOf(target, tick.now));
  }
}

SpringState CubemarsMit::measured() const noexcept {
  const bool cut_off = samples_at_speed_end_ == kSamplesAtEnd;
  return {position_rad_, cut_off ? cut_off_speed_.of(velocity_rad_s_) : velocity_rad_s_};
}

double CubemarsMit::driveRadS(double output_rpm) const noexcept {
  return toDrive(output_rpm) * kRadPerSPerRpm;
}

double CubemarsMit::limitRadS() const noexcept {
  return std::fabs(driveRadS(static_cast<double>(velocityLimitRpm())));
}

void CubemarsMit::dropWindup(float /*least_rpm*/) noexcept {
  lead_.dropWindup(velocity_rad_s_, limitRadS(), driveTorqueLimitNm());
}

double CubemarsMit::boundRpm(double wanted_rpm) noexcept {
  return rpmWithinLimit(wanted_rpm, own().ranges.velocity_rad_s / std::fabs(driveRadS(1.0)));
}

SpringLaw CubemarsMit::velocityLaw(double output_rpm, double torque_ff_nm, double gain) noexcept {
  return {.velocity_rad_s = driveRadS(boundRpm(output_rpm)),
          .damping_nms_per_rad = gain,
          .torque_nm = torqueToDrive(torque_ff_nm)};
}

// `stiffness` and `damping` at the drive's output.
SpringLaw CubemarsMit::angleLaw(const Target& target, double stiffness, double damping) noexcept {
  const double ff_nm = static_cast<double>(target.torque_ff_nm);
  if (!inRange()) {
    // The command's position field ends there; the drive's response beyond it is unknown.
    limits_ |= kLimitAngle;
    return resistance(std::max(std::min(damping, CubemarsRanges::kDampingNmsPerRad), velocity_gain_));
  }
  const double reach_rad = reach_.step(springReach(stiffness), position_rad_);
  const double wanted_rad = drivePositionFor(target.value) * kRadPerDeg;
  SpringLaw law{.position_rad = std::clamp(wanted_rad, -reach_rad, reach_rad),
                .velocity_rad_s = driveRadS(boundRpm(static_cast<double>(target.velocity_ff_rpm))),
                .stiffness_nm_per_rad = stiffness,
                .damping_nms_per_rad = damping,
                .torque_nm = torqueToDrive(ff_nm)};
  if (law.position_rad != wanted_rad) limits_ |= kLimitAngle;
  // As the frame can say them: the errors are bounded by these.
  boundGains(law, CubemarsRanges::kStiffnessNmPerRad, CubemarsRanges::kDampingNmsPerRad);
  return law;
}

SpringLaw CubemarsMit::approachLaw(const Target& target, MonotonicTime now) noexcept {
  auto law = angleLaw(target, angle_stiffness_, angle_damping_);
  if (limitRadS() > 0.0 && lead_.apply(law, measured(), limitRadS(), driveTorqueLimitNm(), now))
    limits_ |= kLimitVelocity;
  return law;
}

SpringLaw CubemarsMit::lawOf(const Target& target, MonotonicTime now) noexcept {
  const double ff_nm = static_cast<double>(target.torque_ff_nm);
  switch (target.mode) {
    case ControlMode::kCurrent: {
      const double amperes = std::clamp(target.value, -kMostAmperes, kMostAmperes);
      return {.torque_nm = torqueToDrive(amperes * static_cast<double>(torqueNmPerA()) + ff_nm)};
    }
    case ControlMode::kVelocity: return velocityLaw(target.value, ff_nm, velocity_gain_);
    case ControlMode::kTotalAngle: return approachLaw(target, now);
    case ControlMode::kImpedance: {
      // Gains of the shaft, seen through what gear lies behind the drive's output.
      const double ratio = toDrive(1.0);
      return angleLaw(target, static_cast<double>(target.stiffness_nm_per_rad) / (ratio * ratio),
                      static_cast<double>(target.damping_nms_per_rad) / (ratio * ratio));
    }
    case ControlMode::kBrake: return resistance(velocity_gain_);
    case ControlMode::kCoast:
    case ControlMode::kAngle:  // wanted() has made it a total angle
    case ControlMode::kVoltage:
    case ControlMode::kDuty: break;
  }
  return {};
}

void CubemarsMit::send(const SpringLaw& wanted_law) noexcept {
  // The sum is bounded by the range of the field.
  const double most_nm = own().ranges.torque_nm;
  command_ = wanted_law;
  command_.torque_nm = std::clamp(command_.torque_nm, -most_nm, most_nm);
  if (command_.torque_nm != wanted_law.torque_nm) limits_ |= kLimitCurrent;
  if (boundTorque(command_, measured(), driveTorqueLimitNm(), SpringYield::kErrors)) limits_ |= kLimitCurrent;
  // A shaft that is faster than its field can say has a greater error than that: the gains yield.
  const double most_rad_s = own().ranges.velocity_rad_s;
  command_.velocity_rad_s = std::clamp(command_.velocity_rad_s, -most_rad_s, most_rad_s);
  if (boundTorque(command_, measured(), driveTorqueLimitNm(), SpringYield::kGains)) limits_ |= kLimitCurrent;
  keepResisting(command_, CubemarsRanges::kDampingStepNmsPerRad);
  setCommand(torqueToOutput(torqueNm(command_, measured())) / static_cast<double>(torqueNmPerA()),
             CommandUnit::kAmpere);
}

void CubemarsMit::release() noexcept {
  command_ = {};
  setCommand(0.0, CommandUnit::kAmpere);
}

// ---- Packing

CanFrame CubemarsMit::commandFrame(const SpringLaw& law) const noexcept {
  return v3_ ? cubemars::mitV3Frame(driveId(), own().ranges, law)
             : cubemars::mitFrame(driveId(), own().ranges, law);
}

std::size_t CubemarsMit::packCommand(const Tick& tick, std::span<CanFrame> out) noexcept {
  if (out.size() < kMaxFramesPerPacker) return 0;
  if (clear_now_ || enter_now_) return packEnter(out);
  // The last frame of that may not have left.
  const bool behind_enter = std::exchange(entered_, false);
  if (!due(tick) && !behind_enter) return 0;
  if (!enabling() && !obeying()) {
    if (v3_ || !leftAtRest()) return packRest(out);
    out[0] = cubemars::mitOrderFrame(driveId(), MitOrder::kExit);  // the drive answers this one too
    return 1;
  }
  samples_before_rest_.reset();
  out[0] = commandFrame(enabling() ? SpringLaw{} : command_);
  sent_.add(enabling() ? SpringLaw{} : command_, tick.now);
  return 1;
}

// A frame that is packed may be held back: only an answer tells that it was not.
bool CubemarsMit::leftAtRest() noexcept {
  if (!samples_before_rest_) samples_before_rest_ = feedback_.samples;
  return feedback_.samples >= *samples_before_rest_ + kAnswersToRest;
}

std::size_t CubemarsMit::packEnter(std::span<CanFrame> out) noexcept {
  FrameOutbox frames;
  frames.add(commandFrame({}));
  frames.add(cubemars::mitOrderFrame(driveId(), MitOrder::kEnter));
  frames.add(commandFrame({}));
  samples_before_rest_.reset();
  if (!enter_now_) frames.add(cubemars::mitOrderFrame(driveId(), MitOrder::kExit));
  clear_now_ = false;
  entered_ = true;
  return frames.copyTo(out);
}

std::size_t CubemarsMit::packRest(std::span<CanFrame> out) const noexcept {
  FrameOutbox frames;
  // "No torque" of a MIT command is half a step of its field; the current of 0 that follows is exact.
  frames.add(commandFrame({}));
  frames.add(v3_ ? cubemars::currentFrame(driveId(), 0.0)
                 : cubemars::mitOrderFrame(driveId(), MitOrder::kExit));
  return frames.copyTo(out);
}

// ---- Enabling

// No field of an answer tells whether the drive has entered the mode: an answer without an error is the only
// evidence.
void CubemarsMit::runEnabling(const Tick& tick) noexcept {
  if (begins()) {
    enabling_.begin(Step::kEnter);
    forgetStop();
  }
  const bool answered = enabling_.awaits() && feedback_.samples >= samples_before_ + kAnswersToEnter;
  if (answered && error() == 0) enabling_.finish();
  const bool first = !enabling_.awaits();
  enter_now_ = enabling_.asks(tick.now);
  if (enter_now_ && first) samples_before_ = feedback_.samples;
}

SequenceProgress CubemarsMit::sequenceProgress() const noexcept {
  return v3_ ? SequenceProgress::kDone : progressOf(enabling_.progress());
}

// ---- Complaints

bool CubemarsMit::pullsOtherwise() const noexcept { return std::abs(samples_against_) == kSamplesAgainst; }

DriveComplaint CubemarsMit::complaint() const noexcept {
  const auto own = CubeMars_Motor::complaint();
  if (own.fault == FaultCode::kNone && pullsOtherwise()) return {FaultCode::kDriveSetting, kOtherTurns};
  return own;
}

void CubemarsMit::clearComplaint() noexcept {
  forgetStop();
  samples_against_ = 0;
  clear_now_ = !v3_ && !obeying();
}

}  // namespace rc10
