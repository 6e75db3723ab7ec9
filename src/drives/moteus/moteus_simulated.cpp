#include "drives/moteus/moteus_simulated.hpp"
#include "app/angle.hpp"
#include "app/units.hpp"
#include "drives/moteus/moteus_family.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rc10::sim {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// The factory's: servo.default_timeout_s, servo.timeout_max_torque_Nm; its servo.timeout_mode is 12, zero
// velocity. Source: fw/bldc_servo_structs.h.
constexpr double kDefaultTimeoutSeconds = 0.1;
constexpr double kTimeoutTorqueNm = 5.0;
constexpr double kAccelerationRevPerS2 = 50.0;  // servo.default_accel_limit
constexpr double kFastestRevPerS = 500.0;       // servo.max_velocity
// Gate driver on, then 256 samples of the current offsets at 30 kHz. Source: fw/bldc_servo.cc.
constexpr Duration kSwitchTime = std::chrono::milliseconds{10};
// Bandwidth of gains that somebody has tuned for the load.
constexpr double kBandwidthRadS = 120.0;
constexpr std::uint32_t kEverybody = 0x7F;
constexpr std::uint32_t kFirstLimit = 96;  // codes from here on bound the output and are no faults
constexpr std::uint32_t kMaxTorqueLimit = 102;

[[nodiscard]] std::vector<FrameFilter> sentBy(const MotorSettings& settings) {
  return {FrameFilter{.id = moteus::replyId(moteusSettings(settings.own).can_prefix,
                                            static_cast<std::uint32_t>(settings.id))}};
}

// Source of the codes: fw/moteus_controller.cc, Write() and Read().
constexpr std::uint8_t kUnknownRegister = 1;
constexpr std::uint8_t kReadOnly = 2;

/// The value of a written register as the drive keeps it: its counts, times the unit, as floats.
[[nodiscard]] double inSinglePrecision(const moteus::Item& item) noexcept {
  if (item.type == moteus::Type::kFloat || std::isnan(item.value)) return item.value;
  const double scale = moteus::scaleOf(item.reg, item.type);
  const auto counts = static_cast<float>(std::round(item.value / scale));
  return static_cast<double>(counts * static_cast<float>(scale));
}

}  // namespace

MoteusDrive::MoteusDrive(const MotorSettings& settings, const MotorTraits& traits, const MotorLoad& load)
    : ServoDrive(settings, traits, load, sentBy(settings)),
      id_(static_cast<std::uint32_t>(settings.id)),
      prefix_(moteusSettings(settings.own).can_prefix),
      home_state_(traits.absolute && traits.gear_ratio != 1.0 ? 2 : 1) {
  restart();
}

bool MoteusDrive::meant(const CanFrame& frame) const noexcept {
  if (frame.type != FrameType::kData) return false;
  const std::uint32_t destination = frame.id.value & 0xFFU;
  if (destination != id_ && destination != kEverybody) return false;
  return !frame.id.extended || frame.id.value >> 16U == prefix_;
}

// Answers are grouped as the questions are. A read of something that is not there ends the frame with an
// error. Source: mjbots/mjlib, mjlib/multiplex/micro_server.cc.
void MoteusDrive::receive(const CanFrame& frame) noexcept {
  if (!meant(frame)) return;
  const std::uint32_t source = frame.id.value >> 8U & 0xFFU;
  moteus::Writer reply({prefix_ << 16U | id_ << 8U | (source & 0x7FU), false}, frame.bit_rate_switch);
  moteus::Reader reader(frame.payload());
  moteus::Item item;
  bool commanded = false;
  std::array<double, kMaxPayload> values{};
  std::size_t count = 0;
  // Readings are those from before the command: it acts when the frame is done.
  while (reader.next(item) == moteus::Reader::Step::kItem) {
    if (item.kind == moteus::Item::Kind::kWrite) {
      if (const auto code = write(item, commanded); code != 0) reply.error(false, item.reg, code);
    }
    if (item.kind != moteus::Item::Kind::kRead) continue;
    const auto value = read(item.reg, item.type);
    if (!value || count == values.size()) {
      reply.error(true, item.reg, kUnknownRegister);
      break;
    }
    values[count++] = *value;
    if (item.left > 1) continue;
    const auto first = static_cast<moteus::Register>(static_cast<std::uint32_t>(item.reg) + 1U -
                                                     static_cast<std::uint32_t>(count));
    reply.reply(item.type, first, std::span<const double>{values}.first(count));
    count = 0;
  }
  if (commanded) obey();
  if ((source & 0x80U) == 0) return;
  CanFrame out = reply.frame();
  out.id.extended = out.id.value > kStandardIdMask;
  out.fd = frame.fd || out.length > 8;
  answer(out);
}

double* MoteusDrive::commandOf(moteus::Register reg) noexcept {
  using enum moteus::Register;
  switch (reg) {
    case kPwmPhaseA: return &command_.pwm[0];
    case kPwmPhaseB: return &command_.pwm[1];
    case kPwmPhaseC: return &command_.pwm[2];
    case kVoltagePhaseA: return &command_.phase_v[0];
    case kVoltagePhaseB: return &command_.phase_v[1];
    case kVoltagePhaseC: return &command_.phase_v[2];
    case kVoltageFocTheta: return &command_.foc_theta;
    case kVoltageFoc: return &command_.foc_v;
    case kVoltageFocThetaRate: return &command_.foc_theta_rate;
    case kVoltageDqD: return &command_.d_v;
    case kVoltageDqQ: return &command_.q_v;
    case kCommandQCurrent: return &command_.q_a;
    case kCommandDCurrent: return &command_.d_a;
    case kCommandPosition: return &command_.position_rev;
    case kCommandVelocity: return &command_.velocity_rev_s;
    case kStopPosition: return &command_.stop_rev;
    case kCommandTorque:
    case kStayWithinTorque: return &command_.torque_nm;
    case kKpScale:
    case kStayWithinKpScale: return &command_.kp_scale;
    case kKdScale:
    case kStayWithinKdScale: return &command_.kd_scale;
    case kIlimitScale:
    case kStayWithinIlimitScale: return &command_.ilimit_scale;
    case kMaxTorque:
    case kStayWithinMaxTorque: return &command_.max_torque_nm;
    case kTimeout:
    case kStayWithinTimeout: return &command_.timeout_s;
    case kVelocityLimit: return &command_.limit_rev_s;
    case kAccelerationLimit: return &command_.limit_rev_s2;
    case kFixedVoltage: return &command_.fixed_v;
    case kFixedCurrent: return &command_.fixed_a;
    case kIgnorePositionBounds:
    case kStayWithinIgnorePositionBounds: return &command_.ignore_bounds;
    case kStayWithinLower: return &command_.lower_rev;
    case kStayWithinUpper: return &command_.upper_rev;
    default: return nullptr;
  }
}

std::uint8_t MoteusDrive::write(const moteus::Item& item, bool& commanded) noexcept {
  if (item.reg == moteus::Register::kMode) {
    if (!(item.value >= 0.0 && item.value <= 15.0)) return kUnknownRegister;
    command_ = {};
    command_.mode = static_cast<moteus::Mode>(item.value);
    commanded = true;
    return 0;
  }
  if (double* const value = commandOf(item.reg); value != nullptr) {
    *value = inSinglePrecision(item);
    return 0;
  }
  return read(item.reg, moteus::Type::kInt32) ? kReadOnly : kUnknownRegister;
}

std::optional<double> MoteusDrive::read(moteus::Register reg, moteus::Type type) noexcept {
  switch (reg) {
    case moteus::Register::kMode: return static_cast<double>(mode_);
    case moteus::Register::kPosition: return positionRev();
    case moteus::Register::kVelocity: return driveRpm() / kRpmPerTurnPerS;
    case moteus::Register::kTorque: return driveTorqueNm();
    case moteus::Register::kQCurrent: return currentA();
    case moteus::Register::kDCurrent:
    case moteus::Register::kAbsolutePosition:
    case moteus::Register::kMotorTemperature: return 0.0;  // no second encoder, no thermistor
    case moteus::Register::kPower: return driveTorqueNm() * driveRpm() * kRadPerSPerRpm;
    case moteus::Register::kTrajectoryComplete: return arrived() ? 1.0 : 0.0;
    case moteus::Register::kHomeState: return home_state_;
    case moteus::Register::kVoltage: return physics().parameters().supply_v;
    case moteus::Register::kTemperature: return physics().temperatureC();
    case moteus::Register::kFault: return fault_;
    case moteus::Register::kMilliseconds: return milliseconds(type);
    case moteus::Register::kRegisterMapVersion:
      return type == moteus::Type::kInt32 ? std::optional<double>{version_} : std::nullopt;
    default: break;
  }
  const double* const command = commandOf(reg);
  return command != nullptr ? std::optional{*command} : std::nullopt;
}

double MoteusDrive::milliseconds(moteus::Type type) const noexcept {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(clock_).count();
  switch (type) {
    case moteus::Type::kInt8: return static_cast<std::int8_t>(ms & 0xFF);
    case moteus::Type::kInt16: return static_cast<std::int16_t>(ms & 0xFFFF);
    case moteus::Type::kInt32: return static_cast<std::int32_t>(ms & 0xFFFF'FFFF);
    case moteus::Type::kFloat: break;
  }
  return static_cast<double>(ms & 0x7F'FFFF);
}

void MoteusDrive::obey() noexcept {
  if (std::isnan(command_.timeout_s) || command_.timeout_s != 0.0) {
    left_s_ = command_.timeout_s;
  } else {
    left_s_ = kDefaultTimeoutSeconds;
  }
  if (command_.mode == moteus::Mode::kStopped) {
    change(moteus::Mode::kStopped);
    fault_ = 0;
    return;
  }
  if (command_.mode < moteus::Mode::kPwm) return;  // not to be commanded
  // A fault or a time-out is left by a stop only.
  if (mode_ == moteus::Mode::kStopped) return change(moteus::Mode::kEnabling);
  const bool driven = mode_ >= moteus::Mode::kPwm && mode_ != moteus::Mode::kTimeout;
  if (driven && mode_ != command_.mode) change(command_.mode);
}

void MoteusDrive::change(moteus::Mode mode) noexcept {
  mode_ = mode;
  switching_ = Duration::zero();
  course_rev_ = kNaN;
}

double MoteusDrive::positionRev() const noexcept {
  return std::remainder(driveAngleDeg() / kDegPerTurn, 65536.0);
}

double MoteusDrive::kd() const noexcept {
  const auto& p = physics().parameters();
  const double ratio = p.gear_ratio / traits().gear_ratio;  // of the gear behind the drive's own output
  const double inertia = p.totalInertia() / (ratio * ratio);
  return 2.0 * inertia * kBandwidthRadS * kRadPerTurn;  // N·m per rev/s
}

double MoteusDrive::kp() const noexcept { return kd() * kBandwidthRadS / 2.0; }  // N·m per rev

void MoteusDrive::damp(double kd_scale, double max_torque_nm) noexcept {
  torque(std::clamp(-kd_scale * kd() * driveRpm() / kRpmPerTurnPerS, -max_torque_nm, max_torque_nm));
}

// With limits it gets there by a profile of its own: speeds up, and begins in time to slow down.
void MoteusDrive::profile(double goal_rev, double dt_s) noexcept {
  const double most_rev_s = command_.limit_rev_s > 0.0 ? command_.limit_rev_s : kFastestRevPerS;
  const double most_rev_s2 = command_.limit_rev_s2 > 0.0 ? command_.limit_rev_s2 : kAccelerationRevPerS2;
  const double left_rev = goal_rev - course_rev_;
  const double step_rev_s = most_rev_s2 * dt_s;
  if (std::abs(left_rev) < step_rev_s * dt_s && std::abs(course_rev_s_) <= 2.0 * step_rev_s) {
    course_rev_ = goal_rev;
    course_rev_s_ = 0.0;
    return;
  }
  const double braking_rev_s = std::sqrt(2.0 * most_rev_s2 * std::abs(left_rev));
  const double wanted_rev_s =
      std::copysign(std::min({most_rev_s, braking_rev_s, std::abs(left_rev) / dt_s}), left_rev);
  course_rev_s_ += std::clamp(wanted_rev_s - course_rev_s_, -step_rev_s, step_rev_s);
  course_rev_ += course_rev_s_ * dt_s;
}

void MoteusDrive::positionControl(double dt_s) noexcept {
  const double here_rev = driveAngleDeg() / kDegPerTurn;
  if (std::isnan(course_rev_)) {
    course_rev_ = here_rev;
    course_rev_s_ = driveRpm() / kRpmPerTurnPerS;
  }
  const double told_rev_s = std::isnan(command_.velocity_rev_s) ? 0.0 : command_.velocity_rev_s;
  const bool told = !std::isnan(command_.position_rev);
  // The nearest of the positions that read like this one.
  const double goal_rev = here_rev + std::remainder(command_.position_rev - here_rev, 65536.0);
  if (told && !command_.atOnce()) {
    profile(goal_rev, dt_s);
    command_.position_rev += told_rev_s * dt_s;
  } else {
    if (told) course_rev_ = goal_rev;
    command_.position_rev = kNaN;
    course_rev_s_ = told_rev_s;
    course_rev_ += course_rev_s_ * dt_s;
  }

  const double wanted_nm = command_.kp_scale * kp() * (course_rev_ - here_rev) +
                           command_.kd_scale * kd() * (course_rev_s_ - driveRpm() / kRpmPerTurnPerS) +
                           command_.torque_nm;
  push(wanted_nm);
}

void MoteusDrive::push(double wanted_nm) noexcept {
  constexpr double kUnbounded = static_cast<double>(std::numeric_limits<float>::max());
  const double most_nm =
      std::isnan(command_.max_torque_nm) ? kUnbounded : std::max(0.0, command_.max_torque_nm);
  fault_ = std::abs(wanted_nm) > most_nm ? kMaxTorqueLimit : 0;
  torque(std::isnan(wanted_nm) ? 0.0 : std::clamp(wanted_nm, -most_nm, most_nm));
}

// Held to the bound that it is beyond; between them the feed-forward alone acts.
void MoteusDrive::stayWithin() noexcept {
  const double here_rev = driveAngleDeg() / kDegPerTurn;
  double bound_rev = kNaN;
  if (here_rev > command_.upper_rev) bound_rev = command_.upper_rev;
  if (here_rev < command_.lower_rev) bound_rev = command_.lower_rev;
  if (std::isnan(bound_rev)) return push(command_.torque_nm);
  push(command_.kp_scale * kp() * (bound_rev - here_rev) -
       command_.kd_scale * kd() * driveRpm() / kRpmPerTurnPerS + command_.torque_nm);
}

bool MoteusDrive::arrived() const noexcept {
  return mode_ != moteus::Mode::kPosition || command_.atOnce() || course_rev_s_ == 0.0;
}

void MoteusDrive::control(double dt_s) noexcept {
  // Other modes are not watched.
  const bool watched = mode_ == moteus::Mode::kPosition || mode_ == moteus::Mode::kStayWithin;
  if (left_s_ > 0.0) left_s_ = std::max(0.0, left_s_ - dt_s);
  if (watched && left_s_ <= 0.0) change(moteus::Mode::kTimeout);
  switch (mode_) {
    case moteus::Mode::kPosition: return positionControl(dt_s);
    case moteus::Mode::kStayWithin: return stayWithin();
    case moteus::Mode::kCurrent: return current(std::isnan(command_.q_a) ? 0.0 : command_.q_a);
    case moteus::Mode::kVoltageDq: return voltage(std::isnan(command_.q_v) ? 0.0 : command_.q_v);
    case moteus::Mode::kPwm:
    case moteus::Mode::kVoltage:
    case moteus::Mode::kVoltageFoc:
    case moteus::Mode::kBrake: return shortWinding();
    case moteus::Mode::kZeroVelocity: return damp(command_.kd_scale, kTimeoutTorqueNm);
    case moteus::Mode::kTimeout: return damp(1.0, kTimeoutTorqueNm);
    case moteus::Mode::kEnabling:
    case moteus::Mode::kCalibrating:
    case moteus::Mode::kCalibrated:
      switching_ += std::chrono::duration_cast<Duration>(std::chrono::duration<double>(dt_s));
      if (switching_ >= kSwitchTime / 2) mode_ = moteus::Mode::kCalibrating;
      if (switching_ >= kSwitchTime) change(command_.mode);
      return release();
    case moteus::Mode::kMeasureInductance:
    case moteus::Mode::kStopped:
    case moteus::Mode::kFault: return release();
  }
}

void MoteusDrive::step(Duration dt) noexcept {
  for (Duration left = dt; left > Duration::zero();) {
    const Duration part = std::min(left, MotorPhysics::kLongestStep);
    control(std::chrono::duration<double>(part).count());
    ServoDrive::step(part);
    left -= part;
  }
  clock_ += std::max(dt, Duration::zero());
}

void MoteusDrive::restart() noexcept {
  change(moteus::Mode::kStopped);
  command_ = {};
  fault_ = 0;
  clock_ = Duration::zero();
  release();
  // Where it is at power-up is known within one turn of the rotor.
  if (home_state_ == 2) {
    zeroAt(wrapHalfTurn(driveAngleDeg()));
  } else {
    zeroAt(wrapHalfTurn(driveAngleDeg() * traits().gear_ratio) / traits().gear_ratio);
  }
}

void MoteusDrive::fault(std::uint32_t native_code) noexcept {
  if (native_code == 0 || native_code >= kFirstLimit) {
    if (mode_ == moteus::Mode::kFault) change(moteus::Mode::kStopped);
    fault_ = 0;
    return;
  }
  change(moteus::Mode::kFault);
  fault_ = native_code;
}

std::unique_ptr<Drive> makeMoteusDrive(const MotorSettings& settings, const MotorLoad& load) {
  return std::make_unique<MoteusDrive>(settings, moteusFamily().traits(settings.model, settings.own), load);
}

}  // namespace rc10::sim
