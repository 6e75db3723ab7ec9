#include "drives/moteus/moteus_simulated.hpp"
#include "app/units.hpp"
#include "drives/moteus/moteus_family.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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
// Of gains that somebody has tuned for the load.
constexpr double kBandwidthRadS = 120.0;
constexpr std::uint32_t kEverybody = 0x7F;
constexpr std::uint32_t kFirstLimit = 96;  // codes from here on bound the output and are no faults
constexpr std::uint32_t kMaxTorqueLimit = 102;

[[nodiscard]] std::vector<FrameFilter> sentBy(const MotorSettings& settings) {
  return {FrameFilter{.id = moteus::replyId(moteusSettings(settings.own).can_prefix,
                                            static_cast<std::uint32_t>(settings.id))}};
}

/// Where it is at power-up is known within one turn of the rotor.
[[nodiscard]] double withinTurn(double deg) noexcept { return std::remainder(deg, kDegPerTurn); }

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

void MoteusDrive::receive(const CanFrame& frame) noexcept {
  if (!meant(frame)) return;
  const std::uint32_t source = frame.id.value >> 8U & 0xFFU;
  moteus::Writer reply({prefix_ << 16U | id_ << 8U | (source & 0x7FU), false}, frame.bit_rate_switch);
  moteus::Reader reader(frame.payload());
  moteus::Item item;
  bool commanded = false;
  // Readings are those from before the command: it acts when the frame is done.
  while (reader.next(item) == moteus::Reader::Step::kItem) {
    if (item.kind == moteus::Item::Kind::kWrite) write(item, commanded);
    if (item.kind == moteus::Item::Kind::kRead) reply.reply(item.type, item.reg, {read(item.reg)});
  }
  if (commanded) obey();
  if ((source & 0x80U) == 0) return;
  CanFrame out = reply.frame();
  out.id.extended = out.id.value > kStandardIdMask;
  out.fd = frame.fd || out.length > 8;
  answer(out);
}

void MoteusDrive::write(const moteus::Item& item, bool& commanded) noexcept {
  switch (item.reg) {
    case moteus::Register::kMode:
      if (!(item.value >= 0.0 && item.value <= 15.0)) return;
      command_ = {};
      command_.mode = static_cast<moteus::Mode>(item.value);
      commanded = true;
      return;
    case moteus::Register::kCommandPosition: command_.position_rev = item.value; return;
    case moteus::Register::kCommandVelocity: command_.velocity_rev_s = item.value; return;
    case moteus::Register::kCommandTorque: command_.torque_nm = item.value; return;
    case moteus::Register::kKpScale: command_.kp_scale = item.value; return;
    case moteus::Register::kKdScale: command_.kd_scale = item.value; return;
    case moteus::Register::kMaxTorque:
      command_.max_torque_nm = std::isnan(item.value) ? std::nullopt : std::optional{item.value};
      return;
    case moteus::Register::kTimeout: command_.timeout_s = item.value; return;
    case moteus::Register::kVelocityLimit: command_.limit_rev_s = item.value; return;
    case moteus::Register::kAccelerationLimit: command_.limit_rev_s2 = item.value; return;
    default: return;
  }
}

double MoteusDrive::read(moteus::Register reg) const noexcept {
  switch (reg) {
    case moteus::Register::kMode: return static_cast<double>(mode_);
    case moteus::Register::kPosition: return positionRev();
    case moteus::Register::kVelocity: return driveRpm() / kRpmPerTurnPerS;
    case moteus::Register::kTorque: return driveTorqueNm();
    case moteus::Register::kQCurrent: return currentA();
    case moteus::Register::kHomeState: return home_state_;
    case moteus::Register::kVoltage: return physics().parameters().supply_v;
    case moteus::Register::kTemperature: return physics().temperatureC();
    case moteus::Register::kFault: return fault_;
    case moteus::Register::kTimeout: return command_.timeout_s;
    case moteus::Register::kRegisterMapVersion: return version_;
    case moteus::Register::kMilliseconds: {
      const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(clock_).count();
      return static_cast<std::int16_t>(ms & 0xFFFF);
    }
    default: return 0.0;
  }
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
  const bool known = command_.mode == moteus::Mode::kPosition || command_.mode == moteus::Mode::kBrake ||
                     command_.mode == moteus::Mode::kZeroVelocity;
  if (!known) return;
  switch (mode_) {
    case moteus::Mode::kStopped: return change(moteus::Mode::kEnabling);
    case moteus::Mode::kPosition:
    case moteus::Mode::kBrake:
    case moteus::Mode::kZeroVelocity:
      if (mode_ != command_.mode) change(command_.mode);
      return;
    default: return;  // a fault or a time-out is left by a stop only
  }
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
  return 2.0 * inertia * kBandwidthRadS * 2.0 * std::numbers::pi;  // N·m per rev/s
}

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

  const double kp = kd() * kBandwidthRadS / 2.0;  // N·m per rev
  const double wanted_nm = command_.kp_scale * kp * (course_rev_ - here_rev) +
                           command_.kd_scale * kd() * (course_rev_s_ - driveRpm() / kRpmPerTurnPerS) +
                           command_.torque_nm;
  const double most_nm = std::max(0.0, command_.max_torque_nm.value_or(std::numeric_limits<float>::max()));
  fault_ = std::abs(wanted_nm) > most_nm ? kMaxTorqueLimit : 0;
  torque(std::isnan(wanted_nm) ? 0.0 : std::clamp(wanted_nm, -most_nm, most_nm));
}

void MoteusDrive::control(double dt_s) noexcept {
  // Only position mode is watched.
  if (left_s_ > 0.0) left_s_ = std::max(0.0, left_s_ - dt_s);
  if (mode_ == moteus::Mode::kPosition && left_s_ <= 0.0) change(moteus::Mode::kTimeout);
  switch (mode_) {
    case moteus::Mode::kPosition: return positionControl(dt_s);
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
  if (home_state_ == 2) {
    zeroAt(withinTurn(driveAngleDeg()));
  } else {
    zeroAt(withinTurn(driveAngleDeg() * traits().gear_ratio) / traits().gear_ratio);
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
