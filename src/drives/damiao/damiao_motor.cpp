#include "drives/damiao/damiao_motor.hpp"

#include <algorithm>
#include <cmath>

#include "app/units.hpp"
#include "drives/damiao/damiao_family.hpp"
#include "motor/frame_outbox.hpp"

namespace rc10 {

using damiao::Special;

namespace {

constexpr std::size_t kFrameLength = 8;
// Tries to clear the faults of a drive before it is given up.
constexpr int kClears = 5;
constexpr Duration kPositionAskedEvery = std::chrono::milliseconds{20};
// No drive starts within that time; slow feedback has gaps of its own.
constexpr Duration kDamiaoRestartSilence = std::chrono::milliseconds{100};
constexpr int kDamiaoRestartPeriods = 3;
// A float still tells tenths of a degree here; nobody needs more turns.
constexpr double kFarthestTargetRad = 1e4;

double fastest(const MotorSettings& settings, const DamiaoScale& scale) {
  const auto* model = findDamiaoModel(settings.model);
  return model != nullptr ? damiaoFastestRadS(*model, scale) : scale.v_max_rad_s;
}

}  // namespace

Damiao_Motor::Damiao_Motor(const MotorSettings& settings)
    : SoloMotor(settings, damiaoFamily().traits(settings.model, settings.own),
                driveTurns(settings, damiaoFamily().traits(settings.model, settings.own))),
      own_(damiaoSettings(settings)),
      id_(settings.id),
      filters_{FrameFilter{
          .id = {own_.master_id, false},
          .mask = kStandardIdMask,
          .discriminators = {PayloadDiscriminator{0, 0x0F, static_cast<std::uint8_t>(settings.id)}}}},
      // Special frames go to the id of the mode as well: the manual and the vendor's routine say so, and new
      // firmware looks at the low byte only.
      command_ids_{CanId{
          (static_cast<std::uint32_t>(own_.control) - 1U) * 0x100U + static_cast<std::uint32_t>(settings.id),
          false}},
      // As a shorted winding: full torque at the no-load speed.
      damp_nms_per_rad_(static_cast<double>(traits().effort_full_scale * traits().torque_nm_per_a) /
                        (traits().no_load_rpm > 0.0F
                             ? static_cast<double>(traits().no_load_rpm) * kRadPerSPerRpm
                             : own_.scale.v_max_rad_s)),
      heard_within_(kPositionAskedEvery + 2 * std::max(settings.command_divider, 1) * tickPeriod()),
      position_(own_.scale, fastest(settings, own_.scale), feedbackPeriod()),
      speed_(own_.scale.v_max_rad_s, fastest(settings, own_.scale)),
      travel_(settings.travel),
      enabling_({.id = settings.id, .control = own_.control, .timeout = own_.timeout, .scale = own_.scale}),
      setup_codec_(settings.id, own_.can_fd) {
  release();
}

// ---- Feedback

bool Damiao_Motor::matchesFrame(const CanFrame& frame) const noexcept {
  return frame.type == FrameType::kData && frame.id == filters_[0].id && frame.fd == own_.can_fd &&
         accepts(filters_[0], frame);
}

FrameVerdict Damiao_Motor::updateFeedback(const CanFrame& frame) noexcept {
  if (frame.type != FrameType::kData || frame.fd != own_.can_fd || frame.length != kFrameLength) {
    return FrameVerdict::kMalformed;
  }
  configuring_.onFrame(frame);
  const auto payload = std::span(frame.data).first<kFrameLength>();
  if (const auto reply = damiao::readReply(payload, id_)) {
    takeReply(*reply);
  } else {
    takeState(damiao::readState(payload), frame.received);
  }
  return FrameVerdict::kAccepted;
}

void Damiao_Motor::takeState(const damiao::State& state, MonotonicTime received) noexcept {
  // It may have been restarted meanwhile, and count from another turn.
  if (feedback_.samples > 0 &&
      received - feedback_.received >
          std::max(kDamiaoRestartSilence, kDamiaoRestartPeriods * feedbackPeriod())) {
    position_.forget();
    speed_.restart();
    loseReference();
  }
  const bool was_enabled = status_ == damiao::kStatusEnabled;
  status_ = state.status;
  if (status_ < damiao::kFirstFault) clears_left_ = 0;
  if (sequenceRuns() && enabling_.progress() == SequenceProgress::kPending) {
    enabling_.onStatus(status_);
    armed_ = enabling_.progress() == SequenceProgress::kDone;
  }
  if (armed_ && status_ != damiao::kStatusEnabled) {
    armed_ = false;
    // Restarted, perhaps: it may count from elsewhere.
    if (status_ == damiao::kStatusDisabled) {
      stopped_ = obeying();
      position_.forget();
      speed_.restart();
      loseReference();
    }
  }

  const auto step = position_.take(state.position, received);
  if (step != DamiaoPosition::Step::kFollows) loseReference();
  // A drive that has been enabled all the time was not restarted: its encoder has slipped.
  if (step == DamiaoPosition::Step::kJumped && was_enabled && status_ == damiao::kStatusEnabled) {
    ++feedback_.jumps;
  }

  measured_rad_s_ = speed_.take(damiao::measured(state.velocity, own_.scale.v_max_rad_s, 12), position_.rad(),
                                step == DamiaoPosition::Step::kFollows, received);
  const double torque_nm = torqueToOutput(damiao::measured(state.torque, own_.scale.t_max_nm, 12));
  feedback_.velocity_rpm = static_cast<float>(toOutput(measured_rad_s_) / kRadPerSPerRpm);
  feedback_.torque_nm = static_cast<float>(torque_nm);
  feedback_.current_a = static_cast<float>(torque_nm) / torqueNmPerA();
  // The hotter of power stage and winding.
  feedback_.temperature_c =
      std::max(damiao::temperature(state.drive_temperature), damiao::temperature(state.winding_temperature));
  // Not even an absolute angle is known before the wraps are.
  acceptSample(received, position_.rad() / kRadPerDeg, position_.known());
}

void Damiao_Motor::takeReply(const damiao::RegisterReply& reply) noexcept {
  if (reply.address != damiao::Register::kOutputPosition) {
    // While it obeys, somebody else has asked or written: targets in another scale would be other torques.
    if (sequenceRuns() || armed_) {
      enabling_.onReply(reply);
      if (enabling_.culprit()) armed_ = false;
    }
    return;
  }
  if (reply.written) return;
  if (position_.take(damiao::floatOf(reply.value)) == DamiaoPosition::Wrap::kOther) {
    speed_.restart();
    loseReference();
    takeAngle(position_.rad() / kRadPerDeg, false);  // turns that are known now are no way
  }
  if (position_.known()) takeAngle(position_.rad() / kRadPerDeg);
  if (enabling()) enabling_.onPosition(position_.known());
}

bool Damiao_Motor::setZero(double angle_deg) noexcept {
  return position_.known() && reachesTravelAt(angle_deg) && SoloMotor::setZero(angle_deg);
}

double Damiao_Motor::torqueLimitNm() const noexcept {
  return std::min(driveTorqueLimitNm(), own_.scale.t_max_nm);
}

double Damiao_Motor::springReach(double stiffness_nm_per_rad) const noexcept {
  return springReachRad(own_.scale.p_max_rad, torqueLimitNm(), stiffness_nm_per_rad);
}

bool Damiao_Motor::reachesTravelAt(double angle_deg) const noexcept {
  if (own_.control != DamiaoControl::kMit) return true;
  const double gear = toDrive(1.0);
  const double reach_rad = springReach(own_.gains.angle_stiffness_nm_per_rad / (gear * gear));
  return reachesTravel(travel_, angle_deg, position_.rad() / kRadPerDeg, gear, reach_rad / kRadPerDeg);
}

// ---- Command

void Damiao_Motor::update(const Tick& tick) noexcept {
  limits_ = 0;
  Target target = wanted();
  if (!std::isfinite(target.value)) target = Target{};
  runEnabling(tick);
  if (obeying() && !armed_ && status_ < damiao::kFirstFault) stopped_ = true;
  if (!armed_) {
    release();
    return;
  }
  switch (own_.control) {
    case DamiaoControl::kMit: followMit(target, tick.now); break;
    case DamiaoControl::kVelocity: followVelocity(target); break;
    case DamiaoControl::kPositionVelocity:
    case DamiaoControl::kForcePosition: followAngle(target); break;
  }
}

double Damiao_Motor::fastestRadS() const noexcept {
  const double limit_rad_s = std::fabs(toDrive(static_cast<double>(velocityLimitRpm()))) * kRadPerSPerRpm;
  return limit_rad_s > 0.0 ? std::min(limit_rad_s, own_.scale.v_max_rad_s) : own_.scale.v_max_rad_s;
}

void Damiao_Motor::dropWindup(float /*least_rpm*/) noexcept {
  lead_.dropWindup(measured_rad_s_, fastestRadS(), torqueLimitNm());
}

void Damiao_Motor::release() noexcept {
  command_ = specialFrame(Special::kDisable);
  reach_.release();
  lead_.release();
  stay_rad_.reset();
  setCommand(0.0, CommandUnit::kNone);
}

SpringLaw Damiao_Motor::mitLaw(const Target& target) const noexcept {
  if (ordered() == FrameKind::kDamp) return resistance(damp_nms_per_rad_);
  SpringLaw law;
  // Gains are at the output shaft; an own gear behind the drive counts squared.
  const double gear = toDrive(1.0) * toDrive(1.0);
  const double ff_nm = torqueToDrive(static_cast<double>(target.torque_ff_nm));
  const double ff_rad_s = toDrive(static_cast<double>(target.velocity_ff_rpm)) * kRadPerSPerRpm;
  switch (target.mode) {
    case ControlMode::kCurrent:
      law.torque_nm = torqueToDrive(target.value * static_cast<double>(torqueNmPerA())) + ff_nm;
      break;
    case ControlMode::kBrake: return resistance(own_.gains.velocity_damping_nms_per_rad / gear);
    case ControlMode::kVelocity:
      law.damping_nms_per_rad = own_.gains.velocity_damping_nms_per_rad / gear;
      law.velocity_rad_s = toDrive(target.value) * kRadPerSPerRpm;
      law.torque_nm = ff_nm;
      break;
    case ControlMode::kTotalAngle:
    case ControlMode::kImpedance: {
      const bool given = target.mode == ControlMode::kImpedance;
      law.stiffness_nm_per_rad =
          (given ? static_cast<double>(target.stiffness_nm_per_rad) : own_.gains.angle_stiffness_nm_per_rad) /
          gear;
      law.damping_nms_per_rad =
          (given ? static_cast<double>(target.damping_nms_per_rad) : own_.gains.angle_damping_nms_per_rad) /
          gear;
      law.position_rad = drivePositionFor(target.value) * kRadPerDeg;
      law.velocity_rad_s = ff_rad_s;
      law.torque_nm = ff_nm;
      break;
    }
    default: break;
  }
  return law;
}

void Damiao_Motor::followMit(const Target& target, MonotonicTime now) noexcept {
  const auto law = mitLaw(target);
  DamiaoMitBounds bounds{.scale = own_.scale,
                         .torque_nm = torqueLimitNm(),
                         .velocity_rad_s = velocityLimitRpm() > 0.0F ? fastestRadS() : 0.0,
                         .measured = {position_.rad(), measured_rad_s_},
                         .position_known = position_.known(),
                         .lead = target.mode == ControlMode::kTotalAngle ? &lead_ : nullptr,
                         .now = now,
                         .damping_nms_per_rad = damp_nms_per_rad_};
  if (law.stiffness_nm_per_rad > 0.0)
    bounds.reach_rad = reach_.step(springReach(law.stiffness_nm_per_rad), position_.rad());
  else
    reach_.release();
  if (bounds.lead == nullptr) lead_.release();
  const auto command = boundedMit(law, bounds, limits_);
  command_ = frameOf(command_ids_[0], damiao::mit(command, own_.scale));
  const double torque_nm = torqueToOutput(torqueNm(command, bounds.measured));
  setCommand(torque_nm / static_cast<double>(torqueNmPerA()), CommandUnit::kAmpere);
}

void Damiao_Motor::followVelocity(const Target& target) noexcept {
  const double wanted_rad_s =
      target.mode == ControlMode::kVelocity ? toDrive(target.value) * kRadPerSPerRpm : 0.0;
  const double rad_s = std::clamp(wanted_rad_s, -fastestRadS(), fastestRadS());
  if (rad_s != wanted_rad_s) limits_ |= kLimitVelocity;
  command_ = frameOf(command_ids_[0], damiao::velocity(static_cast<float>(rad_s)));
  setCommand(toOutput(rad_s) / kRadPerSPerRpm, CommandUnit::kNative);
}

void Damiao_Motor::followAngle(const Target& target) noexcept {
  // From beyond what can be told every place lies far back.
  const bool beyond = std::fabs(position_.rad()) > kFarthestTargetRad;
  if (beyond) limits_ |= kLimitAngle;
  const bool moves = target.mode == ControlMode::kTotalAngle && position_.known() && !beyond;
  double rad = 0.0;
  if (moves) {
    const double wanted_rad = drivePositionFor(target.value) * kRadPerDeg;
    rad = std::clamp(wanted_rad, -kFarthestTargetRad, kFarthestTargetRad);
    if (rad != wanted_rad) limits_ |= kLimitAngle;
    stay_rad_.reset();
  } else {
    // With a limit of 0 the position is not even looked at; it is there for a firmware that does.
    if (!stay_rad_) stay_rad_ = position_.rad();
    rad = *stay_rad_;
  }
  const double limit_rad_s = moves ? fastestRadS() : 0.0;
  // From where it is: exact however far away the target was.
  setCommand(feedback_.total_angle_deg + toOutput((rad - position_.rad()) / kRadPerDeg),
             CommandUnit::kNative);
  if (own_.control == DamiaoControl::kPositionVelocity) {
    command_ = frameOf(command_ids_[0],
                       damiao::positionVelocity(static_cast<float>(rad), static_cast<float>(limit_rad_s)));
    return;
  }
  // Where it can follow no angle, an angle stands as a brake does.
  const bool holds = target.mode == ControlMode::kTotalAngle || target.mode == ControlMode::kBrake;
  // A torque beyond the scale of the feedback would be reported as one the other way.
  const auto nm_per_a = static_cast<double>(traits().torque_nm_per_a);
  const double limit_a = std::min(static_cast<double>(effortLimit()), own_.scale.t_max_nm / nm_per_a);
  if (holds && currentAtLimit(limit_a, damiao::torqueStep(own_.scale) / nm_per_a)) limits_ |= kLimitCurrent;
  const double share = limit_a / static_cast<double>(traits().effort_full_scale);
  command_ = frameOf(command_ids_[0], damiao::forcePosition(static_cast<float>(rad), limit_rad_s,
                                                            holds ? std::min(share, 1.0) : 0.0));
}

// ---- Packing

CanFrame Damiao_Motor::frameOf(CanId id, std::span<const std::uint8_t> payload) const noexcept {
  return own_.can_fd ? makeFdFrame(id, payload, true) : makeClassicFrame(id, payload);
}

CanFrame Damiao_Motor::specialFrame(Special command) const noexcept {
  return frameOf(command_ids_[0], damiao::special(command));
}

bool Damiao_Motor::asksPosition(const Tick& tick) noexcept {
  if (position_.known() || feedback_.samples == 0 || enabling()) return false;
  if (tick.now - feedback_.received > heard_within_ || tick.now - asked_position_ < kPositionAskedEvery)
    return false;
  asked_position_ = tick.now;
  return true;
}

std::size_t Damiao_Motor::packCommand(const Tick& tick, std::span<CanFrame> out) noexcept {
  constexpr CanId kRegisters{damiao::kRegisterId, false};
  FrameOutbox frames;
  if (sequenceRuns() && enabling_.progress() == SequenceProgress::kPending) {
    const bool quiet = enabling_.quiet();
    const auto request = enabling_.take(tick.now);
    // Repeated: disable for its feedback; enable for its watchdog, in case the answer alone was lost.
    if (due(tick) && (quiet || !request)) {
      frames.add(specialFrame(quiet ? Special::kDisable : Special::kEnable));
    }
    if (request) frames.add(frameOf(request->of_register ? kRegisters : command_ids_[0], request->payload));
    return frames.copyTo(out);
  }
  const std::size_t count = !armed_ && !obeying() ? configuring_.pack(tick.now, out) : 0;
  if (!due(tick)) return count;
  const bool clears = clears_left_ > 0 && !armed_;
  if (clears) --clears_left_;
  frames.add(clears ? specialFrame(Special::kClear) : command_);
  if (asksPosition(tick)) {
    frames.add(frameOf(kRegisters, damiao::readRegister(id_, damiao::Register::kOutputPosition)));
  }
  return count + frames.copyTo(out.subspan(count));
}

std::size_t Damiao_Motor::packRest(std::span<CanFrame> out) const noexcept {
  FrameOutbox frames;
  frames.add(specialFrame(Special::kDisable));
  return frames.copyTo(out);
}

// ---- Enabling

void Damiao_Motor::runEnabling(const Tick& tick) noexcept {
  if (!enabling()) {
    if (!obeying()) armed_ = false;
    return;
  }
  if (begins()) {
    armed_ = stopped_ = false;
    enabling_.begin();
    // A fault that is known already: it is cleared by request only.
    if (status_ >= damiao::kFirstFault) enabling_.onStatus(status_);
  }
  enabling_.update(tick.now);
}

SequenceProgress Damiao_Motor::sequenceProgress() const noexcept { return progressOf(enabling_.progress()); }

// ---- Complaints

DriveComplaint Damiao_Motor::complaint() const noexcept {
  if (const auto fault = damiao::faultOf(status_); fault != FaultCode::kNone) return {fault, status_};
  if (const auto culprit = enabling_.culprit()) {
    return {FaultCode::kDriveSetting, kRegisterComplaint + static_cast<std::uint32_t>(*culprit)};
  }
  if (stopped_) return {FaultCode::kDriveStopped, status_};
  return scaleComplaint();
}

void Damiao_Motor::clearComplaint() noexcept {
  enabling_.forgive();
  stopped_ = false;
  if (status_ >= damiao::kFirstFault) clears_left_ = kClears;
}

}  // namespace rc10
