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
// A current that is slewed, or comes softly after enabling, is waited for as long as it rises by this share
// within this time.
constexpr double kRises = 0.01;
constexpr Duration kPatience = std::chrono::seconds{1};

}  // namespace

void JointHoming::start(const Measured& measured) noexcept {
  start_deg_ = measured.total_angle_deg;
  started_ = measured.now;
  current_a_ = 0.0;
  went_away_ = false;
  begin(Phase::kAway, measured);
}

void JointHoming::begin(Phase phase, const Measured& measured) noexcept {
  phase_ = phase;
  left_deg_ = still_deg_ = measured.total_angle_deg;
  moved_ = rose_ = measured.received;
  most_a_ = 0.0;
}

JointHoming::Progress JointHoming::step(const Measured& measured) noexcept {
  const bool blind = config_.way == Way::kSwitch && !measured.switch_heard;
  if (measured.now - started_ >= config_.timeout || !std::isfinite(measured.total_angle_deg) || blind)
    return end(Progress::kFailed);
  const bool away = phase_ == Phase::kAway || phase_ == Phase::kBackOff;
  return away ? goAway(measured) : goTowards(measured);
}

JointHoming::Progress JointHoming::end(Progress outcome) noexcept {
  current_a_ = 0.0;
  return outcome;
}

JointHoming::Progress JointHoming::goAway(const Measured& measured) noexcept {
  const double gone_deg = towards(measured.total_angle_deg, left_deg_);
  if (gone_deg >= config_.away_deg && !measured.at_switch) {
    went_away_ = true;
    begin(phase_ == Phase::kAway ? Phase::kTowards : Phase::kAgain, measured);
    return goTowards(measured);
  }
  // A switch that stays closed, or an axis that has come loose.
  if (gone_deg > config_.travel_deg + config_.away_deg) return end(Progress::kFailed);
  if (standstill(measured, -1.0) != Standstill::kNone) {
    // It began at its far end: whether it moves at all is seen on the way towards.
    if (phase_ != Phase::kAway || measured.at_switch) return end(Progress::kFailed);
    begin(Phase::kTowards, measured);
    return goTowards(measured);
  }
  push(-config_.velocity_rpm, measured.velocity_rpm);
  return Progress::kUnderWay;
}

JointHoming::Progress JointHoming::goTowards(const Measured& measured) noexcept {
  const bool moves = went_away_ || towards(start_deg_, measured.total_angle_deg) >= config_.away_deg;
  if (towards(start_deg_, measured.total_angle_deg) > config_.travel_deg + config_.away_deg)
    return end(Progress::kNoStop);
  const auto still = standstill(measured, 1.0);
  if (still != Standstill::kNone && !moves) return end(Progress::kFailed);
  if (still == Standstill::kGivenUp) return end(Progress::kNoStop);
  if (config_.way == Way::kSwitch) {
    if (measured.at_switch) return meet(measured);
    if (still == Standstill::kPressed) return end(Progress::kNoStop);
  } else if (still == Standstill::kPressed) {
    const bool nearer = towards(start_deg_, measured.total_angle_deg) < -config_.tolerance_deg;
    return nearer ? end(Progress::kNoStop) : meet(measured);
  }
  push((phase_ == Phase::kAgain ? kSlower : 1.0) * config_.velocity_rpm, measured.velocity_rpm);
  return Progress::kUnderWay;
}

JointHoming::Progress JointHoming::meet(const Measured& measured) noexcept {
  const double here_deg = measured.total_angle_deg;
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

// By samples, so that neither a gap of the feedback nor a pause of the process is a standstill.
JointHoming::Standstill JointHoming::standstill(const Measured& measured, double direction) noexcept {
  const bool fast = std::fabs(measured.velocity_rpm) > kStill * std::fabs(config_.velocity_rpm);
  const double way_deg = std::fabs(measured.total_angle_deg - still_deg_);
  const double pushed_a =
      direction * std::copysign(measured.current_a, measured.current_a * config_.velocity_rpm);
  const bool rises = pushed_a > most_a_ + kRises * config_.current_a;
  if (fast || way_deg > config_.tolerance_deg) {
    moved_ = rose_ = measured.received;
    still_deg_ = measured.total_angle_deg;
    most_a_ = 0.0;
  } else if (rises) {
    rose_ = measured.received;
    most_a_ = pushed_a;
  }
  if (measured.received - moved_ < config_.stopped) return Standstill::kNone;
  if (std::isnan(pushed_a) || pushed_a >= kPressed * config_.current_a) return Standstill::kPressed;
  return measured.received - rose_ >= config_.stopped + kPatience ? Standstill::kGivenUp : Standstill::kNone;
}

double JointHoming::towards(double from_deg, double to_deg) const noexcept {
  return (to_deg - from_deg) * std::copysign(1.0, config_.velocity_rpm);
}

}  // namespace rc10
