#include "module/joint_homing.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

// Share of the homing velocity: slower than this it stands still.
constexpr double kStill = 0.1;
// The full current pushes until this part of the velocity is missing.
constexpr double kFullPush = 0.5;
// Share of the homing current: as much must be measured at the stop. Drives are some percent off.
constexpr double kPressed = 0.7;
// Share of the homing velocity, on the second way.
constexpr double kSlower = 0.5;

}  // namespace

void JointHoming::start(const Measured& measured) noexcept {
  start_deg_ = measured.total_angle_deg;
  started_ = measured.now;
  current_a_ = 0.0;
  begin(Phase::kAway, measured);
}

void JointHoming::begin(Phase phase, const Measured& measured) noexcept {
  phase_ = phase;
  left_deg_ = measured.total_angle_deg;
  moved_ = measured.now;
}

JointHoming::Progress JointHoming::step(const Measured& measured) noexcept {
  const bool blind = config_.way == Way::kSwitch && !measured.switch_heard;
  if (measured.now - started_ >= config_.timeout || !std::isfinite(measured.total_angle_deg) || blind)
    return end(Progress::kFailed);
  if (phase_ == Phase::kAway || phase_ == Phase::kBackOff) {
    if (towards(measured.total_angle_deg, left_deg_) < config_.away_deg || measured.at_switch) {
      push(-config_.velocity_rpm, measured.velocity_rpm);
      return Progress::kUnderWay;
    }
    begin(phase_ == Phase::kAway ? Phase::kTowards : Phase::kAgain, measured);
  }
  if (config_.way == Way::kSwitch && measured.at_switch) return end(Progress::kFound);
  if (config_.way == Way::kStop && standsStill(measured)) return stoodStill(measured);
  push((phase_ == Phase::kAgain ? kSlower : 1.0) * config_.velocity_rpm, measured.velocity_rpm);
  return Progress::kUnderWay;
}

JointHoming::Progress JointHoming::end(Progress outcome) noexcept {
  current_a_ = 0.0;
  return outcome;
}

JointHoming::Progress JointHoming::stoodStill(const Measured& measured) noexcept {
  const double here_deg = measured.total_angle_deg;
  const double beyond_start_deg = towards(start_deg_, here_deg);
  const bool plausible = beyond_start_deg >= -config_.tolerance_deg &&
                         beyond_start_deg <= config_.travel_deg + config_.away_deg && pressed(measured);
  if (!plausible) return end(Progress::kNoStop);
  if (phase_ == Phase::kAgain) {
    const bool twice = std::fabs(here_deg - met_deg_) <= config_.tolerance_deg;
    return end(twice ? Progress::kFound : Progress::kNoStop);
  }
  met_deg_ = here_deg;
  begin(Phase::kBackOff, measured);
  push(-config_.velocity_rpm, measured.velocity_rpm);
  return Progress::kUnderWay;
}

void JointHoming::push(double velocity_rpm, double measured_rpm) noexcept {
  const double missing = (velocity_rpm - measured_rpm) / (kFullPush * std::fabs(velocity_rpm));
  current_a_ = std::isfinite(missing) ? std::clamp(missing, -1.0, 1.0) * config_.current_a : 0.0;
}

bool JointHoming::standsStill(const Measured& measured) noexcept {
  if (std::fabs(measured.velocity_rpm) > kStill * std::fabs(config_.velocity_rpm)) moved_ = measured.now;
  return measured.now - moved_ >= config_.stopped;
}

bool JointHoming::pressed(const Measured& measured) const noexcept {
  const double towards_a = std::copysign(measured.current_a, measured.current_a * config_.velocity_rpm);
  return std::isnan(measured.current_a) || towards_a >= kPressed * config_.current_a;
}

double JointHoming::towards(double from_deg, double to_deg) const noexcept {
  return (to_deg - from_deg) * std::copysign(1.0, config_.velocity_rpm);
}

}  // namespace rc10
