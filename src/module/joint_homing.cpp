#include "module/joint_homing.hpp"

#include <algorithm>
#include <cmath>

namespace rc10 {
namespace {

// Of the homing velocity: slower than this it stands still.
constexpr double kStill = 0.1;
// The full current pushes until this part of the homing velocity is missing.
constexpr double kFullPush = 0.5;

}  // namespace

void JointHoming::start(const Measured& measured) noexcept {
  phase_ = Phase::kAway;
  start_deg_ = measured.total_angle_deg;
  started_ = measured.now;
  moved_ = measured.now;
  current_a_ = 0.0;
}

JointHoming::Progress JointHoming::step(const Measured& measured) noexcept {
  const bool blind = config_.way == Way::kSwitch && !measured.switch_heard;
  if (measured.now - started_ >= config_.timeout || !std::isfinite(measured.total_angle_deg) || blind) {
    current_a_ = 0.0;
    return Progress::kFailed;
  }
  if (phase_ == Phase::kAway) {
    const double gone_deg =
        (measured.total_angle_deg - start_deg_) * std::copysign(1.0, -config_.velocity_rpm);
    if (gone_deg < config_.away_deg || measured.at_switch) {
      push(-config_.velocity_rpm, measured.velocity_rpm);
      return Progress::kUnderWay;
    }
    phase_ = Phase::kTowards;
    moved_ = measured.now;
  }
  const bool still = standsStill(measured);
  const bool found = config_.way == Way::kSwitch ? measured.at_switch : still;
  if (found) {
    current_a_ = 0.0;
    return Progress::kFound;
  }
  push(config_.velocity_rpm, measured.velocity_rpm);
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

}  // namespace rc10
