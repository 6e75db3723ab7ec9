#include "motor/cascade.hpp"

#include <algorithm>
#include <cmath>

#include "app/angle.hpp"
#include "app/limits.hpp"

namespace rc10 {
namespace {

std::variant<PID_Incremental, PID_Position> makeVelocityLoop(const CascadeConfig& config) {
  if (const auto* incremental = std::get_if<PID_Incremental::Config>(&config.velocity)) {
    return PID_Incremental{*incremental};
  }
  return PID_Position{std::get<PID_Position::Config>(config.velocity)};
}

bool closesLoop(ControlMode mode) noexcept {
  return mode == ControlMode::kVelocity || mode == ControlMode::kAngle || mode == ControlMode::kTotalAngle;
}

bool allFinite(const Target& target, const Cascade::Measured& measured, float effort_ff) noexcept {
  const double sum =
      target.value + measured.total_angle_deg +
      static_cast<double>(target.velocity_ff_rpm + measured.angle_deg + measured.velocity_rpm + effort_ff);
  if (std::isfinite(sum)) return true;  // only if each of them is, as nearly always
  return std::isfinite(target.value) && std::isfinite(target.velocity_ff_rpm) &&
         std::isfinite(measured.angle_deg) && std::isfinite(measured.total_angle_deg) &&
         std::isfinite(measured.velocity_rpm) && std::isfinite(effort_ff);
}

}  // namespace

Cascade::Cascade(const CascadeConfig& config)
    : config_(config),
      velocity_range_(OutputRange{}.within(config.velocity_limit_rpm)),
      velocity_(makeVelocityLoop(config)),
      angle_(config.angle) {}

void Cascade::retune(const CascadeConfig& config) noexcept {
  if (config.velocity.index() != config_.velocity.index()) return;
  config_ = config;
  boundSpeeds(speeds_rpm_);
  angle_.retune(config.angle);
  auto* incremental = std::get_if<PID_Incremental>(&velocity_);
  if (incremental != nullptr) {
    incremental->retune(*std::get_if<PID_Incremental::Config>(&config.velocity));
  } else {
    std::get_if<PID_Position>(&velocity_)->retune(*std::get_if<PID_Position::Config>(&config.velocity));
  }
}

void Cascade::boundSpeeds(const OutputRange& speeds_rpm) noexcept {
  speeds_rpm_ = speeds_rpm;
  const OutputRange limit = OutputRange{}.within(config_.velocity_limit_rpm);
  velocity_range_ = {std::max(limit.low, speeds_rpm.low), std::min(limit.high, speeds_rpm.high)};
}

void Cascade::reset() noexcept {
  active_mode_ = ControlMode::kCoast;
  velocity_limited_ = false;
  effort_limited_ = false;
}

float Cascade::velocityTarget(const Target& target, const Measured& measured, float dt_s) noexcept {
  const OutputRange& range = velocity_range_;
  float wanted = 0.0F;
  if (target.mode == ControlMode::kVelocity) {
    wanted = nearFloat(target.value);
  } else {
    const double error = target.mode == ControlMode::kAngle
                             ? shortestAngle(static_cast<double>(measured.angle_deg), target.value)
                             : target.value - measured.total_angle_deg;
    const float moved = nearFloat(measured.total_angle_deg - last_total_angle_deg_);
    const float ff = saturate(target.velocity_ff_rpm);
    wanted = ff + angle_.stepError(nearFloat(error), moved, dt_s, range.shifted(-ff));
  }
  const float limited = range.clamp(wanted);
  // The angle loop knows the limit and stops there; a velocity target may lie beyond it.
  velocity_limited_ = target.mode == ControlMode::kVelocity ? limited != wanted
                                                            : limited <= range.low || limited >= range.high;
  last_total_angle_deg_ = measured.total_angle_deg;
  return limited;
}

bool Cascade::dropWindup(float effort_in_force, float measured_rpm, float least_rpm) noexcept {
  if (!closesLoop(active_mode_)) return false;
  const auto drops = [&](auto& loop) noexcept {
    const float asked_rpm = measured_rpm + loop.state().error;
    const bool pushes = std::fabs(asked_rpm) > least_rpm && asked_rpm * effort_in_force > 0.0F;
    if (pushes && effort_limited_ && measured_rpm / asked_rpm < 0.5F) {
      loop.start(0.0F, measured_rpm, measured_rpm);
      return true;
    }
    loop.takeOver(effort_in_force - loop.state().output);
    return false;
  };
  auto* incremental = std::get_if<PID_Incremental>(&velocity_);
  const bool dropped =
      incremental != nullptr ? drops(*incremental) : drops(*std::get_if<PID_Position>(&velocity_));
  if (dropped) angle_.reset();
  return dropped;
}

float Cascade::step(const Target& target, const Measured& measured, float dt_s, float effort_limit,
                    float effort_in_force, float effort_ff) noexcept {
  if (!closesLoop(target.mode) || !allFinite(target, measured, effort_ff)) {
    reset();
    return 0.0F;
  }
  const bool fresh = active_mode_ != target.mode;
  if (fresh) {
    angle_.reset();
    last_total_angle_deg_ = measured.total_angle_deg;
    active_mode_ = target.mode;
  }
  const float velocity_target = velocityTarget(target, measured, dt_s);

  const OutputRange range = OutputRange::symmetric(effort_limit);
  const bool beyond = (measured.velocity_rpm > speeds_rpm_.high && effort_in_force > 0.0F) ||
                      (measured.velocity_rpm < speeds_rpm_.low && effort_in_force < 0.0F);
  const auto advance = [&](auto& loop) noexcept {
    if (beyond && std::fabs(measured.velocity_rpm) > std::fabs(loop.state().measured)) {
      loop.start(0.5F * effort_in_force - effort_ff, measured.velocity_rpm, measured.velocity_rpm);
    } else if (fresh) {
      loop.start(effort_in_force - effort_ff, measured.velocity_rpm, velocity_target);
    }
    return loop.step(velocity_target, measured.velocity_rpm, dt_s, range.shifted(-effort_ff));
  };
  auto* incremental = std::get_if<PID_Incremental>(&velocity_);
  const float effort =
      incremental != nullptr ? advance(*incremental) : advance(*std::get_if<PID_Position>(&velocity_));
  const float limited = range.clamp(effort + effort_ff);
  effort_limited_ = limited <= range.low || limited >= range.high;
  return limited;
}

}  // namespace rc10
